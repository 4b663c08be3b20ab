// What `lampyris check` runs: with a scene and without.
#ifndef LAMPYRIS_CLI_CHECK_CHECK_COMMAND_H
#define LAMPYRIS_CLI_CHECK_CHECK_COMMAND_H

struct options;

// Each returns the exit code: EXIT_CODE_CHECK_FAILED where something is found, or fails.
int check_scene_command(const struct options *options);
int check_device_command(const struct options *options);

#endif
