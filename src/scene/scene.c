typedef int scene_placeholder;
