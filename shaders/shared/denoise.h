// Defines bindings, constants and records that the kernels of the denoised preview share with C.
// Each buffer except the film has one uvec4 word per pixel. A buffer whose name ends in _HISTORY
// has the data of the preceding frame.
#ifndef LAMPYRIS_SHARED_DENOISE_H
#define LAMPYRIS_SHARED_DENOISE_H

#include "types.h"

#define DENOISE_FILM 0 // a chunk of the renderer's film
// xyz: unit normal, or 0 if no surface was hit. w: a function of the depth that is linear over the
// image of a plane (lib/denoise_view.glsl), or DENOISE_EMPTY for pixels without samples.
#define DENOISE_GUIDES 1
#define DENOISE_GUIDES_HISTORY 2
// xyz: reflected light divided by the albedo, from the film and the history. w: the equivalent
// number of samples. The variance of one sample divided by this number is the variance of the mean.
#define DENOISE_BLENDED 3
#define DENOISE_BLENDED_HISTORY 4
// xy: the change of the guide's depth to the next pixel in x and y. zw: the sum of squared
// deviations of a sample's luminance, and its degrees of freedom; their quotient is the variance.
#define DENOISE_RECORDS 5
#define DENOISE_RECORDS_HISTORY 6
// Buffers that the wavelet reads and writes: light, and the variance of its luminance.
#define DENOISE_FROM 7
#define DENOISE_TO 8
// xyz: the albedo by which light is divided before, and multiplied after filtering. w: 1 if the
// film's half-buffers give a variance, else 0.
#define DENOISE_MODULATION 9
#define DENOISE_PICTURE 10 // radiance; number of samples of the film
// xyz: light that reaches the camera from emitters without reflection. w: 1 + the index of the
// motion of the pixel's object since the history; 0 if it did not move.
#define DENOISE_EMISSION 11
#define DENOISE_BINDINGS 12

#define DENOISE_WORKGROUP 64u // threads of a workgroup, for a square of pixels
#define DENOISE_TILE 8u       // side of that square, in pixels
#define DENOISE_LEVELS 5u     // maximum number of levels of the wavelet

// Specialization constants.
#define DENOISE_CONSTANT_TEXEL 0   // 1: buffers are read as texel buffers
#define DENOISE_CONSTANT_AOVS 1    // AOV_* that the film has
#define DENOISE_CONSTANT_WAVELET 2 // DENOISE_WAVELET_*
#define DENOISE_CONSTANT_HISTORY 3 // DENOISE_HISTORY_*
#define DENOISE_CONSTANT_GATHER 4  // DENOISE_GATHER_*, as bits
#define DENOISE_CONSTANT_COUNT 5

// Parts of the input. They are gathered from the film by one dispatch, or by two if the device can
// bind only few buffers.
#define DENOISE_GATHER_LIGHT 1u   // guides, light and the albedo that divides it
#define DENOISE_GATHER_PICTURE 2u // radiance and emission
#define DENOISE_GATHER_ALL 3u
#define DENOISE_GATHER_STORAGE 6 // number of storage buffers when all parts are gathered at once

// Modes of the wavelet: an ordinary level; the last level, which also writes the values for the
// judgement of the result; and a linear level, which does not depend on luminances, so that its
// mean is unbiased.
#define DENOISE_WAVELET_LEVEL 0u
#define DENOISE_WAVELET_LAST 1u
#define DENOISE_WAVELET_LINEAR 2u

// Modes of the blend. If the scene has changed since the history was made, the blend runs twice:
// first it writes the difference between film and history; after linear levels of the wavelet have
// averaged this difference, it mixes in as much of the history as is still valid.
#define DENOISE_HISTORY_NONE 0u
#define DENOISE_HISTORY_MIXED 1u
#define DENOISE_HISTORY_COMPARED 2u
#define DENOISE_HISTORY_CHECKED 3u
// The number of linear levels that average the difference. It is even, so that the last level
// writes to the buffer from which the first one reads.
#define DENOISE_COMPARED_LEVELS 2u

#define DENOISE_EMPTY (-1.0f)

// The history counts as at most this many samples when it is mixed with the film. So errors of the
// history, such as moved reflections, disappear after as many new samples.
#define DENOISE_HISTORY_SAMPLES 32.0f
// The history is not used for pixels that have this many samples of their own.
#define DENOISE_FADE_SAMPLES 64.0f

// A camera, with the vectors for projection in both directions. Positions are relative to the
// film's camera, so that precision does not suffer far from the origin.
struct gpu_denoise_view {
    VEC3(position); // position relative to the film's camera
    uint kind;      // CAMERA_*
    VEC3(forward);  // unit
    uint width;
    VEC3(right); // right and up as in gpu_frame
    uint height;
    VEC3(up);
    uint align_view;
    VEC3(to_right); // right divided by its squared length
    uint align_to_right;
    VEC3(to_up);
    uint align_to_up;
};

// An object that has moved since the history was made: its primitives (AOV_IDS), and the rows of
// the affine map from its points, relative to the film's camera, to their former positions.
struct gpu_denoise_motion {
    VEC3(past_x);
    float past_x_at;
    VEC3(past_y);
    float past_y_at;
    VEC3(past_z);
    float past_z_at;
    uint first_primitive;
    uint primitive_count;
    uint instance; // 1 + the instance; 0: the primitives are in world space
    uint align_motion;
};
#define DENOISE_MOTIONS_MAX 32u

// The uniform block.
struct gpu_denoise {
    RECORD(gpu_denoise_view) now;
    RECORD(gpu_denoise_view) history;
    uint halves;     // HALVES_*
    uint first_half; // with HALVES_CONTIGUOUS: number of samples of the first half
    uint motion_count;
    uint repeats; // 1: the film's samples use the same random numbers as the history's
    RECORD(gpu_denoise_motion) motions[DENOISE_MOTIONS_MAX];
};

struct gpu_denoise_push {
    uint first_group; // first workgroup of this part of a split dispatch
    uint first_pixel; // first pixel of the bound film chunk
    uint pixel_count; // number of pixels of that chunk
    uint step;        // step of the wavelet's level, in pixels
};

SHARED_STATIC_ASSERT_SIZE(gpu_denoise_view, 96);
SHARED_STATIC_ASSERT_SIZE(gpu_denoise_motion, 64);
SHARED_STATIC_ASSERT_SIZE(gpu_denoise, 2256);
SHARED_STATIC_ASSERT_SIZE(gpu_denoise_push, 16);

#endif
