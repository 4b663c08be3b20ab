// Uploads the triangles of lamps that are small for their distance from the origin.
#include "render/upload_parts.h"
#include "shared/types.h"

#include <string.h>

bool upload_fill_small_triangles(const struct upload_params *p, uint32_t (*words)[4],
                                 struct arena *scratch, struct err *err)
{
    const struct flat_scene *flat = p->flat;
    uint32_t count = p->bvh->reference_count;
    if (flat->small_count == 0)
        return true;
    uint32_t *emitters = upload_emitter_numbers(p, 0, count, scratch);
    if (!emitters)
        return err_memory(err, "triangles' emitters", (uint64_t)count * sizeof *emitters);
    for (uint32_t i = 0; i < count; i++) {
        const struct flat_small_triangle *small = flat_find_small(flat, p->bvh->triangle_order[i]);
        // A triangle with several entries in leaf order is listed as an emitter with only one of
        // them.
        if (!small || emitters[i] == NO_EMITTER)
            continue;
        struct gpu_small_triangle record = {
            .first = small->first, .count = small->count, .emitter = emitters[i]};
        memcpy(record.v0, small->corner, sizeof record.v0);
        memcpy(record.edge1, small->own_edges[0], sizeof record.edge1);
        memcpy(record.edge2, small->own_edges[1], sizeof record.edge2);
        memcpy(words[(uint64_t)small->place * SMALL_TRIANGLE_WORDS], &record, sizeof record);
    }
    return true;
}
