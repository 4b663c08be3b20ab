#include "cli/commands.h"

#include "base/suggest.h"
#include <string.h>

const struct command commands[COMMAND_TOTAL] = {
    [COMMAND_RENDER] =
        {
            .name = "render",
            .summary = "render a scene to pictures",
            .arguments = "SCENE",
            .description =
                "Renders a scene file (.json, .gltf, .glb, .obj, .ply or .stl) by path tracing, on "
                "any Vulkan device with compute shaders. Settings come from the options, else from "
                "the scene file, else they are the defaults given below. A model without a camera "
                "is framed; one without light is lit by a studio and placed on a ground plane, see "
                "--studio. The summary has the error of the picture, the time and memory that it "
                "took, and the features that were left out. If a signal interrupts the render "
                "(SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR1), it completes the first sample of "
                "every pixel, then writes the picture with the samples that it has, and the "
                "--checkpoint; a second SIGINT or SIGTERM ends it at once. Output files are "
                "replaced only when the new file is complete, and are locked against other runs. "
                "If a picture cannot be written, it is saved as EXR in $TMPDIR.",
            .examples = "lampyris render scenes/cornell.json -o cornell.exr -o cornell.png\n"
                        "lampyris render scenes/models/vase.glb --spp 256 --size 1280x720\n"
                        "lampyris render scenes/models/vase.glb --env scenes/models/gallery.hdr\n"
                        "lampyris render scenes/cornell.json --error 1e-3 --checkpoint c.ck\n"
                        "lampyris render scenes/models/vase.glb --turntable 48 -o turn.mp4",
            .min_arguments = 1,
            .max_arguments = 1,
        },
    [COMMAND_MERGE] =
        {
            .name = "merge",
            .summary = "merge the parts of a picture",
            .arguments = "PART...",
            .description =
                "Adds the parts that render --shard writes, in any order and grouping. The picture "
                "is bit for bit that of one process, and is written as render does. A part is "
                "refused if its scene, settings, seed, version, device or driver differ from those "
                "of the first, if it has samples that another part has, or if it is damaged. "
                "Missing samples are listed with the commands that render them. With --status, "
                "only the headers of the parts are read. This is fast, but only a merge finds "
                "damage of their films. The scene is read "
                "again, so run merge in the working directory of the shards. With --checkpoint, "
                "the sum is written as a part, which can be merged with others; without -o this "
                "needs neither the scene nor a device.",
            .examples = "lampyris render scenes/cornell.json --spp 1024 --shard 2/4\n"
                        "lampyris merge cornell.*.part -o cornell.exr\n"
                        "lampyris merge cornell.*.part --partial -o cornell.png\n"
                        "lampyris merge cornell.*.part --checkpoint some.part\n"
                        "lampyris merge cornell.*.part --status",
            .exits =
                {
                    [EXIT_CODE_OK] = "The picture, or the sum, was written; with --status, no "
                                     "sample is missing.",
                    [EXIT_CODE_CHECK_FAILED] = "Only with --status: samples are missing.",
                    [EXIT_CODE_INPUT] =
                        "The command line is wrong, samples are missing (without --partial), a "
                        "part is damaged, unfinished or does not belong to the others, the scene "
                        "is not that of the parts, or an output is an input. No picture was "
                        "written.",
                    [EXIT_CODE_DEVICE] = "The device that computes the picture from the sum, its "
                                         "driver or the system's memory failed.",
                    [EXIT_CODE_OUTPUT] = "The picture or the sum could not be written.",
                },
            .min_arguments = 1,
            .max_arguments = OPTIONS_PARTS_MAX,
        },
    [COMMAND_SUBMIT] =
        {
            .name = "submit",
            .summary = "let Slurm render a picture in parts",
            .arguments = "SCENE",
            .description =
                "Writes two batch files, SCENE.shards.sh and SCENE.merge.sh, in the working "
                "directory and submits them to Slurm by sbatch: an array of --parts shards, and a "
                "merge that begins when all of them have ended. The options are those of render: "
                "-o is used by the merge, all others by the shards. Slurm starts a shard again if "
                "it is preempted, its node is lost, or its time limit ends; the shard then "
                "continues from its part. Settings that shards refuse on every device, and parts "
                "of "
                "another render under the same names, are refused before anything is submitted. "
                "lampyris merge --status prints the progress of the parts. See "
                "docs/scaling.md.",
            .examples = "lampyris submit scenes/cornell.json --spp 64k --parts 64 -o a.exr\n"
                        "lampyris submit scenes/cornell.json --parts 8 --slurm '--partition=gpu'\n"
                        "lampyris submit scenes/cornell.json --parts 8 --dry-run\n"
                        "lampyris merge --status cornell.[0-9]*.part",
            .exits =
                {
                    [EXIT_CODE_OK] = "The jobs were submitted; with --dry-run, the files were "
                                     "written.",
                    [EXIT_CODE_CHECK_FAILED] = "",
                    [EXIT_CODE_INPUT] = "The command line or the scene is wrong, the shards would "
                                        "refuse the settings, or "
                                        "there are parts of another render. Nothing was submitted.",
                    [EXIT_CODE_DEVICE] = "sbatch is not installed or refused a file, or the "
                                         "system's memory failed.",
                    [EXIT_CODE_OUTPUT] = "A batch file could not be written, or the merge could "
                                         "not write a picture into its folder. Nothing was "
                                         "submitted.",
                },
            .min_arguments = 1,
            .max_arguments = 1,
        },
    [COMMAND_CONVERGE] =
        {
            .name = "converge",
            .summary = "measure error against samples and run time",
            .arguments = "SCENE...",
            .description =
                "Renders each scene with doubling numbers of samples, or for fixed times, several "
                "times with different seeds. Reports the error as a function of samples and of "
                "time: local relMSE with its interval and other metrics, the slope of the curve, "
                "the efficiency, the samples and the time that given errors take, and the bias "
                "that remains. --vary and --curve add curves with other settings; for each pair of "
                "curves the report has the faster one. Replicates of all curves take turns, so "
                "that other load on the machine affects all of them. After a signal the complete "
                "replicates are reported.",
            .examples =
                "lampyris converge scenes/cornell.json --vary sampler=sobol,pcg --report out\n"
                "lampyris converge scenes/veach_mis.json --size 64x48 --vary mis=power,none\n"
                "lampyris converge scenes/veach_mis.json --times 1,2 --curve 'nee=on mis=none'",
            .min_arguments = 1,
            .max_arguments = OPTIONS_ARGUMENTS_MAX,
        },
    [COMMAND_BENCH] =
        {
            .name = "bench",
            .summary = "measure where the time goes",
            .arguments = "SCENE...",
            .description =
                "Renders each scene repeatedly with the same samples (4 per pixel unless --spp is "
                "given). Reports the time of each kernel with its launches, items, share of the "
                "time and variation over repetitions, and the lengths of queues by bounce. --sweep "
                "and --curve add variants, which take turns. Hashes verify that pictures which "
                "must be equal are equal. --kernel times a single kernel.",
            .examples =
                "lampyris bench scenes/cornell.json --sweep wave=4k,16k,64k --report out\n"
                "lampyris bench scenes/glass.json --kernel intersect_closest --rays diffuse\n"
                "lampyris bench scenes/cornell.json --json > before.json\n"
                "lampyris bench scenes/cornell.json --baseline before.json",
            .min_arguments = 1,
            .max_arguments = OPTIONS_ARGUMENTS_MAX,
        },
    [COMMAND_COMPARE] =
        {
            .name = "compare",
            .summary = "measure how far pictures are from a reference",
            .arguments = "IMAGE... REFERENCE",
            .description =
                "Compares pictures x (.exr, .hdr, .pfm, .png or .jpg; PNG and JPEG files are "
                "decoded to linear light; FILE:LAYER is a layer of an EXR file) with a reference r "
                "of the same size. Over all pixels and channels: mse is the mean of (x - r)^2; "
                "rmse is its root; relmse is the mean of (x - r)^2 / (r^2 + 0.01); local-relmse, "
                "which render estimates for its own pictures, is relmse with the mean of r around "
                "each pixel (by SSIM's Gaussian of 1.5 pixels) in place of r in the denominator; "
                "smape is the mean of 2 |x - r| / (|x| + |r| + 1e-6); max is the greatest "
                "difference. psnr (in dB), ssim and flip compare what a display shows: values "
                "clamped and sRGB-encoded. hdr-flip compares over the reference's range of "
                "exposures; it and flip assume 67 pixels a degree. Pixels with a non-finite value "
                "in either picture are counted and left out of the means. mse, relmse and "
                "local-relmse have a 95 % confidence interval. Several pictures are printed as a "
                "table, in which the best value of each column has a star.",
            .examples = "lampyris compare out.exr reference.exr --max relmse=1e-3\n"
                        "lampyris compare a.exr b.exr reference.exr --report page.html\n"
                        "lampyris compare a.exr b.exr reference.exr --reference-variance auto\n"
                        "lampyris compare a.exr b.exr --max differing=0 --difference d.png",
            .min_arguments = 2,
            .max_arguments = OPTIONS_ARGUMENTS_MAX,
        },
    [COMMAND_CHECK] =
        {
            .name = "check",
            .summary = "check a device, or a scene before it is rendered",
            .arguments = "[SCENE]",
            .description =
                "Without a scene, tests the driver and the renderer by cases whose results are "
                "known. Each case is printed with the expected and the measured result, or with "
                "the reason why the device cannot run it; --list lists all cases, and "
                "docs/verification.md describes them. With a scene, finds what makes its picture "
                "wrong, noisy or slow, where it is, its consequence and the remedy, and how long a "
                "render to a given error would take; docs/checking-scenes.md lists the findings. "
                "Exits with 1 if a case fails, or if something makes the scene's picture wrong.",
            .examples = "lampyris check\n"
                        "lampyris check --list\n"
                        "lampyris check scenes/cornell.json\n"
                        "lampyris check scenes/glass.json --error 1e-4 --fix fixed.json",
            .max_arguments = 1,
        },
    [COMMAND_INFO] =
        {
            .name = "info",
            .summary = "describe a scene and what its render needs",
            .arguments = "SCENE",
            .description =
                "Loads a scene and prints its contents, the features that a render would use, and "
                "the device memory that each buffer would take, without rendering. With --device "
                "all, also prints on which devices the scene fits.",
            .examples = "lampyris info scenes/cornell.json\n"
                        "lampyris info scenes/cornell.json --device all\n"
                        "lampyris info scenes/models/vase.glb --size 3840x2160 --json",
            .min_arguments = 1,
            .max_arguments = 1,
        },
    [COMMAND_VIEW] =
        {
            .name = "view",
            .summary = "explore a scene in a window while it converges",
            .arguments = "[SCENE]",
            .description =
                "Opens a window (the program lampyris-view) that shows the scene while it is "
                "rendered, with its error and its cost. The camera can be moved, and all settings, "
                "materials and lights can be changed. F1 shows the panel, whose entries have "
                "explanations; docs/viewer.md lists all keys. With --headless the viewer runs "
                "without a window, for scripts.",
            .examples = "lampyris view scenes/cornell.json\n"
                        "lampyris view scenes/models/vase.glb --env scenes/models/gallery.hdr\n"
                        "lampyris-view scenes/cornell.json --script tour.txt --headless",
            .max_arguments = 1,
        },
    [COMMAND_DEVICES] =
        {
            .name = "devices",
            .summary = "list the Vulkan devices",
            .arguments = "",
            .description = "Lists the Vulkan devices with their drivers, and marks the one that "
                           "would be chosen. A device that runs on the processor is called CPU.",
            .examples = "lampyris devices\n"
                        "lampyris devices --device llvmpipe --json",
        },
    [COMMAND_HELP] =
        {
            .name = "help",
            .summary = "explain the program or a command",
            .arguments = "[COMMAND]",
            .description =
                "Prints all options of a command, or the commands of the program. With --man, a "
                "manual page; with --completion, a script that completes command lines.",
            .examples = "lampyris help render\n"
                        "lampyris help --man | man -l -\n"
                        "eval \"$(lampyris help --completion bash)\"",
            .max_arguments = 1,
        },
};

const struct command *command_find(const char *name, struct err *err)
{
    struct suggestion suggestion = {.wanted = name};
    for (int i = 0; i < COMMAND_TOTAL; i++) {
        if (strcmp(commands[i].name, name) == 0)
            return &commands[i];
        suggest_offer(&suggestion, commands[i].name);
    }
    if (suggestion.nearest)
        err_set(err, ERR_USAGE, "unknown command \"%s\"; did you mean \"%s\"?", name,
                suggestion.nearest);
    else
        err_set(err, ERR_USAGE, "unknown command \"%s\"", name);
    return NULL;
}
