#include "bsdf_means.h"

#include "metrics/metrics.h"

enum { MAX_REPLICATES = 64 };

// Fills an additive recurrence with the powers of the inverse of the root of x^5 = x + 1 (Roberts
// 2018, "The Unreasonable Effectiveness of Quasirandom Sequences"), in 24 bits.
static void fill_sequence(const struct configuration *c, uint32_t number, union bsdf_item *items,
                          uint32_t count, struct random *random)
{
    double shift[4], step[4], root = 1.1673039782614187, power = 1;
    for (int k = 0; k < 4; k++) {
        shift[k] = random_unit(random);
        power /= root;
        step[k] = power;
    }
    for (uint32_t i = 0; i < count; i++) {
        items[i] = (union bsdf_item){.in = {.material = number + 1, .eta = c->eta}};
        memcpy(items[i].in.wo, c->wo, sizeof items[i].in.wo);
        for (int k = 0; k < 4; k++) {
            double x = shift[k] + step[k] * i;
            items[i].in.u[k] = (float)floor((x - floor(x)) * 0x1p24) * 0x1p-24f;
        }
    }
}

// Refracted radiance contains the factor 1 / eta^2, which this removes to get energy.
static double energy_scale(const struct configuration *c, const union bsdf_item *item)
{
    bool bends = (item->sample.flags & BSDF_TRANSMITTED) && !(c->material.flags & MATERIAL_THIN);
    return bends && !c->choices.unscaled ? (double)c->eta * (double)c->eta : 1;
}

struct replicate {
    double absorbed, albedo[3];
};

static struct replicate sum_replicate(const struct configuration *c, const union bsdf_item *items,
                                      uint32_t count)
{
    struct replicate sum = {0};
    for (uint32_t i = 0; i < count; i++) {
        bool valid = items[i].sample.flags & BSDF_VALID;
        sum.absorbed += valid ? 0 : 1.0 / count;
        double scale = valid ? energy_scale(c, &items[i]) / count : 0;
        for (int k = 0; k < 3 && valid; k++)
            sum.albedo[k] += scale * (double)items[i].sample.weight[k];
    }
    return sum;
}

bool bsdf_measure(struct bsdf_device *device, const struct configuration *configuration,
                  uint32_t number, uint32_t replicates, uint32_t samples, struct bsdf_means *out)
{
    double absorbed[MAX_REPLICATES], albedo[3][MAX_REPLICATES], variance;
    struct random random = {number + 1000};
    union bsdf_item *items = malloc(samples * sizeof *items);
    bool ok = items && replicates <= MAX_REPLICATES;
    for (uint32_t r = 0; r < replicates && ok; r++) {
        fill_sequence(configuration, number, items, samples, &random);
        ok = bsdf_run(device, BSDF_ROUTINE_SAMPLE, BSDF_LOBES_CLASS, &configuration->material,
                      items, samples);
        struct replicate sum = sum_replicate(configuration, items, samples);
        absorbed[r] = sum.absorbed;
        for (int c = 0; c < 3; c++)
            albedo[c][r] = sum.albedo[c];
    }
    free(items);
    if (!ok)
        return false;
    stats_mean_variance(absorbed, replicates, &out->absorbed, &variance);
    out->absorbed_error = sqrt(variance / replicates);
    for (int c = 0; c < 3; c++) {
        stats_mean_variance(albedo[c], replicates, &out->albedo[c], &variance);
        out->albedo_error[c] = sqrt(variance / replicates);
    }
    return true;
}
