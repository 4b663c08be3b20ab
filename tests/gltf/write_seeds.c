// Writes the initial files of a fuzzer: `write_seeds FOLDER`.
#include "gltf_seeds.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    struct gltf_seed seed;
    for (uint32_t i = 0; argc == 2 && gltf_seed_make(i, &seed); i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", argv[1], seed.name);
        FILE *file = fopen(path, "wb");
        if (!file || fwrite(seed.bytes.data, 1, seed.bytes.size, file) != seed.bytes.size ||
            fclose(file) != 0) {
            perror(path);
            return 1;
        }
        free(seed.bytes.data);
    }
    return argc == 2 ? 0 : 2;
}
