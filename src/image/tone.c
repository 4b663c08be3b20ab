typedef int tone_placeholder;
