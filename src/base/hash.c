#include "base/hash.h"

#include <string.h>

uint64_t hash_bytes(uint64_t hash, const void *data, size_t size)
{
    const uint64_t prime = UINT64_C(0x100000001b3); // the 64-bit FNV prime
    const uint8_t *bytes = data;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * prime;
    return hash;
}

static uint64_t rotate(uint64_t x, int bits)
{
    return x << bits | x >> (64 - bits);
}

#define FACTOR_1 UINT64_C(0x87c37b91114253d5)
#define FACTOR_2 UINT64_C(0x4cf5ad432745937f)

static uint64_t mix_first(uint64_t k)
{
    return rotate(k * FACTOR_1, 31) * FACTOR_2;
}

static uint64_t mix_second(uint64_t k)
{
    return rotate(k * FACTOR_2, 33) * FACTOR_1;
}

static uint64_t finish(uint64_t k)
{
    k = (k ^ k >> 33) * UINT64_C(0xff51afd7ed558ccd);
    k = (k ^ k >> 33) * UINT64_C(0xc4ceb9fe1a85ec53);
    return k ^ k >> 33;
}

struct hash128 hash128_bytes(const void *data, size_t size)
{
    const uint8_t *bytes = data;
    uint64_t a = 0, b = 0, k[2];
    size_t left = size;
    for (; left >= sizeof k; left -= sizeof k, bytes += sizeof k) {
        memcpy(k, bytes, sizeof k);
        a = (rotate(a ^ mix_first(k[0]), 27) + b) * 5 + 0x52dce729;
        b = (rotate(b ^ mix_second(k[1]), 31) + a) * 5 + 0x38495ab5;
    }
    k[0] = k[1] = 0;
    for (size_t i = 0; i < left; i++)
        k[i / 8] |= (uint64_t)bytes[i] << i % 8 * 8;
    a ^= mix_first(k[0]) ^ size;
    b ^= mix_second(k[1]) ^ size;
    a += b;
    b += a;
    a = finish(a);
    b = finish(b);
    a += b;
    return (struct hash128){{a, a + b}};
}
