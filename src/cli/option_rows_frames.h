// Rows of option_table.c for renders of several pictures: sequences, and frames of samples.
// clang-format off
    [OPTION_TURNTABLE] = {
        .name = "turntable", .argument = "N", .type = VALUE_COUNT, .min = 1, .max = SEQUENCE_FRAMES_MAX,
        .group = "Frames", .commands = FOR_RENDER, .fallback = "one picture",
        .help = "Render N numbered pictures of one turn of the camera around the scene. The first "
                "has the camera's own view; each further view is turned by 360/N degrees, "
                "counter-clockwise seen from above, about a vertical axis through the point of the "
                "line of sight that is nearest to the middle of the scene.",
        FIELD(render.sequence.views),
    },
    [OPTION_FPS] = {
        .name = "fps", .argument = "N", .type = VALUE_REAL, .min = SEQUENCE_FPS_MIN, .max = SEQUENCE_FPS_MAX,
        .group = "Frames", .commands = FOR_RENDER, .fallback = "24",
        .help = "Pictures per second in the video of a --turntable (-o NAME.mp4 or NAME.webm).",
        FIELD(render.sequence.frames_per_s),
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
        .help = "On: each frame adds its samples to those of the frames before. Off: each frame is "
                "a separate picture with new samples.",
        FIELD(render.accumulate),
    },
