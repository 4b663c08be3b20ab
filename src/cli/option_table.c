#include "cli/commands.h"
#include "cli/options.h"

#include <stdio.h>

#define FOR_RENDER (1u << COMMAND_RENDER)
#define FOR_COMPARE (1u << COMMAND_COMPARE)
#define FOR_DEVICES (1u << COMMAND_DEVICES)
#define FOR_HELP (1u << COMMAND_HELP)
#define FOR_CONVERGE (1u << COMMAND_CONVERGE)
#define FOR_BENCH (1u << COMMAND_BENCH)
#define FOR_VIEW (1u << COMMAND_VIEW)
#define FOR_MERGE (1u << COMMAND_MERGE)
#define FOR_SUBMIT (1u << COMMAND_SUBMIT)
#define FOR_CHECK (1u << COMMAND_CHECK)
#define FOR_SCENE                                                                                  \
    (FOR_RENDER | FOR_CONVERGE | FOR_BENCH | FOR_VIEW | FOR_CHECK | 1u << COMMAND_INFO)
#define FOR_ALL ((1u << COMMAND_TOTAL) - 1)

#define FIELD(member)                                                                              \
    .offset = offsetof(struct options, member), .size = sizeof(((struct options *)NULL)->member)

#define MOST_BYTES (UINT64_C(1) << 40) // more than any device has

_Static_assert(offsetof(struct settings, height) == offsetof(struct settings, width) + 4,
               "--size writes width and height at once");
_Static_assert(offsetof(struct bvh_method, intersection_cost) ==
                   offsetof(struct bvh_method, traversal_cost) + sizeof(double),
               "--bvh-costs writes both at once");

// Lines are filled: one field per line would make the table four times as long.
// clang-format off
const struct option_def option_table[OPTION_TOTAL] = {
    [OPTION_OUTPUT] = {
        .name = "output", .short_name = 'o', .argument = "FILE", .type = VALUE_OUTPUT,
        .group = "Picture", .commands = FOR_RENDER | FOR_MERGE | FOR_SUBMIT,
        .fallback = "the scene's name with .exr, in the working directory, and with .png where "
                    "standard output is a terminal; none of a shard and of merge with --checkpoint",
        .common = FOR_RENDER | FOR_MERGE | FOR_SUBMIT,
        .brief = "Write FILE, .exr, .png, .jpg, .hdr or .pfm; several may be given.",
        .help = "Write the picture to FILE. Its extension chooses the format: .exr, .hdr and .pfm "
                "are linear, .png and .jpg are tone-mapped. May be given several times.",
    },
    [OPTION_SIZE] = {
        .name = "size", .argument = "WxH", .type = VALUE_SIZE, .min = 1, .max = SETTINGS_SIZE_MAX,
        .group = "Picture", .commands = FOR_SCENE, .fallback = "the scene file's, else 512x512",
        .common = FOR_SCENE, .brief = "Width and height in pixels.",
        .help = "Width and height in pixels, at most 2^31 pixels in all. The viewer's "
                "window has 1280x720 by default.",
        .offset = offsetof(struct options, scene.settings.width), .size = 2 * sizeof(uint32_t),
    },
    [OPTION_HALF] = {
        .name = "half", .type = VALUE_FLAG, .group = "Picture", .commands = FOR_RENDER | FOR_MERGE,
        .help = "Write EXR files with 16-bit instead of 32-bit channels.", FIELD(render.half_float),
    },
    [OPTION_PNG16] = {
        .name = "png16", .type = VALUE_FLAG, .group = "Picture", .commands = FOR_RENDER | FOR_MERGE,
        .help = "Write PNG files with 16 instead of 8 bits per value.", FIELD(render.png16),
    },
    [OPTION_AOV] = {
        .name = "aov", .argument = "NAME,...", .type = VALUE_AOVS, .group = "Picture",
        .commands = FOR_RENDER, .fallback = "none",
        .common = FOR_RENDER, .brief = "More layers of the EXR file: albedo, depth, ..., all.",
        .help = "Pictures besides the radiance, as layers of the EXR files: albedo, normal, "
                "normal_geometric, depth, position, ids, alpha of the first surface; emission, "
                "direct, indirect; steps of camera rays; samples, variance, halves; or all. See docs/output.md.",
        FIELD(render.aovs),
    },

#define SETTING(ID, type_, member, key, option, group_, help_, ...) \
    [OPTION_##ID] = {.name = option, .type = VALUE_SETTING, .group = group_, .help = help_, \
                     .commands = FOR_SCENE, .setting = &settings_table[SETTING_##ID]},
#define SETTING_OF_IMAGE(ID, type_, member, key, option, group_, help_, ...) \
    [OPTION_##ID] = {.name = option, .type = VALUE_SETTING, .group = group_, .help = help_, \
                     .commands = FOR_RENDER | FOR_VIEW | (OPTION_##ID == OPTION_EXPOSURE ? FOR_COMPARE : 0), \
                     .setting = &settings_table[SETTING_##ID]},
#include "scene/core/settings_list.h"

    [OPTION_TIME] = {
        .name = "time", .argument = "SECONDS", .type = VALUE_REAL, .min = 0.001,
        .max = OPTION_TIME_MAX,
        .group = "Sampling", .commands = FOR_RENDER, .fallback = "no limit",
        .common = FOR_RENDER, .brief = "Stop after this many seconds.",
        .help = "Stop at whole samples per pixel after about this many seconds of rendering, or "
                "at --spp or --frames where given. At least one sample per pixel is taken.",
        FIELD(render.time_seconds),
    },
    [OPTION_ERROR] = {
        .name = "error", .argument = "E", .type = VALUE_REAL, .min = 1e-12, .max = 1e6,
        .group = "Sampling", .commands = FOR_RENDER | FOR_CHECK, .fallback = "no limit",
        .common = FOR_RENDER, .brief = "Stop when the error (local relMSE) is below E.",
        .help = "Stop when the local relMSE (the mean squared error relative to the mean around "
                "each pixel) is below this with 95 % confidence. Looks at the error from 2 samples "
                "per pixel on, where it may have come low enough; ends at --spp (65536 where not "
                "given) or --time at the latest. check says what a render to this error would take; "
                "0.001 where not given.",
        FIELD(render.error),
    },
    [OPTION_ADAPTIVE] = {
        .name = "adaptive", .argument = "on|off", .type = VALUE_SWITCH, .group = "Sampling",
        .commands = FOR_RENDER, .fallback = "off",
        .help = "Give tiles of 16 x 16 pixels as many samples as their error asks for, with --spp "
                "on average, a quarter of it at least and 16 times it at most. A pilot of 16 "
                "samples per pixel, which are not part of the picture, says how many.",
        FIELD(render.adaptive),
    },

    [OPTION_CAMERA] = {
        .name = "camera", .argument = "NAME|INDEX", .type = VALUE_TEXT, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "the first",
        .common = FOR_RENDER | FOR_VIEW | FOR_CONVERGE | 1u << COMMAND_INFO, .brief = "One of the scene's cameras.",
        .help = "Which of the scene's cameras, by name or by number from 0.", FIELD(scene.camera),
    },
    [OPTION_APERTURE] = {
        .name = "aperture", .argument = "MM", .type = VALUE_REAL, .min = 0,
        .max = SCENE_LENS_MAX_MM, .group = "Scene", .commands = FOR_SCENE, .fallback = "the camera's",
        .help = "Radius of the camera's lens in millimetres; 0: a pinhole.", FIELD(scene.aperture_mm),
    },
    [OPTION_FOCUS_DISTANCE] = {
        .name = "focus-distance", .argument = "METRES", .type = VALUE_REAL,
        .min = SCENE_LENGTH_MIN, .max = SCENE_COORDINATE_MAX, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "the camera's",
        .help = "Distance of the plane in focus along the line of sight.",
        FIELD(scene.focus_distance),
    },
    [OPTION_SCENE] = {
        .name = "scene", .argument = "NAME|INDEX", .type = VALUE_TEXT, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "the one that the file names, else the first",
        .common = 1u << COMMAND_INFO, .brief = "One of the scenes of a glTF file.",
        .help = "Which scene of a glTF file, by name or by number from 0.", FIELD(scene.gltf_scene),
    },
    [OPTION_ANIMATION] = {
        .name = "animation", .argument = "NAME|INDEX", .type = VALUE_TEXT, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "none; with --at, the first",
        .help = "Which animation of a glTF file, by name or by number from 0. Without --at it is "
                "shown as it begins.",
        FIELD(scene.animation),
    },
    [OPTION_AT] = {
        .name = "at", .argument = "SECONDS", .type = VALUE_REAL, .min = 0, .max = OPTION_TIME_MAX,
        .group = "Scene", .commands = FOR_SCENE,
        .fallback = "the nodes as they are without animation",
        .help = "Pose a glTF file as its animation has it at this time. Before the first key and "
                "after the last it stands still.",
        FIELD(scene.at_seconds),
    },
    [OPTION_VARIANT] = {
        .name = "variant", .argument = "NAME", .type = VALUE_TEXT, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "the materials that need none",
        .common = 1u << COMMAND_INFO, .brief = "One of the variants of a glTF file.",
        .help = "Which variant of its materials a glTF file is shown with.", FIELD(scene.variant),
    },
    [OPTION_ENV] = {
        .name = "env", .argument = "FILE|R,G,B|sky:...", .type = VALUE_ENVIRONMENT,
        .group = "Scene", .commands = FOR_SCENE, .fallback = "the scene's",
        .common = FOR_RENDER | FOR_VIEW | FOR_CONVERGE | FOR_CHECK, .brief = "Environment: an image, a radiance, or a sky.",
        .help = "What surrounds the scene: a latitude-longitude picture, a constant radiance in "
                "W/(sr m^2), or Preetham's sky with its sun, as in sky:turbidity=3,elevation=45. "
                "Its keys are turbidity (2 to 10), elevation and azimuth of the sun (degrees; 0 is "
                "+X, 90 is +Z), albedo of the ground, diameter of the sun (degrees) and sun (0 "
                "leaves it out). A file whose name looks like one of these is written ./1,1,1.",
    },
    [OPTION_ENV_ROTATE] = {
        .name = "env-rotate", .argument = "DEGREES", .type = VALUE_REAL,
        .min = -SCENE_TURN_MAX, .max = SCENE_TURN_MAX,
        .group = "Scene", .commands = FOR_SCENE, .fallback = "0",
        .help = "Turn what surrounds the scene about +Y, counter-clockwise seen from above, in "
                "addition to the scene's own rotation.",
        FIELD(scene.environment_rotate_degrees),
    },
    [OPTION_ENV_STRENGTH] = {
        .name = "env-strength", .argument = "X", .type = VALUE_REAL, .min = 0,
        .max = SCENE_RADIANCE_MAX,
        .group = "Scene", .commands = FOR_SCENE, .fallback = "1",
        .help = "Multiply the radiance of what surrounds the scene.", FIELD(scene.environment_strength),
    },
    [OPTION_STUDIO] = {
        .name = "studio", .argument = "off|auto|on", .type = VALUE_CHOICE, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "auto",
        .common = FOR_VIEW, .brief = "Light the scene by a studio.",
        .help = "Light a scene by a studio of our own, soft key, fill and rim: where a model brings "
                "no light or too little (auto), in place of its environment (on), or never: without "
                "light there is then an even environment of radiance 1 (off). Scene files with a "
                "camera are lit by the studio with on only.",
        FIELD(scene.studio),
    },
    [OPTION_GROUND] = {
        .name = "ground", .argument = "auto|on|off", .type = VALUE_CHOICE, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "auto: with the studio, unless a camera is below it",
        .help = "A plane below the model that catches its shadow.", FIELD(scene.ground),
    },
    [OPTION_UP] = {
        .name = "up", .argument = "y|x|z", .type = VALUE_CHOICE, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "y",
        .help = "Which axis points up: for the camera, the light and the ground of a model that "
                "comes without them. The model stays as it is.",
        FIELD(scene.up),
    },
    [OPTION_ANISOTROPY] = {
        .name = "anisotropy", .argument = "on|off", .type = VALUE_SWITCH, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "on",
        .help = "Off: all materials scatter alike about their normals, whatever their files say.",
        FIELD(scene.anisotropy),
    },
    [OPTION_DEFINE] = {
        .name = "define", .short_name = 'D', .argument = "KEY=VALUE", .type = VALUE_DEFINE,
        .group = "Scene", .commands = FOR_SCENE,
        .common = FOR_SCENE, .brief = "Replace a value of a JSON scene.",
        .help = "Replace a value of a JSON scene, by its \"define\" name or its dotted path, as in "
                "film.exposure=1. May be given several times.",
    },
    [OPTION_STRICT] = {
        .name = "strict", .type = VALUE_FLAG, .group = "Scene", .commands = FOR_SCENE,
        .help = "A missing texture or material library (MTL) is an error, instead of pink or grey "
                "with a warning.", FIELD(scene.strict),
    },
    [OPTION_ALLOW_OUTSIDE_PATHS] = {
        .name = "allow-outside-paths", .type = VALUE_FLAG, .group = "Scene",
        .commands = FOR_SCENE,
        .help = "Let scene files name files outside their own folder. Only for files you trust.",
        FIELD(scene.allow_outside_paths),
    },

    [OPTION_FRAMES] = {
        .name = "frames", .argument = "N", .type = VALUE_COUNT, .min = 1, .max = UINT32_MAX,
        .group = "Frames", .commands = FOR_RENDER, .fallback = "one picture of --spp samples",
        .help = "Render exactly N frames of --spp-per-frame samples each. N frames of K samples "
                "equal --spp N*K bit for bit.",
        FIELD(render.frames),
    },
    [OPTION_SPP_PER_FRAME] = {
        .name = "spp-per-frame", .argument = "N", .type = VALUE_COUNT, .min = 1,
        .max = SETTINGS_SPP_MAX, .group = "Frames", .commands = FOR_RENDER, .fallback = "1",
        .help = "Samples per pixel of one frame.", FIELD(render.spp_per_frame),
    },
    [OPTION_EVERY] = {
        .name = "every", .argument = "N", .type = VALUE_COUNT, .min = 1, .max = UINT32_MAX,
        .group = "Frames", .commands = FOR_RENDER, .fallback = "only after the last frame",
        .help = "Write a numbered picture after every N frames.", FIELD(render.every),
    },
    [OPTION_ACCUMULATE] = {
        .name = "accumulate", .argument = "on|off", .type = VALUE_SWITCH, .group = "Frames",
        .commands = FOR_RENDER, .fallback = "on",
        .help = "Whether frames add up to one picture. Off: each is fresh, with samples of its "
                "own.",
        FIELD(render.accumulate),
    },
    [OPTION_CHECKPOINT] = {
        .name = "checkpoint", .argument = "FILE", .type = VALUE_TEXT, .group = "Frames",
        .commands = FOR_RENDER | FOR_MERGE, .fallback = "none is kept",
        .common = FOR_RENDER | FOR_MERGE, .brief = "Keep in FILE what --resume, or merge, needs.",
        .help = "Keep in FILE what is needed to go on with this render later, also after a signal "
                "and at the end. FILE may exist already only with --resume. "
                "merge keeps the sum of its parts in FILE, which is a part again.", FIELD(render.checkpoint),
    },
    [OPTION_CHECKPOINT_EVERY] = {
        .name = "checkpoint-every", .argument = "SECONDS", .type = VALUE_REAL, .min = 0,
        .max = OPTION_TIME_MAX, .group = "Frames", .commands = FOR_RENDER, .fallback = "60",
        .help = "Time between two checkpoints; 0: one after every wave.",
        FIELD(render.checkpoint_seconds),
    },
    [OPTION_RESUME] = {
        .name = "resume", .type = VALUE_FLAG, .group = "Frames", .commands = FOR_RENDER,
        .common = FOR_RENDER, .brief = "Go on from --checkpoint, to the same bits.",
        .help = "Go on from the file of --checkpoint, or begin where there is none yet. The "
                "picture is that of a run without interruption, bit for bit, whatever --wave is. "
                "Refuses a checkpoint of another scene, device or other settings; --spp, --time, "
                "--error, --frames and the outputs may change.",
        FIELD(render.resume),
    },

#include "cli/option_rows_shards.h"

    [OPTION_REPLICATES] = {
        .name = "replicates", .argument = "N", .type = VALUE_COUNT, .min = 2, .max = 4096,
        .group = "Curves", .commands = FOR_CONVERGE, .fallback = "16",
        .common = FOR_CONVERGE, .brief = "Independent runs of each curve.",
        .help = "Independent runs of each curve, with seeds from --seed on. Intervals come from "
                "their spread.",
        FIELD(converge.replicates),
    },
    [OPTION_REFERENCE] = {
        .name = "reference", .argument = "FILE|auto|none", .type = VALUE_TEXT, .group = "Curves",
        .commands = FOR_RENDER | FOR_CONVERGE, .fallback = "auto; of render, none",
        .common = FOR_CONVERGE, .brief = "The image that errors are taken against.",
        .help = "What errors are taken against: a picture (its own noise is subtracted where it "
                "has the layers of --aov halves or variance), one made now with a hundred times the "
                "samples, which is announced with its cost, or none: the half-buffers then tell the "
                "error, and no bias. render takes a picture only.",
        FIELD(reference),
    },
    [OPTION_REFERENCE_FROM] = {
        .name = "reference-from", .argument = "FILE", .type = VALUE_TEXT, .group = "Curves",
        .commands = FOR_CONVERGE, .fallback = "--reference",
        .help = "The reference from a file of an earlier run (--images keeps it) or of another renderer, of "
                "the scene's size. Its own noise is subtracted where it has layers half_a and half_b, "
                "or variance, the variance of each value; else it is said to be unknown.",
        FIELD(reference),
    },
    [OPTION_VARY] = {
        .name = "vary", .argument = "KEY=A,B,...", .type = VALUE_VARY, .group = "Curves",
        .commands = FOR_CONVERGE, .fallback = "one curve",
        .common = FOR_CONVERGE, .brief = "A curve for each value, as in sampler=sobol,pcg.",
        .help = "A curve for each value of an option that says how pictures are computed, as in "
                "sampler=sobol,pcg. Several multiply.",
    },
    [OPTION_CURVE] = {
        .name = "curve", .argument = "'KEY=VALUE KEY=VALUE'", .type = VALUE_CURVE,
        .group = "Curves", .commands = FOR_CONVERGE | FOR_BENCH, .fallback = "none",
        .common = FOR_CONVERGE | FOR_BENCH, .brief = "A curve, or variant, by several options at once.",
        .help = "A curve, or a variant of a benchmark, by several options at once, as in 'nee=on "
                "mis=none'. May be given several times; those of --vary or --sweep come after it.",
    },
    [OPTION_SPP_FROM] = {
        .name = "spp-from", .argument = "N", .type = VALUE_COUNT, .min = 1,
        .max = SETTINGS_SPP_MAX, .group = "Curves", .commands = FOR_CONVERGE, .fallback = "16",
        .common = FOR_CONVERGE, .brief = "Samples per pixel of the first point.",
        .help = "Samples a pixel of the first point; each further one has twice as many, up to "
                "--spp (256 where that is not given).",
        FIELD(converge.spp_from),
    },
    [OPTION_TIMES] = {
        .name = "times", .argument = "SECONDS,...", .type = VALUE_TIMES, .min = 0.001,
        .max = OPTION_TIME_MAX, .group = "Curves", .commands = FOR_CONVERGE,
        .fallback = "points at doubling samples",
        .common = FOR_CONVERGE, .brief = "Points at these times of rendering.",
        .help = "Points at these times of rendering instead, rising: every curve ends at the whole "
                "sample that is then done. What needs to know the number of samples beforehand "
                "(samplers stratified, grid and blue-noise, contiguous halves) renders as many as "
                "are expected to fit, by the time that earlier ones took.",
    },

    [OPTION_SWEEP] = {
        .name = "sweep", .argument = "KEY=A,B,...", .type = VALUE_VARY, .group = "Benchmark",
        .commands = FOR_BENCH, .fallback = "one variant",
        .common = FOR_BENCH, .brief = "A variant for each value, as in wave=4k,64k.",
        .help = "A variant for each value of an option, as in wave=4k,16k,64k, workgroup=32,64, "
                "node=quantised,float or spp=1,4. Several multiply.",
    },
    [OPTION_REPEATS] = {
        .name = "repeats", .argument = "N", .type = VALUE_COUNT, .min = 2, .max = 10000,
        .group = "Benchmark", .commands = FOR_BENCH, .fallback = "7",
        .common = FOR_BENCH, .brief = "Timed runs of each variant.",
        .help = "Timed runs of each variant, in turns, after one that only warms up.",
        FIELD(bench.repeats),
    },
    [OPTION_KERNEL] = {
        .name = "kernel", .argument = "NAME", .type = VALUE_TEXT, .group = "Benchmark",
        .commands = FOR_BENCH, .fallback = "all of a render",
        .common = FOR_BENCH, .brief = "Time this kernel alone.",
        .help = "Time this kernel alone, on what it gets in a render: on queues recorded from a wave "
                "in the middle of the picture. Any kernel that \"lampyris bench\" lists, or resolve.",
        FIELD(bench.kernel),
    },
    [OPTION_RAYS] = {
        .name = "rays", .argument = "primary|diffuse|shadow,...", .type = VALUE_RAYS,
        .group = "Benchmark", .commands = FOR_BENCH, .fallback = "those of the kernel",
        .common = FOR_BENCH, .brief = "Rays that --kernel traces.",
        .help = "Which rays --kernel traces: those from the camera or those that surfaces send on, "
                "by intersect_closest, and those to lights, by intersect_shadow. Either kernel may "
                "be named.",
    },
    [OPTION_DEPTH] = {
        .name = "depth", .argument = "N,...", .type = VALUE_DEPTHS, .min = 0,
        .max = SETTINGS_BOUNCES_MAX, .group = "Benchmark", .commands = FOR_BENCH,
        .fallback = "0, and 1 for diffuse rays",
        .help = "After how many bounces the queues for --kernel are recorded; rays to lights: at "
                "which surface of the path they were sent, from 0.",
    },
    [OPTION_BASELINE] = {
        .name = "baseline", .argument = "FILE", .type = VALUE_TEXT, .group = "Benchmark",
        .commands = FOR_BENCH, .fallback = "none",
        .common = FOR_BENCH, .brief = "Compare with the JSON of an earlier run.",
        .help = "Compare with the JSON of an earlier run, and say what is slower or faster beyond "
                "noise. Exit with 1 where something is slower.",
        FIELD(bench.baseline),
    },
    [OPTION_ERROR_BY] = {
        .name = "error-by", .argument = "part,bounce,emitter", .type = VALUE_KINDS,
        .group = "Report", .commands = FOR_RENDER | FOR_CONVERGE, .fallback = "none",
        .help = "Say where the error comes from, by some of these or by all: by part (emission seen "
                "directly, direct and indirect light), by the number of scattering events, by the "
                "kind of emitter. Of a render also the ten brightest contributions, each with the "
                "command that follows its path. The picture is the same.", FIELD(error_by),
    },
    [OPTION_EXPLAIN] = {
        .name = "explain", .type = VALUE_FLAG, .group = "Report", .commands = FOR_RENDER,
        .help = "List what this render leaves out: each feature, lobe, kind of light, kernel and "
                "buffer, why, and the bytes and SPIR-V instructions that this saves; and what the "
                "summary has no room for.",
        FIELD(render.explain),
    },
    [OPTION_TRACE] = {
        .name = "trace", .argument = "FILE", .type = VALUE_TEXT, .group = "Report",
        .commands = FOR_RENDER, .fallback = "none",
        .help = "Write the error after 1, 2, 4, ... samples a pixel and at the end, with the time "
                "it took, to FILE, .csv or .json; also the true one where there is a --reference. "
                "The picture keeps its bits.",
        FIELD(render.trace),
    },
    [OPTION_TEV] = {
        .name = "tev", .argument = "HOST:PORT", .type = VALUE_TEXT, .group = "Report",
        .commands = FOR_RENDER, .fallback = "none",
        .help = "Send the picture as it grows to the viewer tev, which listens on port 14158; "
                "HOST is 127.0.0.1 where only \":PORT\" or \"PORT\" is given, [::1]:14158 an "
                "address of IPv6. Where nobody listens, the render goes on without tev. The "
                "picture keeps its bits.",
        FIELD(render.tev),
    },
    [OPTION_ONLY] = {
        .name = "only", .argument = "GROUP|CASE", .type = VALUE_TEXT, .group = "Cases",
        .commands = FOR_CHECK, .fallback = "all cases that are not long",
        .common = FOR_CHECK, .brief = "Run one group of the cases, or one case.",
        .help = "Run the cases of one group, or one case, by its name in --list.",
        FIELD(check.only),
    },
    [OPTION_LIST] = {
        .name = "list", .type = VALUE_FLAG, .group = "Cases", .commands = FOR_CHECK,
        .common = FOR_CHECK, .brief = "List the cases and run none.",
        .help = "Print the cases with what is done and what is expected, and run none.",
        FIELD(check.list),
    },
    [OPTION_LONG] = {
        .name = "long", .type = VALUE_FLAG, .group = "Cases", .commands = FOR_CHECK,
        .common = FOR_CHECK, .brief = "Run the long cases, too.",
        .help = "Run the long cases, too.", FIELD(check.longer),
    },
    [OPTION_REPRODUCIBLE] = {
        .name = "reproducible", .type = VALUE_FLAG, .group = "Cases", .commands = FOR_CHECK,
        .common = FOR_CHECK, .brief = "Check that images have the same bits.",
        .help = "Run the cases of the group bits, the long ones too: a picture with other waves, "
                "splits of its samples, features and limits. Prints their hashes, and one line to "
                "put into a paper.",
        FIELD(check.reproducible),
    },
    [OPTION_FIX] = {
        .name = "fix", .argument = "OUT.json", .type = VALUE_TEXT, .group = "Cases",
        .commands = FOR_CHECK, .fallback = "none",
        .common = FOR_CHECK, .brief = "Write the scene with the harmless remedies.",
        .help = "Write the scene with the harmless remedies applied: those that remove an error, "
                "or something without effect, and change nothing else in the picture. check lists "
                "the remedies that it applied. Changes to the scene by options of the command "
                "line are written, too. The exit code is 0 if nothing is wrong in the written "
                "file any more, else 1.",
        FIELD(check.fix),
    },
    [OPTION_REPORT] = {
        .name = "report", .argument = "FOLDER|FILE", .type = VALUE_TEXT, .group = "Report",
        .commands = FOR_CONVERGE | FOR_BENCH | FOR_CHECK | FOR_COMPARE, .fallback = "none",
        .common = FOR_CONVERGE | FOR_BENCH | FOR_CHECK | FOR_COMPARE,
        .brief = "Write a report of HTML here.",
        .help = "Write report.html with plots (by gnuplot), tables and pictures, results.csv and "
                "results.json into this folder. check writes its cases, or what it finds in a scene, "
                "with pictures into this .html file; compare writes a viewer of the pictures and "
                "their errors, with tables, insets and plots, into one.",
        FIELD(study.report),
    },
    [OPTION_IMAGES] = {
        .name = "images", .type = VALUE_FLAG, .group = "Report", .commands = FOR_CONVERGE,
        .common = FOR_CONVERGE, .brief = "Write every image into the report's folder.",
        .help = "Write every replicate's picture and the references into the report's folder, as "
                "EXR, and what report.html is made of, as PNG, SVG and scripts for gnuplot.",
        FIELD(converge.images),
    },

    [OPTION_DEVICE] = {
        .name = "device", .argument = "INDEX,...|NAME|all", .type = VALUE_TEXT, .group = "Device",
        .commands = FOR_SCENE | FOR_DEVICES | FOR_MERGE, .fallback = "the fastest kind",
        .common = FOR_SCENE | FOR_DEVICES, .brief = "Vulkan device, by its number or name.",
        .help = "Device to use, by its number in \"lampyris devices\" or a part of its name. render takes "
                "several numbers, as in 0,1: these devices share the samples of the picture, which "
                "has the bits of one where they are of one kind with one driver. See docs/scaling.md. info takes "
                "all, and says which devices the scene fits on.",
        FIELD(device.gpu.device),
    },
    [OPTION_WAVE] = {
        .name = "wave", .argument = "N", .type = VALUE_COUNT, .min = 64, .max = 16777216,
        .group = "Device", .commands = FOR_SCENE, .fallback = "chosen by device and speed",
        .common = FOR_BENCH | 1u << COMMAND_INFO, .brief = "Paths in flight.",
        .help = "Paths in flight. Changes memory and speed, and no bit of the picture. By default "
                "2^20 on GPUs, and on CPU drivers 64k for small pictures; from 2^18 pixels on "
                "waves of 16k, 64k and 256k paths take turns, and the fastest stay.",
        FIELD(device.wave),
    },
    [OPTION_WORKGROUP] = {
        .name = "workgroup", .argument = "N", .type = VALUE_COUNT, .min = 8, .max = 1024,
        .group = "Device", .commands = FOR_SCENE, .fallback = "chosen by device",
        .help = "Threads of a workgroup, a power of two. Changes speed, and no bit of the picture.",
        FIELD(device.workgroup),
    },
    [OPTION_MEMORY] = {
        .name = "memory", .argument = "BYTES", .type = VALUE_COUNT, .min = 1 << 20, .max = MOST_BYTES,
        .group = "Device", .commands = FOR_SCENE | FOR_COMPARE | FOR_MERGE,
        .fallback = "three quarters of what is available",
        .help = "Host memory that scenes, pictures and hierarchies may take; a scene that needs more is "
                "refused before it is allocated. The default is a share of the memory that the "
                "machine, its control groups and ulimit leave. K, M and G may follow the number: "
                "8G is 8 GiB.",
        FIELD(memory),
    },
    [OPTION_REOPEN] = {
        .name = "reopen", .argument = "N", .type = VALUE_COUNT, .min = 0, .max = 1000,
        .group = "Device", .commands = FOR_RENDER, .fallback = "2",
        .help = "How often a device that is lost is opened again. "
                "Rendering then goes on from the last copy of the film, and the picture is the "
                "same.", FIELD(render.reopens),
    },
    [OPTION_VALIDATION] = {
        .name = "validation", .type = VALUE_FLAG, .group = "Device", .commands = FOR_SCENE,
        .help = "Enable the Vulkan validation layers, synchronization validation included. Slow.",
        FIELD(device.gpu.validation),
    },

    [OPTION_PIXEL] = {
        .name = "pixel", .argument = "X,Y", .type = VALUE_PAIR, .min = 0,
        .max = SETTINGS_SIZE_MAX - 1, .group = "Replay", .commands = FOR_RENDER,
        .help = "Follow one path through this pixel, counted from the top left, and print every "
                "vertex of it instead of rendering.",
        FIELD(render.pixel),
    },
    [OPTION_SAMPLE] = {
        .name = "sample", .argument = "S", .type = VALUE_COUNT, .min = 0,
        .max = SETTINGS_SPP_MAX - 1, .group = "Replay", .commands = FOR_RENDER, .fallback = "0",
        .help = "Index, from 0, of the sample that --pixel follows.", FIELD(render.sample),
    },

    [OPTION_FEATURES] = {
        .name = "features", .argument = "needed|all", .type = VALUE_CHOICE,
        .group = "Kernels", .commands = FOR_SCENE, .fallback = "needed",
        .help = "Compile in what the scene needs, or everything.", FIELD(device.features),
    },
    [OPTION_CLASSES] = {
        .name = "classes", .argument = "sorted|merged", .type = VALUE_CHOICE,
        .group = "Kernels", .commands = FOR_SCENE, .fallback = "sorted",
        .help = "Shade each class of surfaces (diffuse, principled, transmissive, classical) by a "
                "kernel of its own, or all by one. The picture is the same.", FIELD(device.classes),
    },
    [OPTION_BVH] = {
        .name = "bvh", .argument = "sah|median|mean|spatial|middle", .type = VALUE_CHOICE,
        .group = "Kernels", .commands = FOR_SCENE, .fallback = "sah",
        .help = "How triangles are split into a hierarchy: by the surface area heuristic, at the "
                "median or at the mean of their centres, by the heuristic with triangles in "
                "several boxes where that pays, or in the middle of the box. The picture is the "
                "same.", FIELD(device.bvh.split),
    },
    [OPTION_NODE] = {
        .name = "node", .argument = "quantised|float", .type = VALUE_CHOICE, .group = "Kernels",
        .commands = FOR_SCENE, .fallback = "quantised",
        .help = "Boxes of the hierarchy in bytes (64 a node) or in floats (128). The picture is "
                "the same.", FIELD(device.bvh.format),
    },
    [OPTION_BVH_OPTIMIZE] = {
        .name = "bvh-optimize", .argument = "normal|off|long", .type = VALUE_CHOICE,
        .group = "Kernels", .commands = FOR_SCENE, .fallback = "normal",
        .help = "Move subtrees to better places once the hierarchy is built: for a bounded time, "
                "not at all, or until nothing is gained. The picture is the same.",
        FIELD(device.bvh.optimize),
    },
    [OPTION_BVH_LEAF] = {
        .name = "bvh-leaf", .argument = "N", .type = VALUE_COUNT, .min = 1, .max = BVH_LEAF_MAX,
        .group = "Kernels", .commands = FOR_SCENE, .fallback = "2",
        .help = "Triangles that a leaf of the hierarchy has room for, 1 to 8. The picture is the "
                "same.", FIELD(device.bvh.max_leaf),
    },
    [OPTION_BVH_COSTS] = {
        .name = "bvh-costs", .argument = "T,I", .type = VALUE_REAL_PAIR, .min = BVH_COST_MIN,
        .max = BVH_COST_MAX, .group = "Kernels", .commands = FOR_SCENE, .fallback = "1,1",
        .help = "What visiting a node and intersecting a primitive are taken to cost where --bvh "
                "sah and spatial decide between leaves and nodes: only the ratio matters. In "
                "lists T:I, as in --sweep bvh-costs=1:1,1:4. The picture is the same.",
        .offset = offsetof(struct options, device.bvh.traversal_cost), .size = 2 * sizeof(double),
    },
    [OPTION_BVH_CACHE] = {
        .name = "bvh-cache", .argument = "DIR", .type = VALUE_TEXT, .group = "Kernels",
        .commands = FOR_SCENE,
        .help = "Keep hierarchies in this folder, by what they are built of, and take them from "
                "there the next time.", FIELD(device.bvh_cache),
    },
    [OPTION_INSTANCES] = {
        .name = "instances", .argument = "auto|on|off", .type = VALUE_CHOICE, .group = "Kernels",
        .commands = FOR_SCENE, .fallback = "auto",
        .help = "Keep a mesh once, with a hierarchy of its own, for all its instances: where that "
                "pays, always, or never. Pictures differ by rounding only.", FIELD(device.instances),
    },

    [OPTION_FAIL_ALLOCATION] = {
        .name = "fail-allocation", .argument = "N", .type = VALUE_COUNT, .min = 1,
        .max = UINT32_MAX, .is_for_tests = true, .group = "Faults, for tests", .commands = FOR_RENDER | FOR_VIEW,
        .help = "Have the N-th allocation of device memory fail.",
        FIELD(device.gpu.fail_allocation),
    },
    [OPTION_LOSE_DEVICE] = {
        .name = "lose-device", .argument = "N", .type = VALUE_COUNT, .min = 1,
        .max = UINT32_MAX, .is_for_tests = true, .group = "Faults, for tests", .commands = FOR_RENDER | FOR_CHECK | FOR_VIEW,
        .help = "Lose the device at the N-th submission of commands, and again once it was opened "
                "again.",
        FIELD(device.gpu.lose_device_at_submit),
    },
    [OPTION_LOSE_DEVICES] = {
        .name = "lose-devices", .argument = "N", .type = VALUE_COUNT, .min = 1,
        .max = UINT32_MAX, .is_for_tests = true, .group = "Faults, for tests", .commands = FOR_RENDER | FOR_CHECK,
        .fallback = "every time",
        .help = "How often --lose-device loses the device, which is well afterwards.",
        FIELD(device.gpu.devices_to_lose),
    },

    [OPTION_SCRIPT] = {
        .name = "script", .argument = "FILE", .type = VALUE_TEXT, .group = "Viewer",
        .commands = FOR_VIEW, .fallback = "none",
        .common = FOR_VIEW, .brief = "Run the commands in FILE, one a line.",
        .help = "Run the commands in FILE, one a line, which press keys, move the mouse, change "
                "values and save pictures (see docs/viewer.md). The viewer ends after the last "
                "one, or with exit code 1 at the first that fails.",
        FIELD(view.script),
    },
    [OPTION_HEADLESS] = {
        .name = "headless", .type = VALUE_FLAG, .group = "Viewer", .commands = FOR_VIEW,
        .common = FOR_VIEW, .brief = "Open no window; for --script.",
        .help = "Open no window: the same loop in memory, for scripts. Needs --script.",
        FIELD(view.headless),
    },
    [OPTION_WATCH] = {
        .name = "watch", .type = VALUE_FLAG, .group = "Viewer", .commands = FOR_VIEW,
        .common = FOR_VIEW, .brief = "Reload the scene and shaders when files change.",
        .help = "Reload the scene and the shaders when their files change.", FIELD(view.watch),
    },
    [OPTION_VSYNC] = {
        .name = "vsync", .argument = "on|off", .type = VALUE_SWITCH, .group = "Viewer",
        .commands = FOR_VIEW, .fallback = "on",
        .help = "Wait for the display, so that pictures do not tear.", FIELD(view.vsync),
    },
    [OPTION_FRAME_MS] = {
        .name = "frame-ms", .argument = "MS", .type = VALUE_REAL, .min = 1, .max = 1000,
        .group = "Viewer", .commands = FOR_VIEW, .fallback = "33",
        .common = FOR_VIEW, .brief = "Time of a frame to aim at.",
        .help = "Time of a frame to aim at. While the camera moves, the picture is made of fewer "
                "pixels for it.",
        FIELD(view.frame_ms),
    },
    [OPTION_DENOISE] = {
        .name = "denoise", .argument = "on|off", .type = VALUE_SWITCH, .group = "Viewer",
        .commands = FOR_VIEW, .fallback = "off",
        .common = FOR_VIEW, .brief = "Show the image denoised.",
        .help = "Show the picture denoised. What is saved as EXR is not.", FIELD(view.denoise),
    },
    [OPTION_SHADERS] = {
        .name = "shaders", .argument = "DIR", .type = VALUE_TEXT, .group = "Viewer",
        .commands = FOR_VIEW, .fallback = "the source tree that the program was built from",
        .help = "Folder of the kernels' source, which F5 compiles again.", FIELD(view.shaders),
    },
#include "cli/option_rows_compare.h"

    [OPTION_MAN] = {
        .name = "man", .type = VALUE_FLAG, .group = "Format", .commands = FOR_HELP,
        .common = FOR_HELP, .brief = "Print a manual page in roff.",
        .help = "Print a manual page in roff instead of plain text.", FIELD(man),
    },
    [OPTION_COMPLETION] = {
        .name = "completion", .argument = "bash|zsh|fish", .type = VALUE_CHOICE, .group = "Format",
        .commands = FOR_HELP, .common = FOR_HELP, .brief = "Print a shell's script for completion.",
        .help = "Print a script by which this shell completes the command line of lampyris, or with "
                "the command view that of lampyris-view.",
        FIELD(completion),
    },

    [OPTION_JSON] = {
        .name = "json", .type = VALUE_FLAG, .group = "General", .commands = FOR_ALL,
        .common = FOR_BENCH | FOR_COMPARE | FOR_DEVICES | 1u << COMMAND_INFO, .brief = "Print the result as JSON.",
        .help = "Print the result as one JSON object.", FIELD(json),
    },
    [OPTION_QUIET] = {
        .name = "quiet", .short_name = 'q', .type = VALUE_FLAG, .group = "General",
        .commands = FOR_ALL, .help = "No progress and no summary; warnings and errors stay.",
        FIELD(quiet),
    },
    [OPTION_LOG_LEVEL] = {
        .name = "log-level", .argument = "error|warning|note|debug", .type = VALUE_CHOICE,
        .group = "General", .commands = FOR_ALL, .fallback = "warning",
        .help = "What is reported on standard error.", FIELD(log_level),
    },
    [OPTION_HELP] = {
        .name = "help", .short_name = 'h', .type = VALUE_FLAG, .group = "General",
        .commands = FOR_ALL, .help = "Print the options that matter most.", FIELD(help),
    },
    [OPTION_HELP_ALL] = {
        .name = "help-all", .type = VALUE_FLAG, .group = "General", .commands = FOR_ALL,
        .help = "Print all options.", FIELD(help_all),
    },
    [OPTION_VERSION] = {
        .name = "version", .type = VALUE_FLAG, .group = "General", .commands = FOR_ALL,
        .help = "Print the version.", FIELD(version),
    },
};
// clang-format on

const char *option_argument(const struct option_def *def, char out[OPTION_ARGUMENT_MAX])
{
    if (!def->setting)
        return def->argument;
    const struct field *field = &def->setting->field;
    size_t used = 0;
    if (field->type == FIELD_SWITCH)
        return "on|off";
    for (int i = 0; field->type == FIELD_CHOICE && field->words[i] && used < OPTION_ARGUMENT_MAX;
         i++)
        used += (size_t)snprintf(out + used, OPTION_ARGUMENT_MAX - used, "%s%s", i ? "|" : "",
                                 field->words[i]);
    if (field->type != FIELD_CHOICE)
        snprintf(out, OPTION_ARGUMENT_MAX, "%s%s%s", def->setting->argument, field->word ? "|" : "",
                 field->word ? field->word : "");
    return out;
}

// Returns whether submit has an option of render: it passes on what all shards have in common.
static bool is_of_all_shards(const struct option_def *def)
{
    switch ((enum option_id)(def - option_table)) {
    case OPTION_TIME:
    case OPTION_ERROR:
    case OPTION_ADAPTIVE:
    case OPTION_FRAMES:
    case OPTION_SPP_PER_FRAME:
    case OPTION_EVERY:
    case OPTION_ACCUMULATE:
    case OPTION_CHECKPOINT:
    case OPTION_CHECKPOINT_EVERY:
    case OPTION_RESUME:
    case OPTION_SHARD:
    case OPTION_REFERENCE:
    case OPTION_EXPLAIN:
    case OPTION_TRACE:
    case OPTION_TEV:
    case OPTION_PIXEL:
    case OPTION_SAMPLE:
        return false;
    default:
        return def->commands & FOR_RENDER;
    }
}

bool option_belongs(const struct option_def *def, const struct command *command)
{
    return def->commands >> (command - commands) & 1 ||
           (command == &commands[COMMAND_SUBMIT] && is_of_all_shards(def));
}

const char *option_brief(const struct option_def *def, const struct command *command)
{
    if (!option_belongs(def, command))
        return NULL;
    if (def->setting)
        return def->setting->brief;
    return def->common >> (command - commands) & 1 ? def->brief : NULL;
}
