// Pictures besides the radiance, as they are read back with the film.
#ifndef LAMPYRIS_RENDER_FILM_AOVS_H
#define LAMPYRIS_RENDER_FILM_AOVS_H

#include "base/arena.h"
#include "flatten/flatten.h"
#include <stdbool.h>
#include <stdint.h>

// The brightest contribution to a pixel. All 0: it has no light.
struct film_brightest {
    float radiance[3]; // as it was added to the sample's, which may be clamped
    uint32_t origin;   // BRIGHTEST_ORIGIN()
    uint32_t sample;   // of the lowest number, where several are as bright
};

// Pixels in rows from the top; NULL where it was not asked for. Of the first surface that camera
// rays meet, glass and mirrors too: means over all samples, of which those that meet none count as
// 0, but for depth and position, which are means over the samples that meet one.
struct film_aovs {
    float (*albedo)[3];
    float (*normal)[3];           // of shading, in the world, towards the camera
    float (*normal_geometric)[3]; // the same of the surface as it is
    float *depth;                 // along the ray, metres; infinite where no sample meets anything
    float (*position)[3];         // in the world, metres; 0 where no sample meets anything
    float *alpha;                 // the share of samples that meet something
    float *steps; // of camera rays on their way to it: nodes visited and primitives tested
    // Object, material and primitive that the pixel's first sample meets, each by its number in the
    // scene plus 1, 0 for nothing. Objects are instances, then shapes; a mesh's triangles are
    // primitives, a shape has one.
    uint32_t (*ids)[3];
    // Parts of the radiance: after no, one and more scattering events.
    float (*emission)[3], (*direct)[3], (*indirect)[3];
    float (*variance)[3]; // of the radiance's mean, from the half-buffers; infinite where unknown
    // With AOVS_BY: what each class brings to the means of both half-buffers, the classes of a
    // pixel beside each other (shared/aov.h).
    uint32_t class_count;
    float (*class_a)[3], (*class_b)[3];
    struct film_brightest *brightest;
};

// What the device has to know of those wanted: AOV_*, without those that the film has anyway, with
// AOV_ALPHA where others need it.
uint32_t film_aovs_of_device(uint32_t wanted);
// Bytes of a pixel of those wanted, on the host.
uint32_t film_aovs_bytes(uint32_t wanted);
bool film_aovs_allocate(uint32_t wanted, uint64_t pixels, struct arena *arena,
                        struct film_aovs *out, struct err *err);
// Takes pixel `at` from its record (shared/aov.h), the words behind gpu_resolved_pixel. `device`:
// as of film_aovs_of_device.
void film_aovs_read(const struct film_aovs *aovs, uint64_t at, const uint32_t *words,
                    uint32_t device, const struct flat_scene *flat);

#endif
