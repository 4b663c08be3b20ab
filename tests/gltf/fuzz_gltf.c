// libFuzzer target for glTF and GLB bytes: `fuzz_gltf CORPUS_FOLDER`. The first four bytes decide
// the container. Built with clang on demand; what it loads must be whole.
#include "gltf_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct bytes copy = {malloc(size + 1), size};
    memcpy(copy.data, data, size);
    copy.data[size] = 0; // as file_read leaves it
    struct scene scene;
    struct err err;
    // No such folder, so that no URI of the fuzzer's names a file.
    const char *path = "/nonexistent/fuzz.gltf";
    if (load_bytes(&scene, path, copy, &err) && scene_objection(&scene)) {
        fprintf(stderr, "%s\n", scene_objection(&scene));
        abort();
    }
    scene_finish(&scene);
    free(copy.data);
    return 0;
}
