// Photometric profiles: the intensity of a luminaire by direction, from IES files (ANSI/IES
// LM-63-1986 to -2019, TILT=NONE or INCLUDE, photometric type C).
#ifndef LAMPYRIS_SCENE_SKY_IES_H
#define LAMPYRIS_SCENE_SKY_IES_H

#include "scene/core/scene.h"

#define IES_ANGLES_MAX 4096      // angles of each kind, vertical and horizontal
#define IES_VALUES_MAX (1 << 22) // values in a file

// Lumens of one watt at the wavelength of the greatest luminous efficacy (683.002 lm/W by the
// definition of the candela, BIPM 2019). glTF importers use this for light of any spectrum, and so
// does this project.
#define LUMENS_A_WATT 683.0

// Relative intensity by angles: 1 at its maximum, bilinear between the angles of the file, and 0
// beyond its vertical angles.
struct light_profile {
    const char *path;
    uint32_t vertical_count; // at least 1
    uint32_t
        horizontal_count; // 1: alike all round; else from 0 to 360 degrees, the last as the first
    float *vertical;      // degrees from the direction, ascending, in [0, 180]
    float *horizontal;    // degrees about it, see docs/scene-format.md
    float *relative;      // horizontal_count rows of vertical_count
    double greatest;      // intensity of the file's maximum, W/sr: candela / LUMENS_A_WATT
    double solid_angle;   // integral of `relative` over all directions
    const struct light_profile *next; // the next of the scene's profiles
};

// Loads a profile into scene->arena, or returns the one that was read from this file before.
// Continues scene->hash over the file's bytes. ERR_INPUT names the line.
bool ies_load(struct scene *scene, const char *path, const struct light_profile **out,
              struct err *err);

#endif
