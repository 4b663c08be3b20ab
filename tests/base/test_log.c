#include "base/log.h"
#include "base/parallel.h"
#include "base/thread.h"
#include "test.h"

struct record {
    int count;
    enum log_level level;
    char message[2048];
};

static void keep(void *context, enum log_level level, const char *message)
{
    struct record *record = context;
    record->count++;
    record->level = level;
    snprintf(record->message, sizeof record->message, "%s", message);
}

TEST(the_level_decides)
{
    struct record record = {0};
    log_configure(LOG_INFO, keep, &record);
    log_message(LOG_DEBUG, "too much");
    CHECK(record.count == 0);
    log_info("%d triangles", 3);
    CHECK(record.count == 1 && record.level == LOG_INFO);
    CHECK(strcmp(record.message, "3 triangles") == 0, "%s", record.message);
    log_configure(LOG_ERROR, keep, &record);
    log_warn("unheard");
    CHECK(record.count == 1);
    log_configure(LOG_WARN, NULL, NULL);
}

TEST(messages_are_one_line_and_of_bounded_length)
{
    struct record record = {0};
    log_configure(LOG_WARN, keep, &record);
    log_warn("a\nb\x1b");
    CHECK(strcmp(record.message, "a?b?") == 0, "%s", record.message);
    char text[4000];
    memset(text, 'x', sizeof text);
    text[sizeof text - 1] = '\0';
    log_warn("%s", text);
    CHECK(record.count == 2);
    log_configure(LOG_WARN, NULL, NULL);
}

static void warn_often(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)context;
    for (size_t i = begin; i < end; i++)
        log_warn("%zu from %u", i, thread);
}

TEST(threads_take_turns)
{
    struct record record = {0};
    log_configure(LOG_WARN, keep, &record);
    parallel_for(10000, 10, 4, warn_often, NULL);
    CHECK(record.count == 10000, "%d", record.count);
    log_configure(LOG_WARN, NULL, NULL);
}

TEST(a_thread_may_have_a_sink_of_its_own)
{
    struct record process = {0}, own = {0};
    struct mutex mutex = MUTEX_INIT;
    const struct log_target target = {LOG_INFO, keep, &own, &mutex};
    log_configure(LOG_WARN, keep, &process);
    CHECK(log_redirect(&target) == NULL);
    log_info("mine");
    parallel_for(1000, 10, 4, warn_often, NULL);
    CHECK(own.count == 1001 && process.count == 0, "%d and %d", own.count, process.count);
    CHECK(log_redirect(NULL) == &target);
    log_info("below the process's level");
    parallel_for(1000, 10, 4, warn_often, NULL);
    CHECK(own.count == 1001 && process.count == 1000, "%d and %d", own.count, process.count);
    log_configure(LOG_WARN, NULL, NULL);
}

TEST_MAIN(TEST_CASE(a_thread_may_have_a_sink_of_its_own), TEST_CASE(the_level_decides),
          TEST_CASE(messages_are_one_line_and_of_bounded_length), TEST_CASE(threads_take_turns))
