#include "check/scene/media_overlaps.h"

#include "shared/types.h"

struct overlap *overlaps_of(struct overlaps *overlaps, uint32_t upper, uint32_t lower,
                            uint32_t object)
{
    for (uint32_t i = 0; i < overlaps->count; i++)
        if (overlaps->items[i].upper == upper && overlaps->items[i].lower == lower)
            return &overlaps->items[i];
    if (overlaps->count == OVERLAPS_MAX)
        return NULL;
    overlaps->items[overlaps->count] =
        (struct overlap){.upper = upper, .lower = lower, .object = object};
    return &overlaps->items[overlaps->count++];
}

// --- the order of media --------------------------------------------------------------------------

#define PRIORITY_MAX 255u

// The numbers of the media in the desired order. They ascend with the media's priorities.
struct order {
    uint32_t media[MEDIA_MAX], count;
    uint32_t priorities[MEDIA_MAX + 1]; // priority of each medium, by number
    bool is_possible;                   // the available priorities are sufficient for this order
};

// Returns whether a medium vanishes by mistake. A body that is always inside of the other body was
// intended to be there; if lines cross its border, the two bodies only overlap.
static bool vanishes(const struct overlap *overlap)
{
    return overlap->crossed == 0 && overlap->swallowed > 0;
}

// Returns whether the lower of two media vanishes inside of the upper one wherever they overlap.
// Several pairs of materials may have these two media.
static bool is_to_swap(const struct gpu_material *materials, const struct overlaps *overlaps,
                       uint32_t lower, uint32_t upper)
{
    bool is_swallowed = false;
    for (uint32_t i = 0; i < overlaps->count; i++) {
        const struct overlap *overlap = &overlaps->items[i];
        if (materials[overlap->lower].medium != lower || materials[overlap->upper].medium != upper)
            continue;
        if (!vanishes(overlap) || overlap->held > 0)
            return false;
        is_swallowed = true;
    }
    return is_swallowed;
}

// Swaps adjacent media only, so that the order of all other pairs is kept.
static void swap_neighbours(const struct gpu_material *materials, const struct overlaps *overlaps,
                            struct order *order)
{
    bool changes = true;
    while (changes) {
        changes = false;
        for (uint32_t k = 0; k + 1 < order->count; k++) {
            uint32_t lower = order->media[k], upper = order->media[k + 1];
            if (lower > upper || !is_to_swap(materials, overlaps, lower, upper))
                continue;
            order->media[k] = upper;
            order->media[k + 1] = lower;
            changes = true;
        }
    }
}

// Raises priorities until they ascend. Media keep equal priorities if their order in the file is
// the right one; a medium that is raised gets a priority of its own.
static void raise(struct order *order)
{
    bool was_raised = false;
    for (uint32_t k = 1; k < order->count; k++) {
        uint32_t before = order->media[k - 1], medium = order->media[k];
        uint32_t least = order->priorities[before] + (was_raised || before > medium);
        was_raised = order->priorities[medium] < least;
        if (was_raised)
            order->priorities[medium] = least;
        order->is_possible &= order->priorities[medium] <= PRIORITY_MAX;
    }
}

static void find_order(const struct survey *survey, const struct gpu_material *materials,
                       const struct overlaps *overlaps, struct order *order)
{
    *order = (struct order){.count = survey->job.renderer.tables.medium_count, .is_possible = true};
    for (uint32_t k = 0; k < order->count; k++)
        order->media[k] = k + 1;
    for (uint32_t i = 0; i < survey->scene->material_count; i++)
        order->priorities[materials[i].medium] = survey->scene->materials[i].medium_priority;
    swap_neighbours(materials, overlaps, order);
    raise(order);
}

static bool is_above(const struct order *order, uint32_t a, uint32_t b)
{
    for (uint32_t k = order->count; k-- > 0;)
        if (order->media[k] == a || order->media[k] == b)
            return order->media[k] == a;
    return false;
}

// --- the findings --------------------------------------------------------------------------------

static bool add(struct survey *survey, const struct overlap *overlap, bool can_fix, struct err *err)
{
    bool is_wrong = vanishes(overlap);
    const char *object = survey_object_name(survey, overlap->object);
    const char *materials[] = {survey_material_name(survey, overlap->lower),
                               survey_material_name(survey, overlap->upper)};
    if (!object || !materials[0] || !materials[1])
        return err_memory(err, "names", 0);
    const uint8_t *touched = survey_touched_by_object(survey, overlap->object);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "media-overlap",
            .level = is_wrong ? FINDING_WRONG : FINDING_REMARK,
            .place =
                arena_printf(survey->arena, "%s, %s, and %s", object, materials[0], materials[1]),
            .figure = arena_printf(survey->arena, "both have \"priority\" %u",
                                   survey->scene->materials[overlap->lower].medium_priority),
            .consequence = is_wrong
                               ? "The inner medium is treated as the outer one, so it vanishes."
                               : "Where they overlap, the order of the materials in the file "
                                 "decides which medium applies.",
            .remedy = "Give the medium that should apply there the higher \"priority\".",
            .share = survey_share(survey, touched),
            .pixels = touched,
            .change = can_fix ? "the inner medium gets the higher \"priority\"; the order of all "
                                "other media is unchanged"
                              : NULL,
        },
        err);
}

bool overlaps_add(struct survey *survey, const struct overlaps *overlaps, struct err *err)
{
    const struct gpu_material *materials = survey_gpu_materials(survey);
    struct order order;
    find_order(survey, materials, overlaps, &order);
    for (uint32_t i = 0; i < overlaps->count; i++) {
        const struct overlap *overlap = &overlaps->items[i];
        bool can_fix = order.is_possible && is_above(&order, materials[overlap->lower].medium,
                                                     materials[overlap->upper].medium);
        if (overlap->crossed + overlap->swallowed > 0 && !add(survey, overlap, can_fix, err))
            return false;
    }
    for (uint32_t i = 0; i < survey->scene->material_count && order.is_possible; i++)
        if (survey->params->fixes && materials[i].medium > 0)
            survey->scene->materials[i].medium_priority = order.priorities[materials[i].medium];
    return true;
}
