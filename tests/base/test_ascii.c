#include "test.h"

#include "base/ascii.h"
#include "base/file.h"

TEST(the_case_of_ascii_letters_does_not_matter)
{
    CHECK(ascii_equal("glTF", "GLtf") && ascii_equal("", ""));
    CHECK(!ascii_equal("json", "jso") && !ascii_equal("jso", "json"));
    CHECK(!ascii_equal("[", "{") && !ascii_equal("@", "`")); // these codes differ in the same bit
                                                             // as upper and lower case letters
    CHECK(!ascii_equal("\xc3\x84", "\xc3\xa4"));             // Ä and ä differ in any locale
}

TEST(prefixes)
{
    CHECK(ascii_begins("DATA:text", "data:") && ascii_begins("x", ""));
    CHECK(!ascii_begins("dat", "data:") && !ascii_begins("", "x"));
}

TEST(extensions)
{
    CHECK(path_has_extension("a.b/c.PNG", "png") && path_has_extension("c", ""));
    CHECK(!path_has_extension("c.png", "ng") && !path_has_extension(".png", "png"));
    CHECK(!path_has_extension("a.png/c", "png"));
}

TEST_MAIN(TEST_CASE(the_case_of_ascii_letters_does_not_matter), TEST_CASE(prefixes),
          TEST_CASE(extensions))
