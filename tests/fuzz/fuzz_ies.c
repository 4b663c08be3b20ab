// libFuzzer target for photometric profiles: fuzz_ies CORPUS_FOLDER.
#include "fuzz_input.h"
#include "ies_reference.h"

static bool load(struct scene *scene, const char *path, struct err *err)
{
    const struct light_profile *profile;
    if (!ies_load(scene, path, &profile, err))
        return false;
    double value = ies_relative(profile, 33, 77);
    if (!(value >= 0 && value <= 1))
        abort();
    return true;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_load(load, data, size);
}
