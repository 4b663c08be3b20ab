#ifndef LAMPYRIS_BASE_HASH_H
#define LAMPYRIS_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

// 64-bit FNV-1a (Fowler, Noll, Vo), continued from `hash`; start with HASH_INIT.
#define HASH_INIT UINT64_C(0xcbf29ce484222325)
uint64_t hash_bytes(uint64_t hash, const void *data, size_t size);

// 128 bits that identify contents, some GB/s (MurmurHash3_x64_128, Appleby 2011, with seed 0).
// Equal for equal bytes on machines of the same byte order; no defence against forgery.
struct hash128 {
    uint64_t word[2];
};
struct hash128 hash128_bytes(const void *data, size_t size);

#endif
