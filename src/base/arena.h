// Arena memory: many allocations, one release. The CPU data of a scene are in one arena, the
// temporary data of a phase in another. An arena is not thread-safe: one thread uses it at a time.
#ifndef LAMPYRIS_BASE_ARENA_H
#define LAMPYRIS_BASE_ARENA_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

struct arena_block;

// {0} is a valid, empty arena. Its memory counts against the budget of the process (memory.h).
struct arena {
    struct arena_block *blocks;
    size_t used_bytes; // bytes allocated so far, including padding
};

// Returns zeroed memory for `count` elements of `size` bytes. It is aligned to 64 bytes, or to 16
// if it is smaller than 64 bytes. Returns NULL when count * size overflows, or when memory or its
// budget is exhausted. A count of 0 gives a valid pointer.
void *arena_alloc(struct arena *arena, size_t count, size_t size);
// Copies an array. Returns NULL in the same cases as arena_alloc.
void *arena_copy(struct arena *arena, const void *from, size_t count, size_t size);
// Makes room for `more` elements after the first `count` of a growing array. Returns `items` itself
// if the capacity suffices, else a copy of at least twice the capacity. The old array stays in the
// arena; doubling keeps the sum of all outgrown arrays below the size of the current one. Returns
// NULL in the same cases as arena_alloc, and for more than 2^32 - 1 elements.
void *arena_reserve(struct arena *arena, void *items, uint32_t count, uint64_t more,
                    uint32_t *capacity, size_t size);
// Appends a zeroed element to a growing array, whose pointer is at `array`, and stores the
// element's index in `index` if that is not NULL. Returns NULL in the same cases as arena_reserve.
void *arena_append(struct arena *arena, void *array, uint32_t *count, uint32_t *capacity,
                   size_t size, uint32_t *index);
char *arena_strdup(struct arena *arena, const char *text); // NULL in the same cases as arena_alloc
// Formats a text of any length. Returns NULL in the same cases as arena_alloc.
char *arena_printf(struct arena *arena, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
char *arena_vprintf(struct arena *arena, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));
// Releases all memory and leaves {0} in the arena. Accepts NULL and {0}.
void arena_finish(struct arena *arena);

// For tests: makes the n-th allocation from now fail once, in any arena and thread, as if memory
// were exhausted. 1 is the next allocation; 0 cancels the failure.
void arena_fail_at(uint64_t n);

#define ARENA_NEW(arena, type, count) ((type *)arena_alloc((arena), (count), sizeof(type)))

#endif
