// Lists the layers of an EXR file that contain AOVs.
#include "output/layers.h"

#include "render/render.h"
#include "shared/aov.h"

static const char *const axes[] = {"X", "Y", "Z", NULL};
static const char *const depth[] = {"Z", NULL};
static const char *const alpha[] = {"A", NULL};
static const char *const ids[] = {"object", "material", "primitive", NULL};
static const char *const count[] = {"count", NULL};

void layers_list(const struct film_image *film, uint32_t wanted, struct layers *out)
{
    const struct film_aovs *aovs = &film->aovs;
    const struct image_layer layers[] = {
        {"albedo", aovs->albedo, NULL, IMAGE_LAYER_FLOAT},
        {"normal", aovs->normal, axes, IMAGE_LAYER_FLOAT},
        {"normal_geometric", aovs->normal_geometric, axes, IMAGE_LAYER_FLOAT},
        {"depth", aovs->depth, depth, IMAGE_LAYER_FULL},
        {"position", aovs->position, axes, IMAGE_LAYER_FULL},
        {"alpha", aovs->alpha, alpha, IMAGE_LAYER_FLOAT},
        {"steps", aovs->steps, count, IMAGE_LAYER_FULL},
        {"id", aovs->ids, ids, IMAGE_LAYER_UINT},
        {"emission", aovs->emission, NULL, IMAGE_LAYER_FLOAT},
        {"direct", aovs->direct, NULL, IMAGE_LAYER_FLOAT},
        {"indirect", aovs->indirect, NULL, IMAGE_LAYER_FLOAT},
        {"variance", aovs->variance, NULL, IMAGE_LAYER_FULL},
        {"samples", wanted & AOV_SAMPLES ? film->samples : NULL, count, IMAGE_LAYER_UINT},
        {"half_a", wanted & AOV_HALVES ? film->half_a : NULL, NULL, IMAGE_LAYER_FLOAT},
        {"half_b", wanted & AOV_HALVES ? film->half_b : NULL, NULL, IMAGE_LAYER_FLOAT},
    };
    _Static_assert(sizeof layers / sizeof *layers == LAYERS_MAX, "room for all");
    *out = (struct layers){0};
    for (uint32_t i = 0; i < LAYERS_MAX; i++)
        if (layers[i].values)
            out->list[out->count++] = layers[i];
}

uint64_t layers_bytes(uint32_t wanted, bool half_float)
{
    uint64_t bytes = film_aovs_bytes(wanted);
    bytes += wanted & AOV_SAMPLES ? sizeof(uint32_t) : 0;
    bytes += wanted & AOV_HALVES ? 2 * sizeof(float[3]) : 0;
    // Most layers then take half the bytes; the exceptions are neglected.
    return half_float ? bytes / 2 : bytes;
}
