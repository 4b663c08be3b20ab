#include "cli/commands.h"
#include "cli/options.h"
#include "cli/render/render_run.h"
#include "test.h"

enum { MOST_WORDS = 32 };

// Splits a line at blanks and parses it; '_' in a word stands for a blank.
static bool parse(const char *line, struct options *options, struct err *err)
{
    static char text[2048];
    char *words[MOST_WORDS + 1] = {"lampyris"};
    int count = 1;
    snprintf(text, sizeof text, "%s", line);
    for (char *word = strtok(text, " "); word && count < MOST_WORDS; word = strtok(NULL, " ")) {
        for (char *c = word; *c; c++)
            *c = *c == '_' ? ' ' : *c;
        words[count++] = word;
    }
    *err = (struct err){0};
    return options_parse(count, words, options, err);
}

static void check_error(const char *line, const char *expected)
{
    struct options options;
    struct err err;
    CHECK(!parse(line, &options, &err), "accepted: %s", line);
    CHECK(err.code == ERR_USAGE, "%s: code %d", line, err.code);
    CHECK(strstr(err.msg, expected), "%s\n  gave:     %s\n  expected: %s", line, err.msg, expected);
    options_finish(&options);
}

TEST(every_option_of_render_is_stored)
{
    struct options o;
    struct err err;
    REQUIRE(parse("render scene.json -o a.exr --output=b.PNG --size 640x480 --half --exposure -1.5 "
                  "--tone agx --time 2.5 --seed 7 --filter box --max-bounces 0 --mis none "
                  "--roulette-min-bounces off --camera 1 --env 0,0.5,1e2",
                  &o, &err),
            "%s", err.msg);
    CHECK(o.command == &commands[COMMAND_RENDER] && strcmp(o.arguments[0], "scene.json") == 0);
    CHECK(o.render.output_count == 2 && strcmp(o.render.outputs[0], "a.exr") == 0 &&
          strcmp(o.render.outputs[1], "b.PNG") == 0);
    CHECK(o.scene.settings.width == 640 && o.scene.settings.height == 480 && o.render.half_float);
    CHECK(o.scene.settings.exposure == -1.5f && o.scene.settings.tone_curve == TONE_AGX);
    CHECK(o.render.time_seconds == 2.5 && o.scene.settings.seed == 7 &&
          o.scene.settings.filter == FILTER_BOX);
    CHECK(o.scene.settings.max_bounces == 0 && o.scene.settings.mis == MIS_NONE);
    CHECK(o.scene.settings.roulette_min_bounces == UINT32_MAX && strcmp(o.scene.camera, "1") == 0);
    CHECK(!o.scene.environment.file && o.scene.environment.radiance[0] == 0 &&
          o.scene.environment.radiance[1] == 0.5f && o.scene.environment.radiance[2] == 100);
    options_finish(&o);

    REQUIRE(parse("info s.glb --scene main --animation 2 --at 1.25 --variant red", &o, &err), "%s",
            err.msg);
    CHECK(strcmp(o.scene.variant, "red") == 0);
    CHECK(strcmp(o.scene.gltf_scene, "main") == 0 && strcmp(o.scene.animation, "2") == 0 &&
          o.scene.at_seconds == 1.25);
    CHECK(options_given(&o, OPTION_AT));
    options_finish(&o);

    REQUIRE(parse("render s.glb --env sky.hdr --allow-outside-paths --frames 10 --spp-per-frame 2 "
                  "--every 5 --accumulate off --device llvm --wave 16k --validation "
                  "--features all --memory 2G",
                  &o, &err),
            "%s", err.msg);
    CHECK(strcmp(o.scene.environment.file, "sky.hdr") == 0 && o.scene.allow_outside_paths);
    CHECK(o.render.frames == 10 && o.render.spp_per_frame == 2 && o.render.every == 5 &&
          !o.render.accumulate);
    CHECK(strcmp(o.device.gpu.device, "llvm") == 0 && o.device.wave == 16384 &&
          o.device.gpu.validation);
    CHECK(o.device.features == FEATURES_ALL && o.memory == UINT64_C(1) << 31);
    options_finish(&o);

    REQUIRE(parse("render s.ply --spp 4294967295 --pixel 12,34 --sample 56 -D a=1 -Db.c=x=y "
                  "-D d= -q --json --log-level debug",
                  &o, &err),
            "%s", err.msg);
    CHECK(o.scene.settings.spp == UINT32_MAX && o.render.pixel[0] == 12 &&
          o.render.pixel[1] == 34 && o.render.sample == 56);
    CHECK(o.scene.override_count == 3 && strcmp(o.scene.overrides[0].key, "a") == 0 &&
          strcmp(o.scene.overrides[1].key, "b.c") == 0 &&
          strcmp(o.scene.overrides[1].value, "x=y") == 0 &&
          strcmp(o.scene.overrides[2].value, "") == 0);
    CHECK(o.quiet && o.json && o.log_level == LOG_DEBUG);
    options_finish(&o);
}

static bool given_any(const struct options *options)
{
    for (int i = 0; i < OPTION_TOTAL; i++)
        if (options_given(options, (enum option_id)i))
            return true;
    return false;
}

TEST(defaults_hold_where_nothing_is_given)
{
    struct options o;
    struct err err;
    REQUIRE(parse("render scene.json", &o, &err), "%s", err.msg);
    CHECK(!given_any(&o) && o.render.output_count == 0 && o.scene.override_count == 0);
    CHECK(o.render.accumulate && o.render.spp_per_frame == 1 && o.render.frames == 0 &&
          o.log_level == LOG_WARN);
    CHECK(!o.device.gpu.device && !o.scene.camera && !o.compare.difference &&
          o.render.time_seconds == 0 && o.device.wave == 0);
    options_finish(&o);
}

TEST(only_given_settings_are_applied)
{
    struct options o;
    struct err err;
    REQUIRE(parse("render s.json --spp 3 --size 7x5 --exposure 2", &o, &err), "%s", err.msg);
    struct settings settings = {.width = 1, .height = 2, .spp = 9, .seed = 4, .max_bounces = 6};
    options_apply_settings(&o.scene, &settings);
    CHECK(settings.width == 7 && settings.height == 5 && settings.spp == 3);
    CHECK(settings.exposure == 2 && settings.seed == 4 && settings.max_bounces == 6);
    options_finish(&o);
}

TEST(arguments_and_options_mix)
{
    struct options o;
    struct err err;
    REQUIRE(parse("--quiet compare --max mse=0.5 a.exr --max relmse=1e-3 -- --b.exr", &o, &err),
            "%s", err.msg);
    CHECK(o.quiet && o.argument_count == 2 && strcmp(o.arguments[1], "--b.exr") == 0);
    CHECK(o.compare.limit_count == 2 && o.compare.limits[0].metric == METRIC_MSE &&
          o.compare.limits[0].value == 0.5);
    CHECK(o.compare.limits[1].metric == METRIC_RELMSE && o.compare.limits[1].value == 1e-3);
    options_finish(&o);
    REQUIRE(parse("compare a b --min psnr=30 --difference=--d.png", &o, &err), "%s", err.msg);
    CHECK(o.compare.limits[0].is_minimum && strcmp(o.compare.difference, "--d.png") == 0);
    options_finish(&o);
    REQUIRE(parse("render s.json --spp 1 --spp 2", &o, &err), "%s", err.msg);
    CHECK(o.scene.settings.spp == 2, "the last one holds");
    options_finish(&o);
}

TEST(the_command_line_is_kept_for_a_shell)
{
    struct options o;
    struct err err;
    REQUIRE(parse("render a_'b'.json -D x=[1,2] --spp=4", &o, &err), "%s", err.msg);
    CHECK(strcmp(o.command_line, "lampyris render 'a '\\''b'\\''.json' -D 'x=[1,2]' --spp=4") == 0,
          "%s", o.command_line);
    options_finish(&o);
}

TEST(help_and_version_excuse_what_is_missing)
{
    static const char *const lines[] = {"--help",      "-h",
                                        "--version",   "render --help",
                                        "render -h x", "compare --version",
                                        "--help-all",  "info --help-all"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct options o;
        struct err err;
        CHECK(parse(lines[i], &o, &err), "%s: %s", lines[i], err.msg);
        options_finish(&o);
    }
}

TEST(usage_errors_say_what_was_expected)
{
    check_error("", "no command given");
    check_error("--quiet", "no command given");
    check_error("rendr s.json", "unknown command \"rendr\"; did you mean \"render\"?");
    check_error("bake", "unknown command \"bake\"");
    check_error("render", "too few arguments; expected render SCENE");
    check_error("render a b", "unexpected argument \"b\"; expected render SCENE");
    check_error("compare a", "expected compare IMAGE... REFERENCE");
    check_error("devices x", "unexpected argument \"x\"; expected devices");
    check_error("render s --sp 1", "unknown option --sp; did you mean --spp?");
    check_error("render s --bogus", "unknown option --bogus");
    check_error("render s -x", "unknown option -x");
    check_error("render s -spp 3", "long options have two dashes");
    check_error("--spp 3 render s", "--spp must be given after the command");
    check_error("render s --max mse=1",
                "\"render\" has no option --max: it belongs to \"compare\"");
    check_error(
        "compare a b --spp 3",
        "it belongs to \"render\", \"submit\", \"converge\", \"bench\", \"check\", \"info\"");
    check_error("render s --spp", "--spp needs a value: --spp N");
    check_error("render s --output --half", "--output needs a value: --output FILE");
    check_error("render s --half=yes", "--half takes no value, but got \"yes\"");
    check_error("render s -qx", "--quiet takes no value, but got \"x\"");
}

TEST(value_errors_name_the_option_and_the_value)
{
    check_error("render s --spp 0", "--spp: \"0\" is outside [1, 4294967295]");
    check_error("render s --spp -1", "--spp: \"-1\" is not a number");
    check_error("render s --spp 4G", "is outside");
    check_error("render s --spp 18446744073709551616", "is not a number");
    check_error("render s --spp 18446744073709551615k", "is not a number");
    check_error("render s --spp 1.5", "is not a number");
    check_error("render s --spp 1kk", "is not a number");
    check_error("render s --spp 0x10", "is not a number");
    check_error("render s --spp=", "\"\" is not a number");
    check_error("render s --size 640", "\"640\" is not of the form WxH");
    check_error("render s --size 640x", "is not of the form WxH");
    check_error("render s --size 640x480x3", "is not of the form WxH");
    check_error("render s --size 0x480", "is outside [1, 16777216]");
    check_error("render s --size 65536x65536", "is more than 2^31 pixels");
    check_error("render s --pixel 1", "is not of the form X,Y");
    check_error("render s --exposure nan", "\"nan\" is not a finite number");
    check_error("render s --exposure 1e999", "is not a finite number");
    check_error("render s --exposure 0x1p3", "is not a finite number");
    check_error("render s --exposure 101", "is outside [-100, 100]");
    check_error("render s --time -1", "is outside [0.001, ");
    check_error("render s --bvh half", "expected one of sah|median|mean|spatial|middle");
    check_error("render s --bvh-leaf 0", "--bvh-leaf: \"0\" is outside [1, 8]");
    check_error("render s --bvh-leaf 9", "is outside [1, 8]");
    check_error("render s --bvh-costs 1", "--bvh-costs: \"1\" is not of the form T,I");
    check_error("render s --bvh-costs 1,2,3", "is not of the form T,I");
    check_error("render s --bvh-costs 0,1", "--bvh-costs: \"0,1\" is outside [0.001, 1000]");
    check_error("render s --bvh-costs 1:1001", "is outside [0.001, 1000]");
    check_error("render s --tone filmic", "\"filmic\" is unknown; expected one of none|reinhard");
    check_error("render s --tone none|reinhard", "is unknown");
    check_error("render s --tone=", "\"\" is unknown");
    check_error("render s --filter gauss",
                "\"gauss\" is unknown; did you mean \"gaussian\"? Expected one of box|tent");
    check_error("render s --filter best", "\"best\" is unknown; expected one of box|tent");
    check_error("render s --sampler soboll", "did you mean \"sobol\"?");
    check_error("render s --bvh m", "\"m\" is unknown; expected one of");
    check_error("render s --aov depth,albeto", "\"albeto\" is unknown; did you mean \"albedo\"?");
    check_error("bench s --kernel intersect_closest --rays difuse", "did you mean \"diffuse\"?");
    check_error("render s --accumulate yes", "\"yes\" is neither \"on\" nor \"off\"");
    check_error("render s --roulette-min-bounces never", "--roulette-min-bounces: \"never\"");
    check_error("render s --env 1,2", "--env: \"1,2\" is not a colour; expected R,G,B");
    check_error("render s --env 1,2,3,4", "is not a colour");
    check_error("render s --env 1,-2,3", "negative");
    check_error("render s --env 1,2,1e39", "too large");
    check_error("render s --env=", "--env: the value is empty");
    check_error("render s --camera=", "--camera: the value is empty");
    check_error("render s --at -1", "--at: \"-1\" is outside [0, 1000000000]");
    check_error("render s --at 1e400", "--at: \"1e400\" is not a finite number");
    check_error("render s -o a.tga", "--output: ");
    check_error("render s -o a.exr -o a.exr", "\"a.exr\" is given twice");
    check_error("render s -D key", "\"key\" is not of the form KEY=VALUE");
    check_error("render s -D =1", "is not of the form KEY=VALUE");
    check_error("compare a b --max mse", "is not of the form METRIC=VALUE");
    check_error("compare a b --max sim=1", "\"sim\" is unknown; did you mean \"ssim\"?");
    check_error("compare a b --max error=1", "\"error\" is unknown; expected one of mse, rmse");
    check_error("compare a b --max ssim=1", "a greater ssim is better; use --min");
    check_error("compare a b --max mse=", "the limit is not a finite number");
    check_error("compare a b --max mse=-1", "the limit is not a finite number");
    check_error("compare a b --max psnr=30", "a greater psnr is better; use --min");
    check_error("compare a b --min mse=1", "a greater mse is worse; use --max");
    check_error("render s --log-level loud", "error|warning|note|debug");
}

TEST(combinations_are_checked)
{
    check_error("render s --every 2", "--every needs --frames");
    check_error("render s --spp-per-frame 2", "--spp-per-frame needs --frames");
    check_error("render s --accumulate off", "--accumulate needs --frames");
    check_error("render s --sample 2", "--sample needs --pixel");
    check_error("render s --spp 4 --frames 2", "--spp and --frames exclude each other");
    check_error("render s --frames 1M --spp-per-frame 4k",
                "is 4294967296 samples; expected at most");
}

TEST(memory_runs_out_politely)
{
    for (uint64_t n = 1; n <= 5; n++) {
        struct options o;
        struct err err;
        arena_fail_at(n);
        CHECK(!parse("render s -D a=1", &o, &err), "%d", (int)n);
        CHECK(err.code == ERR_SYSTEM, "%d: %s", (int)n, err.msg);
        options_finish(&o);
    }
    arena_fail_at(0);
    options_finish(NULL);
}

static void check_setting(const struct option_def *def, const char *value,
                          const struct settings *expected)
{
    struct options o;
    struct err err;
    char line[120];
    snprintf(line, sizeof line, "render s --%s=%s", def->name, value);
    REQUIRE(parse(line, &o, &err), "%s: %s", line, err.msg);
    CHECK(field_same(&def->setting->field, &o.scene.settings, expected), "%s", line);
    options_finish(&o);
}

// Tests every word and both ends of every range, and that the help has the default.
TEST(settings_take_what_their_table_says)
{
    for (int i = 0; i < OPTION_TOTAL; i++) {
        const struct option_def *def = &option_table[i];
        if (!def->setting)
            continue;
        const struct field *field = &def->setting->field;
        struct settings s = settings_default();
        char text[FIELD_TEXT_MAX], line[400];
        field_text(field, &s, text);
        check_setting(def, text, &s);
        for (uint32_t n = 0; field->type == FIELD_CHOICE && field->words[n]; n++) {
            field_set(field, &s, n);
            check_setting(def, field->words[n], &s);
        }
        if (field->word) {
            field_set_word(field, &s);
            check_setting(def, field->word, &s);
        }
        for (int end = 0; end < 2 && field->max > field->min; end++) {
            field_set(field, &s, end ? field->max : field->min);
            snprintf(text, sizeof text, "%.17g", end ? field->max : field->min);
            check_setting(def, text, &s);
            double beyond = end ? 2 * field->max + 1 : field->min - 1;
            snprintf(line, sizeof line, "render s --%s=%.0f", def->name, beyond);
            check_error(line, beyond < 0 && field->type == FIELD_COUNT ? "is not a number"
                                                                       : "is outside");
        }
    }
}

TEST(the_table_is_complete)
{
    for (int i = 0; i < OPTION_TOTAL; i++) {
        const struct option_def *def = &option_table[i];
        REQUIRE(def->name && def->help && def->group && def->commands, "row %d", i);
        CHECK((def->type == VALUE_SETTING) == (def->setting != NULL), "--%s", def->name);
        CHECK((def->type == VALUE_FLAG || def->setting) == !def->argument, "--%s", def->name);
        bool has_list =
            def->type == VALUE_OUTPUT || def->type == VALUE_VARY || def->type == VALUE_DEFINE ||
            def->type == VALUE_LIMIT || def->type == VALUE_ENVIRONMENT ||
            def->type == VALUE_CURVE || def->type == VALUE_TIMES || def->type == VALUE_DEPTHS ||
            def->type == VALUE_RAYS || def->type == VALUE_SETTING || def->type == VALUE_AT;
        CHECK(has_list == (def->size == 0), "--%s", def->name);
        for (int j = 0; j < i; j++)
            CHECK(strcmp(option_table[j].name, def->name) != 0 &&
                      (!def->short_name || option_table[j].short_name != def->short_name),
                  "--%s twice", def->name);
    }
}

// The command that `lampyris render` prints to follow a dropped contribution is a valid command
// line.
TEST(the_reproducing_command_follows_its_path)
{
    struct options options, again;
    struct err err;
    REQUIRE(parse("render floor.json --spp 4", &options, &err), "%s", err.msg);
    struct render_run run = {.options = &options};
    run.job.film.width = 32;
    CHECK(!render_reproducing_command(&run), "nothing was left out");
    run.job.renderer.stats.nonfinite =
        (struct nonfinite_stats){.recorded = true, .pixel = 5 * 32 + 7, .sample = 3};
    const char *command = render_reproducing_command(&run);
    REQUIRE(command && strncmp(command, "lampyris ", 9) == 0, "%s", command);
    REQUIRE(parse(command + 9, &again, &err), "%s: %s", command, err.msg);
    CHECK(options_given(&again, OPTION_PIXEL) && options_given(&again, OPTION_SAMPLE) &&
              again.render.pixel[0] == 7 && again.render.pixel[1] == 5 &&
              again.render.sample == 3 && again.scene.settings.spp == 4 &&
              strcmp(again.arguments[0], "floor.json") == 0,
          "%s", command);
    options_finish(&again);
    options_finish(&options);
    arena_finish(&run.arena);
}

TEST_MAIN(TEST_CASE(every_option_of_render_is_stored),
          TEST_CASE(defaults_hold_where_nothing_is_given),
          TEST_CASE(only_given_settings_are_applied), TEST_CASE(arguments_and_options_mix),
          TEST_CASE(the_command_line_is_kept_for_a_shell),
          TEST_CASE(help_and_version_excuse_what_is_missing),
          TEST_CASE(usage_errors_say_what_was_expected),
          TEST_CASE(value_errors_name_the_option_and_the_value),
          TEST_CASE(combinations_are_checked), TEST_CASE(memory_runs_out_politely),
          TEST_CASE(settings_take_what_their_table_says), TEST_CASE(the_table_is_complete),
          TEST_CASE(the_reproducing_command_follows_its_path))
