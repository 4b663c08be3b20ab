typedef int load_gltf_placeholder;
