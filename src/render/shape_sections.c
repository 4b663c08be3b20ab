#include "render/shape_sections.h"

#include "shared/sdf.h"
#include "shared/types.h"

struct shape_sections shape_sections(const struct scene *scene, const struct flat_scene *flat)
{
    uint64_t instructions = 0;
    uint32_t fields = 0;
    for (uint32_t i = 0; i < scene->sdf_count; i++)
        instructions += scene->sdfs[i].count;
    for (uint32_t i = 0; i < flat->shape_count; i++)
        fields += flat->shapes[i].kind == SHAPE_SDF;
    struct shape_sections s = {.instances = flat->shape_count * SHAPE_WORDS};
    s.sdfs = s.instances + flat->placed_count * INSTANCE_WORDS;
    s.sdf_code = s.sdfs + fields * SDF_WORDS;
    s.small_triangles = s.sdf_code + (uint32_t)(instructions * SDF_INSTRUCTION_WORDS);
    s.words = s.small_triangles + (uint64_t)flat->small_count * SMALL_TRIANGLE_WORDS;
    return s;
}
