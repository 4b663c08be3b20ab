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

#define MOST_BYTES (UINT64_C(1) << 40) // more memory than any device has

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
        .fallback = "the scene's name with .exr, in the working directory, and also with .png if "
                    "standard output is a terminal; no picture for a shard, or for merge with "
                    "--checkpoint",
        .common = FOR_RENDER | FOR_MERGE | FOR_SUBMIT,
        .brief = "Write FILE, .exr, .png, .jpg, .hdr or .pfm; several may be given.",
        .help = "Write the picture to FILE. Its extension chooses the format: .exr, .hdr and .pfm "
                "are linear, .png and .jpg are tone-mapped. May be given several times. Pictures of "
                "--turntable and --at START:END:FPS are numbered from 1, in place of #### or %04d "
                "in FILE, or before its extension; .mp4 and .webm are videos made by ffmpeg.",
    },
    [OPTION_SIZE] = {
        .name = "size", .argument = "WxH", .type = VALUE_SIZE, .min = 1, .max = SETTINGS_SIZE_MAX,
        .group = "Picture",
        .commands = FOR_SCENE, .fallback = "that of the scene file, else 512x512",
        .common = FOR_SCENE, .brief = "Width and height in pixels.",
        .help = "Width and height in pixels; the picture may have at most 2^31 pixels. The "
                "viewer's window has 1280x720 pixels by default.",
        .offset = offsetof(struct options, scene.settings.width), .size = 2 * sizeof(uint32_t),
    },
    [OPTION_CROP] = {
        .name = "crop", .argument = "X0,Y0,X1,Y1", .type = VALUE_WINDOW, .min = 0, .max = SETTINGS_SIZE_MAX,
        .group = "Picture", .commands = FOR_RENDER, .fallback = "the whole picture",
        .help = "Render only the window of columns X0 to X1 - 1 and rows Y0 to Y1 - 1. Its pixels "
                "have the same bits as in the whole picture of --size. EXR files store the "
                "position of the window (data window and display window). The error is that of "
                "the window.",
        FIELD(render.crop),
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
        .help = "Layers of the EXR files in addition to the radiance: albedo, normal, "
                "normal_geometric, depth, position, ids and alpha of the first surface; emission, "
                "direct and indirect light; steps of camera rays; samples, variance, halves; or "
                "all. See docs/output.md.",
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
        .help = "Stop after about this many seconds of rendering, at a whole number of samples per "
                "pixel, or earlier if --spp or --frames is reached. At least one sample per pixel "
                "is rendered.",
        FIELD(render.time_seconds),
    },
    [OPTION_ERROR] = {
        .name = "error", .argument = "E", .type = VALUE_REAL, .min = 1e-12, .max = 1e6,
        .group = "Sampling", .commands = FOR_RENDER | FOR_CHECK, .fallback = "no limit",
        .common = FOR_RENDER, .brief = "Stop when the error (local relMSE) is below E.",
        .help = "Stop when the local relMSE (the mean squared error relative to the mean around "
                "each pixel) is below E with 95 % confidence. The error is estimated from 2 "
                "samples per pixel on, whenever it may be low enough. The render ends at --spp "
                "(65536 if not given) or --time at the latest. check prints what a render to this "
                "error would take; its default is 0.001.",
        FIELD(render.error),
    },
    [OPTION_ADAPTIVE] = {
        .name = "adaptive", .argument = "on|off", .type = VALUE_SWITCH, .group = "Sampling",
        .commands = FOR_RENDER, .fallback = "off",
        .help = "Distribute the samples over tiles of 16 x 16 pixels by their error: --spp on "
                "average, at least a quarter and at most 16 times as many. The errors are "
                "estimated from 16 additional samples per pixel, which are not part of the "
                "picture.",
        FIELD(render.adaptive),
    },

    [OPTION_CAMERA] = {
        .name = "camera", .argument = "NAME|INDEX", .type = VALUE_TEXT, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "the first one",
        .common = FOR_RENDER | FOR_VIEW | FOR_CONVERGE | 1u << COMMAND_INFO,
        .brief = "One of the scene's cameras.",
        .help = "The scene's camera to use, by name or by number from 0.", FIELD(scene.camera),
    },
    [OPTION_APERTURE] = {
        .name = "aperture", .argument = "MM", .type = VALUE_REAL, .min = 0,
        .max = SCENE_LENS_MAX_MM, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "the camera's",
        .help = "Radius of the camera's lens in millimetres; 0 is a pinhole camera.",
        FIELD(scene.aperture_mm),
    },
    [OPTION_FOCUS_DISTANCE] = {
        .name = "focus-distance", .argument = "METRES", .type = VALUE_REAL,
        .min = SCENE_LENGTH_MIN, .max = SCENE_COORDINATE_MAX, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "the camera's",
        .help = "Distance in metres, along the line of sight, of the plane in focus.",
        FIELD(scene.focus_distance),
    },
    [OPTION_SCENE] = {
        .name = "scene", .argument = "NAME|INDEX", .type = VALUE_TEXT, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "the one that the file names, else the first",
        .common = 1u << COMMAND_INFO, .brief = "One of the scenes of a glTF file.",
        .help = "The scene of a glTF file to use, by name or by number from 0.",
        FIELD(scene.gltf_scene),
    },
    [OPTION_ANIMATION] = {
        .name = "animation", .argument = "NAME|INDEX", .type = VALUE_TEXT, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "none; with --at, the first",
        .help = "The animation of a glTF file to use, by name or by number from 0. Without --at, "
                "its first moment is shown.",
        FIELD(scene.animation),
    },
    [OPTION_AT] = {
        .name = "at", .argument = "SECONDS|START:END:FPS", .type = VALUE_AT, .min = 0, .max = OPTION_TIME_MAX,
        .group = "Scene", .commands = FOR_SCENE,
        .fallback = "no animation",
        .help = "Show the animation of a glTF file at this time. Before its first keyframe and "
                "after its last one, nothing moves. With START:END:FPS, render writes numbered "
                "pictures of the animation: the first at START, FPS per second, without END.",
    },
    [OPTION_VARIANT] = {
        .name = "variant", .argument = "NAME", .type = VALUE_TEXT, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "the default materials",
        .common = 1u << COMMAND_INFO, .brief = "One of the material variants of a glTF file.",
        .help = "The material variant of a glTF file (KHR_materials_variants), by name.",
        FIELD(scene.variant),
    },
    [OPTION_ENV] = {
        .name = "env", .argument = "FILE|R,G,B|sky:...", .type = VALUE_ENVIRONMENT,
        .group = "Scene", .commands = FOR_SCENE, .fallback = "the scene's",
        .common = FOR_RENDER | FOR_VIEW | FOR_CONVERGE | FOR_CHECK,
        .brief = "Environment: an image, a radiance, or a sky.",
        .help = "The environment of the scene: a latitude-longitude picture, a constant radiance "
                "in W/(sr m^2), or Preetham's sky with its sun, as in "
                "sky:turbidity=3,elevation=45. Its keys are turbidity (2 to 10), elevation and "
                "azimuth of the sun (degrees; 0 is +X, 90 is +Z), albedo of the ground, diameter "
                "of the sun (degrees) and sun (0 leaves it out). If the name of a file looks like "
                "a radiance, write it as ./1,1,1.",
    },
    [OPTION_ENV_ROTATE] = {
        .name = "env-rotate", .argument = "DEGREES", .type = VALUE_REAL,
        .min = -SCENE_TURN_MAX, .max = SCENE_TURN_MAX,
        .group = "Scene", .commands = FOR_SCENE, .fallback = "0",
        .help = "Rotate the environment about +Y, counter-clockwise seen from above, in "
                "addition to the scene's own rotation.",
        FIELD(scene.environment_rotate_degrees),
    },
    [OPTION_ENV_STRENGTH] = {
        .name = "env-strength", .argument = "X", .type = VALUE_REAL, .min = 0,
        .max = SCENE_RADIANCE_MAX,
        .group = "Scene", .commands = FOR_SCENE, .fallback = "1",
        .help = "Multiply the radiance of the environment by X.", FIELD(scene.environment_strength),
    },
    [OPTION_STUDIO] = {
        .name = "studio", .argument = "off|auto|on", .type = VALUE_CHOICE, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "auto",
        .common = FOR_VIEW, .brief = "Light the scene with a studio.",
        .help = "Light the scene with a built-in studio of soft key, fill and rim lights. auto: "
                "if a model has no light or too little, but not if a scene file has a camera. on: "
                "always, in place of the scene's environment. off: never; a scene without light "
                "gets a constant environment of radiance 1.",
        FIELD(scene.studio),
    },
    [OPTION_GROUND] = {
        .name = "ground", .argument = "auto|on|off", .type = VALUE_CHOICE, .group = "Scene",
        .commands = FOR_SCENE,
        .fallback = "auto: with the studio, unless a camera is below the plane",
        .help = "Add a plane below the model, which receives its shadow.", FIELD(scene.ground),
    },
    [OPTION_UP] = {
        .name = "up", .argument = "y|x|z", .type = VALUE_CHOICE, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "y",
        .help = "The axis that points up, for the camera, the studio and the ground of a model "
                "that has none of its own. The model itself is not changed.",
        FIELD(scene.up),
    },
    [OPTION_ANISOTROPY] = {
        .name = "anisotropy", .argument = "on|off", .type = VALUE_SWITCH, .group = "Scene",
        .commands = FOR_SCENE, .fallback = "on",
        .help = "Off: all materials are isotropic, whatever their files specify.",
        FIELD(scene.anisotropy),
    },
    [OPTION_DEFINE] = {
        .name = "define", .short_name = 'D', .argument = "KEY=VALUE", .type = VALUE_DEFINE,
        .group = "Scene", .commands = FOR_SCENE,
        .common = FOR_SCENE, .brief = "Replace a value of a JSON scene.",
        .help = "Replace a value of a JSON scene. KEY is its \"define\" name or its dotted path, "
                "as in film.exposure=1. May be given several times.",
    },
    [OPTION_STRICT] = {
        .name = "strict", .type = VALUE_FLAG, .group = "Scene", .commands = FOR_SCENE,
        .help = "Fail if a texture or a material library (MTL) is missing, instead of rendering it "
                "pink or grey with a warning.", FIELD(scene.strict),
    },
    [OPTION_ALLOW_OUTSIDE_PATHS] = {
        .name = "allow-outside-paths", .type = VALUE_FLAG, .group = "Scene",
        .commands = FOR_SCENE,
        .help = "Let scene files refer to files outside their own folder. Use this only for scenes "
                "that you trust.",
        FIELD(scene.allow_outside_paths),
    },

#include "cli/option_rows_frames.h"

    [OPTION_CHECKPOINT] = {
        .name = "checkpoint", .argument = "FILE", .type = VALUE_TEXT, .group = "Frames",
        .commands = FOR_RENDER | FOR_MERGE, .fallback = "none is written",
        .common = FOR_RENDER | FOR_MERGE,
        .brief = "Save the render in FILE, for --resume or merge.",
        .help = "Save the state of the render in FILE from time to time, after a signal and at the "
                "end, so that it can be continued later. FILE must not exist, except with "
                "--resume. merge writes the sum of its parts to FILE, which is again a part.",
        FIELD(render.checkpoint),
    },
    [OPTION_CHECKPOINT_EVERY] = {
        .name = "checkpoint-every", .argument = "SECONDS", .type = VALUE_REAL, .min = 0,
        .max = OPTION_TIME_MAX, .group = "Frames", .commands = FOR_RENDER,
        .fallback = "as often as 2 % of the time permits, and at least every 60 s",
        .help = "Time between two checkpoints; 0: one after every wave. With mpirun, 0 lets each rank "
                "also save its samples after each of its blocks, in FILE.blocks-*, so that no "
                "finished block is lost with a rank.",
        FIELD(render.checkpoint_seconds),
    },
    [OPTION_RESUME] = {
        .name = "resume", .type = VALUE_FLAG, .group = "Frames", .commands = FOR_RENDER,
        .common = FOR_RENDER, .brief = "Continue from --checkpoint, to the same bits.",
        .help = "Continue from the file of --checkpoint, or begin if it does not exist. The "
                "picture is bit for bit that of an uninterrupted run, whatever --wave is. The "
                "scene, the device and the settings must be those of the checkpoint; --spp, "
                "--time, --error, --frames and the outputs may differ. With --turntable and --at "
                "START:END:FPS: skip the pictures that are finished, according to the metadata of "
                "their files (EXR, PNG); files of another sequence are an error.",
        FIELD(render.resume),
    },

#include "cli/option_rows_shards.h"

    [OPTION_REPLICATES] = {
        .name = "replicates", .argument = "N", .type = VALUE_COUNT, .min = 2, .max = 4096,
        .group = "Curves", .commands = FOR_CONVERGE, .fallback = "16",
        .common = FOR_CONVERGE, .brief = "Independent runs of each curve.",
        .help = "Number of independent runs of each curve, with seeds from --seed on. Confidence "
                "intervals are computed from their variation.",
        FIELD(converge.replicates),
    },
    [OPTION_REFERENCE] = {
        .name = "reference", .argument = "FILE|auto|none", .type = VALUE_TEXT, .group = "Curves",
        .commands = FOR_RENDER | FOR_CONVERGE, .fallback = "auto; for render, none",
        .common = FOR_CONVERGE, .brief = "The image against which errors are measured.",
        .help = "The reference against which errors are measured: the picture FILE (its own noise "
                "is subtracted if it has the layers of --aov halves or variance); auto, which "
                "renders a reference with a hundred times the samples and prints its cost in "
                "advance; or none: errors are then estimated from the half-buffers, without bias. "
                "render accepts only FILE.",
        FIELD(reference),
    },
    [OPTION_REFERENCE_FROM] = {
        .name = "reference-from", .argument = "FILE", .type = VALUE_TEXT, .group = "Curves",
        .commands = FOR_CONVERGE, .fallback = "--reference",
        .help = "Read the reference from a file of an earlier run with --images, or of another "
                "renderer. It must have the scene's size. Its own noise is subtracted if it has "
                "the layers half_a and half_b, or variance (the variance of each value); otherwise "
                "its noise is not known.",
        FIELD(reference),
    },
    [OPTION_VARY] = {
        .name = "vary", .argument = "KEY=A,B,...", .type = VALUE_VARY, .group = "Curves",
        .commands = FOR_CONVERGE, .fallback = "one curve",
        .common = FOR_CONVERGE, .brief = "A curve for each value, as in sampler=sobol,pcg.",
        .help = "Measure a curve for each value of an option that affects how pictures are "
                "computed, as in sampler=sobol,pcg. If given several times, all combinations are "
                "measured.",
    },
    [OPTION_CURVE] = {
        .name = "curve", .argument = "'KEY=VALUE KEY=VALUE'", .type = VALUE_CURVE,
        .group = "Curves", .commands = FOR_CONVERGE | FOR_BENCH, .fallback = "none",
        .common = FOR_CONVERGE | FOR_BENCH, .brief = "A curve, or a variant, with several options.",
        .help = "Add a curve, or a variant of a benchmark, with several options, as in 'nee=on "
                "mis=none'. May be given several times. The curves of --vary or --sweep follow.",
    },
    [OPTION_SPP_FROM] = {
        .name = "spp-from", .argument = "N", .type = VALUE_COUNT, .min = 1,
        .max = SETTINGS_SPP_MAX, .group = "Curves", .commands = FOR_CONVERGE, .fallback = "16",
        .common = FOR_CONVERGE, .brief = "Samples per pixel of the first point.",
        .help = "Samples per pixel of the first point; each further point has twice as many, up to "
                "--spp (256 if not given).",
        FIELD(converge.spp_from),
    },
    [OPTION_TIMES] = {
        .name = "times", .argument = "SECONDS,...", .type = VALUE_TIMES, .min = 0.001,
        .max = OPTION_TIME_MAX, .group = "Curves", .commands = FOR_CONVERGE,
        .fallback = "points at doubling numbers of samples",
        .common = FOR_CONVERGE, .brief = "Place the points at these rendering times.",
        .help = "Place the points of the curves at these rendering times, in ascending order, "
                "instead of at numbers of samples. Each point has a whole number of samples per "
                "pixel. Methods that need this number in advance (the samplers stratified, grid "
                "and blue-noise, and contiguous halves) render as many samples as are expected to "
                "fit, according to the time of earlier ones.",
    },

    [OPTION_SWEEP] = {
        .name = "sweep", .argument = "KEY=A,B,...", .type = VALUE_VARY, .group = "Benchmark",
        .commands = FOR_BENCH, .fallback = "one variant",
        .common = FOR_BENCH, .brief = "A variant for each value, as in wave=4k,64k.",
        .help = "Measure a variant for each value of an option, as in wave=4k,16k,64k, "
                "workgroup=32,64, node=quantised,float or spp=1,4. If given several times, all "
                "combinations are measured.",
    },
    [OPTION_REPEATS] = {
        .name = "repeats", .argument = "N", .type = VALUE_COUNT, .min = 2, .max = 10000,
        .group = "Benchmark", .commands = FOR_BENCH, .fallback = "7",
        .common = FOR_BENCH, .brief = "Timed runs of each variant.",
        .help = "Number of timed runs of each variant, after runs that only warm up. The variants "
                "take turns.",
        FIELD(bench.repeats),
    },
    [OPTION_KERNEL] = {
        .name = "kernel", .argument = "NAME", .type = VALUE_TEXT, .group = "Benchmark",
        .commands = FOR_BENCH, .fallback = "all kernels of a render",
        .common = FOR_BENCH, .brief = "Time only this kernel.",
        .help = "Time only this kernel, on the queues that it gets in a render, recorded from a "
                "wave in the middle of the picture. NAME is a kernel that \"lampyris bench\" "
                "lists, or resolve.",
        FIELD(bench.kernel),
    },
    [OPTION_RAYS] = {
        .name = "rays", .argument = "primary|diffuse|shadow,...", .type = VALUE_RAYS,
        .group = "Benchmark", .commands = FOR_BENCH, .fallback = "those of the kernel",
        .common = FOR_BENCH, .brief = "Rays that --kernel traces.",
        .help = "The rays that --kernel traces: camera rays (primary) or rays scattered by "
                "surfaces (diffuse), which intersect_closest traces, or shadow rays, which "
                "intersect_shadow traces. --kernel may name either of the two.",
    },
    [OPTION_DEPTH] = {
        .name = "depth", .argument = "N,...", .type = VALUE_DEPTHS, .min = 0,
        .max = SETTINGS_BOUNCES_MAX, .group = "Benchmark", .commands = FOR_BENCH,
        .fallback = "0, and 1 for diffuse rays",
        .help = "The number of bounces after which the queues for --kernel are recorded. For "
                "shadow rays, the index, from 0, of the path's surface at which they begin.",
    },
    [OPTION_BASELINE] = {
        .name = "baseline", .argument = "FILE", .type = VALUE_TEXT, .group = "Benchmark",
        .commands = FOR_BENCH, .fallback = "none",
        .common = FOR_BENCH, .brief = "Compare with the JSON of an earlier run.",
        .help = "Compare with the JSON output of an earlier run, and report what is significantly "
                "slower or faster. Exit with 1 if something is slower.",
        FIELD(bench.baseline),
    },
    [OPTION_ERROR_BY] = {
        .name = "error-by", .argument = "part,bounce,emitter", .type = VALUE_KINDS,
        .group = "Report", .commands = FOR_RENDER | FOR_CONVERGE, .fallback = "none",
        .help = "Split the error by its sources: by part (visible emission, direct and indirect "
                "light), by the number of bounces (scattering events), by the kind of emitter, or "
                "by several of these. render also lists the ten brightest contributions, each with "
                "the command that follows its path. The picture is not changed.",
        FIELD(error_by),
    },
    [OPTION_EXPLAIN] = {
        .name = "explain", .type = VALUE_FLAG, .group = "Report", .commands = FOR_RENDER,
        .help = "List each feature, lobe, kind of light, kernel and buffer that this render leaves "
                "out, with the reason and the bytes and SPIR-V instructions that this saves. Also "
                "print details that the summary omits.",
        FIELD(render.explain),
    },
    [OPTION_TRACE] = {
        .name = "trace", .argument = "FILE", .type = VALUE_TEXT, .group = "Report",
        .commands = FOR_RENDER, .fallback = "none",
        .help = "Write the error after 1, 2, 4, ... samples per pixel and at the end, with the "
                "rendering time, to FILE (.csv or .json). With --reference, also write the "
                "measured error. The picture is not changed.",
        FIELD(render.trace),
    },
    [OPTION_TEV] = {
        .name = "tev", .argument = "HOST:PORT", .type = VALUE_TEXT, .group = "Report",
        .commands = FOR_RENDER, .fallback = "none",
        .help = "Send the picture, while it is rendered, to the viewer tev, which listens on port "
                "14158 by default. If only \":PORT\" or \"PORT\" is given, HOST is 127.0.0.1; an "
                "IPv6 address is written [::1]:14158. If nobody listens there, the render "
                "continues without tev. The picture is not changed.",
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
        .help = "Print each case with a description and the expected result, and run none.",
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
        .help = "Run the cases of the group bits, including the long ones: they render a picture "
                "with other wave sizes, divisions of its samples, features and limits. Print the "
                "hashes of the pictures, and a sentence for use in a paper.",
        FIELD(check.reproducible),
    },
    [OPTION_FIX] = {
        .name = "fix", .argument = "OUT.json", .type = VALUE_TEXT, .group = "Cases",
        .commands = FOR_CHECK, .fallback = "none",
        .common = FOR_CHECK, .brief = "Write the scene with harmless remedies applied.",
        .help = "Write the scene to OUT.json with all harmless remedies applied: those that remove "
                "an error, or an object without effect, and do not change the picture otherwise. "
                "check lists the remedies. Changes of the scene by other options are written, too. "
                "Exit with 0 if nothing is wrong in the written file, else with 1.",
        FIELD(check.fix),
    },
    [OPTION_REPORT] = {
        .name = "report", .argument = "FOLDER|FILE", .type = VALUE_TEXT, .group = "Report",
        .commands = FOR_CONVERGE | FOR_BENCH | FOR_CHECK | FOR_COMPARE, .fallback = "none",
        .common = FOR_CONVERGE | FOR_BENCH | FOR_CHECK | FOR_COMPARE,
        .brief = "Write an HTML report here.",
        .help = "converge and bench write report.html with plots (by gnuplot), tables and "
                "pictures, results.csv and results.json into this folder. check writes its cases, "
                "or its findings in a scene, with pictures into this .html file. compare writes a "
                "viewer of the pictures and their errors, with tables, insets and plots, into this "
                ".html file.",
        FIELD(study.report),
    },
    [OPTION_IMAGES] = {
        .name = "images", .type = VALUE_FLAG, .group = "Report", .commands = FOR_CONVERGE,
        .common = FOR_CONVERGE, .brief = "Write every image into the report's folder.",
        .help = "Write the pictures of all replicates and the references into the report's folder, "
                "as EXR, and the parts of report.html, as PNG, SVG and gnuplot scripts.",
        FIELD(converge.images),
    },

    [OPTION_DEVICE] = {
        .name = "device", .argument = "INDEX,...|NAME|all", .type = VALUE_TEXT, .group = "Device",
        .commands = FOR_SCENE | FOR_DEVICES | FOR_MERGE,
        .fallback = "the first device of the fastest kind",
        .common = FOR_SCENE | FOR_DEVICES, .brief = "Vulkan device, by its number or name.",
        .help = "The device, by its number in \"lampyris devices\" or by a part of its name (a number of "
                "one or two digits is never part of a name). "
                "render accepts several numbers, as in 0,1: these devices share the samples of the "
                "picture. Devices of the same kind with the same driver render the same bits as "
                "one of them alone. See docs/scaling.md. info accepts \"all\", and prints on which "
                "devices the scene fits.",
        FIELD(device.gpu.device),
    },
    [OPTION_WAVE] = {
        .name = "wave", .argument = "N", .type = VALUE_COUNT, .min = 64, .max = 16777216,
        .group = "Device",
        .commands = FOR_SCENE, .fallback = "chosen by the kind of device and by speed",
        .common = FOR_BENCH | 1u << COMMAND_INFO, .brief = "Number of paths in flight.",
        .help = "Number of paths in flight. It changes memory and speed, but no bit of the "
                "picture. The default is 2^20 on GPUs. On CPU drivers it is 64k for small "
                "pictures; from 2^18 pixels on, waves of 16k, 64k and 256k paths are tried, and "
                "the fastest size is used.",
        FIELD(device.wave),
    },
    [OPTION_WORKGROUP] = {
        .name = "workgroup", .argument = "N", .type = VALUE_COUNT, .min = 8, .max = 1024,
        .group = "Device", .commands = FOR_SCENE, .fallback = "chosen by the kind of device",
        .help = "Threads per workgroup, a power of two. It changes the speed, but no bit of the "
                "picture.",
        FIELD(device.workgroup),
    },
    [OPTION_MEMORY] = {
        .name = "memory", .argument = "BYTES", .type = VALUE_COUNT, .min = 1 << 20, .max = MOST_BYTES,
        .group = "Device", .commands = FOR_SCENE | FOR_COMPARE | FOR_MERGE,
        .fallback = "three quarters of the available memory",
        .help = "Limit of the host memory for scenes, pictures and hierarchies. A scene that needs "
                "more is refused before its memory is allocated. Available memory is what the "
                "machine, its control groups and ulimit leave free. K, M or G may follow the "
                "number: 8G is 8 GiB.",
        FIELD(memory),
    },
    [OPTION_REOPEN] = {
        .name = "reopen", .argument = "N", .type = VALUE_COUNT, .min = 0, .max = 1000,
        .group = "Device", .commands = FOR_RENDER, .fallback = "2",
        .help = "Number of times that a lost device is opened again. Rendering then continues from "
                "the last copy of the film, and the picture is the same.",
        FIELD(render.reopens),
    },
    [OPTION_VALIDATION] = {
        .name = "validation", .type = VALUE_FLAG, .group = "Device", .commands = FOR_SCENE,
        .help = "Enable the Vulkan validation layers, including synchronization validation. This "
                "is slow.",
        FIELD(device.gpu.validation),
    },

    [OPTION_PIXEL] = {
        .name = "pixel", .argument = "X,Y", .type = VALUE_PAIR, .min = 0,
        .max = SETTINGS_SIZE_MAX - 1, .group = "Replay", .commands = FOR_RENDER,
        .help = "Instead of rendering, follow one path through this pixel, counted from the top "
                "left, and print all its vertices.",
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
        .help = "Compile only the features that the scene needs into the kernels, or all of them.",
        FIELD(device.features),
    },
    [OPTION_CLASSES] = {
        .name = "classes", .argument = "sorted|merged", .type = VALUE_CHOICE,
        .group = "Kernels", .commands = FOR_SCENE, .fallback = "sorted",
        .help = "Shade each class of surfaces (diffuse, principled, transmissive, classical) by a "
                "separate kernel, or all classes by one kernel. The picture is the same.",
        FIELD(device.classes),
    },
    [OPTION_BVH] = {
        .name = "bvh", .argument = "sah|median|mean|spatial|middle", .type = VALUE_CHOICE,
        .group = "Kernels", .commands = FOR_SCENE, .fallback = "sah",
        .help = "How triangles are split to build the hierarchy: by the surface area heuristic "
                "(SAH), at the median or at the mean of their centres, by SAH with spatial splits, "
                "which put a triangle into several boxes where that reduces the cost, or in the "
                "middle of the box. The picture is the same.",
        FIELD(device.bvh.split),
    },
    [OPTION_NODE] = {
        .name = "node", .argument = "quantised|float", .type = VALUE_CHOICE, .group = "Kernels",
        .commands = FOR_SCENE, .fallback = "quantised",
        .help = "Store the boxes of the hierarchy as bytes (64 bytes per node) or as floats (128 "
                "bytes). The picture is the same.",
        FIELD(device.bvh.format),
    },
    [OPTION_BVH_OPTIMIZE] = {
        .name = "bvh-optimize", .argument = "normal|off|long", .type = VALUE_CHOICE,
        .group = "Kernels", .commands = FOR_SCENE, .fallback = "normal",
        .help = "After building the hierarchy, move subtrees to better places: for a limited time "
                "(normal), not at all (off), or until the cost no longer decreases (long). The "
                "picture is the same.",
        FIELD(device.bvh.optimize),
    },
    [OPTION_BVH_LEAF] = {
        .name = "bvh-leaf", .argument = "N", .type = VALUE_COUNT, .min = 1, .max = BVH_LEAF_MAX,
        .group = "Kernels", .commands = FOR_SCENE, .fallback = "2",
        .help = "Greatest number of triangles in a leaf of the hierarchy, 1 to 8. The picture is "
                "the same.",
        FIELD(device.bvh.max_leaf),
    },
    [OPTION_BVH_COSTS] = {
        .name = "bvh-costs", .argument = "T,I", .type = VALUE_REAL_PAIR, .min = BVH_COST_MIN,
        .max = BVH_COST_MAX, .group = "Kernels", .commands = FOR_SCENE, .fallback = "1,1",
        .help = "The assumed costs of visiting a node and of intersecting a primitive, by which "
                "--bvh sah and spatial decide between leaves and nodes; only their ratio matters. "
                "In lists write T:I, as in --sweep bvh-costs=1:1,1:4. The picture is the same.",
        .offset = offsetof(struct options, device.bvh.traversal_cost), .size = 2 * sizeof(double),
    },
    [OPTION_BVH_CACHE] = {
        .name = "bvh-cache", .argument = "DIR", .type = VALUE_TEXT, .group = "Kernels",
        .commands = FOR_SCENE,
        .help = "Store hierarchies in this folder, and load them from there if the same geometry "
                "is rendered again.",
        FIELD(device.bvh_cache),
    },
    [OPTION_INSTANCES] = {
        .name = "instances", .argument = "auto|on|off", .type = VALUE_CHOICE, .group = "Kernels",
        .commands = FOR_SCENE, .fallback = "auto",
        .help = "Store a mesh only once, with a separate hierarchy, for all its instances: if that "
                "saves memory or time (auto), always (on), or never (off). Pictures differ only by "
                "rounding errors.",
        FIELD(device.instances),
    },

    [OPTION_FAIL_ALLOCATION] = {
        .name = "fail-allocation", .argument = "N", .type = VALUE_COUNT, .min = 1,
        .max = UINT32_MAX, .is_for_tests = true, .group = "Faults, for tests",
        .commands = FOR_RENDER | FOR_VIEW,
        .help = "Make the N-th allocation of device memory fail.",
        FIELD(device.gpu.fail_allocation),
    },
    [OPTION_LOSE_DEVICE] = {
        .name = "lose-device", .argument = "N", .type = VALUE_COUNT, .min = 1,
        .max = UINT32_MAX, .is_for_tests = true, .group = "Faults, for tests",
        .commands = FOR_RENDER | FOR_CHECK | FOR_VIEW,
        .help = "Lose the device at the N-th submission of commands, and again each time after it "
                "was opened again.",
        FIELD(device.gpu.lose_device_at_submit),
    },
    [OPTION_LOSE_DEVICES] = {
        .name = "lose-devices", .argument = "N", .type = VALUE_COUNT, .min = 1,
        .max = UINT32_MAX, .is_for_tests = true, .group = "Faults, for tests",
        .commands = FOR_RENDER | FOR_CHECK,
        .fallback = "every time",
        .help = "Number of times that --lose-device loses the device; afterwards it works.",
        FIELD(device.gpu.devices_to_lose),
    },

    [OPTION_SCRIPT] = {
        .name = "script", .argument = "FILE", .type = VALUE_TEXT, .group = "Viewer",
        .commands = FOR_VIEW, .fallback = "none",
        .common = FOR_VIEW, .brief = "Run the commands in FILE, one per line.",
        .help = "Run the commands in FILE, one per line. They press keys, move the mouse, change "
                "values and save pictures (see docs/viewer.md). The viewer ends after the last "
                "command, or with exit code 1 at the first command that fails.",
        FIELD(view.script),
    },
    [OPTION_HEADLESS] = {
        .name = "headless", .type = VALUE_FLAG, .group = "Viewer", .commands = FOR_VIEW,
        .common = FOR_VIEW, .brief = "Open no window; for --script.",
        .help = "Run without a window, for scripts; pictures are drawn in memory. Needs --script.",
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
        .common = FOR_VIEW, .brief = "Target for the time of a frame.",
        .help = "Target for the time of a frame, in milliseconds. While the camera moves, fewer "
                "pixels are rendered to reach it.",
        FIELD(view.frame_ms),
    },
    [OPTION_DENOISE] = {
        .name = "denoise", .argument = "on|off", .type = VALUE_SWITCH, .group = "Viewer",
        .commands = FOR_VIEW, .fallback = "off",
        .common = FOR_VIEW, .brief = "Show the image denoised.",
        .help = "Denoise the displayed picture. Pictures saved as EXR are not denoised.",
        FIELD(view.denoise),
    },
    [OPTION_SHADERS] = {
        .name = "shaders", .argument = "DIR", .type = VALUE_TEXT, .group = "Viewer",
        .commands = FOR_VIEW, .fallback = "the source tree that the program was built from",
        .help = "Folder of the kernels' source code, which F5 compiles again.", FIELD(view.shaders),
    },
#include "cli/option_rows_compare.h"

    [OPTION_MAN] = {
        .name = "man", .type = VALUE_FLAG, .group = "Format", .commands = FOR_HELP,
        .common = FOR_HELP, .brief = "Print a manual page in roff.",
        .help = "Print a manual page in roff instead of plain text.", FIELD(man),
    },
    [OPTION_COMPLETION] = {
        .name = "completion", .argument = "bash|zsh|fish", .type = VALUE_CHOICE, .group = "Format",
        .commands = FOR_HELP, .common = FOR_HELP, .brief = "Print a completion script for a shell.",
        .help = "Print a script with which this shell completes command lines of lampyris; with "
                "the command view, those of lampyris-view.",
        FIELD(completion),
    },

    [OPTION_JSON] = {
        .name = "json", .type = VALUE_FLAG, .group = "General", .commands = FOR_ALL,
        .common = FOR_BENCH | FOR_COMPARE | FOR_DEVICES | 1u << COMMAND_INFO,
        .brief = "Print the result as JSON.",
        .help = "Print the result as one JSON object.", FIELD(json),
    },
    [OPTION_QUIET] = {
        .name = "quiet", .short_name = 'q', .type = VALUE_FLAG, .group = "General",
        .commands = FOR_ALL, .help = "Print only warnings and errors.",
        FIELD(quiet),
    },
    [OPTION_LOG_LEVEL] = {
        .name = "log-level", .argument = "error|warning|note|debug", .type = VALUE_CHOICE,
        .group = "General", .commands = FOR_ALL, .fallback = "warning",
        .help = "Least severe messages to print.",
        FIELD(log_level),
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

// Returns whether submit passes on an option of render. It passes on those that all shards have in
// common.
static bool is_of_all_shards(const struct option_def *def)
{
    switch ((enum option_id)(def - option_table)) {
    case OPTION_CROP:
    case OPTION_TIME:
    case OPTION_ERROR:
    case OPTION_TURNTABLE:
    case OPTION_FPS:
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
