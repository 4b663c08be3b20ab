typedef int arena_placeholder;
