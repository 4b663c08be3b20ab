// A run of `lampyris bench`: rendering time by kernel and by bounce, for each scene and each
// variant of the options.
#ifndef LAMPYRIS_CLI_BENCH_BENCH_H
#define LAMPYRIS_CLI_BENCH_BENCH_H

#include "cli/options.h"
#include "cli/variants.h"
#include "job/job.h"
#include "metrics/curve.h"
#include <jansson.h>

enum bench_row_kind {
    BENCH_WALL,   // a repetition by the host's clock
    BENCH_KERNEL, // one of its kernels, by the device's timestamps
    BENCH_HOST,   // work of the host in between
    BENCH_ALONE,  // a kernel on recorded queues
};

// A quantity that is timed in every repetition. The kernels and the host add up to the wall clock.
struct bench_row {
    enum bench_row_kind kind;
    const char *name;      // unique in its variant: the kernel's name, "waiting", ...
    enum kernel_id kernel; // only for BENCH_KERNEL, BENCH_ALONE
    const char *rays;      // for BENCH_ALONE: "primary", ...; else NULL
    uint32_t depth;        // only for BENCH_ALONE
    double *ms;            // one value per repetition; NAN if the device has no timestamps
    // These are the same in every repetition.
    uint64_t launches, items; // 0: not counted
    double bytes; // bytes that the items' records take at least to read and write; NAN: not counted
    // Nodes of the BVH that rays visited, and primitives that they tested; 0: not counted.
    uint64_t nodes, primitives;

    // These are computed from the times.
    struct interval median; // median of ms
    struct interval ratio;  // the first variant's ms divided by these, paired: above 1 is faster
    double share;           // fraction of the wall clock; NAN for BENCH_ALONE
};

// The work of the kernels for one bounce in a repetition.
struct bench_bounce {
    uint64_t items[KERNEL_COUNT];
    double *ms[KERNEL_COUNT]; // one per repetition
};

struct bench_variant {
    struct variant variant;
    struct scene scene_data;
    struct job job;
    struct bench_row *rows;
    uint32_t row_count;
    struct bench_bounce *bounces;              // STATS_BOUNCES of them, or NULL
    uint32_t bounce_count;                     // 1 + the last bounce with any work
    double load_seconds;                       // the renderer's stats have the rest of the start-up
                                               // time
    double warm_up_ms, counting_ms;            // time of the two repetitions that are not timed
    uint64_t closest_rays, shadow_rays, paths; // per repetition
    uint64_t image_hash;                       // as reported by render; 0: there is no image
    bool differs;                              // some repetition gave another image
};

// The time of the whole run by phase.
struct bench_seconds {
    double device;   // to open it
    double start;    // load, build, upload, compile
    double warm_up;  // the first repetition of each variant
    double counting; // the second, with kernels that count
    double timed;    // the repetitions whose times are reported
    double pictures; // reading back and hashing
};

struct bench {
    const struct options *options;
    struct arena arena;
    struct gpu gpu;
    struct bench_variant *variants; // those of a scene are adjacent
    uint32_t variant_count;
    uint32_t repeats, repeats_done; // fewer when a signal stopped it
    bool stopped;
    struct err failure; // an error of the device, after the first repetition
    struct bench_seconds seconds;
    double load;                  // load of the machine before the run: runnable threads; NAN: not
                                  // known
    bool differs;                 // images that must be equal differ
    struct err difference;        // says which of them
    json_t *baseline;             // NULL: none was given
    struct bench_change *changes; // since the baseline
    uint32_t change_count;
};

// --- bench_run.c ---
// Creates the variants, their scenes and renderers; `repeats` is that of the options.
bool bench_prepare(struct bench *b, struct err *err);
// Returns which variant runs as the n-th in a round. The order differs between rounds, so that no
// variant always follows the same one.
uint32_t bench_turn(uint32_t round, uint32_t n, uint32_t variants);
bool bench_measure(struct bench *b, struct err *err);
// Returns the bytes that a kernel reads of one item's records.
double bench_bytes_read(const struct renderer *renderer, enum kernel_id kernel);
// Allocates `count` rows with room for their times.
struct bench_row *bench_rows_create(struct bench *b, uint32_t count, struct err *err);
void bench_finish(struct bench *b);

// --- bench_conclude.c ---
// Computes medians, shares and ratios, and whether images that must be equal are.
bool bench_conclude(struct bench *b, struct err *err);
// bench_first() returns the first variant of the same scene, bench_find() the row with that name,
// or NULL.
const struct bench_variant *bench_first(const struct bench *b, const struct bench_variant *variant);
const struct bench_row *bench_find(const struct bench_variant *variant, const char *row);
// Returns the bytes of nodes and primitives that the row's rays read; NAN if they are not counted.
double bench_bvh_bytes(const struct bench_variant *variant, const struct bench_row *row);
// Returns the row of the whole repetition; NULL with --kernel.
const struct bench_row *bench_wall(const struct bench_variant *variant);
// Returns the rays of a bounce relative to the paths: the fraction of the wave's slots that are
// active.
double bench_occupancy(const struct bench_variant *variant, uint32_t bounce);
const char *bench_label(const struct bench_variant *variant); // "as given" if nothing is varied
const char *bench_verdict(struct interval ratio); // "faster", "slower" or "not told apart"

// --- bench_baseline.c ---
// A row in this run and in an earlier one.
struct bench_change {
    const struct bench_variant *variant;
    const struct bench_row *row;
    double before_ms;           // median
    struct interval ratio;      // ms now divided by ms then, with an interval that holds for all
                                // rows together
    enum curve_verdict verdict; // better: faster
};

// Two runs of the same program may differ by this factor, beyond the variation of their
// repetitions.
#define BENCH_FLOOR 1.05
// The probability that any row is reported as changed though it is not.
#define BENCH_FALSE_ALARMS 0.05

// Reads the JSON of an earlier run, before anything is measured. ERR_INPUT if it is not such a
// file, or of another device or other samples.
bool bench_load_baseline(struct bench *b, struct err *err);
bool bench_compare_baseline(struct bench *b, struct err *err); // sets b->changes
const char *bench_change_word(const struct bench_change *change);
bool bench_is_slower(const struct bench *b); // than the baseline, in any row

// --- bench_json.c ---
json_t *bench_json(const struct bench *b); // docs/bench.schema.json

// --- bench_report.c ---
void bench_print(const struct bench *b);
// Writes results.csv, results.json and report.html with its charts into a folder, which is created.
bool bench_write(struct bench *b, const char *folder, struct err *err);

// --- bench_html.c ---
bool bench_write_html(struct bench *b, const char *folder, struct err *err);

// --- bench_kernel.c ---
// With --kernel: checks what can be checked before anything is loaded.
bool bench_check_kernel(const struct bench_options *options, struct err *err);
// With --kernel, in place of bench_measure: fills the rows of the variants of bench_prepare.
bool bench_measure_kernel(struct bench *b, struct err *err);

#endif
