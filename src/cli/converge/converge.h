// A run of `lampyris converge`. It measures curves of the error as a function of samples and time,
// one for each scene and each variant of the options.
#ifndef LAMPYRIS_CLI_CONVERGE_CONVERGE_H
#define LAMPYRIS_CLI_CONVERGE_CONVERGE_H

#include "cli/options.h"
#include "cli/variants.h"
#include "job/job.h"
#include "metrics/curve.h"
#include "metrics/metrics.h"

enum converge_metric {
    CONVERGE_LOCAL_RELMSE, // slopes, efficiencies and targets refer to this metric
    CONVERGE_RELMSE,
    CONVERGE_MSE,
    CONVERGE_SMAPE,
    CONVERGE_PSNR,
    CONVERGE_SSIM, // for large images, SSIM and FLIP are measured in the first replicate only
    CONVERGE_FLIP,
    CONVERGE_METRICS
};
extern const char *const converge_metric_names[CONVERGE_METRICS];

// The measurement of a replicate at a point of its curve.
struct converge_sample {
    uint64_t spp;
    double seconds;                  // rendering time since the replicate's first sample
    double metric[CONVERGE_METRICS]; // NAN if not measured
    double at_most; // upper bound of the local relMSE if there is no reference; NAN if not known
};

// The measurements of all replicates at a point of a curve.
struct converge_point {
    struct interval spp, seconds, metric[CONVERGE_METRICS];
    double at_most; // geometric mean of the replicates' bounds; NAN if a replicate has none
    // Number of replicates whose local relMSE is not known; if it is not 0, the error is not known.
    uint32_t unknown;
};

// The image with which the images of a scene are compared. If there is none, errors are estimated
// from the half-buffers, which do not show bias.
struct converge_reference {
    const char *name; // path of the file, or "auto"; NULL: there is no reference
    uint64_t spp;     // samples per pixel of an "auto" reference
    struct reference picture;
};

// The samples and the time at which a curve reaches a local relMSE: see converge_conclude.c.
#define CONVERGE_TARGETS 3 // the local relMSEs 1e-2, 1e-3 and 1e-4
extern const double converge_targets[CONVERGE_TARGETS];
struct converge_target {
    struct interval seconds, spp; // the time includes start-up; NAN if not known
    bool extrapolated;            // the target is before the first point or beyond the last one
};

struct converge_curve {
    struct variant variant;
    struct scene scene_data;
    struct job job;
    struct converge_sample *samples; // index: replicate * number of points + point
    float (**pictures)[3];           // image of each replicate at the last point; NULL: not kept
    double start_seconds;            // time of loading, building the BVH, uploading and compiling
    // Sources of the error of each replicate at the last point; NULL without --error-by.
    struct error_sources *sources;
    struct job_speed speed; // rendering speed, from which numbers of samples are planned

    // The following members are computed from the samples.
    struct converge_point *points;
    // Exponent of the error as a function of samples, or of time with --times.
    struct interval slope;
    struct interval efficiency;     // 1 / (local relMSE * seconds) at the last point
    struct interval efficiency_mse; // 1 / (MSE * seconds) at the last point
    struct interval bias;    // the part of relMSE that does not decrease; NAN without a reference
    struct interval *ratios; // efficiency divided by that of each curve of the same scene
    struct converge_target targets[CONVERGE_TARGETS];
    struct error_sources pooled; // the sources of all replicates combined
    uint64_t image_hash;         // hash of the first replicate's image
    const char *command;         // the command that renders this image
};

struct converge {
    const struct options *options;
    struct arena arena;
    struct gpu gpu;
    struct progress progress;      // the progress of the options, to which this run adds a phase
    const char *phase;             // name of the phase; NULL: that of the renderer
    struct converge_curve *curves; // the curves of a scene are adjacent
    uint32_t curve_count;
    struct converge_reference *references; // one per scene
    uint64_t *spp;         // samples per pixel at each point, doubling; NULL with --times
    const double *seconds; // time of each point, ascending; NULL without --times
    uint32_t point_count, replicate_count;
    uint32_t replicates_done; // less than the requested number if a signal ended the run
    bool stopped;
    struct err failure; // an error of the device after the first replicate
};

static inline struct converge_sample *converge_at(const struct converge *c,
                                                  const struct converge_curve *curve,
                                                  uint32_t replicate, uint32_t point)
{
    return &curve->samples[(size_t)replicate * c->point_count + point];
}

// Returns the number of curves of the same scene; *first is the index of the first one.
uint32_t converge_siblings(const struct converge *c, const struct converge_curve *curve,
                           uint32_t *first);

// --- converge_run.c ---
bool converge_prepare(struct converge *c, struct err *err); // creates curves, scenes and renderers
bool converge_open(struct converge *c, struct converge_curve *curve, struct err *err);
// Calls job_advance(), unless the run should stop.
bool converge_advance(struct converge *c, struct job *job, const struct job_step *step,
                      struct err *err);
// Measures one replicate after the other. Within a replicate the curves of a scene alternate, so
// that a change of the machine's speed affects all of them.
bool converge_measure(struct converge *c, struct err *err);
void converge_finish(struct converge *c);

// --- converge_measure.c ---
// Measures the current image of the curve's job.
bool converge_measure_point(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                            uint32_t point, struct err *err);
// Returns whether images are so small that SSIM and FLIP are measured for every replicate.
bool converge_is_small(const struct converge_curve *curve);

// --- converge_reference.c ---
bool converge_reference(struct converge *c, struct err *err);

// --- converge_conclude.c ---
bool converge_conclude(struct converge *c, struct err *err);
// Returns the text of the variant's options; "as given" if no option varies.
const char *converge_label(const struct converge_curve *curve);
// Returns the verdict of the JSON for a ratio of efficiencies: "faster", "slower" or "not told
// apart".
const char *converge_verdict(struct interval ratio);
bool converge_is_biased(const struct converge_curve *curve);
// Writes the sentences that explain the numbers, and returns how many there are.
#define CONVERGE_NOTES 6
#define CONVERGE_NOTE_SIZE 160
uint32_t converge_notes(const struct converge *c, char notes[][CONVERGE_NOTE_SIZE]);

// --- converge_error_by.c ---
// Splits the error of the current image of the curve's job by its sources. This and the next
// function do nothing without --error-by.
bool converge_split_error(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                          struct err *err);
bool converge_pool_sources(struct converge *c, struct converge_curve *curve, struct err *err);

// --- converge_command.c ---
// Makes the command that renders the curve's first image again. The run's arena owns it.
bool converge_command(struct converge *c, const struct converge_curve *curve, const char **out,
                      struct err *err);

// --- converge_print.c ---
void converge_print(const struct converge *c);

// --- converge_report.c ---
int converge_print_json(const struct converge *c);
// Writes results.csv, results.json, report.html and (with --images) the images into a folder, which
// is created if necessary.
bool converge_write(struct converge *c, const char *folder, struct err *err);
// Checks, when the scenes have been loaded and before anything is measured, that no file that
// converge_write() writes is an input.
bool converge_check_files(struct converge *c, const char *folder, struct err *err);

// --- converge_html.c ---
bool converge_write_html(struct converge *c, const char *folder, struct err *err);

// --- converge_plot.c ---
// Makes a gnuplot script that plots the local relMSE against samples or time; the caller frees it.
// *script is NULL if no error is known.
bool converge_plot(const struct converge *c, uint32_t scene, bool over_time, char **script,
                   struct err *err);

#endif
