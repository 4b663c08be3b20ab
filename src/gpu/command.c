typedef int command_placeholder;
