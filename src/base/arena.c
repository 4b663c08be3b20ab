#include "base/arena.h"

#include "base/memory.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Under AddressSanitizer the unused part of a block is poisoned and a gap is left between
// allocations, so that accesses beyond the end of an allocation are found, as with malloc().
#if defined(__SANITIZE_ADDRESS__)
#define ARENA_POISONS 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ARENA_POISONS 1
#endif
#endif

#ifdef ARENA_POISONS
#include <sanitizer/asan_interface.h>
enum { GAP_BYTES = 64 };

// Makes failed allocations return NULL under AddressSanitizer, too, so that the program reports
// them.
const char *__asan_default_options(void)
{
    return "allocator_may_return_null=1";
}
#else
#define ASAN_POISON_MEMORY_REGION(address, bytes) ((void)(address), (void)(bytes))
#define ASAN_UNPOISON_MEMORY_REGION(address, bytes) ((void)(address), (void)(bytes))
enum { GAP_BYTES = 0 };
#endif

enum {
    ALIGN_SMALL = 16,
    ALIGN_LARGE = 64, // a cache line, which suits SIMD loads and mapped uploads
    FIRST_BLOCK_BYTES = 1 << 14,
    LAST_BLOCK_BYTES = 1 << 20,
};

struct arena_block {
    struct arena_block *next;
    uint8_t *data; // aligned to ALIGN_LARGE, inside the same allocation as this header
    size_t size, used;
};

static _Atomic uint64_t fail_countdown;

void arena_fail_at(uint64_t n)
{
    atomic_store(&fail_countdown, n);
}

static bool fault_is_due(void)
{
    uint64_t n = atomic_load_explicit(&fail_countdown, memory_order_relaxed);
    while (n > 0)
        if (atomic_compare_exchange_weak(&fail_countdown, &n, n - 1))
            return n == 1;
    return false;
}

// The block comes from calloc, because the pages of a large block then stay untouched until they
// are used.
static struct arena_block *block_create(size_t size)
{
    size_t overhead = sizeof(struct arena_block) + ALIGN_LARGE - 1;
    if (size > SIZE_MAX - overhead)
        return NULL;
    struct arena_block *block = calloc(1, overhead + size);
    if (!block)
        return NULL;
    uintptr_t start = (uintptr_t)(block + 1);
    uintptr_t aligned = (start + ALIGN_LARGE - 1) & ~(uintptr_t)(ALIGN_LARGE - 1);
    block->data = (uint8_t *)block + (aligned - (uintptr_t)block);
    block->size = size;
    ASAN_POISON_MEMORY_REGION(block->data, size);
    return block;
}

// Returns the position of an allocation in a block, or SIZE_MAX if it does not fit.
static size_t block_fit(const struct arena_block *block, size_t bytes, size_t alignment)
{
    size_t at = (block->used + alignment - 1) & ~(alignment - 1);
    return at <= block->size && bytes <= block->size - at ? at : SIZE_MAX;
}

// Returns the block for an allocation. If the current block has too little room, makes a new
// current block. A large allocation gets a block of its own, which is linked after the current one,
// so that the current one stays in use.
static struct arena_block *block_for(struct arena *arena, size_t bytes, size_t alignment)
{
    struct arena_block *current = arena->blocks;
    if (current && block_fit(current, bytes, alignment) != SIZE_MAX)
        return current;
    size_t shared = FIRST_BLOCK_BYTES;
    if (current && current->size >= FIRST_BLOCK_BYTES)
        shared = current->size < LAST_BLOCK_BYTES ? current->size * 2 : LAST_BLOCK_BYTES;
    bool own = bytes > shared / 4;
    struct arena_block *block = block_create(own ? bytes : shared);
    if (!block)
        return NULL;
    if (own && current) {
        block->next = current->next;
        current->next = block;
    } else {
        block->next = current;
        arena->blocks = block;
    }
    return block;
}

void *arena_alloc(struct arena *arena, size_t count, size_t size)
{
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 2)
        return NULL;
    size_t alignment = bytes >= ALIGN_LARGE ? ALIGN_LARGE : ALIGN_SMALL;
    // At least one byte is allocated, so that pointers differ and a count of 0 gives a valid one.
    size_t padded = ((bytes > 0 ? bytes : 1) + GAP_BYTES + alignment - 1) & ~(alignment - 1);
    if (!memory_take(padded))
        return NULL;
    struct arena_block *block = fault_is_due() ? NULL : block_for(arena, padded, alignment);
    if (!block) {
        memory_fail(padded);
        return NULL;
    }
    size_t at = block_fit(block, padded, alignment);
    block->used = at + padded;
    arena->used_bytes += padded;
    ASAN_UNPOISON_MEMORY_REGION(block->data + at, bytes);
    return block->data + at;
}

void *arena_copy(struct arena *arena, const void *from, size_t count, size_t size)
{
    void *copy = arena_alloc(arena, count, size);
    if (copy && count > 0)
        memcpy(copy, from, count * size);
    return copy;
}

void *arena_reserve(struct arena *arena, void *items, uint32_t count, uint64_t more,
                    uint32_t *capacity, size_t size)
{
    if (more <= *capacity - count)
        return items;
    uint64_t needed = count + more, doubled = 2 * (uint64_t)*capacity;
    uint64_t grown_capacity = needed > doubled ? needed : doubled;
    void *grown = arena_alloc(arena, grown_capacity, size); // before the test, so that the budget
                                                            // is checked
    if (!grown || grown_capacity > UINT32_MAX)
        return NULL;
    if (count > 0)
        memcpy(grown, items, count * size);
    *capacity = (uint32_t)grown_capacity;
    return grown;
}

void *arena_append(struct arena *arena, void *array, uint32_t *count, uint32_t *capacity,
                   size_t size, uint32_t *index)
{
    const uint64_t first_capacity = 8;
    void *items;
    memcpy(&items, array, sizeof items);
    items =
        arena_reserve(arena, items, *count, *capacity == 0 ? first_capacity : 1, capacity, size);
    if (!items)
        return NULL;
    memcpy(array, &items, sizeof items);
    if (index)
        *index = *count;
    return (char *)items + (*count)++ * size;
}

char *arena_strdup(struct arena *arena, const char *text)
{
    size_t size = strlen(text) + 1;
    char *copy = arena_alloc(arena, size, 1);
    return copy ? memcpy(copy, text, size) : NULL;
}

char *arena_printf(struct arena *arena, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *text = arena_vprintf(arena, format, arguments);
    va_end(arguments);
    return text;
}

char *arena_vprintf(struct arena *arena, const char *format, va_list arguments)
{
    va_list measured;
    va_copy(measured, arguments);
    int length = vsnprintf(NULL, 0, format, measured);
    va_end(measured);
    char *text = length >= 0 ? arena_alloc(arena, (size_t)length + 1, 1) : NULL;
    if (text)
        vsnprintf(text, (size_t)length + 1, format, arguments);
    return text;
}

void arena_finish(struct arena *arena)
{
    if (!arena)
        return;
    for (struct arena_block *block = arena->blocks; block;) {
        struct arena_block *next = block->next;
        ASAN_UNPOISON_MEMORY_REGION(block->data, block->size);
        free(block);
        block = next;
    }
    memory_give(arena->used_bytes);
    *arena = (struct arena){0};
}
