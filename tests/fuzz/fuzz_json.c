// libFuzzer target for the JSON format: fuzz_json CORPUS_FOLDER; scenes/ is an initial corpus. A
// scene that loads must be flattened or rejected with a message.
#include "fuzz_input.h"

#include "flatten/flatten.h"

static bool load(struct scene *scene, const char *path, struct err *err)
{
    const struct scene_load_params params = {.path = path};
    struct arena arena = {0};
    struct flat_scene flat;
    scene->settings = settings_default();
    bool ok = load_json(scene, &params, scene_load_into, err) &&
              scene_flatten(&(struct flatten_params){scene, INSTANCING_AUTO}, &arena, &flat, err);
    arena_finish(&arena);
    return ok;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_load(load, data, size);
}
