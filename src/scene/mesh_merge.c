// From corners with two indices, of a position and of a normal, to vertices that have both.
#include "mesh_loader.h"

// An open-addressing hash table from pairs to vertices. A slot holds a vertex plus one; 0 is an
// empty one.
struct pair_table {
    uint32_t *slots;
    uint64_t slot_mask;
    struct vertex_pairs vertices;
};

// A bijection of 64 bits that mixes them well: the finaliser of SplitMix64 (Steele, Lea, Flood
// 2014) with the constants of Stafford's variant 13.
static uint64_t mix_bits(uint64_t x)
{
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

// The vertex of a pair, made when it is new. The table has more slots than pairs are ever added.
static uint32_t find_or_add(struct pair_table *table, uint32_t position, uint32_t normal)
{
    struct vertex_pairs *vertices = &table->vertices;
    uint64_t slot = mix_bits((uint64_t)position << 32 | normal);
    for (;; slot++) {
        uint32_t *entry = &table->slots[slot & table->slot_mask];
        if (*entry == 0) {
            vertices->pairs[vertices->count][0] = position;
            vertices->pairs[vertices->count][1] = normal;
            *entry = ++vertices->count;
            return *entry - 1;
        }
        const uint32_t *pair = vertices->pairs[*entry - 1];
        if (pair[0] == position && pair[1] == normal)
            return *entry - 1;
    }
}

static bool create_table(struct arena *scratch, uint64_t corner_count, struct pair_table *table,
                         struct err *err)
{
    if (corner_count >= UINT32_MAX)
        return err_set(err, ERR_INPUT, "%llu corners with normals, expected fewer than 4294967295",
                       (unsigned long long)corner_count);
    uint64_t slot_count = 16;
    while (slot_count < 2 * corner_count) // At most half full, so that chains stay short.
        slot_count *= 2;
    *table = (struct pair_table){
        .slots = ARENA_NEW(scratch, uint32_t, slot_count),
        .slot_mask = slot_count - 1,
        .vertices.pairs = arena_alloc(scratch, corner_count, sizeof *table->vertices.pairs),
    };
    if (!table->slots || !table->vertices.pairs)
        return err_memory(err, "merging vertices",
                          slot_count * sizeof *table->slots +
                              corner_count * sizeof *table->vertices.pairs);
    return true;
}

bool mesh_pair_vertices(struct arena *scratch, uint64_t triangle_count, uint32_t (*indices)[3],
                        uint32_t (*normal_indices)[3], struct vertex_pairs *out, struct err *err)
{
    struct pair_table table = {0};
    if (!create_table(scratch, 3 * triangle_count, &table, err))
        return false;
    for (uint64_t t = 0; t < triangle_count; t++) {
        for (int c = 0; c < 3; c++)
            indices[t][c] = find_or_add(&table, indices[t][c], normal_indices[t][c]);
    }
    *out = table.vertices;
    return true;
}
