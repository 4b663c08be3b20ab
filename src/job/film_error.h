// How good a film is, as its half-buffers tell: the one judge of render, converge and the viewer.
#ifndef LAMPYRIS_JOB_FILM_ERROR_H
#define LAMPYRIS_JOB_FILM_ERROR_H

#include "metrics/metrics.h"
#include "render/render.h"

struct film_error_params {
    uint64_t samples;   // a pixel; the mean where pixels have different counts
    double confidence;  // 0: the usual
    bool shares_depths; // all pixels' paths do, so that their errors depend on each other
    // Of contiguous halves, which overstate the error, and say nothing before they have as many
    // samples as are planned.
    bool is_contiguous;
    uint64_t planned;
    struct unseen_light unseen;
};

// Returns what the renderer's settings decide of the estimate; nothing is unseen.
struct film_error_params film_error_of(const struct renderer *renderer, uint64_t samples);
// Prepares the same with the unseen light of the scene; what it points to is in `arena`.
bool film_error_prepare(struct renderer *renderer, uint64_t samples, struct arena *arena,
                        struct film_error_params *out, struct err *err);

// Estimates as metrics_half_error() does. What cannot be relied upon is taken back: local_relmse
// and mse are NAN where there is no interval, but where pixels share their paths' depths; then
// there is neither interval nor bound, and the estimate is to be told as one. Contiguous halves
// tell a bound alone.
bool film_error(const struct film_image *film, const struct film_error_params *params,
                struct half_error *out, struct err *err);

// Returns whether most of a film's light is in pixels so dark that the constant in local relMSE
// leaves less than a thirtieth of their relative error: it says little of such a picture.
bool film_error_is_blind(const struct film_image *film);

// Nothing is known, for this reason.
struct half_error film_error_none(const char *reason);

// Returns whether there is an estimate alone.
bool film_error_is_plain(const struct half_error *error);

// "local relMSE 0.0082, 95 % interval 0.0077 to 0.0088", "local relMSE at most 0.28 (95 %)", "local
// relMSE about 0.01, without interval or bound" or "local relMSE not known".
#define FILM_ERROR_WORDS 96
void film_error_words(const struct half_error *error, char out[FILM_ERROR_WORDS]);

#endif
