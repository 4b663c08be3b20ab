// A run of `lampyris bench`. It measures the rendering time by kernel and by bounce, for each scene
// and each variant of the options.
#ifndef LAMPYRIS_CLI_BENCH_BENCH_H
#define LAMPYRIS_CLI_BENCH_BENCH_H

#include "cli/options.h"
#include "cli/variants.h"
#include "job/job.h"
#include "metrics/curve.h"
#include <jansson.h>

enum bench_row_kind {
    BENCH_WALL,   // a whole repetition, by the host's clock
    BENCH_KERNEL, // one kernel of a repetition, by the device's timestamps
    BENCH_HOST,   // the host's work between kernels
    BENCH_ALONE,  // a single kernel on recorded queues
};

// A quantity that is timed in every repetition. The times of the kernels and of the host add up to
// the wall-clock time.
struct bench_row {
    enum bench_row_kind kind;
    const char *name;      // unique within a variant: the name of the kernel, "waiting", …
    enum kernel_id kernel; // for BENCH_KERNEL and BENCH_ALONE only
    const char *rays;      // for BENCH_ALONE: kind of rays, such as "primary"; otherwise NULL
    uint32_t depth;        // for BENCH_ALONE only: number of the bounce
    double *ms;            // time of each repetition; NAN if the device has no timestamps
    // The following numbers are the same in every repetition.
    uint64_t launches, items; // dispatches, and items that they process; 0: not counted
    // Least number of bytes that are read and written for the items' records; NAN: not counted.
    double bytes;
    // BVH nodes that rays visited, and primitives that they tested; 0: not counted.
    uint64_t nodes, primitives;

    // The following numbers are computed from the times.
    struct interval median; // median of ms
    // Time of the first variant divided by the time of this one, paired by repetition. If it is
    // above 1, this variant is faster.
    struct interval ratio;
    double share; // fraction of the wall-clock time; NAN for BENCH_ALONE
};

// The work of all kernels for one bounce in a repetition.
struct bench_bounce {
    uint64_t items[KERNEL_COUNT];
    double *ms[KERNEL_COUNT]; // time of each repetition, for each kernel
};

struct bench_variant {
    struct variant variant;
    struct scene scene_data;
    struct job job;
    struct bench_row *rows;
    uint32_t row_count;
    struct bench_bounce *bounces; // STATS_BOUNCES elements, or NULL
    uint32_t bounce_count;        // 1 + the last bounce at which there was any work
    // Load time of the scene; the renderer's statistics have the rest of the start-up time.
    double load_seconds;
    double warm_up_ms, counting_ms; // time of the two repetitions whose times are not reported
    uint64_t closest_rays, shadow_rays, paths; // per repetition
    uint64_t image_hash;                       // as `render` reports it; 0: there is no image
    bool differs;                              // a repetition gave a different image
};

// The time of the whole run, divided into phases.
struct bench_seconds {
    double device;   // opening the device
    double start;    // loading scenes, building BVHs, uploading, compiling kernels
    double warm_up;  // first repetition of each variant
    double counting; // second repetition, with kernels that count
    double timed;    // repetitions whose times are reported
    double pictures; // reading images back and computing their hashes
};

struct bench {
    const struct options *options;
    struct arena arena;
    struct gpu gpu;
    struct bench_variant *variants; // the variants of a scene are adjacent
    uint32_t variant_count;
    uint32_t repeats, repeats_done; // repeats_done is less than repeats if a signal ended the run
    bool stopped;
    struct err failure; // an error of the device after the first repetition
    struct bench_seconds seconds;
    double load; // average number of runnable threads on the machine before the run; NAN: not known
    bool differs;                 // images that must be equal are different
    struct err difference;        // describes the images that differ
    json_t *baseline;             // JSON of an earlier run; NULL: none was given
    struct bench_change *changes; // changes since the baseline
    uint32_t change_count;
};

// --- bench_run.c ---
// Creates the variants with their scenes and renderers. `repeats` is taken from the options.
bool bench_prepare(struct bench *b, struct err *err);
// Returns the index of the variant that runs as the n-th in a round. The order changes between
// rounds, so that a variant does not always follow the same other one.
uint32_t bench_turn(uint32_t round, uint32_t n, uint32_t variants);
bool bench_measure(struct bench *b, struct err *err);
// Returns the number of bytes that a kernel reads and writes in the records of one item.
double bench_bytes_read(const struct renderer *renderer, enum kernel_id kernel);
// Allocates `count` rows, with memory for their times.
struct bench_row *bench_rows_create(struct bench *b, uint32_t count, struct err *err);
void bench_finish(struct bench *b);

// --- bench_conclude.c ---
// Computes medians, shares and ratios, and compares the images that must be equal.
bool bench_conclude(struct bench *b, struct err *err);
// bench_first() returns the first variant of the same scene. bench_find() returns the row with this
// name, or NULL.
const struct bench_variant *bench_first(const struct bench *b, const struct bench_variant *variant);
const struct bench_row *bench_find(const struct bench_variant *variant, const char *row);
// Returns the number of bytes of BVH nodes and primitives that the rays of a row read; NAN if they
// are not counted.
double bench_bvh_bytes(const struct bench_variant *variant, const struct bench_row *row);
// Returns the row of the whole repetition, or NULL with --kernel.
const struct bench_row *bench_wall(const struct bench_variant *variant);
// Returns the number of rays of a bounce divided by the number of paths. This is the fraction of
// the wave's slots that are active.
double bench_occupancy(const struct bench_variant *variant, uint32_t bounce);
const char *bench_label(const struct bench_variant *variant); // "as given" if nothing is varied
// Returns the verdict of the JSON: "faster", "slower" or "not told apart".
const char *bench_verdict(struct interval ratio);

// --- bench_baseline.c ---
// The change of a row since an earlier run.
struct bench_change {
    const struct bench_variant *variant;
    const struct bench_row *row;
    double before_ms; // median of the earlier run
    // Present time divided by the earlier one; the intervals of all rows hold simultaneously.
    struct interval ratio;
    enum curve_verdict verdict; // CURVE_BETTER means faster
};

// Two runs of the same program may differ by this factor in addition to the variation of their
// repetitions.
#define BENCH_FLOOR 1.05
// The probability that at least one row is reported as changed although none has.
#define BENCH_FALSE_ALARMS 0.05

// Reads the JSON of an earlier run before anything is measured. Fails with ERR_INPUT if the file is
// not such JSON, or if it is from another device or with another number of samples.
bool bench_load_baseline(struct bench *b, struct err *err);
bool bench_compare_baseline(struct bench *b, struct err *err); // sets b->changes
// Returns the verdict of the JSON, in the words of bench_verdict().
const char *bench_change_word(const struct bench_change *change);
// Returns whether any row is slower than in the baseline.
bool bench_is_slower(const struct bench *b);

// --- bench_json.c ---
json_t *bench_json(const struct bench *b); // the format is docs/bench.schema.json

// --- bench_report.c ---
void bench_print(const struct bench *b);
// Writes results.csv, results.json and report.html with its charts into a folder, which is created
// if necessary.
bool bench_write(struct bench *b, const char *folder, struct err *err);

// --- bench_html.c ---
bool bench_write_html(struct bench *b, const char *folder, struct err *err);

// --- bench_kernel.c ---
// With --kernel: checks the options as far as this is possible without loading a scene.
bool bench_check_kernel(const struct bench_options *options, struct err *err);
// With --kernel: replaces bench_measure() and fills the rows of the variants that bench_prepare()
// has made.
bool bench_measure_kernel(struct bench *b, struct err *err);

#endif
