// One run of `lampyris converge`: curves of error against samples and time, one for each scene and
// each combination of what is varied.
#ifndef LAMPYRIS_CLI_CONVERGE_CONVERGE_H
#define LAMPYRIS_CLI_CONVERGE_CONVERGE_H

#include "cli/options.h"
#include "cli/variants.h"
#include "job/job.h"
#include "metrics/curve.h"
#include "metrics/metrics.h"

enum converge_metric {
    CONVERGE_LOCAL_RELMSE, // the error that slopes, efficiencies and targets are of
    CONVERGE_RELMSE,
    CONVERGE_MSE,
    CONVERGE_SMAPE,
    CONVERGE_PSNR,
    CONVERGE_SSIM, // of large pictures of the first replicate only, as is FLIP
    CONVERGE_FLIP,
    CONVERGE_METRICS
};
extern const char *const converge_metric_names[CONVERGE_METRICS];

// A replicate's state at one point.
struct converge_sample {
    uint64_t spp;
    double seconds;                  // of rendering, since its first sample
    double metric[CONVERGE_METRICS]; // NAN where not measured
    double at_most;                  // without a reference: a bound of the local relMSE, or NAN
};

// The state of all replicates at one point.
struct converge_point {
    struct interval spp, seconds, metric[CONVERGE_METRICS];
    double at_most;   // the geometric mean of the replicates' bounds; NAN where one has none
    uint32_t unknown; // replicates whose local relMSE is not known: none of the errors is, then
};

// The picture that others are compared with. Without one, errors are those of the half-buffers,
// which are blind to bias.
struct converge_reference {
    const char *name; // file, or "auto"; NULL: none
    uint64_t spp;     // of "auto"
    struct reference picture;
};

// When a curve comes down to a local relMSE: see converge_conclude.c.
#define CONVERGE_TARGETS 3 // 1e-2, 1e-3, 1e-4
extern const double converge_targets[CONVERGE_TARGETS];
struct converge_target {
    struct interval seconds, spp; // with the start; NAN where not known
    bool extrapolated;            // before the first point or beyond the last
};

struct converge_curve {
    struct variant variant;
    struct scene scene_data;
    struct job job;
    struct converge_sample *samples; // replicate * points + point
    float (**pictures)[3];           // of the last point, one a replicate; NULL: not kept
    double start_seconds;            // load, BVH, upload and compile
    struct error_sources *sources;   // of the last point, one a replicate; NULL without --error-by
    struct job_speed speed;          // what a number of samples is planned from

    // These follow from the samples.
    struct converge_point *points;
    struct interval slope;          // of log error on log samples, or on log seconds with --times
    struct interval efficiency;     // 1 / (local relMSE * s) at the end
    struct interval efficiency_mse; // 1 / (MSE * s)
    struct interval bias;           // what of relMSE stays; NAN without a reference
    struct interval *ratios;        // of efficiencies, to each curve of the scene
    struct converge_target targets[CONVERGE_TARGETS];
    struct error_sources pooled; // what the replicates' sources say together
    uint64_t image_hash;         // of the first replicate's picture
    const char *command;         // that renders it
};

struct converge {
    const struct options *options;
    struct arena arena;
    struct gpu gpu;
    struct progress progress;      // options' with a phase of ours
    const char *phase;             // NULL: the renderer's own
    struct converge_curve *curves; // those of a scene are adjacent
    uint32_t curve_count;
    struct converge_reference *references; // one a scene
    uint64_t *spp;                         // a point, doubling; NULL with --times
    const double *seconds;                 // a point, rising; NULL without
    uint32_t point_count, replicate_count;
    uint32_t replicates_done; // fewer when a signal stopped it
    bool stopped;
    struct err failure; // of the device, after the first replicate
};

static inline struct converge_sample *converge_at(const struct converge *c,
                                                  const struct converge_curve *curve,
                                                  uint32_t replicate, uint32_t point)
{
    return &curve->samples[(size_t)replicate * c->point_count + point];
}

// The curves of its scene: from *first on.
uint32_t converge_siblings(const struct converge *c, const struct converge_curve *curve,
                           uint32_t *first);

// --- converge_run.c ---
bool converge_prepare(struct converge *c, struct err *err); // curves, scenes, renderers
bool converge_open(struct converge *c, struct converge_curve *curve, struct err *err);
// Calls job_advance(), unless the run is asked to stop.
bool converge_advance(struct converge *c, struct job *job, const struct job_step *step,
                      struct err *err);
// Replicate by replicate, all curves of a scene in turn, so that a machine that becomes slower does
// so for all of them.
bool converge_measure(struct converge *c, struct err *err);
void converge_finish(struct converge *c);

// --- converge_measure.c ---
// Measures the picture that the curve's job has.
bool converge_measure_point(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                            uint32_t point, struct err *err);
// Returns whether SSIM and FLIP are measured of every replicate.
bool converge_is_small(const struct converge_curve *curve);

// --- converge_reference.c ---
bool converge_reference(struct converge *c, struct err *err);

// --- converge_conclude.c ---
bool converge_conclude(struct converge *c, struct err *err);
// "as given" where nothing is varied.
const char *converge_label(const struct converge_curve *curve);
// "faster", "slower" or "not told apart", of a ratio of efficiencies.
const char *converge_verdict(struct interval ratio);
bool converge_is_biased(const struct converge_curve *curve);
// Writes the sentences that belong beside the numbers; returns how many.
#define CONVERGE_NOTES 6
#define CONVERGE_NOTE_SIZE 160
uint32_t converge_notes(const struct converge *c, char notes[][CONVERGE_NOTE_SIZE]);

// --- converge_error_by.c ---
// Splits the error of the picture that the curve's job has. Nothing without --error-by, nor below.
bool converge_split_error(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                          struct err *err);
bool converge_pool_sources(struct converge *c, struct converge_curve *curve, struct err *err);

// --- converge_command.c ---
// The command that renders the curve's first picture again; in the run's arena.
bool converge_command(struct converge *c, const struct converge_curve *curve, const char **out,
                      struct err *err);

// --- converge_print.c ---
void converge_print(const struct converge *c);

// --- converge_report.c ---
int converge_print_json(const struct converge *c);
// results.csv, results.json and report.html into a folder, which is created, and, with --images,
// what it is made of.
bool converge_write(struct converge *c, const char *folder, struct err *err);
// Before measuring, with the scenes loaded: that none of these files is one that is read.
bool converge_check_files(struct converge *c, const char *folder, struct err *err);

// --- converge_html.c ---
bool converge_write_html(struct converge *c, const char *folder, struct err *err);

// --- converge_plot.c ---
// A gnuplot script of local relMSE against samples, or against time; to be freed. *script is NULL
// where no error is known.
bool converge_plot(const struct converge *c, uint32_t scene, bool over_time, char **script,
                   struct err *err);

#endif
