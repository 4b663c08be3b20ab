typedef int clock_placeholder;
