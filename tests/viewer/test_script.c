#define _GNU_SOURCE // nftw of temporary_folder.h
#include "base/temporary_folder.h"
#include "test.h"
#include "viewer/core/watch_files.h"
#include "viewer/script/script_words.h"
#include "viewer/window/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

struct script {
    struct arena arena;
    struct command_line *commands;
    uint32_t count;
    struct err err;
    bool ok;
};

// Reads a script; the result is released by arena_finish().
static struct script read_text(const char *text)
{
    struct script s = {0};
    char folder[256];
    if (!temporary_enter(folder, sizeof folder) || !temporary_write("s.txt", text))
        abort();
    s.ok = script_read("s.txt", &s.arena, &s.commands, &s.count, &s.err);
    temporary_leave(folder);
    return s;
}

TEST(commands_and_their_arguments)
{
    struct script s = read_text("# nothing\n"
                                "\n"
                                "key Ctrl+Shift+z   # undone again\n"
                                "key F12 down\n"
                                "mouse 1.5 -2\n"
                                "button middle up\n"
                                "set a.b \"x \\\"y\\\" # z\"\r\n"
                                "press quit\n"
                                "wait 30 samples\n"
                                "wait idle\n"
                                "exr out.exr b denoised\n"
                                "check a.b off state\n"
                                "expect sides.0.samples >= 4\n"
                                "text \"\"");
    REQUIRE(s.ok, "%s", s.err.msg);
    REQUIRE(s.count == 12, "%u", s.count);
    const struct command_line *c = s.commands;
    CHECK(c[0].verb == VERB_KEY && c[0].code == GLFW_KEY_Z && c[0].press == PRESS_BOTH &&
              c[0].modifiers == (EVENT_CONTROL | EVENT_SHIFT) && c[0].line == 3,
          "%d %u", c[0].code, c[0].modifiers);
    CHECK(c[1].code == GLFW_KEY_F12 && c[1].press == PRESS_DOWN && c[1].modifiers == 0, " ");
    CHECK(c[2].numbers[0] == 1.5 && c[2].numbers[1] == -2, "%g", c[2].numbers[0]);
    CHECK(c[3].code == 2 && c[3].press == PRESS_UP, "%d", c[3].code);
    CHECK(strcmp(c[4].texts[0], "a.b") == 0 && strcmp(c[4].texts[1], "x \"y\" # z") == 0, "%s",
          c[4].texts[1]);
    CHECK(c[5].verb == VERB_PRESS && !c[5].texts[1], " ");
    CHECK(c[6].unit == WAIT_SAMPLES && c[6].numbers[0] == 30, " ");
    CHECK(c[7].unit == WAIT_IDLE, " ");
    CHECK(c[8].side == 1 && c[8].denoised, "%u", c[8].side);
    CHECK(c[9].effect == EFFECT_STATE && strcmp(c[9].texts[1], "off") == 0, " ");
    CHECK(c[10].comparison == COMPARE_AT_LEAST && strcmp(c[10].texts[1], "4") == 0, " ");
    CHECK(c[11].verb == VERB_TEXT && c[11].texts[0][0] == '\0' && c[11].line == 14, " ");
    arena_finish(&s.arena);
}

TEST(faults_are_told_by_line_and_word)
{
    static const struct {
        const char *text, *line, *word;
    } faults[] = {
        {"\n\nkye A\n", "s.txt:3: ", "did you mean key?"},
        {"key Esc", "s.txt:1: ", "Esc"},
        {"key Escap", "s.txt:1: ", "did you mean Escape?"},
        {"key F13", "s.txt:1: ", "F13"},
        {"key A sideways", "s.txt:1: ", "\"sideways\" is unexpected; expected: key NAME"},
        {"key", "s.txt:1: ", "the key's name is missing; expected: key NAME [down|up]"},
        {"mouse 1 x", "s.txt:1: ", "\"x\" is not a number"},
        {"mouse 1 nan", "s.txt:1: ", "\"nan\" is not a number"},
        {"button front", "s.txt:1: ", "left, right or middle"},
        {"set a.b", "s.txt:1: ", "the value is missing"},
        {"resize 0 5", "s.txt:1: ", "at least 1 x 1 pixels"},
        {"resize 20000 5", "s.txt:1: ", "20000 is not a whole number from 0 to 16384"},
        {"wait 3", "s.txt:1: ", "frames, ms or samples"},
        {"wait 1.5 frames", "s.txt:1: ", "1.5 is not a whole number"},
        {"wait", "s.txt:1: ", "wait N frames|ms|samples, or wait idle"},
        {"expect a = b", "s.txt:1: ", "== != < <= > >= ~ !~"},
        {"quit now", "s.txt:1: ", "\"now\" is unexpected"},
        {"timeout -1", "s.txt:1: ", "more than 0"},
        {"text \"open", "s.txt:1: ", "a quotation mark is missing"},
        {"text a b c d e f g h i", "s.txt:1: ", "more than 8 words"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        struct script s = read_text(faults[i].text);
        CHECK(!s.ok && s.err.code == ERR_INPUT, "%s", faults[i].text);
        CHECK(strncmp(s.err.msg, faults[i].line, strlen(faults[i].line)) == 0, "%s", s.err.msg);
        CHECK(strstr(s.err.msg, faults[i].word), "%s: %s", faults[i].word, s.err.msg);
        arena_finish(&s.arena);
    }
}

static bool has(const struct watch_files *files, const char *name)
{
    for (uint32_t i = 0; i < files->count; i++)
        if (strcmp(files->paths[i], name) == 0)
            return true;
    return false;
}

TEST(files_that_scenes_name_are_watched)
{
    struct watch_files files = {0};
    char folder[256];
    REQUIRE(temporary_enter(folder, sizeof folder), "%s", folder);
    temporary_write("a.json",
                    "{\"file\": \"m.obj\", \"env\": \"none.exr\", \"x\": \"other.json\"}");
    temporary_write("other.json", "{\"image\":\"t.png\"}");
    temporary_write("m.obj", "mtllib m.mtl\nv 0 0 0\n");
    temporary_write("m.mtl", "map_Kd t.png");
    temporary_write("t.png", "not a picture");
    temporary_write("unnamed.json", "{}");
    watch_files_add_scene(&files, "./a.json");
    CHECK(files.count == 5, "%u", files.count);
    CHECK(has(&files, "./m.obj") && has(&files, "./m.mtl") && has(&files, "./t.png") &&
              has(&files, "./other.json"),
          " ");
    uint64_t stamp = watch_files_stamp(&files);
    temporary_write("unnamed.json", "{\"a\": 1}");
    CHECK(watch_files_stamp(&files) == stamp, "another file");
    temporary_write("t.png", "another one");
    uint64_t written = watch_files_stamp(&files);
    CHECK(written != stamp, "written");
    temporary_write("new", "another one");
    REQUIRE(rename("new", "t.png") == 0, "rename");
    CHECK(watch_files_stamp(&files) != written, "replaced");
    watch_files_finish(&files);
    CHECK(files.count == 0, "%u", files.count);
    temporary_leave(folder);
}

TEST_MAIN(TEST_CASE(commands_and_their_arguments), TEST_CASE(faults_are_told_by_line_and_word),
          TEST_CASE(files_that_scenes_name_are_watched))
