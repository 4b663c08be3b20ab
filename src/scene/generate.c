typedef int generate_placeholder;
