// Runs the shipped BSDFs on items that the host writes (shaders/check_bsdf.comp).
#ifndef LAMPYRIS_CHECK_BSDF_H
#define LAMPYRIS_CHECK_BSDF_H

#include "shared/check_bsdf.h"
#include <stdint.h>

// Inputs and outputs of an item.
union bsdf_item {
    struct {
        float wo[3];
        uint32_t material;
        float wi[3];
        float eta;
        float u[4];
        float unused[4];
    } in;
    struct {
        float wi[3];
        float pdf;
        float weight[3];
        uint32_t flags;
        float eval[3]; // f cos
        float eval_pdf;
        float unused[4];
    } sample;
    struct {
        float f[3]; // times cos
        float pdf;
        float unused[12];
    } eval;
    float out[16]; // the words of any of these
};

#endif
