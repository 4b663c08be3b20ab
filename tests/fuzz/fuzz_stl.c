// libFuzzer target for STL: fuzz_stl CORPUS_FOLDER.
#include "fuzz_input.h"

static bool load(struct scene *scene, const char *path, struct err *err)
{
    uint32_t mesh;
    return load_stl(scene, path, SCENE_NONE, &mesh, err);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_load(load, data, size);
}
