// Fuzz target for checkpoints, which are read as --resume and merge read them. Hashes detect
// damage, so the input is also tried with a correct hash of the data before the film.
#include "base/hash.h"
#include "render/checkpoint.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bool read_bytes(void *bytes, size_t size)
{
    FILE *file = fmemopen(bytes, size, "rb");
    if (!file)
        abort();
    struct arena arena = {0};
    struct checkpoint checkpoint;
    struct err err = {0};
    bool ok = checkpoint_read(file, "fuzz", &arena, &checkpoint, &err);
    char *block = ok ? malloc(checkpoint.block_bytes) : NULL;
    while (ok && checkpoint_next_bytes(&checkpoint) > 0)
        ok = checkpoint_next_block(&checkpoint, block, &err);
    free(block);
    if (ok && strlen(checkpoint.identity) < size)
        ok = checkpoint_check(&checkpoint, "version=0\n--seed=1\n", &err);
    if (!ok && (err.code == ERR_NONE || !err.msg[0]))
        abort();
    fclose(file);
    arena_finish(&arena);
    return ok;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0) // fmemopen may refuse it
        return 0;
    uint8_t *copy = malloc(size);
    if (!copy)
        abort();
    memcpy(copy, data, size);
    read_bytes(copy, size);
    // The header has the number of these bytes, and their hash follows them.
    uint64_t head = 0;
    if (size >= 16 + sizeof head)
        memcpy(&head, copy + 16, sizeof head);
    if (head > 0 && head <= size - sizeof head) {
        uint64_t hash = hash_bytes(HASH_INIT, copy, head);
        memcpy(copy + head, &hash, sizeof hash);
        read_bytes(copy, size);
    }
    free(copy);
    return 0;
}
