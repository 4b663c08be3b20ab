typedef int volk_placeholder;
