typedef int image_exr_placeholder;
