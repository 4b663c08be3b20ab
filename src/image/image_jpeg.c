typedef int image_jpeg_placeholder;
