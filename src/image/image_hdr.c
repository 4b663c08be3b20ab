typedef int image_hdr_placeholder;
