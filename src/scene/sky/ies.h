// Photometric profiles: how a luminaire spreads its light over directions, as IES files tell it
// (ANSI/IES LM-63-1986 to -2019, TILT=NONE or INCLUDE, photometric type C).
#ifndef LAMPYRIS_SCENE_SKY_IES_H
#define LAMPYRIS_SCENE_SKY_IES_H

#include "scene/core/scene.h"

#define IES_ANGLES_MAX 4096      // of one kind
#define IES_VALUES_MAX (1 << 22) // in a file

// Lumens of light of one watt, at the wavelength where a watt has the most (683.002 lm/W by the
// definition of the candela, BIPM 2019): what glTF's importers take for all light, and we too.
#define LUMENS_A_WATT 683.0

// Relative intensity over angles: 1 where it is greatest. Between the angles bilinear in them,
// beyond the vertical ones 0.
struct light_profile {
    const char *path;
    uint32_t vertical_count; // at least 1
    uint32_t
        horizontal_count; // 1: alike all round; else from 0 to 360 degrees, the last as the first
    float *vertical;      // degrees from the direction, ascending, in [0, 180]
    float *horizontal;    // degrees about it, see docs/scene-format.md
    float *relative;      // horizontal_count rows of vertical_count
    double greatest;      // intensity, W/sr, of the file: candela / LUMENS_A_WATT
    double solid_angle;   // integral of `relative` over all directions
    const struct light_profile *next; // of the scene's
};

// Everything in scene->arena. A file that was read before is not read again. Continues scene->hash
// over the file's bytes. ERR_INPUT names the line.
bool ies_load(struct scene *scene, const char *path, const struct light_profile **out,
              struct err *err);

#endif
