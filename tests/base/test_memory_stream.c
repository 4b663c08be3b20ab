#include "test.h"

#include "base/memory_stream.h"

TEST(what_is_printed_is_the_text)
{
    struct memory_stream stream;
    REQUIRE(memory_stream_open(&stream));
    for (int i = 0; i < 30000; i++)
        fprintf(stream.file, "%d\n", i % 10);
    CHECK(memory_stream_close(&stream));
    CHECK(stream.size == 60000 && strlen(stream.text) == 60000, "%zu", stream.size);
    CHECK(strncmp(stream.text + 59996, "8\n9\n", 5) == 0);
    memory_stream_finish(&stream);
    CHECK(!stream.text);
}

TEST(nothing_is_an_empty_text)
{
    struct memory_stream stream;
    REQUIRE(memory_stream_open(&stream));
    CHECK(memory_stream_close(&stream) && stream.size == 0 && strcmp(stream.text, "") == 0);
    CHECK(!memory_stream_close(&stream)); // the stream is already closed
    memory_stream_finish(&stream);
    memory_stream_finish(&stream);
}

TEST_MAIN(TEST_CASE(what_is_printed_is_the_text), TEST_CASE(nothing_is_an_empty_text))
