#include "cli/outputs.h"

#include "base/file.h"
#include "image/image.h"

bool outputs_check_one(const char *path, struct err *err)
{
    return image_check_format(path, err) && file_check_writable(path, err);
}

bool outputs_check_layers(const char *const *paths, uint32_t count, uint32_t aovs, struct err *err)
{
    bool has_exr = false;
    for (uint32_t i = 0; i < count; i++)
        has_exr |= path_has_extension(paths[i], "exr");
    return has_exr || count == 0 || aovs == 0 ||
           err_set(err, ERR_USAGE, "--aov: layers go into EXR files; expected -o NAME.exr");
}
