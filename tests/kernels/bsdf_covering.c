#include "bsdf_covering.h"

#include <stdbool.h>
#include <string.h>

// The number of candidates for a row; the one with most new pairs is taken.
#define CANDIDATES 30

static bool covered[COVERING_MAX_AXES][COVERING_MAX_VALUES][COVERING_MAX_AXES][COVERING_MAX_VALUES];

static uint32_t next_random(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(*state >> 33);
}

static uint32_t uncovered_with(uint32_t axis, uint8_t value, const uint8_t *row,
                               const bool *decided, uint32_t axes)
{
    uint32_t count = 0;
    for (uint32_t other = 0; other < axes; other++)
        if (other != axis && decided[other])
            count += !covered[axis][value][other][row[other]];
    return count;
}

// Returns how many pairs of this value with values of other axes no row has yet.
static uint32_t open_pairs(const uint8_t *values, uint32_t axes, uint32_t axis, uint8_t value)
{
    uint32_t count = 0;
    for (uint32_t other = 0; other < axes; other++)
        for (uint8_t v = 0; other != axis && v < values[other]; v++)
            count += !covered[axis][value][other][v];
    return count;
}

// Starts from a value with many such pairs, then chooses the values of the other axes in random
// order.
static uint32_t make_row(const uint8_t *values, uint32_t axes, uint64_t *random, uint8_t *row)
{
    bool decided[COVERING_MAX_AXES] = {false};
    uint32_t gained = 0, most = 0, start = 0;
    uint8_t start_value = 0;
    for (uint32_t axis = 0; axis < axes; axis++)
        for (uint8_t value = 0; value < values[axis]; value++) {
            uint32_t open = open_pairs(values, axes, axis, value) * 64 + next_random(random) % 64;
            if (open > most) {
                most = open;
                start = axis;
                start_value = value;
            }
        }
    row[start] = start_value;
    decided[start] = true;
    uint32_t shift = next_random(random) % axes;
    for (uint32_t i = 0; i < axes; i++) {
        uint32_t axis = (i * 7 + shift) % axes; // 7 and the numbers of axes in use are coprime
        for (uint32_t step = 0; decided[axis] && step < axes; step++)
            axis = (axis + 1) % axes;
        if (decided[axis])
            break;
        uint32_t best = 0, first = next_random(random);
        row[axis] = (uint8_t)(first % values[axis]);
        for (uint32_t v = 0; v < values[axis]; v++) {
            uint8_t value = (uint8_t)((first + v) % values[axis]);
            uint32_t gain = uncovered_with(axis, value, row, decided, axes);
            if (gain > best) {
                best = gain;
                row[axis] = value;
            }
        }
        gained += best;
        decided[axis] = true;
    }
    return gained;
}

static void cover(const uint8_t *row, uint32_t axes)
{
    for (uint32_t a = 0; a < axes; a++)
        for (uint32_t b = 0; b < axes; b++)
            covered[a][row[a]][b][row[b]] = true;
}

uint32_t covering_build(const uint8_t *values, uint32_t axes, uint8_t (*rows)[COVERING_MAX_AXES],
                        uint32_t capacity)
{
    uint64_t random = 1;
    uint32_t count = 0;
    memset(covered, 0, sizeof covered);
    while (count < capacity) {
        uint32_t best = 0;
        for (int i = 0; i < CANDIDATES; i++) {
            uint8_t row[COVERING_MAX_AXES] = {0};
            uint32_t gained = make_row(values, axes, &random, row);
            if (gained > best) {
                best = gained;
                memcpy(rows[count], row, sizeof row);
            }
        }
        if (best == 0)
            break;
        cover(rows[count++], axes);
    }
    return count;
}

uint32_t covering_missing(const uint8_t *values, uint32_t axes,
                          const uint8_t (*rows)[COVERING_MAX_AXES], uint32_t count)
{
    uint32_t missing = 0;
    memset(covered, 0, sizeof covered);
    for (uint32_t i = 0; i < count; i++)
        cover(rows[i], axes);
    for (uint32_t a = 0; a < axes; a++)
        for (uint32_t b = 0; b < a; b++)
            for (uint8_t va = 0; va < values[a]; va++)
                for (uint8_t vb = 0; vb < values[b]; vb++)
                    missing += !covered[a][va][b][vb];
    return missing;
}
