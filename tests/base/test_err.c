#include "base/err.h"
#include "test.h"

TEST(set_fills_in_and_returns_false)
{
    struct err err = {0};
    CHECK(!err_set(&err, ERR_INPUT, "%s: %d is outside [0, 1]", "a.json", 7));
    CHECK(err.code == ERR_INPUT);
    CHECK(strcmp(err.msg, "a.json: 7 is outside [0, 1]") == 0, "%s", err.msg);
    CHECK(!err_set(NULL, ERR_BUG, "nobody listens"));
}

TEST(prepend_keeps_the_code)
{
    struct err err = {0};
    err_set(&err, ERR_OUTPUT, "no space");
    CHECK(!err_prepend(&err, "%s.exr", "out"));
    CHECK(err.code == ERR_OUTPUT);
    CHECK(strcmp(err.msg, "out.exr: no space") == 0, "%s", err.msg);
    CHECK(!err_prepend(NULL, "nobody listens"));
}

TEST(the_message_may_be_its_own_argument)
{
    struct err err = {0};
    err_set(&err, ERR_GPU, "lost");
    err_set(&err, ERR_GPU, "device %s, really %s", err.msg, err.msg);
    CHECK(strcmp(err.msg, "device lost, really lost") == 0, "%s", err.msg);
}

TEST(long_messages_are_cut)
{
    char text[2000];
    memset(text, 'x', sizeof text);
    text[sizeof text - 1] = '\0';
    struct err err = {0};
    err_set(&err, ERR_INPUT, "%s", text);
    CHECK(strlen(err.msg) == sizeof err.msg - 1);
    err_prepend(&err, "%s", text);
    CHECK(strlen(err.msg) == sizeof err.msg - 1);
}

TEST(control_characters_cannot_reach_a_terminal)
{
    struct err err = {0};
    err_set(&err, ERR_INPUT, "name \"\x1b[2J\n\x7f\" \xc3\xa9");
    CHECK(strcmp(err.msg, "name \"?[2J\?\?\" \xc3\xa9") == 0, "%s", err.msg);
}

TEST(memory_names_the_purpose)
{
    struct err err = {0};
    CHECK(!err_memory(&err, "triangles", 48));
    CHECK(err.code == ERR_SYSTEM);
    CHECK(strcmp(err.msg, "out of memory (48 bytes for triangles)") == 0, "%s", err.msg);
}

TEST(the_place_is_that_of_the_problem)
{
    struct err err = {0};
    err_set(&err, ERR_INPUT, "1.7 is outside [0, 1]");
    CHECK(!err.file[0] && !err.place[0]);
    err_locate(&err, "base.json", "/materials/white/roughness");
    err_prepend(&err, "base.json: materials.white.roughness");
    err_locate(&err, "scene.json", "/base/file");
    err_prepend(&err, "scene.json: base.file");
    CHECK(strcmp(err.file, "base.json") == 0, "%s", err.file);
    CHECK(strcmp(err.place, "/materials/white/roughness") == 0, "%s", err.place);
    err_set(&err, ERR_INPUT, "something else: %s", err.msg);
    CHECK(!err.file[0] && !err.place[0]);

    char text[1000];
    memset(text, 'x', sizeof text);
    text[sizeof text - 1] = '\0';
    err_locate(&err, "a.json", text);
    CHECK(strcmp(err.file, "a.json") == 0 && !err.place[0], "%s", err.place);
    err_set(&err, ERR_INPUT, "again");
    err_locate(&err, text, "/place");
    CHECK(!err.file[0] && !err.place[0]);
    err_locate(NULL, "nobody", "listens");
}

TEST_MAIN(TEST_CASE(set_fills_in_and_returns_false), TEST_CASE(prepend_keeps_the_code),
          TEST_CASE(the_message_may_be_its_own_argument), TEST_CASE(long_messages_are_cut),
          TEST_CASE(control_characters_cannot_reach_a_terminal),
          TEST_CASE(memory_names_the_purpose), TEST_CASE(the_place_is_that_of_the_problem))
