// Fuzz target for an image of the format FUZZ_FORMAT ("exr", "hdr", "jpeg", "pfm", "png", "tga" or
// "webp") in memory, and for its metadata. Inputs of other formats are rejected, so that they do
// not enter the corpus.
#include "base/memory.h"
#include "image/image.h"
#include "image/image_internal.h"
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bool read_format(const struct image_source *source, struct arena *arena)
{
    struct pixels image = {0};
    struct image_attribute *attributes;
    uint32_t count = 0;
    if (strcmp(FUZZ_FORMAT, "exr") == 0) {
        image_exr_read_attributes(source, arena, &attributes, &count, NULL);
        return image_exr_read(source, arena, &image, NULL);
    }
    if (strcmp(FUZZ_FORMAT, "png") == 0) {
        image_png_read_attributes(source, arena, &attributes, &count, NULL);
        return image_png_read(source, arena, &image, NULL);
    }
    if (strcmp(FUZZ_FORMAT, "hdr") == 0)
        return image_hdr_read(source, arena, &image, NULL);
    if (strcmp(FUZZ_FORMAT, "pfm") == 0)
        return image_pfm_read(source, arena, &image, NULL);
#ifdef HAS_TGA
    if (strcmp(FUZZ_FORMAT, "tga") == 0)
        return image_tga_read(source, arena, &image, NULL);
#endif
#ifdef HAS_WEBP
    if (strcmp(FUZZ_FORMAT, "webp") == 0)
        return image_webp_read(source, arena, &image, NULL);
#endif
    return image_jpeg_read(source, arena, &image, NULL);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct image_source source = {.path = "fuzz", .data = data, .size = size};
    memory_set_budget(64u << 20);
    struct arena arena = {0};
    read_format(&source, &arena);
    source.with_alpha = source.is_linear = true;
    read_format(&source, &arena);
    arena_finish(&arena);
    return 0;
}
