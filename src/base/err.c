typedef int err_placeholder;
