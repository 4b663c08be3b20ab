// Runs `lampyris check`, with or without a scene.
#ifndef LAMPYRIS_CLI_CHECK_CHECK_COMMAND_H
#define LAMPYRIS_CLI_CHECK_CHECK_COMMAND_H

struct options;

// Both return the exit code: EXIT_CODE_CHECK_FAILED if something is found, or if a case fails.
int check_scene_command(const struct options *options);
int check_device_command(const struct options *options);

#endif
