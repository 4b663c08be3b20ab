// The expected output of a viewer, computed on the host in double precision.
#ifndef LAMPYRIS_TESTS_DISPLAY_REFERENCE_H
#define LAMPYRIS_TESTS_DISPLAY_REFERENCE_H

#include "image/image.h"
#include "render/show/display.h"
#include "render_fixture.h"

// A pixel as in shared/display.h: a value times its weight, and the weight.
struct value {
    double rgb[3], weight;
};

struct values {
    uint32_t width, height;
    struct value *pixels;
};

struct values values_new(uint32_t width, uint32_t height, struct arena *arena);
void set_value(struct value *v, const float rgb[3]);
// Returns the values of a film, one for each pixel.
struct values values_of(const struct film_image *film, uint32_t shown, struct arena *arena);
struct values values_scaled(const struct values *from, uint32_t width, uint32_t height,
                            bool nearest, struct arena *arena);

// The expected values of each side, at the size on the screen.
struct expected {
    struct values sides[2];
};

// Draws, and compares each pixel: at most one code of 255 apart. With LAMPYRIS_PICTURES=FOLDER in
// the environment it writes the picture there, to be looked at.
void check_picture(const char *name, struct display *display, const struct display_call *call,
                   const struct expected *expected, struct arena *arena);
// Returns the pixels drawn last.
uint8_t (*display_pixels(struct display *display, const struct display_call *call,
                         struct arena *arena))[4];

// A film and a display of it.
struct stage {
    struct gpu gpu; // opened before
    struct scene scene;
    struct renderer renderer;
    struct display display;
    struct arena arena;
    struct film_image film; // as stage_render left it
};

// film: as in scene files.
bool stage_open(struct stage *s, const char *path, const char *film, uint32_t aovs,
                struct err *err);
bool stage_render(struct stage *s, uint64_t samples, struct err *err);
// Checks that nothing is left over, and that the validation layers were silent.
void stage_close(struct stage *s);
// One side, of the whole film, one pixel for one.
struct display_call call_of_film(const struct stage *s, uint32_t shown);

#endif
