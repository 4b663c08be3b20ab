// `lampyris check`: whether a device computes what it should; with a scene, what in it is stiff.
#include "cli/check/check_command.h"
#include "cli/commands.h"

int cmd_check(const struct options *options)
{
    return options->argument_count > 0 ? check_scene_command(options)
                                       : check_device_command(options);
}
