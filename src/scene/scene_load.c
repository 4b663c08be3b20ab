typedef int scene_load_placeholder;
