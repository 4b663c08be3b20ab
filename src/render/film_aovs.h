// Reads back images besides the radiance (AOVs), together with the film.
#ifndef LAMPYRIS_RENDER_FILM_AOVS_H
#define LAMPYRIS_RENDER_FILM_AOVS_H

#include "base/arena.h"
#include "flatten/flatten.h"
#include <stdbool.h>
#include <stdint.h>

// The brightest contribution to a pixel. All members are 0 for a pixel without light.
struct film_brightest {
    float radiance[3]; // as added to the sample's radiance, after any clamping
    uint32_t origin;   // bounce, site and kind of emitter of the contribution, as BRIGHTEST_ORIGIN
                       // packs them
    uint32_t sample;   // the lowest such sample, if several are equally bright
};

// AOVs: pixels in rows from the top; NULL for those not requested. The members from `albedo` to
// `ids` describe the first surface that camera rays meet, even if it is glass or a mirror. Values
// are means over all samples, in which samples that meet no surface count as 0. Depth and position
// are means over the samples that meet a surface.
struct film_aovs {
    float (*albedo)[3];
    float (*normal)[3];           // the shading normal in world space, towards the camera
    float (*normal_geometric)[3]; // the geometric normal in world space, towards the camera
    float *depth;                 // along the ray, metres; infinite if no sample meets a surface
    float (*position)[3];         // in the world, metres; 0 if no sample meets a surface
    float *alpha;                 // the fraction of samples that meet a surface
    float *steps; // nodes visited and primitives tested by camera rays until their hits
    // The object, material and primitive that the pixel's first sample meets: their numbers in the
    // scene plus 1, or 0 for nothing. Objects are instances, then shapes. A mesh's triangles are
    // its primitives; a shape has one.
    uint32_t (*ids)[3];
    // The radiance that arrives after no, one, and more scattering events.
    float (*emission)[3], (*direct)[3], (*indirect)[3];
    float (*variance)[3]; // variance of the mean radiance, from the half-buffers; infinite if
                          // unknown
    // With AOVS_BY: the contribution of each class to the means of both half-buffers; a pixel's
    // classes are adjacent (shared/aov.h).
    uint32_t class_count;
    float (*class_a)[3], (*class_b)[3];
    struct film_brightest *brightest;
};

// Returns the AOVs that the device has to compute for the wanted ones: AOV_* without those that
// every film has, and with AOV_ALPHA if other AOVs need it.
uint32_t film_aovs_of_device(uint32_t wanted);
// Returns the number of bytes per pixel that the wanted AOVs take in host memory.
uint32_t film_aovs_bytes(uint32_t wanted);
bool film_aovs_allocate(uint32_t wanted, uint64_t pixels, struct arena *arena,
                        struct film_aovs *out, struct err *err);
// Reads pixel `at` from its record (shared/aov.h). `words` are the record's words after struct
// gpu_resolved_pixel; `device` is the result of film_aovs_of_device().
void film_aovs_read(const struct film_aovs *aovs, uint64_t at, const uint32_t *words,
                    uint32_t device, const struct flat_scene *flat);

#endif
