typedef int flatten_placeholder;
