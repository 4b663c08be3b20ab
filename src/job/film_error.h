// Estimates the error of a film from its half-buffers, for render, converge and the viewer.
#ifndef LAMPYRIS_JOB_FILM_ERROR_H
#define LAMPYRIS_JOB_FILM_ERROR_H

#include "metrics/metrics.h"
#include "render/render.h"

struct film_error_params {
    uint64_t samples;   // samples per pixel; their mean if pixels have different numbers
    double confidence;  // 0: the default
    bool shares_depths; // in a sample, the paths of all pixels have the same depth, so that their
                        // errors are not independent
    // The halves are contiguous: they overestimate the error, and are usable only after all planned
    // samples.
    bool is_contiguous;
    uint64_t planned;
    bool lacks_light; // some light is missing, because only some rows have started light paths
    struct unseen_light unseen;
};

// Returns the parameters that follow from the renderer's settings, without unseen light.
struct film_error_params film_error_of(const struct renderer *renderer, uint64_t samples);
// Does the same as film_error_of(), and adds the unseen light of the scene. `arena` owns its data.
bool film_error_prepare(struct renderer *renderer, uint64_t samples, struct arena *arena,
                        struct film_error_params *out, struct err *err);

// Estimates the error of the film's rows as metrics_half_error() does, and removes unreliable
// results. If there is no interval, local_relmse and mse are NAN; contiguous halves never have an
// interval, but only a bound. If pixels share the depths of their paths, there is neither an
// interval nor a bound; local_relmse and mse are then kept, and must be reported as estimates
// without an interval.
bool film_error(const struct film_image *film, const struct film_error_params *params,
                struct half_error *out, struct err *err);

// Returns the rendered rows of a film as a film of their own, with half-buffers and classes.
struct film_image film_rows_alone(const struct film_image *film);

// Returns whether the local relMSE is not meaningful for a film: most of its light is in pixels so
// dark that the constant in the local relMSE reduces their relative error to less than a thirtieth.
bool film_error_is_blind(const struct film_image *film);

// Returns the value for an unknown error, with the reason why the error is unknown.
struct half_error film_error_none(const char *reason);

// Returns whether there is an estimate without an interval or bound.
bool film_error_is_plain(const struct half_error *error);

// Writes one of these texts: "local relMSE 0.0082, 95 % interval 0.0077 to 0.0088", "local relMSE
// at most 0.28 (95 %)", "local relMSE about 0.01, without interval or bound" or "local relMSE not
// known".
#define FILM_ERROR_WORDS 96
void film_error_words(const struct half_error *error, char out[FILM_ERROR_WORDS]);

#endif
