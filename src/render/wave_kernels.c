// Creates the kernels of a renderer: their code, constants and pipelines.
#include "render/wave.h"

#include "gpu/spirv_trim.h"
#include "render/kernels.h"
#include "render/sdf_inline.h"
#include <stdlib.h>

// Returns the code of a kernel: from the kernel set that was given to the renderer, or the embedded
// code.
static struct kernel_code code_of(const struct renderer *r, enum kernel_id id)
{
    struct kernel_code code = kernel_code(id, r->specialization.features & FEATURE_BALLOT);
    if (r->kernel_set && r->kernel_set->codes[id].spirv) {
        code.spirv = r->kernel_set->codes[id].spirv;
        code.bytes = r->kernel_set->codes[id].bytes;
    }
    return code;
}

struct kernel_source {
    struct specialization constants;
    struct gpu_kernel_params params;
    uint32_t *made; // code with inlined programs of distance fields, or NULL; the caller frees it
};

// Finds the code and the constants of a kernel. *out must not be moved.
static void find_source(const struct renderer *r, const struct specialization *s, enum kernel_id id,
                        struct kernel_source *out)
{
    struct kernel_code code = code_of(r, id);
    *out = (struct kernel_source){.constants = *s};
    if (id >= KERNEL_shade_diffuse && id <= KERNEL_shade_classical)
        out->constants.lobes = s->class_lobes[id - KERNEL_shade_diffuse];
    if (id != KERNEL_intersect_closest && id != KERNEL_intersect_shadow)
        out->constants.features &= ~FEATURE_STEPS; // only traversal kernels count steps; other
                                                   // kernels are not compiled again for this
                                                   // feature
    out->params = (struct gpu_kernel_params){
        .name = code.name,
        .spirv = code.spirv,
        .spirv_bytes = code.bytes,
        .constants = (const uint32_t *)&out->constants,
        .constant_count = CONSTANT_COUNT,
    };
    if (r->specialization.geometry & GEOMETRY_SDFS)
        out->made = sdf_inline(code.spirv, code.bytes, r->scene, &out->params.spirv_bytes);
    if (!out->made)
        return;
    out->params.made_from = code.spirv;
    out->params.spirv = out->made;
    out->params.variant = sdf_inline_key(r->scene);
}

bool wave_create_kernels(struct renderer *r, struct err *err)
{
    for (int id = 0; id < KERNEL_COUNT; id++) {
        progress_report(r->progress, "Compiling", (double)id / KERNEL_COUNT);
        gpu_kernel_finish(r->gpu, &r->kernels[id]);
        if (!specialization_needs_kernel(&r->specialization, (enum kernel_id)id))
            continue;
        struct kernel_source source;
        find_source(r, &r->specialization, (enum kernel_id)id, &source);
        bool ok = gpu_kernel_create(r->gpu, &source.params, &r->kernels[id], err);
        free(source.made);
        if (!ok)
            return memory_plan_refused(&r->plan, r->gpu, err);
    }
    return true;
}

uint32_t wave_kernel_instructions(const struct renderer *r, const struct specialization *s,
                                  enum kernel_id id)
{
    struct kernel_source source;
    find_source(r, s, id, &source);
    const struct gpu_kernel_params *p = &source.params;
    uint32_t *trimmed = malloc(p->spirv_bytes), count = 0;
    if (trimmed) {
        size_t bytes =
            spirv_trim(p->spirv, p->spirv_bytes, p->constants, p->constant_count, trimmed);
        bool is_trimmed = bytes && bytes != SPIRV_TRIM_NO_MEMORY;
        count = is_trimmed ? spirv_instructions(trimmed, bytes)
                           : spirv_instructions(p->spirv, p->spirv_bytes);
    }
    free(trimmed);
    free(source.made);
    return count;
}
