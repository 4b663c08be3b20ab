// `lampyris bench --tune`: which sizes of waves and of workgroups render the scenes fastest on this
// device.
//
// A stage searches for the wave, the next one for the workgroup at that wave. Candidates are
// rendered in turns with what is the best so far, in rounds, so that a machine that slows down does
// so for all of them; after every few rounds the slower half is left out (successive halving). Both
// only propose: a winner of several is flattered by its own noise. What came of them is measured
// anew against the device's default, for all the time that is left, and is kept only when the
// interval of that ratio leaves 1 out.
#ifndef LAMPYRIS_CLI_BENCH_TUNE_H
#define LAMPYRIS_CLI_BENCH_TUNE_H

#include "cli/tune_cache.h"
#include "cli/tuned.h"
#include "metrics/curve.h"
#include "render/render.h"

#define TUNE_CANDIDATES 32 // of a stage
#define TUNE_ROUNDS 64     // of a candidate, at most

enum tune_stage { TUNE_WAVE, TUNE_WORKGROUP, TUNE_CONFIRM, TUNE_STAGES };
extern const char *const tune_stage_names[TUNE_STAGES];

struct tune_candidate {
    struct tuned sizes;
    bool fits; // into the device's limits, for every scene
    bool left; // still in the race
    uint32_t rounds;
    // Of each round, geometric means over scenes: of this one, and of what it is compared with.
    double seconds[TUNE_ROUNDS], base_seconds[TUNE_ROUNDS];
    struct interval speed; // base_seconds / seconds
};

struct tune_contest {
    struct tuned base; // what the others are compared with
    struct tune_candidate candidates[TUNE_CANDIDATES];
    uint32_t count;
};

struct tune_scene {
    struct scene scene;
    struct renderer renderer;
    uint64_t image_hash; // of what every size must give; 0: not known yet
};

struct tune {
    const struct options *options;
    struct progress watch; // asks to stop, and draws nothing
    struct arena arena;
    struct tune_cache cache;
    struct gpu gpu;
    struct tune_scene *scenes;
    uint32_t scene_count;
    uint64_t samples;        // of a pixel, of one run
    uint32_t rounds_at_once; // between two times that the slower half of a stage is left out
    struct tuned usual, best;
    struct tune_contest contests[TUNE_STAGES];
    bool confirmed;
    double budget_seconds, seconds;
    double load; // of the machine before the search: runnable threads; NAN: not known
    uint64_t start_ns;
    uint32_t runs_done, runs_planned;
    bool stopped;
};

// --- tune.c ---
int tune_run(const struct options *options);

// --- tune_contest.c ---
// The candidates of a stage against `base`, until one is left. *best: the winner where it seems to
// be faster, else base.
bool tune_contest(struct tune *t, enum tune_stage stage, struct tuned base, struct tuned *best,
                  struct err *err);
// `rounds` of one candidate against `base`.
bool tune_duel(struct tune *t, enum tune_stage stage, uint32_t rounds, struct err *err);
// How many runs a contest of so many candidates takes, with one round at once.
uint32_t tune_contest_runs(uint32_t candidates);
// One run of all scenes: the geometric mean of their seconds. fits may be NULL; where it is given
// and becomes false, nothing was rendered.
bool tune_measure(struct tune *t, struct tuned sizes, double *seconds, bool *fits, struct err *err);
// After a run: the picture's bits are the same for all sizes. Whatever is found changes none.
bool tune_check_pictures(struct tune *t, struct tuned sizes, struct err *err);

// --- tune_report.c ---
void tune_print(const struct tune *t);
int tune_print_json(const struct tune *t);

#endif
