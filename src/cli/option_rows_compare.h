// Rows of option_table: the limits and maps of compare.
// clang-format off
    [OPTION_MAX] = {
        .name = "max", .argument = "METRIC=VALUE", .type = VALUE_LIMIT, .group = "Checks",
        .commands = FOR_COMPARE,
        .common = FOR_COMPARE, .brief = "Exit with 1 if the metric is greater.",
        .help = "Exit with 1 if the metric is greater: mse, rmse, relmse, local-relmse, smape, "
                "flip, hdr-flip, max, or the number of nonfinite or differing pixels. The limit "
                "applies to each picture. May be given several times. If there is any limit, "
                "pixels that are not finite also fail, unless --max nonfinite=N permits them.",
    },
    [OPTION_MIN] = {
        .name = "min", .argument = "METRIC=VALUE", .type = VALUE_LIMIT, .group = "Checks",
        .commands = FOR_COMPARE,
        .common = FOR_COMPARE, .brief = "Exit with 1 if the metric is smaller.",
        .help = "Exit with 1 if the metric is smaller: psnr, in dB, or ssim.",
    },
    [OPTION_DIFFERENCE] = {
        .name = "difference", .argument = "FILE", .type = VALUE_TEXT, .group = "Map",
        .commands = FOR_COMPARE,
        .common = FOR_COMPARE, .brief = "Write a map of the differences, .png or .exr.",
        .help = "Write a map of the differences: .png in false colours, from black to pale yellow, "
                "with a scale below and pixels that are not finite in green; .exr with the "
                "numbers, in a layer named like --map. With several pictures the files are "
                "map.0001.png and so on.",
        FIELD(compare.difference),
    },
    [OPTION_MAP] = {
        .name = "map", .argument = "relative|squared|smape|flip|hdr-flip", .type = VALUE_CHOICE,
        .group = "Map", .commands = FOR_COMPARE, .fallback = "relative",
        .common = FOR_COMPARE, .brief = "The measure that the map shows.",
        .help = "The measure that --difference shows: |x - r| / (|r| + 0.01) (relative), a pixel's "
                "contribution to relmse (squared) or smape, or FLIP. The first three have a "
                "logarithmic scale of colours.",
        FIELD(compare.map),
    },
    [OPTION_REFERENCE_VARIANCE] = {
        .name = "reference-variance", .argument = "FILE|auto|VALUE", .type = VALUE_TEXT,
        .group = "Metrics", .commands = FOR_COMPARE, .fallback = "no noise is subtracted",
        .common = FOR_COMPARE, .brief = "Noise of the reference, which is subtracted.",
        .help = "The variance of the reference's own noise, which is subtracted from mse, rmse, "
                "relmse and local-relmse. FILE: a picture with the variance of each value. auto: "
                "it is estimated from the layers of --aov halves in the reference. VALUE: one "
                "variance for all values.",
        FIELD(compare.reference_variance),
    },
    [OPTION_EXPOSURES] = {
        .name = "exposures", .argument = "START,STOP", .type = VALUE_TEXT, .group = "Metrics",
        .commands = FOR_COMPARE, .fallback = "computed from the reference",
        .help = "The range of exposures for hdr-flip, in stops, so that comparisons with different "
                "references use the same exposures.",
        FIELD(compare.exposures),
    },
