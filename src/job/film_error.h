// Estimates the error of a film from its half-buffers, for render, converge and the viewer.
#ifndef LAMPYRIS_JOB_FILM_ERROR_H
#define LAMPYRIS_JOB_FILM_ERROR_H

#include "metrics/metrics.h"
#include "render/render.h"

struct film_error_params {
    uint64_t samples;   // a pixel; the mean where pixels have different counts
    double confidence;  // 0: the usual
    bool shares_depths; // all pixels' paths do, so that their errors depend on each other
    // The halves are contiguous: they overestimate the error, and are not usable before they have
    // as many samples as planned.
    bool is_contiguous;
    uint64_t planned;
    struct unseen_light unseen;
};

// Returns what the renderer's settings decide of the estimate; nothing is unseen.
struct film_error_params film_error_of(const struct renderer *renderer, uint64_t samples);
// Prepares the parameters likewise, with the unseen light of the scene; the data lives in `arena`.
bool film_error_prepare(struct renderer *renderer, uint64_t samples, struct arena *arena,
                        struct film_error_params *out, struct err *err);

// Estimates as metrics_half_error() does, and removes unreliable results: local_relmse and mse are
// NAN if there is no interval, unless pixels share their paths' depths; then there is neither
// interval nor bound, and the estimate must be reported as one. Contiguous halves give only a
// bound.
bool film_error(const struct film_image *film, const struct film_error_params *params,
                struct half_error *out, struct err *err);

// Returns whether most of a film's light is in pixels so dark that the constant in local relMSE
// leaves less than a thirtieth of their relative error: it says little of such a picture.
bool film_error_is_blind(const struct film_image *film);

// Returns an unknown error, with the reason.
struct half_error film_error_none(const char *reason);

// Returns whether there is an estimate alone.
bool film_error_is_plain(const struct half_error *error);

// Writes "local relMSE 0.0082, 95 % interval 0.0077 to 0.0088", "local relMSE at most 0.28 (95 %)",
// "local relMSE about 0.01, without interval or bound" or "local relMSE not known".
#define FILM_ERROR_WORDS 96
void film_error_words(const struct half_error *error, char out[FILM_ERROR_WORDS]);

#endif
