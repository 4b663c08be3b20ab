// Makes vertices from corners that have separate indices for position, normal and texture
// coordinates.
#include "scene/mesh/mesh_loader.h"

#include <string.h>

// An open-addressing hash table from index triples to vertices. A slot holds a vertex plus one; 0
// marks an empty slot.
struct corner_table {
    uint32_t *slots;
    uint64_t slot_mask;
    struct vertex_list vertices;
};

// Mixes bits by a bijection: the finaliser of SplitMix64 (Steele, Lea, Flood 2014) with the
// constants of Stafford's variant 13.
static uint64_t mix_bits(uint64_t x)
{
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

static uint64_t hash_corner(const uint32_t corner[3])
{
    return mix_bits(mix_bits((uint64_t)corner[0] << 32 | corner[1]) + corner[2]);
}

// Returns the vertex of a corner, adding it if it is new. The table has more slots than there are
// corners, so the search ends.
static uint32_t find_or_add(struct corner_table *table, const uint32_t corner[3])
{
    struct vertex_list *vertices = &table->vertices;
    for (uint64_t slot = hash_corner(corner);; slot++) {
        uint32_t *entry = &table->slots[slot & table->slot_mask];
        if (*entry == 0) {
            memcpy(vertices->corners[vertices->count], corner, sizeof *vertices->corners);
            *entry = ++vertices->count;
            return *entry - 1;
        }
        if (memcmp(vertices->corners[*entry - 1], corner, sizeof *vertices->corners) == 0)
            return *entry - 1;
    }
}

static bool create_table(struct arena *scratch, uint64_t corner_count, struct corner_table *table,
                         struct err *err)
{
    if (corner_count >= UINT32_MAX)
        return err_set(err, ERR_INPUT, "%llu corners; expected fewer than 4294967295",
                       (unsigned long long)corner_count);
    uint64_t slot_count = 16;
    while (slot_count < 2 * corner_count) // at most half full, so that probe sequences are short
        slot_count *= 2;
    *table = (struct corner_table){
        .slots = ARENA_NEW(scratch, uint32_t, slot_count),
        .slot_mask = slot_count - 1,
        .vertices.corners = arena_alloc(scratch, corner_count, sizeof *table->vertices.corners),
    };
    if (!table->slots || !table->vertices.corners)
        return err_memory(err, "merging vertices",
                          slot_count * sizeof *table->slots +
                              corner_count * sizeof *table->vertices.corners);
    return true;
}

bool mesh_merge_corners(struct arena *scratch, uint64_t triangle_count, uint32_t (*indices)[3],
                        uint32_t (*normal_indices)[3], uint32_t (*uv_indices)[3],
                        struct vertex_list *out, struct err *err)
{
    struct corner_table table = {0};
    if (!create_table(scratch, 3 * triangle_count, &table, err))
        return false;
    for (uint64_t t = 0; t < triangle_count; t++) {
        for (int c = 0; c < 3; c++) {
            const uint32_t corner[3] = {
                indices[t][c],
                normal_indices ? normal_indices[t][c] : MESH_NO_INDEX,
                uv_indices ? uv_indices[t][c] : MESH_NO_INDEX,
            };
            indices[t][c] = find_or_add(&table, corner);
        }
    }
    *out = table.vertices;
    return true;
}
