#include "image/image_exr_channel.h"

#include <stdio.h>

static uint32_t component_count(const struct image_layer *layer)
{
    uint32_t count = 0;
    while (layer->channels && layer->channels[count])
        count++;
    return layer->channels ? count : 3;
}

static void describe(const struct image_write_params *params, const struct image_layer *layer,
                     uint32_t component, struct exr_channel *out)
{
    static const char *const colors[] = {"R", "G", "B"};
    const char *letter = layer->channels ? layer->channels[component] : colors[component];
    int length = layer->name ? snprintf(out->name, sizeof out->name, "%s.%s", layer->name, letter)
                             : snprintf(out->name, sizeof out->name, "%s", letter);
    bool is_half = params->half_float && layer->type == IMAGE_LAYER_FLOAT;
    out->is_name_too_long = length > EXR_NAME_MAX_BYTES;
    out->type = layer->type == IMAGE_LAYER_UINT ? EXR_PIXEL_UINT
                : is_half                       ? EXR_PIXEL_HALF
                                                : EXR_PIXEL_FLOAT;
    out->stride = component_count(layer) * sizeof(float);
    out->values = (const char *)layer->values + component * sizeof(float);
}

bool exr_channel_at(const struct image_write_params *params, uint32_t index,
                    struct exr_channel *out)
{
    const struct image_layer plain = {.values = params->image->pixels};
    for (int i = plain.values ? -1 : 0; i < (int)params->layer_count; i++) {
        const struct image_layer *layer = i < 0 ? &plain : &params->layers[i];
        uint32_t count = component_count(layer);
        if (index < count) {
            describe(params, layer, index, out);
            return true;
        }
        index -= count;
    }
    return false;
}

bool exr_channel_find(const struct image_write_params *params, const char *name,
                      struct exr_channel *out)
{
    for (uint32_t i = 0; exr_channel_at(params, i, out); i++)
        if (strcmp(out->name, name) == 0)
            return true;
    return false;
}
