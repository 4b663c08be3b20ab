// Runs the renderer's BSDFs on items that the host provides (shaders/check_bsdf.comp).
#ifndef LAMPYRIS_CHECK_BSDF_H
#define LAMPYRIS_CHECK_BSDF_H

#include "shared/check_bsdf.h"
#include <stdint.h>

// The input of an item, which is replaced by its output.
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
        float eval[3]; // f times the cosine of the angle of incidence
        float eval_pdf;
        float unused[4];
    } sample;
    struct {
        float f[3]; // f times the cosine
        float pdf;
        float unused[12];
    } eval;
    float out[16]; // the words of any output
};

#endif
