#include "check/embedded_scene.h"

#include "embedded_scenes.h"
#include <string.h>

static const struct {
    const char *name, *text;
} scenes[] = {EMBEDDED_SCENES};

static const char *find(const char *name)
{
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++)
        if (strcmp(scenes[i].name, name) == 0)
            return scenes[i].text;
    return NULL;
}

bool embedded_scene_load(const char *name, const struct scene_override *overrides,
                         struct scene *out, struct err *err)
{
    struct scene_load_params params = {
        .path = name, .text = find(name), .overrides = overrides, .is_strict = true};
    if (!params.text)
        return err_set(err, ERR_BUG, "%s: no scene of this name is embedded in the program", name);
    while (overrides && overrides[params.override_count].key)
        params.override_count++;
    return scene_load(&params, out, err);
}
