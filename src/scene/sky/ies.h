// Photometric profiles: the intensity of a luminaire by direction, from IES files (ANSI/IES
// LM-63-1986 to -2019, TILT=NONE or INCLUDE, photometric type C).
#ifndef LAMPYRIS_SCENE_SKY_IES_H
#define LAMPYRIS_SCENE_SKY_IES_H

#include "scene/core/scene.h"

#define IES_ANGLES_MAX 4096      // maximum number of angles of each kind, vertical and horizontal
#define IES_VALUES_MAX (1 << 22) // maximum number of values in a file

// Lumens per watt at the wavelength of maximum luminous efficacy (683.002 lm/W by the definition of
// the candela, BIPM 2019). Like glTF importers, this program uses the factor for light of any
// spectrum.
#define LUMENS_A_WATT 683.0

// Relative intensity by angles: 1 at its maximum, bilinear between the angles of the file, and 0
// outside its vertical angles.
struct light_profile {
    const char *path;
    uint32_t vertical_count; // at least 1
    // 1: the profile is rotationally symmetric. Otherwise the horizontal angles range from 0 to 360
    // degrees, and the last plane equals the first.
    uint32_t horizontal_count;
    float *vertical;    // degrees from the light's direction, ascending, in [0, 180]
    float *horizontal;  // degrees about the light's direction, see docs/scene-format.md
    float *relative;    // horizontal_count rows of vertical_count values
    double greatest;    // maximum intensity in the file, W/sr: candela / LUMENS_A_WATT
    double solid_angle; // integral of `relative` over all directions
    const struct light_profile *next; // next profile of the scene
};

// Loads a profile into scene->arena, or returns the one that was read from this file before. The
// file's bytes are added to the scene's hash. Fails with ERR_INPUT, naming the line.
bool ies_load(struct scene *scene, const char *path, const struct light_profile **out,
              struct err *err);

#endif
