// load_scene FILE [KEY=VALUE …]: loads a scene with overrides. Exit status 0, or 1 with the error's
// code and message on stdout: what check_format.py drives.
#include "scene.h"

#include <stdio.h>
#include <string.h>

#define MAX_OVERRIDES 16

int main(int argc, char **argv)
{
    struct scene_override overrides[MAX_OVERRIDES];
    struct scene_load_params params = {.overrides = overrides};
    if (argc < 2 || argc - 2 > MAX_OVERRIDES)
        return 2;
    params.path = argv[1];
    for (int i = 2; i < argc; i++) {
        char *equals = strchr(argv[i], '=');
        if (!equals)
            return 2;
        *equals = '\0';
        overrides[params.override_count++] = (struct scene_override){argv[i], equals + 1};
    }
    struct scene scene;
    struct err err = {0};
    bool ok = scene_load(&params, &scene, &err);
    if (!ok)
        printf("%d %s\n", err.code, err.msg);
    scene_finish(&scene);
    return !ok;
}
