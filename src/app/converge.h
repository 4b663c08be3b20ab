// One run of `lampyris converge`: curves of error against samples and time, one for each scene and
// each combination of what is varied.
#ifndef LAMPYRIS_APP_CONVERGE_H
#define LAMPYRIS_APP_CONVERGE_H

#include "curve.h"
#include "metrics.h"
#include "options.h"
#include "reference.h"
#include "render.h"
#include "variants.h"

enum converge_metric {
    CONVERGE_RELMSE,
    CONVERGE_MSE,
    CONVERGE_SMAPE,
    CONVERGE_PSNR,
    CONVERGE_SSIM, // of the first replicate only, as is FLIP: they take longer than rendering
    CONVERGE_FLIP,
    CONVERGE_METRICS
};
extern const char *const converge_metric_names[CONVERGE_METRICS];

// What one replicate had reached at one number of samples.
struct converge_sample {
    double seconds;                  // of rendering, since its first sample
    double metric[CONVERGE_METRICS]; // NAN where not measured
};

// What is compared with. Without one, errors are those of the half-buffers: blind to bias.
struct converge_reference {
    const char *name; // file, or "auto"; NULL: none
    uint64_t spp;     // of "auto"
    struct reference picture;
};

#define CONVERGE_TARGETS 3 // relMSE 1e-2, 1e-3, 1e-4
extern const double converge_targets[CONVERGE_TARGETS];

struct converge_curve {
    struct variant variant;
    struct scene scene_data;
    struct renderer renderer;
    struct converge_sample *samples; // replicate * points + point
    float (**pictures)[3];           // of the last point, one a replicate
    double start_seconds;            // load, BVH, upload and compile

    // What follows from the samples.
    struct interval *error;            // of relMSE, a point
    struct interval *seconds;          // a point
    struct interval slope, efficiency; // of log relMSE on log samples; 1 / (relMSE * s) at the end
    struct interval bias;              // what of relMSE stays; NAN without a reference
    struct interval ratio;             // of efficiencies to the scene's first curve
    double time_to[CONVERGE_TARGETS];  // seconds with the start; NAN where not known
    bool extrapolated[CONVERGE_TARGETS];
};

struct converge {
    const struct options *options;
    struct arena arena;
    struct gpu gpu;
    struct converge_curve *curves; // those of a scene are adjacent
    uint32_t curve_count;
    struct converge_reference *references; // one a scene
    uint64_t *spp;                         // a point, doubling
    uint32_t point_count, replicate_count;
    uint32_t replicates_done; // fewer when a signal stopped it
    bool stopped;
};

static inline struct converge_sample *converge_at(const struct converge *c,
                                                  const struct converge_curve *curve,
                                                  uint32_t replicate, uint32_t point)
{
    return &curve->samples[(size_t)replicate * c->point_count + point];
}

// --- converge_run.c ---
bool converge_prepare(struct converge *c, struct err *err); // curves, scenes, renderers
bool converge_reference(struct converge *c, struct err *err);
// Replicate by replicate, all curves of a scene in turn, so that a machine that becomes slower does
// so for all of them.
bool converge_measure(struct converge *c, struct err *err);
void converge_finish(struct converge *c);

// --- converge_conclude.c ---
bool converge_conclude(struct converge *c, struct err *err);

// "as given" where nothing is varied.
const char *converge_label(const struct converge_curve *curve);
const char *converge_verdict(const struct converge_curve *curve); // of its ratio

// --- converge_report.c ---
void converge_print(const struct converge *c);
int converge_print_json(const struct converge *c);
// results.csv, results.json and report.html with its plots into a folder, which is created.
bool converge_write(struct converge *c, const char *folder, struct err *err);

// --- converge_html.c ---
bool converge_write_html(struct converge *c, const char *folder, struct err *err);

#endif
