// Uploads signed distance fields in the form that kernels read.
#include "flatten/flatten_shapes.h"
#include "render/upload_parts.h"
#include "shared/sdf.h"

#include <math.h>
#include <string.h>

// Fills the transform between world space and a field's own space. The axes of `shape`, which is in
// world space, are half the edges of the field's box. `first` is the index of the field's first
// instruction.
static void fill_sdf(const struct sdf *sdf, const struct shape *shape, uint32_t first,
                     struct gpu_sdf *out)
{
    double scale = 0;
    for (int j = 0; j < 3; j++) {
        double half = sdf->max[j] / 2 - sdf->min[j] / 2, squared = 0;
        const double *axis = shape->axes[j];
        for (int i = 0; i < 3; i++)
            squared += axis[i] * axis[i];
        scale = fmax(scale, sqrt(squared) / half);
        // The matrix is a rotation times the scale: its inverse is the transpose over the square of
        // the scale.
        for (int i = 0; i < 3; i++)
            out->to_object[j][i] = (float)(axis[i] * half / squared);
    }
    for (int i = 0; i < 3; i++) {
        double place = shape->center[i];
        for (int j = 0; j < 3; j++)
            place -= shape->axes[j][i] * (sdf->max[j] + sdf->min[j]) / (sdf->max[j] - sdf->min[j]);
        out->to_object[i][3] = (float)place;
        out->min[i] = (float)sdf->min[i];
        out->max[i] = (float)sdf->max[i];
    }
    out->first = first;
    out->count = sdf->count;
    out->scale = (float)scale;
    out->lipschitz = (float)sdf->lipschitz;
    out->magnitude = (float)sdf->magnitude;
}

void upload_fill_sdfs(const struct upload_params *p, uint32_t (*records)[4], uint32_t (*code)[4])
{
    const struct scene *scene = p->scene;
    uint32_t number = 0;
    for (uint32_t i = 0; i < p->flat->shape_count; i++) {
        if (p->flat->shapes[i].kind != SHAPE_SDF)
            continue;
        const struct shape shape =
            flatten_place_shape(p->flat, &scene->shapes[p->flat->shapes[i].source]);
        uint32_t first = 0;
        for (uint32_t k = 0; k < shape.sdf; k++)
            first += scene->sdfs[k].count;
        struct gpu_sdf record = {0};
        fill_sdf(&scene->sdfs[shape.sdf], &shape, first, &record);
        memcpy(records[(uint64_t)number * SDF_WORDS], &record, sizeof record);
        number++;
    }
    uint64_t at = 0;
    for (uint32_t k = 0; k < scene->sdf_count; k++) {
        const struct sdf *sdf = &scene->sdfs[k];
        memcpy(code[at], sdf->code, sdf->count * sizeof *sdf->code);
        at += (uint64_t)sdf->count * SDF_INSTRUCTION_WORDS;
    }
}
