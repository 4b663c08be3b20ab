// Runs a fuzz target's seeds through it without a fuzzer: `replay_NAME FILE…`, each whole, cut
// short and with single bytes changed, the same way every time. A target that objects aborts.
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MAX_SEED = 1 << 20, CUTS = 16, CHANGES = 64 };

// A copy of exactly the length, so that the address sanitizer sees a read past the end.
static void run(const uint8_t *data, size_t size, size_t changed, uint8_t mask)
{
    uint8_t *copy = malloc(size > 0 ? size : 1);
    if (!copy)
        abort();
    memcpy(copy, data, size);
    if (mask)
        copy[changed] ^= mask;
    LLVMFuzzerTestOneInput(copy, size);
    free(copy);
}

int main(int argc, char **argv)
{
    static const uint8_t masks[] = {0x01, 0x10, 0x80, 0xff};
    static uint8_t seed[MAX_SEED];
    for (int i = 1; i < argc; i++) {
        FILE *file = fopen(argv[i], "rb");
        size_t size = file ? fread(seed, 1, sizeof seed, file) : 0;
        if (!file || size == 0 || size == sizeof seed || fclose(file) != 0) {
            fprintf(stderr, "%s: no file of 1 to %d bytes\n", argv[i], MAX_SEED - 1);
            return 1;
        }
        // The name stands before what it does, so that a crash tells which seed it was.
        fprintf(stderr, "%s\n", argv[i]);
        run(seed, size, 0, 0);
        for (size_t k = 0; k < CUTS; k++)
            run(seed, size * k / CUTS, 0, 0);
        for (size_t k = 0; k < CHANGES; k++)
            run(seed, size, size * k / CHANGES, masks[k % sizeof masks]);
    }
    return argc > 1 ? 0 : 2;
}
