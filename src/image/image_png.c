typedef int image_png_placeholder;
