typedef int load_ply_placeholder;
