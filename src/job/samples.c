#include "job/samples.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

uint64_t samples_count(const struct sample_ranges *ranges)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < ranges->count; i++)
        count += ranges->list[i].end - ranges->list[i].first;
    return count;
}

struct sample_range samples_of_part(uint32_t index, uint32_t count, uint64_t samples)
{
    // There are at most 2^31 pairs, so the products fit into 64 bits.
    uint64_t pairs = samples / 2;
    struct sample_range range = {2 * (pairs * (index - 1) / count), 2 * (pairs * index / count)};
    if (index == count)
        range.end = samples;
    return range;
}

struct sample_range rows_of_part(uint32_t index, uint32_t count, uint32_t rows, uint32_t side)
{
    const uint64_t tiles = rows / side + (rows % side != 0);
    struct sample_range range = {side * (tiles * (index - 1) / count),
                                 side * (tiles * index / count)};
    if (index == count)
        range.end = rows;
    return range;
}

// Reads a decimal number; a sign or blanks before it are errors. Returns the rest of the text, or
// NULL.
static const char *parse_number(const char *text, uint64_t *out)
{
    if (*text < '0' || *text > '9')
        return NULL;
    char *end;
    *out = strtoull(text, &end, 10);
    return *out <= UINT32_MAX ? end : NULL;
}

const char *samples_parse_range(const char *text, struct sample_range *out)
{
    text = parse_number(text, &out->first);
    if (!text || *text != ':')
        return NULL;
    text = parse_number(text + 1, &out->end);
    return text && out->first < out->end ? text : NULL;
}

bool samples_parse(const char *text, size_t length, struct arena *arena, struct sample_ranges *out)
{
    const char *end = text + length;
    size_t most = 1;
    for (size_t i = 0; i < length; i++)
        most += text[i] == ',';
    *out = (struct sample_ranges){.list = ARENA_NEW(arena, struct sample_range, most)};
    if (!out->list)
        return false;
    while (true) {
        struct sample_range range;
        text = samples_parse_range(text, &range);
        bool follows = out->count == 0 || (text && range.first > out->list[out->count - 1].end);
        if (!text || text > end || !follows || out->count == most)
            return false;
        out->list[out->count++] = range;
        if (text == end)
            return true;
        if (*text++ != ',')
            return false;
    }
}

const char *samples_text(const struct sample_ranges *ranges, struct arena *arena)
{
    // Each range takes at most two numbers of 32 bits, a colon and a comma.
    const size_t size = 22 * (size_t)ranges->count + 8;
    char *text = ARENA_NEW(arena, char, size);
    size_t used = 0;
    for (uint32_t i = 0; text && i < ranges->count; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%" PRIu64 ":%" PRIu64, i ? "," : "",
                                 ranges->list[i].first, ranges->list[i].end);
    if (text && ranges->count == 0)
        snprintf(text, size, "none");
    return text;
}

bool samples_overlap(const struct sample_ranges *a, const struct sample_ranges *b,
                     struct sample_range *out)
{
    for (uint32_t i = 0, k = 0; i < a->count && k < b->count;) {
        const struct sample_range *x = &a->list[i], *y = &b->list[k];
        out->first = x->first > y->first ? x->first : y->first;
        out->end = x->end < y->end ? x->end : y->end;
        if (out->first < out->end)
            return true;
        if (x->end < y->end)
            i++;
        else
            k++;
    }
    return false;
}

bool samples_join(const struct sample_ranges *a, const struct sample_ranges *b, struct arena *arena,
                  struct sample_ranges *out, struct err *err)
{
    size_t most = (size_t)a->count + b->count;
    *out = (struct sample_ranges){.list = ARENA_NEW(arena, struct sample_range, most)};
    if (!out->list)
        return err_memory(err, "ranges of samples", most * sizeof *out->list);
    for (uint32_t i = 0, k = 0; i < a->count || k < b->count;) {
        bool takes_a = k == b->count || (i < a->count && a->list[i].first < b->list[k].first);
        const struct sample_range *next = takes_a ? &a->list[i++] : &b->list[k++];
        if (out->count > 0 && out->list[out->count - 1].end == next->first)
            out->list[out->count - 1].end = next->end;
        else
            out->list[out->count++] = *next;
    }
    return true;
}

bool samples_missing(const struct sample_ranges *ranges, uint64_t end, struct arena *arena,
                     struct sample_ranges *out, struct err *err)
{
    size_t most = (size_t)ranges->count + 1;
    *out = (struct sample_ranges){.list = ARENA_NEW(arena, struct sample_range, most)};
    if (!out->list)
        return err_memory(err, "ranges of samples", most * sizeof *out->list);
    uint64_t at = 0;
    for (uint32_t i = 0; i < ranges->count && at < end; i++) {
        uint64_t first = ranges->list[i].first < end ? ranges->list[i].first : end;
        if (first > at)
            out->list[out->count++] = (struct sample_range){at, first};
        at = ranges->list[i].end;
    }
    if (at < end)
        out->list[out->count++] = (struct sample_range){at, end};
    return true;
}
