#ifndef LAMPYRIS_BASE_HASH_H
#define LAMPYRIS_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

// 64-bit FNV-1a (Fowler, Noll, Vo), continued from `hash`; start with HASH_INIT.
#define HASH_INIT UINT64_C(0xcbf29ce484222325)
uint64_t hash_bytes(uint64_t hash, const void *data, size_t size);

#endif
