// Where the error of a film comes from, as --error-by asks: its classes of light, and the brightest
// contributions, each with the sample whose path brought it.
#ifndef LAMPYRIS_JOB_ERROR_SOURCES_H
#define LAMPYRIS_JOB_ERROR_SOURCES_H

#include "job/film_error.h"
#include "metrics/error_by.h"

// The ways in which light is divided into classes.
enum error_kind { ERROR_BY_PART, ERROR_BY_BOUNCE, ERROR_BY_EMITTER, ERROR_KIND_COUNT };
extern const char *const error_kind_names[ERROR_KIND_COUNT]; // as in the option
// "direct", "7 and more", "suns" ...
const char *error_class_name(enum error_kind kind, uint32_t class);
// Returns the AOV_BY_* bit of a kind.
uint32_t error_kind_aov(enum error_kind kind);

#define BRIGHT_PATHS_MAX 10

// The brightest contribution to a pixel.
struct bright_path {
    uint32_t x, y, sample;
    uint32_t scattering_events;
    uint32_t emitter;   // number of the emitter's class in ERROR_BY_EMITTER
    bool is_connection; // found by a shadow ray; else by a ray that met the emitter
    float radiance[3];  // as it was added to the sample's
    // How far it is above the pixel's mean, against the brightness around the pixel as the error
    // has it: the root of the mean over channels of (x - M)^2 / (L^2 + 1e-2), x above M.
    double excess;
    double share; // fraction of the picture's error that is in this pixel; NAN if the picture has
                  // no error
};

struct error_sources {
    uint32_t kinds;     // AOV_BY_*; 0: nobody asked
    const char *reason; // why the shares are not known; NULL where they are
    bool has_intervals; // else pixels depend on each other, and the shares have none
    struct error_by by[ERROR_KIND_COUNT]; // those of `kinds`
    // The brightest contributions of pixels, those that have most excess: in that order, and of
    // equal ones in the order of pixels. None where the shares are not known.
    struct bright_path brightest[BRIGHT_PATHS_MAX];
    uint32_t brightest_count;
};

// Finds the sources of the error of a film of a renderer with these AOVs, whose error is estimated
// by these params; `samples`, `confidence` and `unseen` do not matter. Does nothing without
// --error-by. Returns false only when out of memory. Any thread may call it.
bool error_sources_find(const struct film_image *film, uint32_t aovs,
                        const struct film_error_params *params, struct error_sources *out,
                        struct err *err);

#endif
