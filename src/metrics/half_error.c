typedef int half_error_placeholder;
