typedef int file_placeholder;
