// Looks a direction up in a photometric profile, for tests: kernels read it from a texture.
#ifndef LAMPYRIS_TESTS_IES_REFERENCE_H
#define LAMPYRIS_TESTS_IES_REFERENCE_H

#include "scene/sky/ies.h"
#include <stddef.h>

static inline uint32_t ies_interval(const float *angles, uint32_t count, double angle)
{
    uint32_t low = 0, high = count - 1;
    while (low + 1 < high) {
        uint32_t middle = (low + high) / 2;
        if ((double)angles[middle] <= angle)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static inline double ies_at_vertical(const struct light_profile *p, uint32_t plane, uint32_t v,
                                     double part)
{
    const float *row = &p->relative[(size_t)plane * p->vertical_count];
    uint32_t next = v + 1 < p->vertical_count ? v + 1 : v;
    return (double)row[v] + part * ((double)row[next] - (double)row[v]);
}

// At these angles in degrees; horizontal in [0, 360].
static inline double ies_relative(const struct light_profile *p, double vertical, double horizontal)
{
    uint32_t count = p->vertical_count;
    if (vertical < (double)p->vertical[0] || vertical > (double)p->vertical[count - 1])
        return 0;
    uint32_t v = ies_interval(p->vertical, count, vertical), h = 0;
    double part_v = 0, part_h = 0;
    if (count > 1)
        part_v = (vertical - (double)p->vertical[v]) /
                 ((double)p->vertical[v + 1] - (double)p->vertical[v]);
    if (p->horizontal_count == 1)
        return ies_at_vertical(p, 0, v, part_v);
    h = ies_interval(p->horizontal, p->horizontal_count, horizontal);
    part_h = (horizontal - (double)p->horizontal[h]) /
             ((double)p->horizontal[h + 1] - (double)p->horizontal[h]);
    double low = ies_at_vertical(p, h, v, part_v), high = ies_at_vertical(p, h + 1, v, part_v);
    return low + part_h * (high - low);
}

#endif
