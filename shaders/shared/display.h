// Records and constants that the kernels of the viewer's image and of its denoiser share with C.
#ifndef LAMPYRIS_SHARED_DISPLAY_H
#define LAMPYRIS_SHARED_DISPLAY_H

#include "aov.h"
#include "types.h"

// An image shows the radiance, or one of the other layers (AOV_*).
#define SHOWN_RADIANCE 0u
#define SHOWN_ALBEDO 1u
#define SHOWN_NORMAL 2u  // its components from [-1, 1]
#define SHOWN_DEPTH 3u   // false colours over a range
#define SHOWN_OBJECTS 4u // a colour for each
#define SHOWN_MATERIALS 5u
#define SHOWN_SAMPLES 6u
#define SHOWN_VARIANCE 7u
#define SHOWN_STEPS 8u // steps of the camera ray's traversal: the heat map
#define SHOWN_EMISSION 9u
#define SHOWN_DIRECT 10u
#define SHOWN_INDIRECT 11u
#define SHOWN_COUNT 12u
// Ways to convert their values to colours.
#define SHOWN_BIT(shown) (1u << (shown))
#define SHOWN_TONED                                                                                \
    (SHOWN_BIT(SHOWN_RADIANCE) | SHOWN_BIT(SHOWN_EMISSION) | SHOWN_BIT(SHOWN_DIRECT) |             \
     SHOWN_BIT(SHOWN_INDIRECT))
#define SHOWN_FALSE                                                                                \
    (SHOWN_BIT(SHOWN_DEPTH) | SHOWN_BIT(SHOWN_SAMPLES) | SHOWN_BIT(SHOWN_VARIANCE) |               \
     SHOWN_BIT(SHOWN_STEPS))
// Logarithmic false colours: for values up to the horizon, or over many powers of ten.
#define SHOWN_LOGARITHMIC (SHOWN_BIT(SHOWN_DEPTH) | SHOWN_BIT(SHOWN_VARIANCE))

// Storage buffers of the kernels that make a picture to look at. Linear pictures are vec4 a pixel:
// a value times its weight, and the weight, 0 where nothing is known. False colours: the value
// times the share that has one, that share, 0.
#define DISPLAY_BINDING_FILM 0     // a chunk of it
#define DISPLAY_BINDING_DENOISED 1 // vec4 a pixel of the film
#define DISPLAY_BINDING_SOURCES 2  // what the scene's objects are, by primitive: see display.c
#define DISPLAY_BINDING_FROM 3     // a linear picture
#define DISPLAY_BINDING_TO 4       // another
#define DISPLAY_BINDING_LEFT 5     // linear pictures of the size that is shown
#define DISPLAY_BINDING_RIGHT 6
#define DISPLAY_BINDING_KEPT_LEFT 7
#define DISPLAY_BINDING_KEPT_RIGHT 8
#define DISPLAY_BINDING_PALETTE 9 // vec4 a colour, linear
#define DISPLAY_BINDING_TAPS 10   // struct gpu_display_taps, of columns, then of rows
#define DISPLAY_BINDING_PIXELS 11 // RGBA8
#define DISPLAY_BINDING_RANGE 12  // struct gpu_display_range
#define DISPLAY_BINDING_COUNT 13

// Specialization constants.
#define DISPLAY_CONSTANT_WORKGROUP 0
#define DISPLAY_CONSTANT_SHOWN 1
#define DISPLAY_CONSTANT_FLAGS 2 // DISPLAY_*
#define DISPLAY_CONSTANT_AOVS 3  // the film's
#define DISPLAY_CONSTANT_HALVES 4
#define DISPLAY_CONSTANT_TONE 5 // enum tone_curve
#define DISPLAY_CONSTANT_COUNT 6

#define DISPLAY_TEXELS (1u << 0)   // linear pictures are read as texels
#define DISPLAY_DENOISED (1u << 1) // the value is the denoiser's
#define DISPLAY_LARGER (1u << 2)   // along no side smaller: between two pixels
#define DISPLAY_NEAREST (1u << 3)  // the same, pixels as squares
#define DISPLAY_TWO (1u << 4)      // two sides
#define DISPLAY_KEPT (1u << 5)     // what was kept, where the film has nothing
#define DISPLAY_KEEP (1u << 6)     // makes a linear picture to be kept

#define DISPLAY_WORKGROUP 64u
#define DISPLAY_SIDE_MAX 32768u // pixels of a shown picture: far fewer than place_of() can
#define DISPLAY_TAPS_MAX 128u   // pixels of a larger film that one is made of, along a side
#define DISPLAY_RANGE_ITEMS 16u // pixels that one thread looks at

#define DISPLAY_TONE_NONE 0u
#define DISPLAY_TONE_REINHARD 1u
#define DISPLAY_TONE_ACES 2u
#define DISPLAY_TONE_AGX 3u

struct gpu_display_push {
    uint first_item; // first item of this dispatch
    uint items;      // in all
    // display_read: of the chunk, of the film; what renderer's frame says; what SOURCES has
    uint first_pixel;
    uint planned_samples;
    uint dropped, instances, meshes;
    // display_scale: pixels of FROM that are there
    uint from_first, from_count;
    uint from_width;
    uint to_width;
    uint first_row; // first row of TO
    uint is_added;  // to what is there
    // display_show
    uint width, height; // size of all
    uint left, top;     // place of the picture in it
    uint picture_width, picture_height;
    uint split; // the picture's column where the second side begins
    float gain;
    float range_low;
    float range_scale; // 1 / (high - low), of logarithms where false colours go by them
};
SHARED_STATIC_ASSERT_SIZE(gpu_display_push, 92);

// Taps of one pixel along one side of an image: the pixels of another image that it is made of, and
// the weight of each. The weight that head and tail leave of 1 is shared evenly by those between
// them.
struct gpu_display_taps {
    uint first;
    uint count_step; // how many, in bits 0-7; from one to the next
    float head, tail;
};
SHARED_STATIC_ASSERT_SIZE(gpu_display_taps, 16);

// The histogram of the values for false colours, by the first bits of floats: an octave has 2^4
// bins.
#define DISPLAY_BIN_SHIFT 19
#define DISPLAY_BINS 4096
struct gpu_display_range {
    uint least; // bits of floats, which have the order of the floats; what is not negative
    uint greatest;
    uint count;
    uint align_range;
    uint bin[DISPLAY_BINS];
};

#endif
