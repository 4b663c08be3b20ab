typedef int buffer_placeholder;
