#include "cli/sharing.h"

#include "render/attributes.h"
#include "shared/types.h"
#include <inttypes.h>
#include <stdio.h>

// Returns the number of triangles if all instances were copies, minus those that are stored.
static uint64_t saved_triangles(const struct flat_scene *flat)
{
    uint64_t saved = 0;
    for (uint32_t i = 0; i < flat->placed_count; i++)
        saved += flat->meshes[flat->instances[i].mesh].triangle_count;
    return saved - (flat->triangle_count - flat->world_triangle_count);
}

static uint64_t saved_bytes(const struct flat_scene *flat, uint32_t features)
{
    return saved_triangles(flat) * (sizeof(struct gpu_triangle) + 16 * attribute_words(features));
}

void sharing_print(const struct flat_scene *flat, uint32_t features)
{
    if (flat->placed_count == 0)
        return;
    double mib = (double)saved_bytes(flat, features) / (1 << 20);
    printf("shared    %u mesh%s by %u instances: ", flat->mesh_count,
           flat->mesh_count == 1 ? "" : "es", flat->placed_count);
    printf(mib < 1024 ? "%.1f MiB" : "%.1f GiB", mib < 1024 ? mib : mib / 1024);
    printf(" saved, the size of %" PRIu64 " triangles\n", saved_triangles(flat));
}

json_t *sharing_json(const struct flat_scene *flat, uint32_t features)
{
    return json_pack("{s:i, s:i, s:I, s:I}", "meshes", flat->mesh_count, "instances",
                     flat->placed_count, "triangles_not_stored", (json_int_t)saved_triangles(flat),
                     "bytes_not_stored", (json_int_t)saved_bytes(flat, features));
}
