// Defines records and constants that the kernels of the viewer's image and of its denoiser share
// with C.
#ifndef LAMPYRIS_SHARED_DISPLAY_H
#define LAMPYRIS_SHARED_DISPLAY_H

#include "aov.h"
#include "types.h"

// The quantity that an image shows: the radiance or an AOV (AOV_*).
#define SHOWN_RADIANCE 0u
#define SHOWN_ALBEDO 1u
#define SHOWN_NORMAL 2u  // components from [-1, 1] as colours
#define SHOWN_DEPTH 3u   // false colours over a range
#define SHOWN_OBJECTS 4u // each object has its own colour
#define SHOWN_MATERIALS 5u
#define SHOWN_SAMPLES 6u
#define SHOWN_VARIANCE 7u
#define SHOWN_STEPS 8u // steps of the camera ray's traversal: the heat map
#define SHOWN_EMISSION 9u
#define SHOWN_DIRECT 10u
#define SHOWN_INDIRECT 11u
#define SHOWN_COUNT 12u
// Sets of quantities that are converted to colours by tone mapping or as false colours.
#define SHOWN_BIT(shown) (1u << (shown))
#define SHOWN_TONED                                                                                \
    (SHOWN_BIT(SHOWN_RADIANCE) | SHOWN_BIT(SHOWN_EMISSION) | SHOWN_BIT(SHOWN_DIRECT) |             \
     SHOWN_BIT(SHOWN_INDIRECT))
#define SHOWN_FALSE                                                                                \
    (SHOWN_BIT(SHOWN_DEPTH) | SHOWN_BIT(SHOWN_SAMPLES) | SHOWN_BIT(SHOWN_VARIANCE) |               \
     SHOWN_BIT(SHOWN_STEPS))
// Logarithmic false colours, for values that extend to the horizon or over many powers of ten.
#define SHOWN_LOGARITHMIC (SHOWN_BIT(SHOWN_DEPTH) | SHOWN_BIT(SHOWN_VARIANCE))

// Storage buffers of the display's kernels. A linear image has a vec4 for each pixel: a value times
// its weight, and the weight, which is 0 if the value is not known. The value of a quantity in
// false colours is a vector: the quantity times the fraction of samples that have it, that
// fraction, and 0.
#define DISPLAY_BINDING_FILM 0     // a chunk of the film
#define DISPLAY_BINDING_DENOISED 1 // vec4 for each pixel of the film
#define DISPLAY_BINDING_SOURCES 2  // tables by which objects of primitives are found: see display.c
#define DISPLAY_BINDING_FROM 3     // linear image to read
#define DISPLAY_BINDING_TO 4       // linear image to write
// Linear images of the displayed size, for the left and the right side.
#define DISPLAY_BINDING_LEFT 5
#define DISPLAY_BINDING_RIGHT 6
#define DISPLAY_BINDING_KEPT_LEFT 7
#define DISPLAY_BINDING_KEPT_RIGHT 8
#define DISPLAY_BINDING_PALETTE 9 // vec4 for each colour, linear
#define DISPLAY_BINDING_TAPS 10   // struct gpu_display_taps of all columns, then of all rows
#define DISPLAY_BINDING_PIXELS 11 // RGBA8
#define DISPLAY_BINDING_RANGE 12  // struct gpu_display_range
#define DISPLAY_BINDING_COUNT 13

// Specialization constants.
#define DISPLAY_CONSTANT_WORKGROUP 0
#define DISPLAY_CONSTANT_SHOWN 1
#define DISPLAY_CONSTANT_FLAGS 2 // DISPLAY_*
#define DISPLAY_CONSTANT_AOVS 3  // AOVs of the film
#define DISPLAY_CONSTANT_HALVES 4
#define DISPLAY_CONSTANT_TONE 5 // enum tone_curve
#define DISPLAY_CONSTANT_COUNT 6

#define DISPLAY_TEXELS (1u << 0)   // linear images are read as texels
#define DISPLAY_DENOISED (1u << 1) // the value comes from the denoiser
#define DISPLAY_LARGER (1u << 2)   // scaling reduces no axis: interpolates between two pixels
#define DISPLAY_NEAREST                                                                            \
    (1u << 3)                  // as DISPLAY_LARGER, but without interpolation: pixels appear as
                               // squares
#define DISPLAY_TWO (1u << 4)  // there are two sides
#define DISPLAY_KEPT (1u << 5) // shows the kept image where the film has no samples
#define DISPLAY_KEEP (1u << 6) // makes a linear image that is kept

#define DISPLAY_WORKGROUP 64u
#define DISPLAY_SIDE_MAX 32768u // pixels of a displayed image: far below the limit of place_of()
// Maximum number of the film's pixels, along an axis, that make one displayed pixel.
#define DISPLAY_TAPS_MAX 128u
#define DISPLAY_RANGE_ITEMS 16u // pixels that one thread reads

#define DISPLAY_TONE_NONE 0u
#define DISPLAY_TONE_REINHARD 1u
#define DISPLAY_TONE_ACES 2u
#define DISPLAY_TONE_AGX 3u

struct gpu_display_push {
    uint first_item; // first item of this dispatch
    uint items;      // number of all items
    // For display_read: the first pixel of the chunk, the number of planned samples, and the sizes
    // of the tables in SOURCES.
    uint first_pixel;
    uint planned_samples;
    uint dropped, instances, meshes;
    // For display_scale: the pixels that FROM has.
    uint from_first, from_count;
    uint from_width;
    uint to_width;
    uint first_row; // first row of TO
    uint is_added;  // 1: adds to the present contents
    // The members for display_show follow.
    uint width, height; // size of the whole output
    uint left, top;     // position of the image in the output
    uint picture_width, picture_height;
    uint split; // column of the image at which the second side begins
    float gain;
    float range_low;
    float range_scale; // 1 / (high - low), in logarithms if false colours are logarithmic
};
SHARED_STATIC_ASSERT_SIZE(gpu_display_push, 92);

// The pixels of an image that contribute to one pixel of its scaled image, along one axis, and
// their weights. The pixels between the first (head) and the last one (tail) have equal weights;
// the sum of all weights is 1.
struct gpu_display_taps {
    uint first;
    uint count_step; // number of taps in bits 0-7; distance between two taps in the bits above
    float head, tail;
};
SHARED_STATIC_ASSERT_SIZE(gpu_display_taps, 16);

// The histogram of values for false colours, by the high bits of floats; a factor of 2 has 2^4
// bins.
#define DISPLAY_BIN_SHIFT 19
#define DISPLAY_BINS 4096
struct gpu_display_range {
    uint least; // bits of non-negative floats, which have the same order as the floats
    uint greatest;
    uint count;
    uint align_range;
    uint bin[DISPLAY_BINS];
};

#endif
