// `lampyris check`: whether a device computes what it should; with a scene, what in it is stiff.
#include "base/file.h"
#include "base/file_inputs.h"
#include "cli/check/check_command.h"
#include "cli/commands.h"

bool check_report(const char *path, struct err *err)
{
    return !path || (file_inputs_check(path, err) && file_check_writable(path, err));
}

int cmd_check(const struct options *options)
{
    return options->argument_count > 0 ? check_scene_command(options)
                                       : check_device_command(options);
}
