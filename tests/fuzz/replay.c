// Runs a fuzz target on its seeds without a fuzzer: `replay_NAME FILE…`. Each file is tried whole,
// truncated, and with single bytes changed, always in the same way. A target aborts if it finds an
// error.
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MAX_SEED = 1 << 20, CUTS = 16, CHANGES = 64 };

// Copies the data to a block of exactly this length, so that the address sanitizer detects reads
// past the end.
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
        // The name is printed first, so that a crash shows which file caused it.
        fprintf(stderr, "%s\n", argv[i]);
        run(seed, size, 0, 0);
        for (size_t k = 0; k < CUTS; k++)
            run(seed, size * k / CUTS, 0, 0);
        for (size_t k = 0; k < CHANGES; k++)
            run(seed, size, size * k / CHANGES, masks[k % sizeof masks]);
    }
    return argc > 1 ? 0 : 2;
}
