// Implements `lampyris check` with and without a scene.
#ifndef LAMPYRIS_CLI_CHECK_CHECK_COMMAND_H
#define LAMPYRIS_CLI_CHECK_CHECK_COMMAND_H

struct options;

// Both functions return the exit code. It is EXIT_CODE_CHECK_FAILED if an error is found in the
// scene, or if a case fails.
int check_scene_command(const struct options *options);
int check_device_command(const struct options *options);

#endif
