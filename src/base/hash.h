#ifndef LAMPYRIS_BASE_HASH_H
#define LAMPYRIS_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

// Hashes bytes by 64-bit FNV-1a (Fowler, Noll, Vo), continuing from `hash`; start with HASH_INIT.
#define HASH_INIT UINT64_C(0xcbf29ce484222325)
uint64_t hash_bytes(uint64_t hash, const void *data, size_t size);

// A hash of 128 bits that identifies contents, computed at several GB/s (MurmurHash3_x64_128,
// Appleby 2011, with seed 0). Equal bytes have equal hashes on machines of the same byte order. It
// gives no protection against forgery.
struct hash128 {
    uint64_t word[2];
};
struct hash128 hash128_bytes(const void *data, size_t size);

#endif
