// Declarations that the files of `lampyris compare` share.
#ifndef LAMPYRIS_CLI_COMPARE_COMPARE_H
#define LAMPYRIS_CLI_COMPARE_COMPARE_H

#include "cli/options.h"
#include "job/reference.h"
#include "metrics/metrics.h"
#include "metrics/perceptual.h"
#include "report/html_viewer.h"

// The comparison of an image with the reference. With --reference-variance, the noise of the
// reference is subtracted from mse, rmse, relmse and local relmse; rmse then has the sign of mse.
struct compared {
    const char *path;
    double value[METRIC_TOTAL];
    double measured[METRIC_TOTAL]; // the metrics before the noise of the reference is subtracted
    struct error_intervals error;  // 95 % intervals, after subtraction
    uint32_t max_pixel[2];
    bool is_equal; // equal to the reference bit for bit
    bool passed;
    const char *map; // path of the difference image; NULL: none
};

struct comparison {
    const struct options *options;
    struct arena arena; // owns the reference
    const char *reference_path;
    struct reference reference;
    bool is_corrected; // the noise of the reference has been subtracted
    struct flip_exposures exposures;
    struct compared pictures[OPTIONS_ARGUMENTS_MAX]; // in the order of the command line
    uint32_t count;
    bool passed;
    struct html_page page; // the page of --report, and the viewer in it
    struct html_viewer viewer;
};

// compare_map.c: writes the difference image picture->map. `flip` has the values of a FLIP map, one
// per pixel. Temporary memory is taken from `arena`.
bool compare_write_map(const struct comparison *c, const struct compared *picture,
                       const struct picture_pair *pair, const float *flip, struct arena *arena,
                       struct err *err);
// Returns the definition of a map's values, such as "|x - r| / (|r| + 0.01)".
const char *compare_map_words(enum error_map map);

// compare_html.c: the page of --report. It is begun when the reference has been read, receives each
// image with its maps of FLIP and HDR-FLIP, and is finally written, or freed after a failure.
bool compare_html_begin(struct comparison *c, struct err *err);
bool compare_html_add(struct comparison *c, const struct compared *picture,
                      const struct image *image, float *const flip[2], struct err *err);
bool compare_html_end(struct comparison *c, bool ok, struct err *err);

// compare_report.c: returns the 95 % interval of a metric, or NULL if the metric has none.
const struct interval *compare_interval(const struct compared *picture, enum compare_metric metric);
// Returns whether no other image is better. It is false if there is only one image.
bool compare_is_best(const struct comparison *c, uint32_t picture, enum compare_metric metric);
void compare_print_text(const struct comparison *c);
int compare_print_json(const struct comparison *c);

#endif
