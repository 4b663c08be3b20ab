// The command line. A single table, option_table, has the name, the argument and the help of each
// option. Parsing, the help and the manual pages use it.
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

#define OPTIONS_ARGUMENTS_MAX 16     // greatest number of arguments, except for merge
#define OPTIONS_PARTS_MAX UINT32_MAX // the greatest number of parts for merge
#define SEQUENCE_FRAMES_MAX 1000000u
#define SEQUENCE_FPS_MIN 0.001
#define SEQUENCE_FPS_MAX 1000.0
#define OPTION_TIME_MAX 1e9 // greatest value of --time, seconds

// The options, in the order of option_table and of the help.
enum option_id {
    OPTION_OUTPUT,
    OPTION_SIZE,
    OPTION_CROP,
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
    OPTION_TURNTABLE,
    OPTION_FPS,
    OPTION_FRAMES,
    OPTION_SPP_PER_FRAME,
    OPTION_EVERY,
    OPTION_ACCUMULATE,
    OPTION_CHECKPOINT,
    OPTION_CHECKPOINT_EVERY,
    OPTION_RESUME,
    OPTION_SHARD,
    OPTION_SHARD_BY,
    OPTION_PARTIAL,
    OPTION_MIXED,
    OPTION_STATUS,
    OPTION_EXPECT,
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

// The syntax of an option's value on the command line, and the type of its member of struct
// options.
enum option_type {
    VALUE_FLAG,        // no value; bool
    VALUE_SWITCH,      // "on" or "off"; bool
    VALUE_COUNT,       // digits, optionally with k, M or G (powers of 1024); uint32_t or uint64_t
    VALUE_REAL,        // decimal number; float or double
    VALUE_CHOICE,      // a word of the '|'-separated `argument`; an enum in the same order
    VALUE_TEXT,        // any text; const char *
    VALUE_SETTING,     // as the setting's row defines; the member of `settings`
    VALUE_SIZE,        // WxH; two uint32_t
    VALUE_PAIR,        // X,Y; two uint32_t
    VALUE_REAL_PAIR,   // X,Y, or X:Y in lists; two double
    VALUE_ENVIRONMENT, // FILE or R,G,B
    VALUE_WINDOW,      // X0,Y0,X1,Y1 with X1 > X0 and Y1 > Y0; four uint32_t
    VALUE_AT,          // SECONDS or START:END:FPS; scene.at_seconds, and render.sequence
    // Options that may be repeated. Each has a list of its own:
    VALUE_OUTPUT,
    VALUE_DEFINE, // KEY=VALUE
    VALUE_LIMIT,  // METRIC=VALUE
    VALUE_VARY,   // KEY=A,B,...
    VALUE_CURVE,  // "KEY=VALUE KEY=VALUE"
    VALUE_AOVS,   // names separated by commas; bits of AOV_*
    VALUE_KINDS,  // names separated by commas; bits of AOVS_BY
    // Options that take a list and may not be repeated:
    VALUE_TIMES,  // S,T,...
    VALUE_DEPTHS, // N,M,...
    VALUE_RAYS,   // words separated by commas
};

struct option_def {
    const char *name;     // long name, without the dashes
    char short_name;      // 0: none
    const char *argument; // name of the value in the help; NULL for a flag and for a setting
    enum option_type type;
    double min, max;      // range of a number, including both ends; 0, 0: no range
    const char *fallback; // the default, for the help; may be NULL
    const char *help;     // sentences, with units
    const char *group;    // heading in the help
    unsigned commands;    // bit 1 << enum command_id for each command that takes it
    unsigned common;      // bits of the commands whose --help lists the option; 0 for settings
    const char *brief;    // the option's line in --help; for settings, `setting` has it
    bool is_for_tests;    // the option is only in manual pages and tests/README.md, not in the help
    size_t offset, size;  // offset and size of the member in struct options
    const struct setting *setting; // the setting, which defines what this row does not; NULL: the
                                   // option is not a setting
};

extern const struct option_def option_table[OPTION_TOTAL];
// Returns the option with this long name, or NULL.
const struct option_def *option_find(const char *name, size_t length);

// Shells for which there is a completion script.
enum completion_shell { COMPLETION_BASH, COMPLETION_ZSH, COMPLETION_FISH };

enum features_option { FEATURES_NEEDED, FEATURES_ALL };
enum classes_option { CLASSES_SORTED, CLASSES_MERGED };

// The rays that --rays of bench records: camera rays, rays scattered by surfaces, and shadow rays.
enum rays_option { RAYS_PRIMARY, RAYS_DIFFUSE, RAYS_SHADOW };

// The device and how it is used. No bit of the image depends on these options.
struct device_options {
    struct gpu_params gpu;
    uint32_t wave;      // number of paths in flight; 0: chosen by the kind of device
    uint32_t workgroup; // threads per workgroup; 0: chosen by the kind of device
    enum features_option features;
    enum classes_option classes;
    struct bvh_method bvh;
    const char *bvh_cache; // folder; NULL: none
    enum instancing instances;
};

// A render of several numbered pictures. At most one of the first two is set.
struct sequence_options {
    uint32_t views;      // number of views of --turntable; 0: not given
    bool is_animation;   // --at has a range
    double start, end;   // seconds of an animation; the end is not included
    double frames_per_s; // pictures per second of the animation, or of a turntable's video
};

// The units that --shard distributes, in the order of the values of --shard-by.
enum shard_by { SHARD_BY_SAMPLES, SHARD_BY_TILES };

struct render_options {
    const char **outputs;
    uint32_t output_count;
    uint32_t aovs;    // AOV_*
    uint32_t crop[4]; // X0, Y0, X1, Y1 of the window; all 0: the whole picture
    bool half_float, png16;
    double time_seconds; // seconds; 0: no limit
    double error;        // upper bound of the local relMSE at which to stop; 0: no limit
    bool adaptive;       // each tile has a number of samples of its own

    struct sequence_options sequence;
    uint32_t frames, spp_per_frame; // 0 frames: one image of settings.spp samples
    uint32_t every;                 // number of frames after which an image is written; 0: only at
                                    // the end
    bool accumulate;
    const char *checkpoint;            // NULL: none is written
    double checkpoint_seconds;         // interval between two checkpoints
#define OPTION_CHECKPOINT_SECONDS 60.0 // longest interval without --checkpoint-every
    bool resume;
    const char *shard_text; // text given to --shard; NULL: none
    enum shard_by shard_by;
    struct job_shard shard;
    struct job_merged *merged; // set by merge: the film of the picture to write; otherwise NULL
    uint32_t reopens;          // number of times that a lost device is reopened

    uint32_t pixel[2]; // with --pixel: X and Y of the pixel of the path to follow
    uint64_t sample;   // index, from 0, of the sample of this path
    bool explain;      // list the omitted parts, with reasons
    const char *trace; // file; NULL: none
    const char *tev;   // HOST:PORT; NULL: none
    // The command line without options that belong to a single run, such as --error and
    // --checkpoint.
    const char *repeatable_line;
    // The command line to which --pixel and --sample are added to follow a path; NULL for a
    // sequence of pictures, of which --pixel cannot select one.
    const char *following_line;
    // The command line without options of a single shard. With --shard added it renders other
    // samples of the same picture; with -o added it renders the picture.
    const char *shared_line;
};

// Options of converge and bench, which compare variants of a render.
struct study_options {
    const char **vary; // "KEY=A,B,...", from --vary or --sweep
    uint32_t vary_count;
    const char **curves; // "KEY=VALUE KEY=VALUE"
    uint32_t curve_count;
    const char *report; // folder, or file for check and compare; NULL: none
};

struct converge_options {
    uint32_t replicates;
    uint64_t spp_from;
    const double *times; // in seconds, ascending; NULL: points are at numbers of samples
    uint32_t time_count;
    bool images; // write every image as EXR into the report
};

struct bench_options {
    uint32_t repeats;
    const char *kernel;     // the only kernel to time; NULL: a complete render
    uint32_t rays;          // 1 << RAYS_*; 0: all
    const uint32_t *depths; // bounces; NULL: those implied by `rays`
    uint32_t depth_count;
    const char *baseline; // JSON file of an earlier run; NULL: none
};

struct check_options {
    const char *only; // name of a group or a case; NULL: all cases
    bool list;
    bool longer;       // also run the long cases
    bool reproducible; // run only the cases of bitwise equality, and print a sentence about them
    const char *fix;   // file to which the scene is written with harmless remedies; NULL: none
};

struct compare_options {
    struct compare_limit *limits;
    uint32_t limit_count;
    const char *difference; // file of the difference image; NULL: none
    enum error_map map;
    const char *reference_variance; // file, "auto" or a number; NULL: none
    const char *exposures;          // "START,STOP"; NULL: computed from the reference
};

struct merge_options {
    bool partial;         // write the picture even if samples are missing
    bool mixed;           // the parts may be from several devices
    bool status;          // print which samples the parts have, without adding them
    const char *expected; // hash of the render that the parts must be of; NULL: any
};

struct submit_options {
    uint32_t parts;    // 0: not given
    const char *slurm; // options of sbatch; NULL: none
    bool dry_run;      // only write the batch files
};

struct view_options {
    const char *script; // file; NULL: none
    bool headless;      // the viewer has no window
    bool watch;         // reload changed files
    bool vsync;
    double frame_ms;     // target for the time of a frame, in milliseconds
    bool denoise;        // denoise the displayed image
    const char *shaders; // folder of the shaders' source code; NULL: the folder of the build
};

// The options of all commands. A command uses the common members and its own; other members have
// their defaults.
struct options {
    int argc; // main's arguments, for commands that reproduce a run
    char **argv;
    const struct command *command; // NULL only with --help or --version
    int command_index;             // index of the command's name in argv
    const char **arguments; // SCENE …; IMAGE and REFERENCE; PART …; or COMMAND of help; ends with
                            // NULL
    uint32_t argument_count;
    bool given[OPTION_TOTAL];
    const char *command_line; // the complete command line, quoted for a shell

    bool help, help_all, version, man, quiet, json;
    enum completion_shell completion;
    enum log_level log_level;
    const struct progress *progress; // receives reports and stops the work; set by main
    uint64_t memory;                 // budget of host memory, bytes; 0: chosen by the free memory
    uint32_t error_by;               // AOVS_BY: the classes by which the error is split
    const char *reference;           // file, "auto" or "none"; NULL: "auto", for render "none"

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

// Parses and checks the command line. Fails with ERR_USAGE or ERR_SYSTEM. *out must be finished in
// any case; after a failure, out->command is the command whose help may be suggested.
bool options_parse(int argc, char **argv, struct options *out, struct err *err);
void options_finish(struct options *options); // accepts NULL and {0}

static inline bool options_given(const struct options *options, enum option_id id)
{
    return options->given[id];
}

// Returns whether the option changes how an image is computed, so that the command can vary it.
// Display options are excluded; size and samples can only be varied by bench.
bool option_is_setting(const struct option_def *def, const struct command *command);

// Parses a value and stores it (option_values.c). The error message says what is wrong and what was
// expected, without the option's name.
bool option_store(const struct option_def *def, const char *text, struct options *options,
                  struct err *err);
// Records that the option was given.
void option_mark(const struct option_def *def, struct options *options);

// Returns whether several numbered pictures are rendered: --turntable, or --at with a range.
bool options_have_sequence(const struct options *options);

// Returns whether an output is the video of a sequence, by its extension.
bool output_is_video(const char *path);

// Quotes a word for a shell, as printable_quote() does.
char *options_quote(const char *word, char *out);
// Returns "./" for the name of a file that begins with '-', and otherwise "". With it in front, no
// program takes the name for an option.
const char *options_folder_of(const char *name);

// Returns the placeholder of the value in the help: "WxH", "path|direct", "METRES|off".
#define OPTION_ARGUMENT_MAX 120
const char *option_argument(const struct option_def *def, char out[OPTION_ARGUMENT_MAX]);

// Returns whether the command has the option.
bool option_belongs(const struct option_def *def, const struct command *command);
// Returns the option's line in the command's --help; NULL if only --help-all has the option.
const char *option_brief(const struct option_def *def, const struct command *command);

#endif
