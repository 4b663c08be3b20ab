// libFuzzer target for OBJ: fuzz_obj CORPUS_FOLDER. The input cannot refer to material libraries.
#include "fuzz_input.h"

static bool load(struct scene *scene, const char *path, struct err *err)
{
    uint32_t mesh;
    return load_obj(scene, path, SCENE_NONE, false, &mesh, err);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_load(load, data, size);
}
