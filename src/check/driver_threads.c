// Tests the driver's loops, atomics, barriers, memory and subgroup operations.
#include "check/driver.h"

#include "check/case_list.h"
#include <stdlib.h>
#include <string.h>

#define ITEMS 8192u

struct threads {
    uint32_t routine, constant, dispatches;
    uint32_t items;      // 0: ITEMS
    bool texels, ballot; // features that the device must have
    void (*fill)(uint32_t index, driver_item *item);
    bool (*judge)(const struct check *check, const struct driver_run *run, const driver_item *out,
                  struct check_result *result);
};

static void fill_numbers(uint32_t index, driver_item *item)
{
    *item = (driver_item){.u = {index, 0, 0, 0}};
}

static void fill_mixed(uint32_t index, driver_item *item)
{
    uint64_t state = index;
    for (int i = 0; i < 4; i++)
        item->u[i] = driver_random(&state);
}

// --- routines ------------------------------------------------------------------------------------

// The longest loop of the renderer adds eight sums of 2^12 samples. A traversal continues in
// another dispatch after 30,000 iterations (docs/architecture.md).
#define TURNS_NEEDED 32768u
#define TURNS_ASKED 100000u

static void fill_turns(uint32_t index, driver_item *item)
{
    (void)index;
    *item = (driver_item){.u = {TURNS_ASKED, 0, 0, 0}};
}

static bool judge_turns(const struct check *check, const struct driver_run *run,
                        const driver_item *out, struct check_result *result)
{
    (void)check, (void)run;
    uint32_t turns = out[0].u[0];
    if (turns == TURNS_ASKED)
        return check_seen(result, true, "all %u iterations", turns);
    return check_seen(result, turns >= TURNS_NEEDED, "the loop ends after %u iterations", turns);
}

static int compare_words(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

// Returns how many of 0 .. count-1 are not among the values exactly once.
static uint32_t missing_numbers(uint32_t *values, uint32_t count)
{
    uint32_t missing = 0;
    qsort(values, count, sizeof *values, compare_words);
    for (uint32_t i = 0; i < count; i++)
        missing += values[i] != i;
    return missing;
}

static bool judge_atomics(const struct check *check, const struct driver_run *run,
                          const driver_item *out, struct check_result *result)
{
    (void)check;
    static uint32_t values[ITEMS];
    for (uint32_t i = 0; i < run->items; i++)
        values[i] = out[i].u[0];
    uint32_t missing = missing_numbers(values, run->items);
    return check_seen(result, missing == 0, "%u of %u numbers are missing or occur twice", missing,
                      run->items);
}

static bool judge_barriers(const struct check *check, const struct driver_run *run,
                           const driver_item *out, struct check_result *result)
{
    (void)check;
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < run->items; i++) {
        uint32_t first = i / DRIVER_WORKGROUP * DRIVER_WORKGROUP;
        wrong += out[i].u[0] != first + (i - first + run->constant) % DRIVER_WORKGROUP;
    }
    return check_seen(result, wrong == 0, "%u of %u values are in the wrong place", wrong,
                      run->items);
}

static bool judge_array(const struct check *check, const struct driver_run *run,
                        const driver_item *out, struct check_result *result)
{
    (void)check;
    uint32_t wrong = 0, n = run->constant + 2;
    for (uint32_t i = 0; i < run->items; i++)
        wrong += out[i].u[0] != i * (n * (n - 1) / 2); // every element is visited: 97 is prime
    return check_seen(result, wrong == 0, "%u of %u sums are wrong", wrong, run->items);
}

static bool judge_dispatches(const struct check *check, const struct driver_run *run,
                             const driver_item *out, struct check_result *result)
{
    (void)check;
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < run->items; i++) {
        // The first dispatch reads element 1 of the uploaded data, which is 0.
        uint32_t value = 0;
        for (uint32_t k = 0; k < run->dispatches; k++)
            value = 3 * value + 1;
        wrong += out[i].u[~run->dispatches & 1u] != value;
    }
    return check_seen(result, wrong == 0, "%u of %u values are wrong", wrong, run->items);
}

static bool judge_texels(const struct check *check, const struct driver_run *run,
                         const driver_item *out, struct check_result *result)
{
    (void)check;
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < run->items; i++) {
        driver_item expected;
        fill_mixed(i, &expected);
        wrong += memcmp(&expected, &out[i], sizeof expected) != 0;
    }
    return check_seen(result, wrong == 0, "%u of %u texels have other values", wrong, run->items);
}

static bool judge_subgroups(const struct check *check, const struct driver_run *run,
                            const driver_item *out, struct check_result *result)
{
    static uint32_t ranks[ITEMS];
    uint32_t odd = 0, other_size = 0;
    for (uint32_t i = 0; i < run->items; i++) {
        other_size += out[i].u[0] != check->gpu->subgroup_size;
        if (out[i].u[3] & 1u)
            ranks[odd++] = out[i].u[1];
    }
    uint32_t missing = missing_numbers(ranks, odd);
    return check_seen(result, missing == 0 && odd == run->items / 2 && other_size == 0,
                      "%u lanes, %u threads with another size, %u of %u ranks missing or twice",
                      out[0].u[0], other_size, missing, odd);
}

static bool judge_reconvergence(const struct check *check, const struct driver_run *run,
                                const driver_item *out, struct check_result *result)
{
    (void)check;
    uint32_t apart = 0;
    for (uint32_t i = 0; i < run->items; i++)
        apart += out[i].u[0] != out[i].u[1];
    return check_seen(result, apart == 0,
                      "%u of %u threads vote without some threads of their subgroup", apart,
                      run->items);
}

static bool judge_timestamps(const struct check *check, const struct driver_run *run,
                             const driver_item *out, struct check_result *result)
{
    (void)check, (void)out;
    bool plausible = run->device_ns > 0.0 && run->device_ns <= run->host_ns;
    return check_seen(result, plausible, "%.3f ms by the device, %.3f ms by the host",
                      run->device_ns * 1e-6, run->host_ns * 1e-6);
}

static bool run_threads(const struct check *check, const struct check_case *this_case,
                        struct check_result *result, struct err *err)
{
    const struct threads *t = this_case->data;
    struct driver_run run = {.program = DRIVER_THREADS,
                             .routine = t->routine,
                             .constant = t->constant,
                             .items = t->items ? t->items : ITEMS,
                             .dispatches = t->dispatches,
                             .texels = t->texels};
    if (t->ballot && !check->gpu->has_ballot)
        return check_not_run(result, "the device has no subgroup ballot, and none is used");
    if (t->texels && !gpu_texel_fits(check->gpu, ITEMS * sizeof(driver_item)))
        return check_not_run(result, "the device has too few texels, and none are used");
    if (t->judge == judge_timestamps && !check->gpu->has_timestamps)
        return check_not_run(result, "the device has no timestamps, and none are used");
    static driver_item items[ITEMS];
    for (uint32_t i = 0; i < ITEMS; i++)
        t->fill(i, &items[i]);
    return driver_run(check, &run, items, err) && t->judge(check, &run, items, result);
}

#define THREADS(...)                                                                               \
    .run = run_threads, .data = &(const struct threads)                                            \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }

static const struct check_case cases[] = {
    {"loops", "at least 32,768 iterations",
     THREADS(CHECK_LOOP, .items = DRIVER_WORKGROUP, .fill = fill_turns, .judge = judge_turns)},
    {"atomics", "8,192 threads get 8,192 different numbers",
     THREADS(CHECK_ATOMICS, .fill = fill_numbers, .judge = judge_atomics)},
    {"barriers", "values move around their workgroup 37 times",
     THREADS(CHECK_BARRIERS, 37, .fill = fill_numbers, .judge = judge_barriers)},
    {"arrays sized by a constant", "97 elements keep the values that are written",
     THREADS(CHECK_ARRAY, 95, .fill = fill_numbers, .judge = judge_array)},
    {"memory between dispatches", "each of 64 dispatches reads what the previous one has written",
     THREADS(CHECK_DISPATCHES, .dispatches = 64, .fill = fill_numbers, .judge = judge_dispatches)},
    {"texel buffers", "the words that were written",
     THREADS(CHECK_TEXELS, .texels = true, .fill = fill_mixed, .judge = judge_texels)},
    {"subgroups", "the size that the device reports, and each rank once",
     THREADS(CHECK_SUBGROUPS, .ballot = true, .fill = fill_numbers, .judge = judge_subgroups)},
    {"reconvergence", "after a branch all lanes vote together",
     THREADS(CHECK_RECONVERGENCE, .ballot = true, .fill = fill_numbers,
             .judge = judge_reconvergence)},
    {"timestamps", "they increase, by at most as much as the host's clock",
     THREADS(CHECK_LOOP, .items = DRIVER_WORKGROUP, .fill = fill_turns, .judge = judge_timestamps)},
};

CHECK_GROUP(check_threads, "threads",
            "loops, atomics, barriers, memory and subgroups of the driver", cases);
