// Adds the films of several renderers: their records and their statistics.
#include "job/crew.h"
#include "job/job_internal.h"
#include "shared/aov.h"
#include <string.h>

void job_add_stats(const struct render_stats *part, struct render_stats *to)
{
    to->render_seconds += part->render_seconds;
    to->closest_rays += part->closest_rays;
    to->shadow_rays += part->shadow_rays;
    for (uint32_t i = 0; i < CLASS_COUNT; i++)
        to->surface_hits[i] += part->surface_hits[i];
    for (uint32_t i = 0; i < STEPS_COUNT; i++)
        to->steps[i] += part->steps[i];
    for (uint32_t i = 0; i < KERNEL_COUNT; i++) {
        const double longest = part->kernels[i].longest_ms;
        to->kernels[i].ms += part->kernels[i].ms;
        to->kernels[i].launches += part->kernels[i].launches;
        to->kernels[i].longest_ms =
            longest > to->kernels[i].longest_ms ? longest : to->kernels[i].longest_ms;
        for (uint32_t k = 0; k < STATS_BOUNCES; k++)
            to->bounce_ms[k][i] += part->bounce_ms[k][i];
    }
    to->host.recording += part->host.recording;
    to->host.submitting += part->host.submitting;
    to->host.reading_back += part->host.reading_back;
    to->paths += part->paths;
    to->sparse += part->sparse;
    to->branches += part->branches;
    to->clamped += part->clamped;
    to->clamped_light += part->clamped_light;
    to->waves_ahead += part->waves_ahead;
    to->media_lost += part->media_lost;
    to->waves += part->waves;
    to->voided_waves += part->voided_waves;
    to->suspended += part->suspended;
    const struct nonfinite_stats *from = &part->nonfinite;
    struct nonfinite_stats *sum = &to->nonfinite;
    for (int site = 0; site < SITE_COUNT; site++)
        sum->count[site] += from->count[site];
    bool is_lower =
        from->pixel < sum->pixel || (from->pixel == sum->pixel && from->sample < sum->sample);
    if (from->recorded && (!sum->recorded || is_lower)) {
        sum->recorded = true;
        sum->pixel = from->pixel;
        sum->sample = from->sample;
        sum->site = from->site;
        sum->bounce = from->bounce;
    }
}

void crew_add(uint32_t aovs, uint64_t bytes, const struct crew_film *part, struct crew_film *to)
{
    const bool precedes = !to->has_samples || part->copy.emptied_at < to->copy.emptied_at;
    job_add_stats(&part->copy.stats, &to->copy.stats);
    if (!part->has_samples)
        return;
    film_records_add(aovs, part->copy.records, to->copy.records,
                     bytes / (16 * AOV_FILM_WORDS(aovs)), precedes);
    if (precedes)
        to->copy.emptied_at = part->copy.emptied_at;
    to->has_samples = true;
}

bool crew_is_uniform(const struct crew *crew)
{
    for (uint32_t i = 1; i <= crew->count; i++)
        if (strcmp(crew->members[i].device, crew->members[0].device) != 0 ||
            strcmp(crew->members[i].driver, crew->members[0].driver) != 0)
            return false;
    return true;
}
