// One run of `lampyris bench`: where the time of rendering goes, by kernel and by bounce, for each
// scene and each variant of the options.
#ifndef LAMPYRIS_CLI_BENCH_BENCH_H
#define LAMPYRIS_CLI_BENCH_BENCH_H

#include "cli/options.h"
#include "cli/variants.h"
#include "job/job.h"
#include "metrics/curve.h"
#include <jansson.h>

enum bench_row_kind {
    BENCH_WALL,   // a repetition by the host's clock
    BENCH_KERNEL, // a kernel of it, by the device's timestamps
    BENCH_HOST,   // what the host does between
    BENCH_ALONE,  // a kernel on recorded queues
};

// One thing that is timed in every repetition. Kernels and host add up to the wall clock.
struct bench_row {
    enum bench_row_kind kind;
    const char *name;      // unique in its variant: the kernel's, "waiting", ...
    enum kernel_id kernel; // of BENCH_KERNEL, BENCH_ALONE
    const char *rays;      // of BENCH_ALONE: "primary", ...; else NULL
    uint32_t depth;        // of BENCH_ALONE
    double *ms;            // one a repetition; NAN where the device has no timestamps
    // These are the same in every repetition.
    uint64_t launches, items; // 0: not counted
    double bytes; // that the items' records take at least to read and write; NAN: not counted
    // Nodes of the BVH that rays visited, and primitives that they tested; 0: not counted.
    uint64_t nodes, primitives;

    // These follow from the times.
    struct interval median; // of ms
    struct interval ratio;  // of the first variant's ms to these, paired: above 1 is faster
    double share;           // of the wall clock; NAN of BENCH_ALONE
};

// The work of the kernels of one bounce in a repetition.
struct bench_bounce {
    uint64_t items[KERNEL_COUNT];
    double *ms[KERNEL_COUNT]; // one a repetition
};

struct bench_variant {
    struct variant variant;
    struct scene scene_data;
    struct job job;
    struct bench_row *rows;
    uint32_t row_count;
    struct bench_bounce *bounces;              // STATS_BOUNCES of them, or NULL
    uint32_t bounce_count;                     // the last one that did something, and one
    double load_seconds;                       // the renderer's stats have the rest of the start
    double warm_up_ms, counting_ms;            // of the two repetitions that do not count
    uint64_t closest_rays, shadow_rays, paths; // a repetition
    uint64_t image_hash;                       // as of render; 0: there is no picture
    bool differs;                              // some repetition made another picture
};

// Where the time of all this went.
struct bench_seconds {
    double device;   // to open it
    double start;    // load, build, upload, compile
    double warm_up;  // the first repetition of each variant
    double counting; // the second, with the kernels that count
    double timed;    // what the results are of
    double pictures; // read back and hashed
};

struct bench {
    const struct options *options;
    struct arena arena;
    struct gpu gpu;
    struct bench_variant *variants; // those of a scene are adjacent
    uint32_t variant_count;
    uint32_t repeats, repeats_done; // fewer when a signal stopped it
    bool stopped;
    struct err failure; // of the device, after the first repetition
    struct bench_seconds seconds;
    double load;                  // of the machine before: runnable threads; NAN: not known
    bool differs;                 // some pictures do that are to be the same:
    struct err difference;        // which
    json_t *baseline;             // NULL: none was given
    struct bench_change *changes; // since then
    uint32_t change_count;
};

// --- bench_run.c ---
// Variants, their scenes and renderers; `repeats` from the options.
bool bench_prepare(struct bench *b, struct err *err);
// Which of the variants runs as the n-th in a round: another order each time, so that nothing
// always follows the same.
uint32_t bench_turn(uint32_t round, uint32_t n, uint32_t variants);
bool bench_measure(struct bench *b, struct err *err);
// Bytes that a kernel reads of one item's records.
double bench_bytes_read(const struct renderer *renderer, enum kernel_id kernel);
// Room for the times of `count` rows.
struct bench_row *bench_rows_create(struct bench *b, uint32_t count, struct err *err);
void bench_finish(struct bench *b);

// --- bench_conclude.c ---
// Medians, shares and ratios; and whether pictures that are to be the same are.
bool bench_conclude(struct bench *b, struct err *err);
// bench_first() returns the first variant of the same scene, bench_find() the row of that name, or
// NULL.
const struct bench_variant *bench_first(const struct bench *b, const struct bench_variant *variant);
const struct bench_row *bench_find(const struct bench_variant *variant, const char *row);
// Bytes of nodes and primitives that the row's rays read; NAN where they are not counted.
double bench_bvh_bytes(const struct bench_variant *variant, const struct bench_row *row);
// The repetition's row; NULL with --kernel.
const struct bench_row *bench_wall(const struct bench_variant *variant);
// Rays of a bounce as a part of the paths: how many of the wave's slots work.
double bench_occupancy(const struct bench_variant *variant, uint32_t bounce);
const char *bench_label(const struct bench_variant *variant); // "as given" where nothing is varied
const char *bench_verdict(struct interval ratio); // "faster", "slower" or "not told apart"

// --- bench_baseline.c ---
// A row now and in an earlier run.
struct bench_change {
    const struct bench_variant *variant;
    const struct bench_row *row;
    double before_ms;           // median
    struct interval ratio;      // ms now to then, with an interval that holds for all rows at once
    enum curve_verdict verdict; // better: faster
};

// Two runs of one program differ by this factor and more than their repetitions tell.
#define BENCH_FLOOR 1.05
// In how many runs of a hundred any row may be called changed without being so.
#define BENCH_FALSE_ALARMS 0.05

// The JSON of an earlier run, before anything is measured: ERR_INPUT where it is none, or of
// another device or other samples.
bool bench_load_baseline(struct bench *b, struct err *err);
bool bench_compare_baseline(struct bench *b, struct err *err); // the changes are the bench's then
const char *bench_change_word(const struct bench_change *change);
bool bench_is_slower(const struct bench *b); // than the baseline, in any row

// --- bench_json.c ---
json_t *bench_json(const struct bench *b); // docs/bench.schema.json

// --- bench_report.c ---
void bench_print(const struct bench *b);
// results.csv, results.json and report.html with its charts into a folder, which is created.
bool bench_write(struct bench *b, const char *folder, struct err *err);

// --- bench_html.c ---
bool bench_write_html(struct bench *b, const char *folder, struct err *err);

// --- bench_kernel.c ---
// With --kernel: what can be checked before anything is loaded.
bool bench_check_kernel(const struct bench_options *options, struct err *err);
// Fills the rows of the variants, which bench_prepare has made, in place of bench_measure.
bool bench_measure_kernel(struct bench *b, struct err *err);

#endif
