// Computes the expected output of a viewer on the host in double precision.
#ifndef LAMPYRIS_TESTS_DISPLAY_REFERENCE_H
#define LAMPYRIS_TESTS_DISPLAY_REFERENCE_H

#include "image/image.h"
#include "render/show/display.h"
#include "render_fixture.h"

// A pixel as in shared/display.h: a value multiplied by its weight, and the weight.
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

// The expected values of each side, with the size on the screen.
struct expected {
    struct values sides[2];
};

// Draws a picture and compares each pixel: codes may differ by at most one of 255. With
// LAMPYRIS_PICTURES=FOLDER in the environment, writes the picture there for inspection.
void check_picture(const char *name, struct display *display, const struct display_call *call,
                   const struct expected *expected, struct arena *arena);
// Returns the pixels drawn last.
uint8_t (*display_pixels(struct display *display, const struct display_call *call,
                         struct arena *arena))[4];

// A film, and a display for it.
struct stage {
    struct gpu gpu; // opened before the stage
    struct scene scene;
    struct renderer renderer;
    struct display display;
    struct arena arena;
    struct film_image film; // the film of the last stage_render()
};

// `film` has the form of "film" in scene files.
bool stage_open(struct stage *s, const char *path, const char *film, uint32_t aovs,
                struct err *err);
bool stage_render(struct stage *s, uint64_t samples, struct err *err);
// Checks that no object is left, and that the validation layers were silent.
void stage_close(struct stage *s);
// Returns the call that shows the whole film on one side, without scaling.
struct display_call call_of_film(const struct stage *s, uint32_t shown);

#endif
