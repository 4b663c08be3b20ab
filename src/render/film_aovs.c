#include "render/film_aovs.h"

#include "shared/aov.h"
#include "shared/types.h"
#include <math.h>
#include <stddef.h>
#include <string.h>

// The images of floats in struct film_aovs.
static const struct plane {
    uint32_t aov, components;
    size_t member;
} planes[] = {
    {AOV_ALBEDO, 3, offsetof(struct film_aovs, albedo)},
    {AOV_NORMAL, 3, offsetof(struct film_aovs, normal)},
    {AOV_NORMAL_GEOMETRIC, 3, offsetof(struct film_aovs, normal_geometric)},
    {AOV_DEPTH, 1, offsetof(struct film_aovs, depth)},
    {AOV_POSITION, 3, offsetof(struct film_aovs, position)},
    {AOV_ALPHA, 1, offsetof(struct film_aovs, alpha)},
    {AOV_STEPS, 1, offsetof(struct film_aovs, steps)},
    {AOV_EMISSION, 3, offsetof(struct film_aovs, emission)},
    {AOV_DIRECT, 3, offsetof(struct film_aovs, direct)},
    {AOV_INDIRECT, 3, offsetof(struct film_aovs, indirect)},
};
enum { PLANE_COUNT = sizeof planes / sizeof *planes };

uint32_t film_aovs_of_device(uint32_t wanted)
{
    return (wanted & (AOVS_OF_SLOTS | AOVS_BY)) | (wanted & AOVS_OF_PLACES ? AOV_ALPHA : 0u);
}

uint32_t film_aovs_bytes(uint32_t wanted)
{
    uint32_t bytes = wanted & AOV_IDS ? 12 : 0;
    bytes += AOV_CLASSES(wanted) * 2 * 12;
    bytes += AOV_HAS_CLASSES(wanted) * (uint32_t)sizeof(struct film_brightest);
    bytes += wanted & AOV_VARIANCE ? 12 : 0;
    for (int i = 0; i < PLANE_COUNT; i++)
        if (wanted & planes[i].aov)
            bytes += planes[i].components * (uint32_t)sizeof(float);
    return bytes;
}

static float *plane_of(const struct film_aovs *aovs, const struct plane *plane)
{
    float *floats;
    memcpy(&floats, (const char *)aovs + plane->member, sizeof floats);
    return floats;
}

static bool allocate_classes(uint32_t wanted, uint64_t pixels, struct arena *arena,
                             struct film_aovs *out, struct err *err)
{
    out->class_count = AOV_CLASSES(wanted);
    if (out->class_count == 0)
        return true;
    uint64_t count = pixels * out->class_count;
    out->class_a = arena_alloc(arena, count, sizeof *out->class_a);
    out->class_b = arena_alloc(arena, count, sizeof *out->class_b);
    out->brightest = arena_alloc(arena, pixels, sizeof *out->brightest);
    return (out->class_a && out->class_b && out->brightest) ||
           err_memory(err, "the halves of --error-by", count * 2 * sizeof *out->class_a);
}

bool film_aovs_allocate(uint32_t wanted, uint64_t pixels, struct arena *arena,
                        struct film_aovs *out, struct err *err)
{
    *out = (struct film_aovs){0};
    for (int i = 0; i < PLANE_COUNT; i++) {
        if (!(wanted & planes[i].aov))
            continue;
        float *floats = arena_alloc(arena, pixels, planes[i].components * sizeof(float));
        if (!floats)
            return err_memory(err, "layers", pixels * planes[i].components * sizeof(float));
        memcpy((char *)out + planes[i].member, &floats, sizeof floats);
    }
    if (wanted & AOV_IDS)
        out->ids = arena_alloc(arena, pixels, sizeof *out->ids);
    if (wanted & AOV_VARIANCE)
        out->variance = arena_alloc(arena, pixels, sizeof *out->variance);
    if ((!out->ids && (wanted & AOV_IDS)) || (!out->variance && (wanted & AOV_VARIANCE)))
        return err_memory(err, "layers", pixels * sizeof *out->ids);
    return allocate_classes(wanted, pixels, arena, out, err);
}

static uint32_t float_at(uint32_t device, const struct plane *plane)
{
    return plane->components == 3 ? AOV_VECTOR_AT(device, plane->aov)
                                  : AOV_SCALAR_AT(device, plane->aov);
}

static void read_ids(const uint32_t words[2], const struct flat_scene *flat, uint32_t ids[3])
{
    if (words[0] == 0)
        return;
    uint32_t number = words[0] - 1;
    if (number & PRIMITIVE_SHAPE) {
        number &= ~PRIMITIVE_SHAPE;
        ids[0] = flat->instance_count + flat->shapes[number].source + 1;
        ids[1] = flat->shapes[number].material + 1;
        ids[2] = 1;
        return;
    }
    uint32_t instance, triangle;
    flat_triangle_source(flat, number, &instance, &triangle);
    uint32_t material = flat->triangles[number].material;
    if (words[1] > 0) {
        const struct flat_instance *placed = &flat->instances[words[1] - 1];
        instance = placed->source;
        material = placed->material == SCENE_NONE ? material : placed->material;
    }
    ids[0] = instance + 1;
    ids[1] = material + 1;
    ids[2] = triangle + 1;
}

// Reads the classes of a pixel. words: the part of its record from the classes on.
static void read_classes(const struct film_aovs *aovs, uint64_t at, const uint32_t *words)
{
    const uint32_t count = aovs->class_count;
    const uint32_t *brightest = words + 4 * 2 * count;
    struct film_brightest *to = &aovs->brightest[at];
    for (uint32_t i = 0; i < count; i++) {
        memcpy(aovs->class_a[at * count + i], &words[4 * i], sizeof *aovs->class_a);
        memcpy(aovs->class_b[at * count + i], &words[4 * (count + i)], sizeof *aovs->class_b);
    }
    memcpy(to->radiance, brightest, sizeof to->radiance);
    to->origin = brightest[3];
    to->sample = brightest[4];
}

void film_aovs_read(const struct film_aovs *aovs, uint64_t at, const uint32_t *words,
                    uint32_t device, const struct flat_scene *flat)
{
    float share = 1.0f;
    if (device & AOV_ALPHA)
        memcpy(&share, &words[AOV_SCALAR_AT(device, AOV_ALPHA)], sizeof share);
    for (int i = 0; i < PLANE_COUNT; i++) {
        const struct plane *plane = &planes[i];
        float *to = plane_of(aovs, plane);
        if (!to)
            continue;
        to += at * plane->components;
        memcpy(to, &words[float_at(device, plane)], plane->components * sizeof *to);
        for (uint32_t c = 0; c < plane->components && (plane->aov & AOVS_OF_PLACES); c++)
            to[c] = share > 0.0f ? to[c] / share : plane->aov == AOV_DEPTH ? INFINITY : 0.0f;
        // The position is in metres from the origin of the device's coordinates.
        for (uint32_t c = 0; c < 3 && plane->aov == AOV_POSITION && share > 0.0f; c++)
            to[c] = (float)((double)to[c] + flat->origin[c]);
    }
    if (aovs->class_count > 0)
        read_classes(aovs, at, &words[4 * (AOV_RESOLVED_CLASSES_AT(device) - RESOLVED_WORDS)]);
    if (aovs->ids)
        read_ids(&words[4 * (AOV_RESOLVED_WORDS(device) - RESOLVED_WORDS - 1u)], flat,
                 aovs->ids[at]);
}
