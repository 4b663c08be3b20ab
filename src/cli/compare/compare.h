// lampyris compare: declarations that its parts share.
#ifndef LAMPYRIS_CLI_COMPARE_COMPARE_H
#define LAMPYRIS_CLI_COMPARE_COMPARE_H

#include "cli/options.h"
#include "job/reference.h"
#include "metrics/metrics.h"
#include "metrics/perceptual.h"
#include "report/html_viewer.h"

// One image compared with the reference. With --reference-variance, the noise of the reference is
// subtracted from mse, rmse, relmse and local relmse; rmse then has the sign of mse.
struct compared {
    const char *path;
    double value[METRIC_TOTAL];
    double measured[METRIC_TOTAL]; // including the reference's noise
    struct error_intervals error;  // 95 % intervals, also without the reference's noise
    uint32_t max_pixel[2];
    bool is_equal; // bit for bit
    bool passed;
    const char *map; // file of the difference image; NULL: none
};

struct comparison {
    const struct options *options;
    struct arena arena; // owns the reference
    const char *reference_path;
    struct reference reference;
    bool is_corrected; // the reference's noise is subtracted
    struct flip_exposures exposures;
    struct compared pictures[OPTIONS_ARGUMENTS_MAX]; // in the order of the command line
    uint32_t count;
    bool passed;
    struct html_page page; // the page of --report; so is the viewer
    struct html_viewer viewer;
};

// compare_map.c: writes picture->map. `flip` holds the values of a FLIP map, one per pixel. Memory
// is taken from `arena`.
bool compare_write_map(const struct comparison *c, const struct compared *picture,
                       const struct picture_pair *pair, const float *flip, struct arena *arena,
                       struct err *err);
// Returns the definition of a map's values: "|x - r| / (|r| + 0.01)".
const char *compare_map_words(enum error_map map);

// compare_html.c: the page of --report. It begins once the reference is read, takes each picture
// with its maps of FLIP and HDR-FLIP, and is written, or after a failure released, at the end.
bool compare_html_begin(struct comparison *c, struct err *err);
bool compare_html_add(struct comparison *c, const struct compared *picture,
                      const struct image *image, float *const flip[2], struct err *err);
bool compare_html_end(struct comparison *c, bool ok, struct err *err);

// compare_report.c
// The 95 % interval of a metric that has one; else NULL.
const struct interval *compare_interval(const struct compared *picture, enum compare_metric metric);
// Returns whether no other picture is better; of a single one it is false.
bool compare_is_best(const struct comparison *c, uint32_t picture, enum compare_metric metric);
void compare_print_text(const struct comparison *c);
int compare_print_json(const struct comparison *c);

#endif
