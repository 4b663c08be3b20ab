// `lampyris check`: tests a device or, if a scene is given, the scene.
#include "cli/check/check_command.h"
#include "cli/commands.h"

int cmd_check(const struct options *options)
{
    return options->argument_count > 0 ? check_scene_command(options)
                                       : check_device_command(options);
}
