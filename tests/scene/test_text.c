// Tests numbers and words of text formats, with the C library's strtof as the reference.
#include "scene/core/text.h"
#include "test.h"

#include <locale.h>

static uint64_t random_state = 1;

// SplitMix64 (Steele, Lea, Flood 2014).
static uint64_t random_bits(void)
{
    uint64_t x = random_state += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

// Parsing must give the same bits, including the sign of zero, and end at the same character as
// strtof.
static void check_against_strtof(const char *text)
{
    char *expected_end;
    float expected = strtof(text, &expected_end), value = 0.0f;
    const char *end = text_parse_float(text, &value);
    REQUIRE(end == expected_end, "'%s': ended at %d", text, end ? (int)(end - text) : -1);
    CHECK(memcmp(&value, &expected, sizeof value) == 0, "'%s': %.9g, expected %.9g", text,
          (double)value, (double)expected);
}

// Does the same in double precision with strtod.
static void check_against_strtod(const char *text)
{
    char *expected_end;
    double expected = strtod(text, &expected_end), value = 0.0;
    struct text_reader reader = {.at = text, .end = text + strlen(text), .path = "text"};
    bool is_taken = text_take_double(&reader, &value);
    REQUIRE(is_taken == (*text != '\0' && *expected_end == '\0'), "'%s'", text);
    CHECK(!is_taken || memcmp(&value, &expected, sizeof value) == 0, "'%s': %.17g, expected %.17g",
          text, value, expected);
}

TEST(doubles)
{
    static const char *const texts[] = {
        "0",
        "-0",
        "5400000.123456789",
        "9007199254740993",
        "9007199254740992e22",
        "1e22",
        "1e23",
        "1e-22",
        "1e-23",
        "123456789012345678901.5",
        "2.2250738585072011e-308",
        "1.7976931348623157e308",
        "-1e400",
        "1e-400",
        "4.9e-324",
        "x",
        "1x",
        "",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        check_against_strtod(texts[i]);
    for (int i = 0; i < 100000; i++) {
        char text[64];
        uint64_t bits = random_bits();
        double real;
        memcpy(&real, &bits, sizeof real);
        if (!isfinite(real))
            continue;
        snprintf(text, sizeof text, "%.*e", i % 20, real);
        check_against_strtod(text);
        snprintf(text, sizeof text, "%.*f", i % 12, (double)(int64_t)bits * 1e-10);
        check_against_strtod(text);
    }
}

TEST(numbers_of_all_shapes)
{
    static const char *const texts[] = {
        "0",
        "-0",
        "+0.0e5",
        "1",
        "-1.5",
        ".5",
        "5.",
        "1e5",
        "1E+5",
        "1e-5",
        "1e",
        "1e+",
        "1.5e-x",
        "93.87400100000001",
        "123456789012345678901234567890",
        "0.000000000000000000000000000001234567890123456789",
        "1e38",
        "3.4028235e38",
        "3.4028236e38",
        "3.40282356e38",
        "3.402823567797336616e38",
        "1e39",
        "-1e400",
        "1e99999999999999999999",
        "1e-99999999999999999999",
        "0e99999999999999999999",
        "1.17549435e-38",
        "1.1754943e-38",
        "1e-40",
        "1.4e-45",
        "7e-46",
        "7.1e-46",
        "16777217",
        "16777216.99999999999",
        "16777217.0000000000000000000000001",
        "16777219",
        "33554434.0000000001",
        "1.00000005960464477539062500",
        "1.00000005960464477539062500000000000001",
        "1.00000005960464477539062499999999999999",
        "9999999999999999999",
        "18446744073709551616",
        "000000000000000000000000000000001.5",
        "0.1e1000000000000000001",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        check_against_strtof(texts[i]);
}

// Many zeros compensate a large exponent.
TEST(zeros_and_exponents_cancel)
{
    static char text[100100];
    strcpy(text, "0.");
    memset(text + 2, '0', 100000);
    strcpy(text + 100002, "25e100001");
    check_against_strtof(text);
    text[0] = '7';
    memset(text + 1, '0', 100000);
    strcpy(text + 100001, "e-100000");
    check_against_strtof(text);
}

TEST(random_numbers)
{
    for (int i = 0; i < 300000; i++) {
        char text[128];
        uint64_t bits = random_bits();
        uint32_t low = (uint32_t)bits;
        float single;
        double real;
        memcpy(&single, &low, sizeof single);
        memcpy(&real, &bits, sizeof real);
        if (!isfinite(single) || !isfinite(real))
            continue;
        snprintf(text, sizeof text, "%.*g", 1 + i % 12, (double)single);
        check_against_strtof(text);
        snprintf(text, sizeof text, "%.*f", i % 20, (double)(int64_t)bits * 1e-15);
        check_against_strtof(text);
        snprintf(text, sizeof text, "%.*e", i % 25, real);
        check_against_strtof(text);
    }
}

// Decimals exactly and almost midway between two neighbouring floats, for which rounding twice
// would be wrong.
TEST(numbers_between_two_floats)
{
    for (int i = 0; i < 100000; i++) {
        uint32_t bits = 0x3f800000u - (20u << 23) + (uint32_t)(random_bits() % (40u << 23));
        float low, high;
        memcpy(&low, &bits, sizeof low);
        bits++;
        memcpy(&high, &bits, sizeof high);
        double middle = 0.5 * ((double)low + (double)high); // exact
        char text[128];
        for (int digits = 6; digits < 40; digits += 3) {
            snprintf(text, sizeof text, "%.*g", digits, middle);
            check_against_strtof(text);
        }
        snprintf(text, sizeof text, "%.17g", nextafter(middle, 0.0));
        check_against_strtof(text);
        snprintf(text, sizeof text, "%.17g", nextafter(middle, 1e9));
        check_against_strtof(text);
    }
}

TEST(what_is_no_number)
{
    static const char *const texts[] = {"", "-", "+", ".", "-.", "e5", "x", "--1", "in", "na"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        float value;
        CHECK(!text_parse_float(texts[i], &value), "'%s'", texts[i]);
    }
}

TEST(infinite_and_nan)
{
    float value = 0.0f;
    CHECK(text_parse_float("inf", &value) && value == INFINITY);
    CHECK(text_parse_float("-Infinity", &value) && value == -INFINITY);
    CHECK(text_parse_float("+NaN", &value) && isnan(value));
    CHECK(text_parse_float("-nan", &value) && isnan(value));
}

// A locale with a decimal comma has no effect, neither on the fast path nor on the slow one.
TEST(the_locale_does_not_matter)
{
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8"))
        fprintf(stderr, "no locale de_DE.UTF-8: tested with a decimal point only\n");
    float value = 0.0f;
    const char *fast = "1.5", *slow = "1.00000005960464477539062500000000000001";
    CHECK(text_parse_float(fast, &value) == fast + 3 && value == 1.5f);
    CHECK(text_parse_float(slow, &value) == slow + strlen(slow) && value > 1.0f, "%.9g",
          (double)value);
    setlocale(LC_NUMERIC, "C");
}

static struct text_reader open_text(const char *text)
{
    struct file_bytes bytes = {(const uint8_t *)text, strlen(text)};
    struct text_reader reader = text_open("file", &bytes);
    reader.joins_lines = true;
    return reader;
}

TEST(integers)
{
    struct text_reader text = open_text(" -12 +7 9223372036854775807 99999999999999999999 5/6 x");
    static const int64_t expected[] = {-12, 7, INT64_MAX, INT64_MAX, 5};
    int64_t value;
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        bool is_read = text_take_integer(&text, &value);
        CHECK(is_read && value == expected[i], "%zu: %lld", i, (long long)value);
    }
    CHECK(!text_word_ended(&text) && *text.at == '/');
    text.at += 2;
    struct err err = {0};
    CHECK(!text_integer(&text, "a count", &value, &err) && err.code == ERR_INPUT);
    CHECK(strcmp(err.msg, "file:1: expected a count, found 'x'") == 0, "%s", err.msg);
}

TEST(words_and_lines)
{
    struct text_reader text = open_text("one  two\\\n three # no\nname with blanks \t\r\n\\\nlast");
    CHECK(text_equals(text_word(&text), "one"));
    CHECK(text_equals(text_word(&text), "two"));
    CHECK(text_equals(text_word(&text), "three") && text.line == 2);
    CHECK(text_line_ended(&text));
    text_next_line(&text);
    CHECK(text_equals(text_rest_of_line(&text), "name with blanks"));
    text_next_line(&text);
    CHECK(text_equals(text_word(&text), "last") && text.line == 5, "%llu",
          (unsigned long long)text.line);
    CHECK(text_line_ended(&text) && text_remaining(&text) == 0);
    CHECK(text_word(&text).size == 0);
}

TEST(only_printable_characters_are_shown)
{
    char shown[8];
    text_printable((struct text_span){"a\x1b[0m\xff!", 7}, shown, sizeof shown);
    CHECK(strcmp(shown, "a?[0m?!") == 0, "%s", shown);
    text_printable((struct text_span){"123456789", 9}, shown, sizeof shown);
    CHECK(strcmp(shown, "1234567") == 0, "%s", shown);
}

TEST_MAIN(TEST_CASE(doubles), TEST_CASE(numbers_of_all_shapes),
          TEST_CASE(zeros_and_exponents_cancel), TEST_CASE(random_numbers),
          TEST_CASE(numbers_between_two_floats), TEST_CASE(what_is_no_number),
          TEST_CASE(infinite_and_nan), TEST_CASE(the_locale_does_not_matter), TEST_CASE(integers),
          TEST_CASE(words_and_lines), TEST_CASE(only_printable_characters_are_shown))
