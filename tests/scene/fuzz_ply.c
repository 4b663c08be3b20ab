// libFuzzer target for PLY: fuzz_ply CORPUS_FOLDER.
#include "fuzz_input.h"

static bool load(struct scene *scene, const char *path, struct err *err)
{
    uint32_t first, count;
    return load_ply(scene, path, SCENE_NONE, &first, &count, err);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_load(load, data, size);
}
