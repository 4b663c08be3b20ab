// What the kernels of the viewer's picture and of its denoiser share with C.
#ifndef LAMPYRIS_SHARED_DISPLAY_H
#define LAMPYRIS_SHARED_DISPLAY_H

// What a picture shows: the radiance, or one of the pictures besides it (AOV_*).
#define SHOWN_RADIANCE 0u
#define SHOWN_ALBEDO 1u
#define SHOWN_NORMAL 2u // its components from [-1, 1]
#define SHOWN_DEPTH 3u  // false colours over a range
#define SHOWN_OBJECTS 4u // a colour for each
#define SHOWN_MATERIALS 5u
#define SHOWN_SAMPLES 6u
#define SHOWN_VARIANCE 7u
#define SHOWN_STEPS 8u // of the camera ray's traversal: the heat map
#define SHOWN_EMISSION 9u
#define SHOWN_DIRECT 10u
#define SHOWN_INDIRECT 11u
#define SHOWN_COUNT 12u

#endif
