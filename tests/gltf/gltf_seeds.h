// Small files that together use the whole loader. Tests of robustness damage them, and they are a
// fuzzer's initial corpus.
#ifndef LAMPYRIS_TESTS_GLTF_SEEDS_H
#define LAMPYRIS_TESTS_GLTF_SEEDS_H

#include "gltf_fixture.h"

struct gltf_seed {
    const char *name; // such as "skin.glb"
    struct bytes bytes;
};

// Makes the file with this index, from 0. Returns false after the last one. Free bytes.data by
// free().
bool gltf_seed_make(uint32_t index, struct gltf_seed *out);

#endif
