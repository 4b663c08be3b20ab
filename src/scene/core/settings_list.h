// The list of all settings of a render, one row each. The including file first defines
//   SETTING(ID, C type, member of struct settings, key in scene files, option, group in the help,
//           help, designated members of struct field in parentheses, and of struct setting)
// A row with SETTING_OF_FILE has no option of its own. A row with SETTING_OF_COUNT changes the
// number of samples in the film but not their values. A row with SETTING_OF_IMAGE changes how the
// film is displayed, and no bit of the film.
//
// Ranges: counts end at 2^20, the maximum length of paths, or are "off". Numbers stored in single
// precision end at 3.4e38, just below its maximum; lengths begin at 1e-37, above which single
// precision has all its digits. The ranges include all values that earlier versions accepted,
// except those that kernels cannot distinguish from 0.
#ifndef SETTING_OF_FILE
#define SETTING_OF_FILE(...)
#endif
#ifndef SETTING_OF_COUNT
#define SETTING_OF_COUNT SETTING
#endif
#ifndef SETTING_OF_IMAGE
#define SETTING_OF_IMAGE SETTING
#endif

// clang-format off
SETTING_OF_FILE(WIDTH, uint32_t, width, "width", NULL, NULL,
    "Width of the image in pixels. The image has at most 2^31 pixels.",
    (COUNT(1, SETTINGS_SIZE_MAX)), .fallback = 512)
SETTING_OF_FILE(HEIGHT, uint32_t, height, "height", NULL, NULL,
    "Height of the image in pixels.",
    (COUNT(1, SETTINGS_SIZE_MAX)), .fallback = 512)
SETTING_OF_IMAGE(EXPOSURE, float, exposure, "exposure", "exposure", "Picture",
    "Exposure in stops: PNG and JPEG images, and the images that psnr, ssim and flip compare, are "
    "multiplied by 2 to this power before the tone curve. auto computes it from the image's "
    "luminances (docs/output.md; not for compare); it is the default for models without light or "
    "camera, and for scenes that get a sky from the command line. EXR, HDR and PFM files are not "
    "changed.",
    (REAL(-SETTINGS_EXPOSURE_MAX, SETTINGS_EXPOSURE_MAX), .word = "auto",
     .flag = offsetof(struct settings, exposure_is_auto)),
    .brief = "Multiply PNG and JPEG by 2 to this power.",
    .fallback = 0, .argument = "STOPS")
SETTING_OF_IMAGE(TONE, uint32_t, tone_curve, "tone", "tone", "Picture",
    "Tone curve of PNG and JPEG images. The default is aces for models without light or camera, "
    "and for scenes that get a sky from the command line.",
    (CHOICE(tone_names)), .brief = "Tone curve of PNG and JPEG images.",
    .fallback = TONE_NONE)

SETTING_OF_COUNT(SPP, uint64_t, spp, "spp", "spp", "Sampling",
    "Samples per pixel.",
    (COUNT(1, SETTINGS_SPP_MAX)), .brief = "Samples per pixel.",
    .fallback = 64, .argument = "N")
SETTING(SEED, uint32_t, seed, "seed", "seed", "Sampling",
    "Seed of the random numbers. The same seed gives the same picture, bit for bit.",
    (COUNT(0, UINT32_MAX)), .fallback = 0, .argument = "N", .label = "Seed")
SETTING(MAX_BOUNCES, uint32_t, max_bounces, "max_bounces", "max-bounces", "Sampling",
    "Maximum number of scattering events on a path: 0 gives emission only, 1 gives direct light "
    "too.",
    (COUNT(0, SETTINGS_BOUNCES_MAX)), .brief = "Scattering events on a path: 1 is direct light.",
    .fallback = 9, .argument = "N", .label = "Bounces")

SETTING(INTEGRATOR, uint32_t, integrator, "integrator", "integrator", "Method",
    "The quantity that is computed: light after any number of bounces (path) or after one "
    "(direct), ambient occlusion (ao), or Whitted's ray tracing of 1979 (whitted): perfect "
    "reflection and refraction, hard shadows and Phong shading, for comparison. bidir computes the "
    "same picture as path, but also traces paths from the lights, to find light that glass and "
    "metal focus. auto is bidir where render finds that it pays off, and path otherwise.",
    (CHOICE(integrator_names)), .fallback = INTEGRATOR_PATH, .label = "Integrator", .gap = true)
SETTING(AO_DISTANCE, float, ao_distance, "ao_distance", "ao-distance", "Method",
    "Maximum distance of occluders, in metres, for the integrator ao.",
    (REAL(SETTINGS_LENGTH_MIN, SETTINGS_REAL_MAX), .word = "off", .word_value = INFINITY),
    .fallback = INFINITY, .special = "any distance", .argument = "METRES", .unit = "m",
    .label = "  distance", NEEDS(INTEGRATOR, 1u << INTEGRATOR_AO))
SETTING(SAMPLER, uint32_t, sampler, "sampler", "sampler", "Method",
    "Source of the random numbers: an Owen-scrambled Sobol sequence (sobol); independent numbers "
    "(pcg; lcg: a linear congruential generator seeded by TEA); one point in each stratum, at "
    "random (stratified) or at its centre (grid); a sequence whose errors are blue noise over the "
    "picture, for few samples (blue-noise); or fractions of sines, which are neither uniform nor "
    "independent, for comparison (sine).",
    (CHOICE(sampler_names)), .fallback = SAMPLER_SOBOL, .label = "Sampler", .gap = true)
SETTING(HALVES, uint32_t, halves, "halves", "halves", "Method",
    "How samples are divided between the two half-buffers whose difference measures the error. "
    "Either each has a random sequence of its own (independent), or they have the first and the "
    "second half of one sequence (contiguous): the picture then has less noise, and the reported "
    "error is an upper bound.",
    (CHOICE(halves_names)), .fallback = HALVES_INDEPENDENT, .label = "Halves")
SETTING(ACCUMULATION, uint32_t, accumulation, "film_accumulation", "accumulation", "Method",
    "How the film adds up samples: in bins whose sum does not depend on the order, in a plain sum, "
    "or as a running mean. The latter two lose precision with many samples: they are for "
    "comparison.",
    (CHOICE(accumulation_names)), .fallback = ACCUMULATION_BINNED, .label = "Accumulation")
SETTING(FILTER, uint32_t, filter, "filter", "filter", "Method",
    "Pixel filter, which is importance-sampled.",
    (CHOICE(filter_names)), .fallback = FILTER_BOX, .label = "Filter",
    NEEDS(PIXEL_JITTER, 1u << true))
SETTING(FILTER_RADIUS, float, filter_radius, "filter_radius", "filter-radius", "Method",
    "Half the width of the pixel filter, in pixels. The filter's own is 0.5 for box, 1 for tent, "
    "1.5 for gaussian and blackman-harris.",
    (REAL(0, SETTINGS_FILTER_RADIUS_MAX)), .fallback = 0, .special = "the filter's own",
    .argument = "PIXELS", .unit = "px", .label = "  radius", .drag = 4,
    NEEDS(PIXEL_JITTER, 1u << true))
SETTING(LIGHT_CHOICE, uint32_t, light_choice, "light_choice", "light-choice", "Method",
    "How the emitter for a vertex's shadow ray is selected: with equal probability (uniform), in "
    "proportion to power (power), or by an estimate of its contribution to the vertex (tree: a "
    "light tree). With all, a vertex sends a shadow ray to each lamp. auto chooses one of these by "
    "the number of emitters and lamps.",
    (CHOICE(light_choice_names)), .fallback = LIGHT_CHOICE_AUTO, .label = "Light choice",
    .gap = true, NEEDS(NEE, 1u << true))
SETTING(NEE, bool, nee, "nee", "nee", "Method",
    "Next-event estimation: shadow rays to emitters.",
    (SWITCH), .fallback = true, .label = "Aim at lights")
SETTING(NEE_DEPTH, uint32_t, nee_depth, "nee_depth", "nee-depth", "Method",
    "Only the first N vertices of a path send shadow rays. At later vertices the light of delta "
    "lights is lost, and the picture is biased.",
    (DEPTH), .fallback = UINT32_MAX, .special = "all vertices", .argument = "N", .label = "  first",
    NEEDS(NEE, 1u << true))
SETTING(MIS, uint32_t, mis, "mis", "mis", "Method",
    "Weights of multiple importance sampling for the two strategies that find emitters, shadow "
    "rays and scattered rays: the power heuristic, the balance heuristic, or none. With none, "
    "light that shadow rays can find is found by them alone.",
    (CHOICE(mis_names)), .fallback = MIS_POWER, .label = "  weights", NEEDS(NEE, 1u << true))
SETTING(MIS_EXPONENT, float, mis_exponent, "mis_exponent", "mis-exponent", "Method",
    "The exponent of the power heuristic. 1 is the balance heuristic, and large values approach "
    "the maximum heuristic. 0 is not allowed: it would give half of the weight to a strategy that "
    "cannot find the light.",
    (REAL(0.01, 1000)), .fallback = 2, .argument = "B", .label = "  exponent", .drag = 8,
    NEEDS(MIS, 1u << MIS_POWER))
SETTING(DIRECTIONS, uint32_t, directions, "directions", "directions", "Method",
    "How the next direction of a path is sampled at a surface that is not perfectly specular: from "
    "the BSDF, uniformly over the sphere or the hemisphere, by the cosine, or by a power of the "
    "cosine about the mirrored direction.",
    (CHOICE(directions_names)), .fallback = DIRECTIONS_BSDF, .label = "Directions", .gap = true)
SETTING(DIRECTION_EXPONENT, float, direction_exponent, "direction_exponent", "direction-exponent",
    "Method", "The exponent of the cosine for the directions power-cosine.",
    (REAL(0, SETTINGS_EXPONENT_MAX)), .fallback = 15, .argument = "N", .label = "  exponent",
    NEEDS(DIRECTIONS, 1u << DIRECTIONS_POWER_COSINE))
SETTING(NORMALS, uint32_t, normals, "normals", "normals", "Method",
    "The distribution from which microfacet normals of rough surfaces are sampled: those visible "
    "from the direction of the incoming path, or all normals. The latter has more variance and is "
    "for comparison.",
    (CHOICE(normals_names)), .fallback = NORMALS_VISIBLE, .label = "Normals")
SETTING(RADIANCE_SCALING, bool, radiance_scaling, "radiance_scaling", "radiance-scaling", "Method",
    "Refraction scales radiance by 1 / eta^2: inside glass of index n, radiance is n^2 times that "
    "outside. Off omits the factor, as some renderers do. A view through a closed body from "
    "outside stays the same.",
    (SWITCH), .fallback = true, .label = "Radiance scaling")
SETTING(SPLIT_LOBES, uint32_t, split_lobes, "split_lobes", "split-lobes", "Method",
    "At the first N vertices of a path, surfaces that have both diffuse and specular lobes scatter "
    "two rays, one by each kind of lobe. This needs the directions bsdf.",
    (COUNT(0, SETTINGS_SPLIT_LOBES_MAX)), .fallback = 0, .argument = "N",
    .label = "Split lobes", NEEDS(DIRECTIONS, 1u << DIRECTIONS_BSDF))
SETTING(CLAMP, float, clamp_limit, "clamp", "clamp", "Method",
    "Scale contributions to a sample down so that no component exceeds this limit, in W/(sr m^2). "
    "This removes fireflies, but also light: the picture is biased.",
    (REAL(0, SETTINGS_REAL_MAX), .word = "off"), .fallback = 0, .argument = "LIMIT",
    .label = "Clamp")
SETTING(MIN_DENSITY, float, min_density, "min_density", "min-density", "Method",
    "Paths end if the density of their next direction, per steradian, is below this limit. The "
    "light that they would have found is missing, so the picture is biased.",
    (REAL(0, SETTINGS_REAL_MAX), .word = "off"), .fallback = 0, .argument = "D", .unit = "1/sr",
    .label = "Least density", .drag = 4)
SETTING(ROULETTE, uint32_t, roulette, "roulette", "roulette", "Method",
    "The probability that a path survives Russian roulette: 2.5 times the largest component of its "
    "throughput (throughput), or a constant (constant). With frame, one random depth for each "
    "sample number ends the paths of all pixels.",
    (CHOICE(roulette_names)), .fallback = ROULETTE_THROUGHPUT, .label = "Roulette")
SETTING(ROULETTE_MIN_BOUNCES, uint32_t, roulette_min_bounces, "roulette_min_bounces",
    "roulette-min-bounces", "Method",
    "Paths may end by Russian roulette after this many scattering events.",
    (DEPTH), .fallback = 3, .special = "never", .argument = "N", .label = "  from",
    NEEDS(ROULETTE, ~(1u << ROULETTE_OFF)))
SETTING(ROULETTE_MAX_BOUNCES, uint32_t, roulette_max_bounces, "roulette_max_bounces",
    "roulette-max-bounces", "Method",
    "The greatest random depth of the roulette \"frame\". The light of longer paths is lost, so "
    "the picture is biased.",
    (DEPTH), .fallback = UINT32_MAX, .special = "any depth", .argument = "N", .label = "  to",
    NEEDS(ROULETTE, 1u << ROULETTE_FRAME))
SETTING(ROULETTE_SURVIVAL, float, roulette_survival, "roulette_survival", "roulette-survival",
    "Method", "Probability of survival, for the roulettes constant and frame.",
    (REAL(0.01, 1)), .fallback = 0.7, .argument = "P", .label = "  survival",
    NEEDS(ROULETTE, 1u << ROULETTE_CONSTANT | 1u << ROULETTE_FRAME))
SETTING(ENVIRONMENT_FILTER, uint32_t, environment_filter, "environment_filter", "env-filter",
    "Method",
    "How the radiance between the texels of an environment's image is found: by bilinear "
    "interpolation, or from the nearest texel.",
    (CHOICE(environment_filter_names)), .fallback = ENVIRONMENT_FILTER_BILINEAR,
    .label = "Environment", .gap = true, .needs_image = true)
SETTING(ENVIRONMENT_SAMPLING, uint32_t, environment_sampling, "environment_sampling",
    "env-sampling", "Method",
    "How shadow rays choose directions towards an environment's image: in proportion to its "
    "luminance, or to its excess over the mean, because scattered rays find the rest (MIS "
    "compensation). The latter needs MIS weights, the directions bsdf and no min_density; "
    "otherwise the former is used.",
    (CHOICE(environment_sampling_names)), .fallback = ENVIRONMENT_SAMPLING_COMPENSATED,
    .label = "  aimed by", .needs_image = true, NEEDS(NEE, 1u << true))
SETTING(PIXEL_JITTER, bool, pixel_jitter, "pixel_jitter", "pixel-jitter", "Method",
    "Spread samples over the pixel's filter; off: all samples are at the pixel's centre.",
    (SWITCH), .fallback = true, .label = "Pixel jitter")
SETTING(PIXEL_SAMPLING, uint32_t, pixel_sampling, "pixel_sampling", "pixel-sampling", "Method",
    "Where samples lie in the pixel's filter: as the sampler places them, all at the pixel's "
    "centre, at random, or one in each stratum, at its centre (grid) or at random in it "
    "(stratified). With centre and grid, detail between the sample points is never found, and the "
    "reported error does not include it.",
    (CHOICE(pixel_sampling_names)), .fallback = PIXEL_SAMPLING_SAMPLER, .label = "Pixel sampling",
    NEEDS(PIXEL_JITTER, 1u << true))
SETTING(PIXEL_STRATA, uint32_t, pixel_strata, "pixel_strata", "pixel-strata", "Method",
    "Strata along a side of a pixel, for the pixel samplings grid and stratified. Each half-buffer "
    "uses every stratum once before it uses any again, so all N x N strata are full after "
    "2 x N x N samples, or after N x N with contiguous halves.",
    (COUNT(1, SETTINGS_STRATA_MAX)), .fallback = 4, .argument = "N", .label = "  strata",
    NEEDS(PIXEL_SAMPLING, 1u << PIXEL_SAMPLING_GRID | 1u << PIXEL_SAMPLING_STRATIFIED))
// clang-format on

#undef SETTING
#undef SETTING_OF_FILE
#undef SETTING_OF_COUNT
#undef SETTING_OF_IMAGE
