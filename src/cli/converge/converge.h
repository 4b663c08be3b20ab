// A run of `lampyris converge`: curves of error against samples and time, one for each scene and
// each variant.
#ifndef LAMPYRIS_CLI_CONVERGE_CONVERGE_H
#define LAMPYRIS_CLI_CONVERGE_CONVERGE_H

#include "cli/options.h"
#include "cli/variants.h"
#include "job/job.h"
#include "metrics/curve.h"
#include "metrics/metrics.h"

enum converge_metric {
    CONVERGE_LOCAL_RELMSE, // used for slopes, efficiencies and targets
    CONVERGE_RELMSE,
    CONVERGE_MSE,
    CONVERGE_SMAPE,
    CONVERGE_PSNR,
    CONVERGE_SSIM, // SSIM and FLIP of large images are measured in the first replicate only
    CONVERGE_FLIP,
    CONVERGE_METRICS
};
extern const char *const converge_metric_names[CONVERGE_METRICS];

// The state of a replicate at one point.
struct converge_sample {
    uint64_t spp;
    double seconds;                  // rendering time since its first sample
    double metric[CONVERGE_METRICS]; // NAN where not measured
    double at_most;                  // without a reference: an upper bound of the local relMSE, or
                                     // NAN
};

// The state of all replicates at one point.
struct converge_point {
    struct interval spp, seconds, metric[CONVERGE_METRICS];
    double at_most;   // geometric mean of the replicates' bounds; NAN if one has none
    uint32_t unknown; // replicates whose local relMSE is not known: then no error is known
};

// The image with which others are compared. Without one, errors are estimated from the
// half-buffers, which are blind to bias.
struct converge_reference {
    const char *name; // file, or "auto"; NULL: none
    uint64_t spp;     // for "auto"
    struct reference picture;
};

// When a curve reaches a local relMSE: see converge_conclude.c.
#define CONVERGE_TARGETS 3 // 1e-2, 1e-3, 1e-4
extern const double converge_targets[CONVERGE_TARGETS];
struct converge_target {
    struct interval seconds, spp; // including the start-up time; NAN if not known
    bool extrapolated;            // before the first point or beyond the last
};

struct converge_curve {
    struct variant variant;
    struct scene scene_data;
    struct job job;
    struct converge_sample *samples; // replicate * points + point
    float (**pictures)[3];           // images at the last point, one per replicate; NULL: not kept
    double start_seconds;            // load, BVH, upload and compile
    struct error_sources *sources;   // at the last point, one per replicate; NULL without
                                     // --error-by
    struct job_speed speed;          // from which a number of samples is planned

    // These are computed from the samples.
    struct converge_point *points;
    struct interval slope;          // slope of log error over log samples, or over log seconds with
                                    // --times
    struct interval efficiency;     // 1 / (local relMSE * s) at the end
    struct interval efficiency_mse; // 1 / (MSE * s)
    struct interval bias;           // the part of relMSE that remains; NAN without a reference
    struct interval *ratios;        // ratios of efficiencies to those of each curve of the scene
    struct converge_target targets[CONVERGE_TARGETS];
    struct error_sources pooled; // the sources of all replicates combined
    uint64_t image_hash;         // hash of the first replicate's image
    const char *command;         // the command that renders that image
};

struct converge {
    const struct options *options;
    struct arena arena;
    struct gpu gpu;
    struct progress progress;      // that of the options, with a phase of this run
    const char *phase;             // NULL: the renderer's own phase
    struct converge_curve *curves; // those of a scene are adjacent
    uint32_t curve_count;
    struct converge_reference *references; // one per scene
    uint64_t *spp;                         // for each point, doubling; NULL with --times
    const double *seconds;                 // for each point, ascending; NULL without --times
    uint32_t point_count, replicate_count;
    uint32_t replicates_done; // fewer when a signal stopped it
    bool stopped;
    struct err failure; // an error of the device, after the first replicate
};

static inline struct converge_sample *converge_at(const struct converge *c,
                                                  const struct converge_curve *curve,
                                                  uint32_t replicate, uint32_t point)
{
    return &curve->samples[(size_t)replicate * c->point_count + point];
}

// Returns the number of curves of its scene, beginning with *first.
uint32_t converge_siblings(const struct converge *c, const struct converge_curve *curve,
                           uint32_t *first);

// --- converge_run.c ---
bool converge_prepare(struct converge *c, struct err *err); // curves, scenes, renderers
bool converge_open(struct converge *c, struct converge_curve *curve, struct err *err);
// Calls job_advance(), unless the run is to stop.
bool converge_advance(struct converge *c, struct job *job, const struct job_step *step,
                      struct err *err);
// Measures replicate by replicate, alternating between the curves of a scene, so that a change of
// the machine's speed affects all of them.
bool converge_measure(struct converge *c, struct err *err);
void converge_finish(struct converge *c);

// --- converge_measure.c ---
// Measures the current image of the curve's job.
bool converge_measure_point(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                            uint32_t point, struct err *err);
// Returns whether SSIM and FLIP are measured for every replicate.
bool converge_is_small(const struct converge_curve *curve);

// --- converge_reference.c ---
bool converge_reference(struct converge *c, struct err *err);

// --- converge_conclude.c ---
bool converge_conclude(struct converge *c, struct err *err);
// "as given" if nothing is varied.
const char *converge_label(const struct converge_curve *curve);
// Returns "faster", "slower" or "not told apart" for a ratio of efficiencies.
const char *converge_verdict(struct interval ratio);
bool converge_is_biased(const struct converge_curve *curve);
// Writes the sentences that accompany the numbers; returns how many.
#define CONVERGE_NOTES 6
#define CONVERGE_NOTE_SIZE 160
uint32_t converge_notes(const struct converge *c, char notes[][CONVERGE_NOTE_SIZE]);

// --- converge_error_by.c ---
// Splits the error of the current image of the curve's job. Does nothing without --error-by, and
// neither does the next function.
bool converge_split_error(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                          struct err *err);
bool converge_pool_sources(struct converge *c, struct converge_curve *curve, struct err *err);

// --- converge_command.c ---
// Makes the command that renders the curve's first image again; it lives in the run's arena.
bool converge_command(struct converge *c, const struct converge_curve *curve, const char **out,
                      struct err *err);

// --- converge_print.c ---
void converge_print(const struct converge *c);

// --- converge_report.c ---
int converge_print_json(const struct converge *c);
// Writes results.csv, results.json and report.html into a folder, which is created, and, with
// --images, the images.
bool converge_write(struct converge *c, const char *folder, struct err *err);
// Before measuring, with the scenes loaded: checks that none of these files is an input.
bool converge_check_files(struct converge *c, const char *folder, struct err *err);

// --- converge_html.c ---
bool converge_write_html(struct converge *c, const char *folder, struct err *err);

// --- converge_plot.c ---
// Makes a gnuplot script of local relMSE against samples, or against time; to be freed. *script is
// NULL if no error is known.
bool converge_plot(const struct converge *c, uint32_t scene, bool over_time, char **script,
                   struct err *err);

#endif
