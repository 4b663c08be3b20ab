// Rows of option_table: which part of a picture a process has, and what becomes of the parts.
// clang-format off
    [OPTION_SHARD] = {
        .name = "shard", .argument = "I/N|FIRST:END|auto", .type = VALUE_TEXT, .group = "Shards",
        .commands = FOR_RENDER, .fallback = "all samples",
        .help = "Render part I, from 1, of N parts of the --spp samples of every pixel, or those "
                "from number FIRST up to, but without, END, and keep them in the file of --checkpoint "
                "for merge. auto takes I and N from Slurm, mpirun or Kubernetes; auto/N says N, which "
                "Kubernetes does not. FILE of --checkpoint may have %i and %n, which stand for I and N "
                "(or FIRST and END); where it is not given, the part is SCENE.I-of-N.part in the working "
                "directory. No picture is written unless -o is given. See docs/scaling.md.",
        FIELD(render.shard_text),
    },
    [OPTION_SHARD_BY] = {
        .name = "shard-by", .argument = "samples|tiles", .type = VALUE_CHOICE, .group = "Shards",
        .commands = FOR_RENDER | FOR_SUBMIT, .fallback = "samples",
        .help = "samples: a shard has some samples of every pixel, so that it shows the whole picture. "
                "tiles: it has all samples of some rows of the picture, in multiples of 16; FIRST:END "
                "are these rows then. Parts by tiles take less room, take as long as what is to be "
                "seen in them, and may be --adaptive. The picture is the same.",
        FIELD(render.shard_by),
    },
    [OPTION_PARTIAL] = {
        .name = "partial", .type = VALUE_FLAG, .group = "Shards", .commands = FOR_MERGE,
        .common = FOR_MERGE, .brief = "Write a picture although samples are missing.",
        .help = "Write the picture of the samples that there are, although some are missing. Without "
                "it that is refused, with the commands that render them.",
        FIELD(merge.partial),
    },
    [OPTION_MIXED] = {
        .name = "mixed", .type = VALUE_FLAG, .group = "Shards", .commands = FOR_MERGE,
        .common = FOR_MERGE, .brief = "Parts may be of several devices and drivers.",
        .help = "Accept parts that several devices and drivers rendered. The picture's bits are "
                "then not those of any one device. merge reports whether the devices' pictures "
                "differ by more than their noise.",
        FIELD(merge.mixed),
    },
    [OPTION_STATUS] = {
        .name = "status", .type = VALUE_FLAG, .group = "Shards", .commands = FOR_MERGE,
        .common = FOR_MERGE, .brief = "Say which samples the parts have, and merge nothing.",
        .help = "Say which samples each part has, and which are missing, with the commands that render "
                "them, and merge nothing. Exits with 1 where samples are missing.",
        FIELD(merge.status),
    },
    [OPTION_PARTS] = {
        .name = "parts", .argument = "N", .type = VALUE_COUNT, .min = 1, .max = SETTINGS_SPP_MAX / 2,
        .group = "Shards", .commands = FOR_SUBMIT, .common = FOR_SUBMIT,
        .brief = "Number of shards.",
        .help = "Number of shards, each of which is a task of Slurm.",
        FIELD(submit.parts),
    },
    [OPTION_SLURM] = {
        .name = "slurm", .argument = "OPTIONS", .type = VALUE_TEXT, .group = "Shards",
        .commands = FOR_SUBMIT, .common = FOR_SUBMIT, .fallback = "none",
        .brief = "Options of sbatch, in one word.",
        .help = "Options of sbatch, in one word: partition, account, time limit, devices. They stand in "
                "both batch files, after those of submit.",
        FIELD(submit.slurm),
    },
    [OPTION_DRY_RUN] = {
        .name = "dry-run", .type = VALUE_FLAG, .group = "Shards", .commands = FOR_SUBMIT,
        .common = FOR_SUBMIT, .brief = "Write the batch files, and submit nothing.",
        .help = "Write the batch files, and print the command that submits them.",
        FIELD(submit.dry_run),
    },
