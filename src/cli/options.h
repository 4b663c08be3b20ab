// The command line. One table, option_table, has the name, the argument and the help of each
// option; parsing, the help texts and the manual page use it.
#ifndef LAMPYRIS_CLI_OPTIONS_H
#define LAMPYRIS_CLI_OPTIONS_H

#include "base/arena.h"
#include "base/err.h"
#include "base/log.h"
#include "bvh/bvh.h"
#include "cli/compare_metric.h"
#include "cli/scene_options.h"
#include "flatten/flatten.h"
#include "gpu/params.h"
#include "job/job.h"
#include "metrics/error_map.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct command;
struct progress;

#define OPTIONS_ARGUMENTS_MAX 16     // but of merge
#define OPTIONS_PARTS_MAX UINT32_MAX // parts that merge takes
#define OPTION_TIME_MAX 1e9          // greatest value of --time, seconds

// The order is that of option_table, which is the order of the help.
enum option_id {
    OPTION_OUTPUT,
    OPTION_SIZE,
    OPTION_HALF,
    OPTION_PNG16,
    OPTION_AOV,
#define SETTING(ID, ...) OPTION_##ID,
#include "scene/core/settings_list.h"
    OPTION_TIME,
    OPTION_ERROR,
    OPTION_ADAPTIVE,
    OPTION_CAMERA,
    OPTION_APERTURE,
    OPTION_FOCUS_DISTANCE,
    OPTION_SCENE,
    OPTION_ANIMATION,
    OPTION_AT,
    OPTION_VARIANT,
    OPTION_ENV,
    OPTION_ENV_ROTATE,
    OPTION_ENV_STRENGTH,
    OPTION_STUDIO,
    OPTION_GROUND,
    OPTION_UP,
    OPTION_ANISOTROPY,
    OPTION_DEFINE,
    OPTION_STRICT,
    OPTION_ALLOW_OUTSIDE_PATHS,
    OPTION_FRAMES,
    OPTION_SPP_PER_FRAME,
    OPTION_EVERY,
    OPTION_ACCUMULATE,
    OPTION_CHECKPOINT,
    OPTION_CHECKPOINT_EVERY,
    OPTION_RESUME,
    OPTION_SHARD,
    OPTION_PARTIAL,
    OPTION_MIXED,
    OPTION_STATUS,
    OPTION_PARTS,
    OPTION_SLURM,
    OPTION_DRY_RUN,
    OPTION_REPLICATES,
    OPTION_REFERENCE,
    OPTION_REFERENCE_FROM,
    OPTION_VARY,
    OPTION_CURVE,
    OPTION_SPP_FROM,
    OPTION_TIMES,
    OPTION_SWEEP,
    OPTION_REPEATS,
    OPTION_KERNEL,
    OPTION_RAYS,
    OPTION_DEPTH,
    OPTION_BASELINE,
    OPTION_ERROR_BY,
    OPTION_EXPLAIN,
    OPTION_TRACE,
    OPTION_TEV,
    OPTION_ONLY,
    OPTION_LIST,
    OPTION_LONG,
    OPTION_REPRODUCIBLE,
    OPTION_FIX,
    OPTION_REPORT,
    OPTION_IMAGES,
    OPTION_DEVICE,
    OPTION_WAVE,
    OPTION_WORKGROUP,
    OPTION_MEMORY,
    OPTION_REOPEN,
    OPTION_VALIDATION,
    OPTION_PIXEL,
    OPTION_SAMPLE,
    OPTION_FEATURES,
    OPTION_CLASSES,
    OPTION_BVH,
    OPTION_NODE,
    OPTION_BVH_OPTIMIZE,
    OPTION_BVH_LEAF,
    OPTION_BVH_COSTS,
    OPTION_BVH_CACHE,
    OPTION_INSTANCES,
    OPTION_FAIL_ALLOCATION,
    OPTION_LOSE_DEVICE,
    OPTION_LOSE_DEVICES,
    OPTION_SCRIPT,
    OPTION_HEADLESS,
    OPTION_WATCH,
    OPTION_VSYNC,
    OPTION_FRAME_MS,
    OPTION_DENOISE,
    OPTION_SHADERS,
    OPTION_MAX,
    OPTION_MIN,
    OPTION_DIFFERENCE,
    OPTION_MAP,
    OPTION_REFERENCE_VARIANCE,
    OPTION_EXPOSURES,
    OPTION_MAN,
    OPTION_COMPLETION,
    OPTION_JSON,
    OPTION_QUIET,
    OPTION_LOG_LEVEL,
    OPTION_HELP,
    OPTION_HELP_ALL,
    OPTION_VERSION,
    OPTION_TOTAL
};

// How an option's value is written, and the type of its member of struct options.
enum option_type {
    VALUE_FLAG,        // none; bool
    VALUE_SWITCH,      // "on" or "off"; bool
    VALUE_COUNT,       // digits and perhaps k, M or G (powers of 1024); uint32_t or uint64_t
    VALUE_REAL,        // decimal; float or double
    VALUE_CHOICE,      // a word of the '|'-separated `argument`; an enum in that order
    VALUE_TEXT,        // anything; const char *
    VALUE_SETTING,     // as the setting's row says; the member of `settings`
    VALUE_SIZE,        // WxH; two uint32_t
    VALUE_PAIR,        // X,Y; two uint32_t
    VALUE_REAL_PAIR,   // X,Y, or X:Y in lists; two double
    VALUE_ENVIRONMENT, // FILE or R,G,B
    // Repeatable options, each with a list of its own:
    VALUE_OUTPUT,
    VALUE_DEFINE, // KEY=VALUE
    VALUE_LIMIT,  // METRIC=VALUE
    VALUE_VARY,   // KEY=A,B,...
    VALUE_CURVE,  // "KEY=VALUE KEY=VALUE"
    VALUE_AOVS,   // names separated by commas; bits of AOV_*
    VALUE_KINDS,  // the same; bits of AOVS_BY
    // Options with lists that are not repeatable:
    VALUE_TIMES,  // S,T,...
    VALUE_DEPTHS, // N,M,...
    VALUE_RAYS,   // words separated by commas
};

struct option_def {
    const char *name;     // without the dashes
    char short_name;      // 0: none
    const char *argument; // name of the value in the help; NULL for a flag and for a setting
    enum option_type type;
    double min, max;      // range of a number, both ends included; 0, 0 where there is none
    const char *fallback; // the default, for the help; or NULL
    const char *help;     // sentences, with units
    const char *group;    // heading in the help
    unsigned commands;    // bit 1 << enum command_id for each command that takes it
    unsigned common;      // those of `commands` whose --help lists it; 0 for settings
    const char *brief;    // its line in --help; settings have their own, in `setting`
    bool is_for_tests;    // manual pages and tests/README.md alone have it, no help
    size_t offset, size;  // place and size of the field in struct options
    const struct setting *setting; // says what is not set here; NULL: it is no setting
};

extern const struct option_def option_table[OPTION_TOTAL];
// Returns the option with that long name, or NULL.
const struct option_def *option_find(const char *name, size_t length);

// Shells that complete options by a script of ours.
enum completion_shell { COMPLETION_BASH, COMPLETION_ZSH, COMPLETION_FISH };

enum features_option { FEATURES_NEEDED, FEATURES_ALL };
enum classes_option { CLASSES_SORTED, CLASSES_MERGED };

// The rays that --rays of bench records: camera rays, rays scattered by surfaces, and shadow rays.
enum rays_option { RAYS_PRIMARY, RAYS_DIFFUSE, RAYS_SHADOW };

// The device and how it is used: no bit of the image depends on it.
struct device_options {
    struct gpu_params gpu;
    uint32_t wave;      // paths in flight; 0: chosen by device
    uint32_t workgroup; // threads; 0: chosen by device
    enum features_option features;
    enum classes_option classes;
    struct bvh_method bvh;
    const char *bvh_cache; // folder; NULL: none
    enum instancing instances;
};

struct render_options {
    const char **outputs;
    uint32_t output_count;
    uint32_t aovs; // AOV_*
    bool half_float, png16;
    double time_seconds; // 0: no limit
    double error;        // local relMSE at which to stop; 0: no such limit
    bool adaptive;       // sample counts by tile

    uint32_t frames, spp_per_frame; // 0 frames: one image of settings.spp samples
    uint32_t every;                 // write an image after this many frames; 0: only at the end
    bool accumulate;
    const char *checkpoint;    // NULL: none is written
    double checkpoint_seconds; // between two checkpoints
    bool resume;
    const char *shard_text; // text given to --shard; NULL: none
    struct job_shard shard;
    struct job_merged *merged; // set by merge: the film of the picture to be written; else NULL
    uint32_t reopens;          // how often a lost device is reopened

    uint32_t pixel[2]; // the path to follow, with --pixel
    uint64_t sample;
    bool explain;      // list the omitted parts, with reasons
    const char *trace; // file; NULL: none
    const char *tev;   // HOST:PORT; NULL: none
    // The command line without options that belong to a single run: --error, --checkpoint and
    // options that depend on it.
    const char *repeatable_line;
    // The command line that follows a path after --pixel and --sample are added.
    const char *following_line;
    // The command line without what belongs to one shard alone: it renders other samples of the
    // same picture when --shard is added, and the picture when -o is.
    const char *shared_line;
};

// Variants of renders that are compared: converge and bench.
struct study_options {
    const char **vary; // "KEY=A,B,..."; also of --sweep
    uint32_t vary_count;
    const char **curves; // "KEY=VALUE KEY=VALUE"
    uint32_t curve_count;
    const char *report; // folder; a file for check; NULL: none
};

struct converge_options {
    uint32_t replicates;
    uint64_t spp_from;
    const double *times; // seconds, ascending; NULL: points are numbers of samples
    uint32_t time_count;
    bool images; // write every image as EXR into the report
};

struct bench_options {
    uint32_t repeats;
    const char *kernel;     // the kernel to time alone; NULL: a complete render
    uint32_t rays;          // 1 << RAYS_*; 0: all
    const uint32_t *depths; // bounces; NULL: those implied by `rays`
    uint32_t depth_count;
    const char *baseline; // an earlier run's JSON; NULL: none
};

struct check_options {
    const char *only; // a group or a case; NULL: all
    bool list;
    bool longer;       // run the long cases, too
    bool reproducible; // run only the cases of bitwise equality, and print a line about them
    const char *fix;   // with a scene: where to write it with harmless remedies; NULL: nowhere
};

struct compare_options {
    struct compare_limit *limits;
    uint32_t limit_count;
    const char *difference; // NULL: no image
    enum error_map map;
    const char *reference_variance; // file, "auto" or a number; NULL: none
    const char *exposures;          // "START,STOP"; NULL: computed from the reference
};

struct merge_options {
    bool partial; // write the picture of the samples that there are
    bool mixed;   // parts may be of several devices
    bool status;  // say what the parts have, and add nothing
};

struct submit_options {
    uint32_t parts;    // 0: not given
    const char *slurm; // options of sbatch; NULL: none
    bool dry_run;      // write the batch files alone
};

struct view_options {
    const char *script; // file; NULL: none
    bool headless;      // without a window
    bool watch;         // reload changed files
    bool vsync;
    double frame_ms;     // goal for the time of a frame
    bool denoise;        // denoise the displayed image
    const char *shaders; // folder of the shaders' source; NULL: that of the build
};

// A command reads the common members and its own; the others have their defaults.
struct options {
    int argc; // as passed to main, for commands that reproduce a run
    char **argv;
    const struct command *command; // NULL only with --help or --version
    const char **arguments; // SCENE …; IMAGE and REFERENCE; PART …; COMMAND of help; then NULL
    uint32_t argument_count;
    bool given[OPTION_TOTAL];
    const char *command_line; // the complete command line, quoted for a shell

    bool help, help_all, version, man, quiet, json;
    enum completion_shell completion;
    enum log_level log_level;
    const struct progress *progress; // receives reports and stops the work; set by main
    uint64_t memory;       // budget of the host's memory, bytes; 0: what the machine has free
    uint32_t error_by;     // AOVS_BY: by what the error is split
    const char *reference; // file, "auto" or "none"; NULL: auto, for render none

    struct scene_options scene;
    struct device_options device;
    struct render_options render;
    struct study_options study;
    struct converge_options converge;
    struct bench_options bench;
    struct check_options check;
    struct compare_options compare;
    struct merge_options merge;
    struct submit_options submit;
    struct view_options view;

    struct arena arena; // owns the lists and the command line; other strings are argv's
};

// Parses and checks the command line. Errors are ERR_USAGE (or ERR_SYSTEM). *out must be finished
// in any case; after a failure its `command` is the one whose help may be suggested.
bool options_parse(int argc, char **argv, struct options *out, struct err *err);
void options_finish(struct options *options); // accepts NULL and {0}

static inline bool options_given(const struct options *options, enum option_id id)
{
    return options->given[id];
}

// Returns whether it changes how an image is computed, so that the command can vary it. Display
// options are excluded; size and samples can only be varied by bench.
bool option_is_setting(const struct option_def *def, const struct command *command);

// Converts the text of one value and stores it (option_values.c). err: the fault and what was
// expected, without the option's name.
bool option_store(const struct option_def *def, const char *text, struct options *options,
                  struct err *err);
// Records that the option was given.
void option_mark(const struct option_def *def, struct options *options);

// Quotes a word for a shell; returns the end of the output. `out` has room for 4 bytes per byte,
// plus 3.
char *options_quote(const char *word, char *out);

// Returns the value's name in the help: "WxH", "path|direct", "METRES|off".
#define OPTION_ARGUMENT_MAX 120
const char *option_argument(const struct option_def *def, char out[OPTION_ARGUMENT_MAX]);

// Returns whether the command has the option.
bool option_belongs(const struct option_def *def, const struct command *command);
// Returns the line that the command's --help has of the option; NULL where only --help-all has it.
const char *option_brief(const struct option_def *def, const struct command *command);

#endif
