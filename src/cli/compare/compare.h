// lampyris compare: what its parts share.
#ifndef LAMPYRIS_CLI_COMPARE_COMPARE_H
#define LAMPYRIS_CLI_COMPARE_COMPARE_H

#include "cli/options.h"
#include "job/reference.h"
#include "metrics/metrics.h"
#include "metrics/perceptual.h"

// One picture against the reference. Of mse, rmse, relmse and local relmse the reference's own
// noise is subtracted where --reference-variance says so; rmse has the sign of mse then.
struct compared {
    const char *path;
    double value[METRIC_TOTAL];
    double measured[METRIC_TOTAL]; // the same with the reference's noise
    struct error_intervals error;  // 95 %, less the reference's noise, too
    uint32_t max_pixel[2];
    bool is_equal; // bit for bit
    bool passed;
    const char *map; // the difference picture's file; NULL: none
};

struct comparison {
    const struct options *options;
    struct arena arena; // owns the reference
    const char *reference_path;
    struct reference reference;
    bool is_corrected; // of the reference's noise
    struct flip_exposures exposures;
    struct compared pictures[OPTIONS_ARGUMENTS_MAX]; // in the order they were given
    uint32_t count;
    bool passed;
};

// compare_map.c: writes picture->map. `flip` holds the numbers of the map where that is a FLIP, one
// a pixel. Memory is taken from `arena`.
bool compare_write_map(const struct comparison *c, const struct compared *picture,
                       const struct picture_pair *pair, const float *flip, struct arena *arena,
                       struct err *err);
// "|x - r| / (|r| + 0.01)": what a map's numbers are.
const char *compare_map_words(enum error_map map);

// compare_report.c
void compare_print_text(const struct comparison *c);
int compare_print_json(const struct comparison *c);

#endif
