// Rows of option_table: options that divide a picture into shards, and that merge their parts.
// clang-format off
    [OPTION_SHARD] = {
        .name = "shard", .argument = "I/N|FIRST:END|auto", .type = VALUE_TEXT, .group = "Shards",
        .commands = FOR_RENDER, .fallback = "all samples",
        .help = "Render only shard I, from 1, of N: its share of the --spp samples of every pixel, or "
                "the samples FIRST to END - 1. The file of --checkpoint is the part that merge adds to "
                "others. auto takes I and N from Slurm, mpirun or Kubernetes; auto/N gives N for "
                "Kubernetes, which does not report it. In the name of the file, %i and %n stand for I "
                "and N (or FIRST and END). Without --checkpoint, the part is SCENE.I-of-N.part in the "
                "working directory. No picture is written unless -o is given. See docs/scaling.md.",
        FIELD(render.shard_text),
    },
    [OPTION_SHARD_BY] = {
        .name = "shard-by", .argument = "samples|tiles", .type = VALUE_CHOICE, .group = "Shards",
        .commands = FOR_RENDER | FOR_SUBMIT, .fallback = "samples",
        .help = "samples: a shard renders some samples of every pixel, so it shows the whole picture. "
                "tiles: it renders all samples of some rows of pixels, and FIRST and END of --shard "
                "are rows, multiples of 16. Parts by tiles are smaller and may be --adaptive, but "
                "shards with simple content end earlier than others. The merged picture is the same.",
        FIELD(render.shard_by),
    },
    [OPTION_PARTIAL] = {
        .name = "partial", .type = VALUE_FLAG, .group = "Shards", .commands = FOR_MERGE,
        .common = FOR_MERGE, .brief = "Write a picture although samples are missing.",
        .help = "Write the picture of the existing samples if some are missing. Without this option, "
                "merge fails and prints the commands that render the missing samples.",
        FIELD(merge.partial),
    },
    [OPTION_MIXED] = {
        .name = "mixed", .type = VALUE_FLAG, .group = "Shards", .commands = FOR_MERGE,
        .common = FOR_MERGE, .brief = "Accept parts of several devices and drivers.",
        .help = "Accept parts that several devices and drivers rendered. The picture's bits are "
                "then not those of any single device. merge reports whether the devices' pictures "
                "differ by more than their noise.",
        FIELD(merge.mixed),
    },
    [OPTION_STATUS] = {
        .name = "status", .type = VALUE_FLAG, .group = "Shards", .commands = FOR_MERGE,
        .common = FOR_MERGE, .brief = "List the samples of the parts, and merge nothing.",
        .help = "Print which samples each part has, which samples are missing, and the commands that "
                "render them; with --json, all of them. Merge nothing. Only the headers of the parts are read and verified by "
                "their hashes, not the films. Exit with 1 if samples are missing.",
        FIELD(merge.status),
    },
    [OPTION_EXPECT] = {
        .name = "expect", .argument = "HASH", .type = VALUE_TEXT, .group = "Shards",
        .commands = FOR_MERGE, .fallback = "any",
        .help = "Refuse the parts if they are not of the render with this hash: of its scene, its "
                "settings and its samples. submit writes the hash into the batch file of the merge, "
                "so that parts of an earlier render with the same names are not taken for the new "
                "ones.",
        FIELD(merge.expected),
    },
    [OPTION_PARTS] = {
        .name = "parts", .argument = "N", .type = VALUE_COUNT, .min = 1, .max = SETTINGS_SPP_MAX / 2,
        .group = "Shards", .commands = FOR_SUBMIT, .common = FOR_SUBMIT,
        .brief = "Number of shards.",
        .help = "Number of shards. Each is one task of a Slurm array.",
        FIELD(submit.parts),
    },
    [OPTION_SLURM] = {
        .name = "slurm", .argument = "OPTIONS", .type = VALUE_TEXT, .group = "Shards",
        .commands = FOR_SUBMIT, .common = FOR_SUBMIT, .fallback = "none",
        .brief = "Options of sbatch, in one word.",
        .help = "Options of sbatch, in one word: partition, account, time limit, devices. They are "
                "written into both batch files, after the options that submit sets.",
        FIELD(submit.slurm),
    },
    [OPTION_DRY_RUN] = {
        .name = "dry-run", .type = VALUE_FLAG, .group = "Shards", .commands = FOR_SUBMIT,
        .common = FOR_SUBMIT, .brief = "Write the batch files, and submit nothing.",
        .help = "Write the batch files and print the command that would submit them.",
        FIELD(submit.dry_run),
    },
