#include "base/err.h"
#include "base/log.h"
#include "base/printable.h"
#include "test.h"

static void check(const char *text, const char *expected)
{
    char copy[200];
    snprintf(copy, sizeof copy, "%s", text);
    printable_mask(copy);
    CHECK(strcmp(copy, expected) == 0, "\"%s\"; expected \"%s\"", copy, expected);
}

TEST(what_is_seen_stays)
{
    check("", "");
    check("plain, ~!", "plain, ~!");
    // Latin, Greek, Hebrew, Arabic, Devanagari and Chinese letters, an emoji, and one of the last
    // code points.
    static const char words[] = "\u00e9 \u03c0 \u05d0\u05d1 \u0627\u0644 \u0915\u093f \u4e2d "
                                "\U0001f600 \U0010fffd \u2026";
    check(words, words);
}

TEST(directions_cannot_be_changed)
{
    // "gpj.exe" displayed as "exe.jpg": tests every character with the property Bidi_Control.
    check("a\u202egpj.exr", "a?gpj.exr");
    check("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069",
          "????????????");
}

TEST(what_is_not_seen_is_shown)
{
    check("a\u200b\u200c\u200db\u2060\ufeff\u00ad\u034f\u3164\uffa0\u115f\u180e", "a???b????????");
    check("\ufe0f\ufff0\ufffb\U0001bca0\U0001d173\U000e0001\U000e0041\U000e01ef\U000e0fff",
          "?????????");
    check("one\u2028two\u2029three", "one?two?three");
}

TEST(no_control_of_a_terminal)
{
    check("\x01\t\n\r\x1b[2J\x7f", "?????[2J?");
    check("\xc2\x80\xc2\x85\xc2\x9b[2J\xc2\x9f", "???[2J?");
    check("\u00a0\u00ac\u00ae", "\u00a0\u00ac\u00ae"); // neighbours of masked characters
}

// Each invalid byte is masked separately, so that an incomplete character does not mask the text
// after it.
TEST(what_is_no_utf8)
{
    check("\x9b"
          "2J \x80\xff\xfe",
          "?2J ???");
    check("\xe4pfel", "?pfel");
    check("\xc3", "?");
    check("\xe2\x80", "??");
    check("\xf0\x9f\x98"
          "a",
          "???a");
    check("\xc0\x80 \xe0\x80\x80 \xed\xa0\x80 \xf4\x90\x80\x80 \xf8\x88\x80\x80\x80",
          "?? ??? ??? ???? ?????");
}

static char logged[300];

static void keep(void *context, enum log_level level, const char *message)
{
    (void)context, (void)level;
    snprintf(logged, sizeof logged, "%s", message);
}

TEST(messages_are_masked)
{
    struct err err = {0};
    err_set(&err, ERR_INPUT, "%s: cannot open", "a\u202egpj.exr");
    CHECK(strcmp(err.msg, "a?gpj.exr: cannot open") == 0, "%s", err.msg);
    err_prepend(&err, "%s", "\u2066scene\u200b");
    CHECK(strcmp(err.msg, "?scene?: a?gpj.exr: cannot open") == 0, "%s", err.msg);
    log_configure(LOG_WARN, keep, NULL);
    log_warn("%s: written, \x9b", "a\u202egpj.exr");
    log_configure(LOG_WARN, NULL, NULL);
    CHECK(strcmp(logged, "a?gpj.exr: written, ?") == 0, "%s", logged);
}

TEST_MAIN(TEST_CASE(what_is_seen_stays), TEST_CASE(directions_cannot_be_changed),
          TEST_CASE(what_is_not_seen_is_shown), TEST_CASE(no_control_of_a_terminal),
          TEST_CASE(what_is_no_utf8), TEST_CASE(messages_are_masked))
