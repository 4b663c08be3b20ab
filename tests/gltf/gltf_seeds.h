// Small files that between them use all of the loader: what tests of robustness damage, and what a
// fuzzer begins with.
#ifndef LAMPYRIS_TESTS_GLTF_SEEDS_H
#define LAMPYRIS_TESTS_GLTF_SEEDS_H

#include "gltf_fixture.h"

struct gltf_seed {
    const char *name; // "skin.glb"
    struct bytes bytes;
};

// One after the other, from index 0 on; false behind the last. free(bytes.data).
bool gltf_seed_make(uint32_t index, struct gltf_seed *out);

#endif
