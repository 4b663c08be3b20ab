// Uploads shapes, instances and distance fields in the form that kernels read.
#include "render/upload_parts.h"

#include "render/shape_sections.h"
#include "shared/sdf.h"
#include <math.h>
#include <string.h>

static void fill_shape(const struct flat_shape *shape, struct gpu_shape *out)
{
    memcpy(out->center, shape->center, sizeof out->center);
    memcpy(out->axis, shape->normal, sizeof out->axis);
    out->radius = shape->radius;
    switch (shape->kind) {
    case SHAPE_PLANE:
        memcpy(out->other, shape->axes[1], sizeof out->other);
        break;
    case SHAPE_BOX:
        out->radius = hypotf(hypotf(shape->axes[2][0], shape->axes[2][1]), shape->axes[2][2]);
        memcpy(out->axis, shape->axes[0], sizeof out->axis);
        memcpy(out->other, shape->axes[1], sizeof out->other);
        break;
    case SHAPE_QUAD:
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        memcpy(out->axis, shape->axes[0], sizeof out->axis);
        memcpy(out->other, shape->axes[1], sizeof out->other);
        break;
    default:
        break;
    }
}

bool upload_shapes(struct gpu *gpu, const struct upload_params *p, struct gpu_buffer *buffers,
                   struct arena *scratch, struct err *err)
{
    const struct shape_sections sections = shape_sections(p->scene, p->flat);
    const struct flat_scene *flat = p->flat;
    uint32_t(*words)[4] = arena_alloc(scratch, sections.words, sizeof *words);
    uint32_t *emitters = upload_emitter_numbers(p, PRIMITIVE_SHAPE, flat->shape_count, scratch);
    if (!words || !emitters)
        return err_memory(err, "shapes", sections.words * sizeof *words);
    uint32_t fields = 0;
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        struct gpu_shape record = {.emitter = emitters[i]};
        const struct flat_shape *shape = &flat->shapes[i];
        fill_shape(shape, &record);
        if (shape->kind == SHAPE_SDF) {
            memcpy(record.other, &fields, sizeof fields);
            fields++;
        }
        record.kind_material =
            shape->kind << SHAPE_KIND_SHIFT | upload_material_word(p, shape->material);
        memcpy(words[(uint64_t)i * SHAPE_WORDS], &record, sizeof record);
    }
    upload_fill_instances(p, &words[sections.instances]);
    upload_fill_sdfs(p, &words[sections.sdfs], &words[sections.sdf_code]);
    if (!upload_fill_small_triangles(p, &words[sections.small_triangles], scratch, err))
        return false;
    return upload_filled(gpu, p, BINDING_SHAPES, words, buffers, err);
}
