#include "base/memory.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t difference(uint64_t a, uint64_t b)
{
    return a > b ? a - b : 0;
}

uint64_t memory_default_budget(void)
{
    uint64_t available = memory_available();
    return available == UINT64_MAX ? 0 : available / 4 * 3;
}

// --- the process's memory ------------------------------------------------------------------------

static struct {
    _Atomic uint64_t budget; // 0: no limit
    _Atomic uint64_t used, failures;
    _Atomic uint64_t refused, left; // bytes of the last refused request, and bytes that were left
                                    // then
} memory;

void memory_set_budget(uint64_t bytes)
{
    atomic_store(&memory.budget, bytes);
}

uint64_t memory_budget(void)
{
    return atomic_load(&memory.budget);
}

uint64_t memory_used(void)
{
    return atomic_load(&memory.used);
}

uint64_t memory_failures(void)
{
    return atomic_load(&memory.failures);
}

uint64_t memory_refused(uint64_t *left)
{
    *left = atomic_load(&memory.left);
    return atomic_exchange(&memory.refused, 0);
}

static void note_failure(uint64_t refused)
{
    atomic_store(&memory.left, difference(memory_budget(), memory_used()));
    atomic_store(&memory.refused, refused);
    atomic_fetch_add(&memory.failures, 1);
}

static bool fits(uint64_t bytes, uint64_t used)
{
    uint64_t budget = atomic_load_explicit(&memory.budget, memory_order_relaxed);
    return budget == 0 || bytes <= difference(budget, used);
}

bool memory_take(uint64_t bytes)
{
    uint64_t used = atomic_load_explicit(&memory.used, memory_order_relaxed);
    while (fits(bytes, used))
        if (atomic_compare_exchange_weak(&memory.used, &used, used + bytes))
            return true;
    note_failure(bytes);
    return false;
}

void memory_give(uint64_t bytes)
{
    atomic_fetch_sub(&memory.used, bytes);
}

void memory_fail(uint64_t bytes)
{
    memory_give(bytes);
    note_failure(0);
}

bool memory_check(uint64_t bytes, const char *what, struct err *err)
{
    if (fits(bytes, memory_used()))
        return true;
    note_failure(bytes);
    return err_memory(err, what, bytes);
}

void *memory_alloc(size_t bytes)
{
    if (!memory_take(bytes))
        return NULL;
    void *data = calloc(1, bytes);
    if (!data) {
        memory_fail(bytes);
        return NULL;
    }
    // Adds the block's actual size, which memory_free will subtract.
    atomic_fetch_add(&memory.used, memory_block_bytes(data) - bytes);
    return data;
}

void memory_free(void *data)
{
    if (data)
        memory_give(memory_block_bytes(data));
    free(data);
}

// --- text ----------------------------------------------------------------------------------------

struct memory_text memory_print(uint64_t bytes)
{
    static const char *const units[] = {"KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
    struct memory_text out;
    double value = (double)bytes / 1024;
    size_t unit = 0;
    for (; value >= 1023.95 && unit + 1 < sizeof units / sizeof units[0]; unit++)
        value /= 1024;
    if (bytes < 1024)
        snprintf(out.text, sizeof out.text, "%u bytes", (unsigned)bytes);
    else
        snprintf(out.text, sizeof out.text, "%.1f %s", value, units[unit]);
    return out;
}
