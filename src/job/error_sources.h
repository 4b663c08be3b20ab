// Finds the sources of a film's error, for --error-by: the classes of light, and the brightest
// contributions, each with the sample whose path made it.
#ifndef LAMPYRIS_JOB_ERROR_SOURCES_H
#define LAMPYRIS_JOB_ERROR_SOURCES_H

#include "job/film_error.h"
#include "metrics/error_by.h"

// The ways to divide light into classes.
enum error_kind { ERROR_BY_PART, ERROR_BY_BOUNCE, ERROR_BY_EMITTER, ERROR_KIND_COUNT };
extern const char *const error_kind_names[ERROR_KIND_COUNT]; // the values of --error-by
// Returns the name of a class: "direct", "7 and more", "suns" ...
const char *error_class_name(enum error_kind kind, uint32_t class);
// Returns the AOV_BY_* bit of a kind.
uint32_t error_kind_aov(enum error_kind kind);

#define BRIGHT_PATHS_MAX 10

// The brightest contribution to a pixel.
struct bright_path {
    uint32_t x, y, sample;
    uint32_t scattering_events;
    uint32_t emitter;   // number of the emitter's class in ERROR_BY_EMITTER
    bool is_connection; // found by a shadow ray; otherwise by a ray that hit the emitter
    float radiance[3];  // the contribution as it was added to the radiance of its sample
    // The excess of the contribution x over the pixel's mean M, relative to the brightness L around
    // the pixel. It is the square root of the mean over channels of (x - M)^2 / (L^2 + 1e-2), to
    // which only channels with x above M contribute.
    double excess;
    double share; // fraction of the picture's error that is in this pixel; NAN if the picture has
                  // no error
};

struct error_sources {
    uint32_t kinds;     // AOV_BY_*; 0: no sources were requested
    const char *reason; // why the shares are not known; NULL if they are known
    bool has_intervals; // false if the errors of pixels depend on each other; the shares then have
                        // no intervals
    struct error_by by[ERROR_KIND_COUNT]; // only the entries of `kinds` are valid
    // The brightest contributions, in descending order of `excess`; equal ones are in the order of
    // pixels. Empty if the shares are not known.
    struct bright_path brightest[BRIGHT_PATHS_MAX];
    uint32_t brightest_count;
};

// Finds the sources of the error of a film whose renderer has these AOVs. `params` are the
// parameters with which its error is estimated; `samples`, `confidence` and `unseen` are not used.
// Does nothing without --error-by. Returns false only when out of memory. Any thread may call it.
bool error_sources_find(const struct film_image *film, uint32_t aovs,
                        const struct film_error_params *params, struct error_sources *out,
                        struct err *err);

#endif
