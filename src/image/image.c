typedef int image_placeholder;
