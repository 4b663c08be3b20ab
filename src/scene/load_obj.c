typedef int load_obj_placeholder;
