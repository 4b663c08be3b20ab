// Creates kernels, descriptor sets and buffers for the display, and dispatches its kernels.
#include "render/show/display_internal.h"

#include "base/memory.h"

#include "display_range.spv.h"
#include "display_read.spv.h"
#include "display_scale.spv.h"
#include "display_show.spv.h"
#include <string.h>

static const struct {
    const char *name;
    const uint32_t *spirv;
    size_t bytes;
} codes[DISPLAY_CODES] = {
    [DISPLAY_READ] = {"display_read", display_read_spirv, sizeof display_read_spirv},
    [DISPLAY_SCALE] = {"display_scale", display_scale_spirv, sizeof display_scale_spirv},
    [DISPLAY_SHOW] = {"display_show", display_show_spirv, sizeof display_show_spirv},
    [DISPLAY_RANGE] = {"display_range", display_range_spirv, sizeof display_range_spirv},
};

bool display_begin(struct display *d, struct err *err)
{
    d->own->set_count = 0;
    return paced_begin(&d->own->paced, err);
}

bool display_end(struct display *d, struct err *err)
{
    if (!paced_end(&d->own->paced, err))
        return false;
    for (int i = 0; i < DISPLAY_CODES; i++)
        d->ms += 1e-6 * d->own->paced.ns[i];
    return true;
}

static bool find_kernel(struct display *d, enum display_code code,
                        const uint32_t constants[DISPLAY_CONSTANT_COUNT], struct gpu_kernel **out,
                        struct err *err)
{
    struct display_state *own = d->own;
    for (uint32_t i = 0; i < DISPLAY_KERNELS; i++) {
        *out = &own->kernels[i];
        if ((*out)->spirv == codes[code].spirv &&
            memcmp((*out)->constants, constants, DISPLAY_CONSTANT_COUNT * sizeof *constants) == 0)
            return true;
    }
    const struct gpu_kernel_params params = {
        .name = codes[code].name,
        .spirv = codes[code].spirv,
        .spirv_bytes = codes[code].bytes,
        .constants = constants,
        .constant_count = DISPLAY_CONSTANT_COUNT,
    };
    *out = &own->kernels[own->kernel_count++ % DISPLAY_KERNELS];
    gpu_kernel_finish(d->gpu, *out);
    return gpu_kernel_create(d->gpu, &params, *out, err);
}

// Writes a descriptor set for the buffers. If all films and linear images that are read can be
// texels, they are bound as texels, too, and *texels is set.
static bool write_set(struct display *d, const struct display_work *work, struct gpu_bindings **out,
                      bool *texels, struct err *err)
{
    struct display_state *own = d->own;
    struct gpu_binding storage[GPU_MAX_STORAGE] = {0};
    const struct gpu_buffer *texel[GPU_MAX_TEXEL] = {0};
    if (own->set_count == DISPLAY_SETS && (!display_end(d, err) || !display_begin(d, err)))
        return false;
    *texels = true;
    for (uint32_t b = 0; b < DISPLAY_BINDING_COUNT; b++) {
        const struct gpu_buffer *buffer = work->buffers[b];
        bool is_read = b == DISPLAY_BINDING_FILM || b == DISPLAY_BINDING_FROM ||
                       (b >= DISPLAY_BINDING_LEFT && b <= DISPLAY_BINDING_TAPS);
        storage[b].buffer = buffer;
        if (!is_read || !buffer)
            continue;
        texel[b] = buffer->texel_view ? buffer : NULL;
        *texels = *texels && texel[b];
    }
    struct gpu_bindings *set = &own->sets[own->set_count];
    if (!(set->dummy.handle ? gpu_bindings_write : gpu_bindings_create)(d->gpu, storage, texel,
                                                                        NULL, set, err))
        return false;
    own->set_count++;
    *out = set;
    return true;
}

bool display_dispatch(struct display *d, const struct display_work *work, struct err *err)
{
    uint32_t constants[DISPLAY_CONSTANT_COUNT];
    struct gpu_kernel *kernel;
    struct gpu_bindings *set;
    bool texels;
    if (!write_set(d, work, &set, &texels, err))
        return false;
    memcpy(constants, work->constants, sizeof constants);
    constants[DISPLAY_CONSTANT_WORKGROUP] = DISPLAY_WORKGROUP;
    constants[DISPLAY_CONSTANT_FLAGS] |= texels ? DISPLAY_TEXELS : 0;
    if (!find_kernel(d, work->code, constants, &kernel, err))
        return false;
    struct gpu_display_push push = work->push;
    const struct paced_work paced = {
        .number = work->code,
        .kernel = kernel,
        .bindings = set,
        .push = &push,
        .push_bytes = sizeof push,
        .first = &push.first_item,
        .first_unit = DISPLAY_WORKGROUP,
        .groups = (work->threads + DISPLAY_WORKGROUP - 1) / DISPLAY_WORKGROUP,
        .workgroup = DISPLAY_WORKGROUP,
    };
    return paced_dispatch(&d->own->paced, &paced, err);
}

bool display_reserve_bytes(struct display *d, const char *name, uint64_t bytes, bool texel,
                           struct gpu_buffer *out, struct err *err)
{
    // A buffer of more than four times the size is freed.
    if (out->handle && out->bytes >= bytes && out->bytes / 4 <= bytes)
        return true;
    // A buffer that grows gets room to spare, because a window that is being enlarged needs a
    // little more with every frame.
    bool grows = out->handle && out->bytes < bytes;
    uint64_t roomy = bytes + bytes / 64 * 16;
    if (grows && roomy <= d->gpu->max_storage_range && (!texel || gpu_texel_fits(d->gpu, roomy)))
        bytes = roomy;
    gpu_buffer_finish(d->gpu, out);
    return gpu_buffer_create(d->gpu, name, bytes, GPU_DEVICE,
                             texel && gpu_texel_fits(d->gpu, bytes), out, err);
}

bool display_reserve(struct display *d, const char *name, uint32_t width, uint32_t height,
                     struct linear *out, struct err *err)
{
    uint64_t bytes = (uint64_t)width * height * 16;
    if (bytes > d->gpu->max_storage_range)
        return err_set(err, ERR_GPU,
                       "a picture of %u x %u pixels takes %s; the device's limit of a buffer that "
                       "kernels write is %s (maxStorageBufferRange)",
                       width, height, memory_print(bytes).text,
                       memory_print(d->gpu->max_storage_range).text);
    out->width = width;
    out->height = height;
    return display_reserve_bytes(d, name, bytes, true, &out->buffer, err);
}

void display_work_finish(struct display *d)
{
    struct display_state *own = d->own;
    paced_finish(&own->paced);
    for (uint32_t i = 0; i < DISPLAY_SETS; i++)
        gpu_bindings_finish(d->gpu, &own->sets[i]);
    for (uint32_t i = 0; i < DISPLAY_KERNELS; i++)
        gpu_kernel_finish(d->gpu, &own->kernels[i]);
}
