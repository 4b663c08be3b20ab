// Bindings, constants and records that the kernels of the denoised preview share with C. Every
// buffer but the film has one word of four a pixel. Where a buffer comes as a pair, the first is
// the current frame's and the second the history, which the last view left.
#ifndef LAMPYRIS_SHARED_DENOISE_H
#define LAMPYRIS_SHARED_DENOISE_H

#include "types.h"

#define DENOISE_FILM 0 // a chunk of the renderer's
// Unit normal, or 0 where nothing is; then what of the depth is linear over a plane's picture
// (lib/denoise_view.glsl), or DENOISE_EMPTY of a pixel without samples.
#define DENOISE_GUIDES 1
#define DENOISE_GUIDES_HISTORY 2
// Reflected light over what it was reflected by, from the film and the history; then of how many
// samples it is worth: the variance of one over that number is the variance of the mean.
#define DENOISE_BLENDED 3
#define DENOISE_BLENDED_HISTORY 4
// The guide's change to the next pixel in x and y; then what gives the variance of a sample's
// luminance: a sum of squared deviations, and its degrees of freedom.
#define DENOISE_RECORDS 5
#define DENOISE_RECORDS_HISTORY 6
// The wavelet reads and writes light and the variance of its luminance.
#define DENOISE_FROM 7
#define DENOISE_TO 8
// The factor by which light is divided and later multiplied again; w is 1 where the film's halves
// give a variance, else 0.
#define DENOISE_MODULATION 9
#define DENOISE_PICTURE 10 // radiance, samples of the film
// What reaches the camera from emitters, without reflection; w is 1 + the number of the motion that
// the pixel's object made since the history, 0 of one that is where it was.
#define DENOISE_EMISSION 11
#define DENOISE_BINDINGS 12

#define DENOISE_WORKGROUP 64u // threads, for a square of pixels
#define DENOISE_TILE 8u       // its side
#define DENOISE_LEVELS 5u     // levels of the wavelet, at most

// Specialization constants.
#define DENOISE_CONSTANT_TEXEL 0   // 1: buffers are read as texel buffers
#define DENOISE_CONSTANT_AOVS 1    // AOV_* that the film has
#define DENOISE_CONSTANT_WAVELET 2 // DENOISE_WAVELET_*
#define DENOISE_CONSTANT_HISTORY 3 // DENOISE_HISTORY_*
#define DENOISE_CONSTANT_GATHER 4  // DENOISE_GATHER_*, as bits
#define DENOISE_CONSTANT_COUNT 5

// These parts are gathered from the film at once, or in two runs where a device binds too few
// buffers.
#define DENOISE_GATHER_LIGHT 1u   // guides, light and its factors
#define DENOISE_GATHER_PICTURE 2u // radiance and emission
#define DENOISE_GATHER_ALL 3u
#define DENOISE_GATHER_STORAGE 6 // storage buffers that gathering all binds

// Levels of the wavelet. The last one leaves what is judged by; a linear one has no regard for
// luminances, so that its mean is biased by none.
#define DENOISE_WAVELET_LEVEL 0u
#define DENOISE_WAVELET_LAST 1u
#define DENOISE_WAVELET_LINEAR 2u

// The modes of the blend. If the scene differs from the history's, the blend runs twice: first it
// writes the difference between film and history, and once the wavelet's linear levels have
// averaged that, it mixes in as much of the history as is still valid.
#define DENOISE_HISTORY_NONE 0u
#define DENOISE_HISTORY_MIXED 1u
#define DENOISE_HISTORY_COMPARED 2u
#define DENOISE_HISTORY_CHECKED 3u
// Levels in between: an even number, so that they end in the buffer in which they began.
#define DENOISE_COMPARED_LEVELS 2u

#define DENOISE_EMPTY (-1.0f)

// A history is never worth more samples than this when it is mixed with the film's: what moved on
// since, reflections and what is half hidden, is then gone after so many new ones.
#define DENOISE_HISTORY_SAMPLES 32.0f
// A film with this many samples of its own needs no history.
#define DENOISE_FADE_SAMPLES 64.0f

// A camera as both ways of projecting need it; rays are relative to the film's camera, so that far
// from the origin nothing is lost.
struct gpu_denoise_view {
    VEC3(position); // position of the film's camera: 0
    uint kind;      // CAMERA_*
    VEC3(forward);  // unit
    uint width;
    VEC3(right); // as of gpu_frame
    uint height;
    VEC3(up);
    uint align_view;
    VEC3(to_right); // right over its squared length
    uint align_to_right;
    VEC3(to_up);
    uint align_to_up;
};

// An object that moved since the history: the primitives that it is made of (AOV_IDS), and the rows
// of the affine map that takes its points, relative to the film's camera, to where they were.
struct gpu_denoise_motion {
    VEC3(past_x);
    float past_x_at;
    VEC3(past_y);
    float past_y_at;
    VEC3(past_z);
    float past_z_at;
    uint first_primitive;
    uint primitive_count;
    uint instance; // plus 1; 0: these primitives are in the world itself
    uint align_motion;
};
#define DENOISE_MOTIONS_MAX 32u

// The uniform block.
struct gpu_denoise {
    RECORD(gpu_denoise_view) now;
    RECORD(gpu_denoise_view) history;
    uint halves;     // HALVES_*
    uint first_half; // with HALVES_CONTIGUOUS: samples of the first one
    uint motion_count;
    uint repeats; // 1: the film's samples have the random numbers of the history's
    RECORD(gpu_denoise_motion) motions[DENOISE_MOTIONS_MAX];
};

struct gpu_denoise_push {
    uint first_group; // first workgroup of this part of a split dispatch
    uint first_pixel; // first pixel of the film's chunk that is bound
    uint pixel_count; // in it
    uint step;        // step of the wavelet's level, pixels
};

SHARED_STATIC_ASSERT_SIZE(gpu_denoise_view, 96);
SHARED_STATIC_ASSERT_SIZE(gpu_denoise_motion, 64);
SHARED_STATIC_ASSERT_SIZE(gpu_denoise, 2256);
SHARED_STATIC_ASSERT_SIZE(gpu_denoise_push, 16);

#endif
