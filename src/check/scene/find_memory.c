// Finds that the image is too large for the device's memory.
#include "check/scene/survey.h"

// Tests whether the device can allocate as much memory as a render, because its report of free
// memory may be wrong. Frees the memory again.
static bool can_allocate(struct survey *survey, uint64_t bytes, bool *can, struct err *err)
{
    struct gpu *gpu = survey->small.renderer.gpu;
    uint64_t most =
        gpu->max_allocation < gpu->max_storage_range ? gpu->max_allocation : gpu->max_storage_range;
    size_t count = (size_t)((bytes + most - 1) / most), made = 0;
    struct gpu_buffer *buffers = ARENA_NEW(&survey->scratch, struct gpu_buffer, count);
    struct err failure = {0};
    if (!buffers)
        return err_memory(err, "buffers", count * sizeof *buffers);
    for (uint64_t left = bytes; left > 0; left -= left < most ? left : most, made++)
        if (!gpu_buffer_create(gpu, "film", left < most ? left : most, GPU_DEVICE, false,
                               &buffers[made], &failure))
            break;
    for (size_t i = 0; i < made; i++)
        gpu_buffer_finish(gpu, &buffers[i]);
    *can = made == count || !gpu->out_of_memory;
    gpu->out_of_memory = false;
    return true;
}

bool find_memory(struct survey *survey, struct err *err)
{
    uint64_t bytes = survey->least_bytes;
    bool can = true;
    // The renders of this check have already had at least as much memory.
    if (!survey->refusal && bytes <= survey->small_bytes)
        return true;
    if (!survey->refusal && !can_allocate(survey, bytes, &can, err))
        return false;
    if (!survey->refusal && can)
        return true;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "too-little-memory",
            .level = FINDING_WRONG,
            .place = arena_printf(survey->arena, "a picture of %u x %u pixels",
                                  survey->settings.width, survey->settings.height),
            .figure = survey->refusal ? survey->refusal
                                      : arena_printf(survey->arena,
                                                     "the scene and the picture take %.1f MiB of "
                                                     "device memory, more than the device provides",
                                                     (double)bytes / 1048576.0),
            .consequence = "A render would fail before its first sample.",
            .remedy = "Render a smaller picture (--size), use a device with more memory, or end "
                      "other programs that use its memory.",
            .share = 1.0,
        },
        err);
}
