// Finds surfaces that bound a medium but are open, face the wrong way or overlap. The search uses
// lines from the camera, lines that start at the surfaces that the camera sees, and paths that
// continue from these surfaces. Lines through glass that coincides with another surface are not
// used, because rounding decides which medium they enter or leave there (find_coincident.c).
#include "check/scene/media_overlaps.h"

#include "base/maths.h"
#include "shared/methods.h"
#include "shared/types.h"
#include <string.h>

#define NESTING_MAX 4 // depth of the media stack in lib/media.glsl

// The kinds of inconsistency: a medium is left but was not entered, is entered but not left, or is
// nested too deeply.
enum loss_kind { LOSS_LEFT, LOSS_OPEN, LOSS_NESTED, LOSS_KINDS };
// The inconsistencies that lines through one object have shown.
struct losses {
    uint32_t material; // material of the first surface found
    uint32_t count;    // number of pixels affected
    uint32_t last;     // index of the last of these pixels plus 1
};
// The inconsistencies along the lines of sight, or along the paths that continue from their ends.
struct ways {
    struct losses *losses[LOSS_KINDS]; // for each kind, one entry per object
    uint32_t *lost;                    // for each pixel, a bit for each kind
    uint32_t *told;                    // like `lost`, but without the losses at objects of `named`
    const bool *named;                 // objects that another finding already names; NULL: none
};

struct entered {
    uint32_t medium, object, material; // SCENE_NONE for the medium around the camera
};
#define STACK_MOST (2 * SIGHTING_STEPS)
struct stack {
    struct entered items[STACK_MOST];
    uint32_t count;
};

struct media_search {
    struct survey *survey;
    const struct gpu_material *materials; // materials as uploaded, with the numbers of their media
    struct ways sight, paths;
    struct stack *stacks; // for each pixel, the media at the end of its line of sight
    struct overlaps overlaps;
};

static bool is_infinite(const struct survey *survey, uint32_t object)
{
    uint32_t shape = object - survey->scene->instance_count;
    return !survey_is_instance(survey, object) && survey->scene->shapes[shape].kind == SHAPE_PLANE;
}

static void note(struct ways *ways, enum loss_kind kind, const struct entered *what, uint32_t pixel)
{
    struct losses *losses = &ways->losses[kind][what->object];
    ways->lost[pixel] |= 1u << kind;
    if (ways->named && ways->named[what->object])
        return;
    ways->told[pixel] |= 1u << kind;
    if (losses->count == 0)
        losses->material = what->material;
    losses->count += losses->last != pixel + 1;
    losses->last = pixel + 1;
}

static bool has_left(const struct ways *ways, uint32_t pixel)
{
    return ways->lost[pixel] >> LOSS_LEFT & 1u;
}

// Records overlaps when a line leaves the body stack->items[left]. A body that was entered later
// and has not been left overlaps it. A body that was entered earlier and has not been left contains
// it.
static void look_at_overlaps(struct media_search *search, const struct stack *stack, uint32_t left)
{
    const struct scene *scene = search->survey->scene;
    const struct entered *body = &stack->items[left];
    for (uint32_t i = 0; i < stack->count; i++) {
        const struct entered *other = &stack->items[i];
        if (other->medium == body->medium || scene->materials[other->material].medium_priority !=
                                                 scene->materials[body->material].medium_priority)
            continue;
        bool is_upper = body->medium > other->medium, is_within = i < left;
        const struct entered *upper = is_upper ? body : other, *lower = is_upper ? other : body;
        // The object of a medium that contains the camera becomes known when the medium is left; it
        // is then the object of `body`.
        uint32_t object = lower->object != SCENE_NONE ? lower->object : upper->object;
        struct overlap *overlap =
            overlaps_of(&search->overlaps, upper->material, lower->material, object);
        if (overlap)
            ++*(!is_within ? &overlap->crossed : is_upper ? &overlap->held : &overlap->swallowed);
    }
}

static void leave(struct media_search *search, struct ways *ways, struct stack *stack,
                  const struct entered *body, uint32_t pixel)
{
    uint32_t at = stack->count;
    while (at > 0 && stack->items[at - 1].medium != body->medium)
        at--;
    if (at == 0) {
        note(ways, LOSS_LEFT, body, pixel);
        return;
    }
    if (stack->items[at - 1].object == SCENE_NONE)
        stack->items[at - 1] = *body;
    // Overlaps are counted along lines of sight only, because the finding reports their share of
    // the image.
    if (ways == &search->sight)
        look_at_overlaps(search, stack, at - 1);
    memmove(&stack->items[at - 1], &stack->items[at], (stack->count - at) * sizeof stack->items[0]);
    stack->count--;
}

static void begin(const struct media_search *search, const struct sightline *line,
                  struct stack *stack)
{
    *stack = (struct stack){0};
    for (uint32_t i = NESTING_MAX; i-- > 0;) {
        uint32_t medium = line->media >> 8u * i & 255u, material = 0;
        while (medium > 0 && search->materials[material].medium != medium)
            material++;
        if (medium > 0)
            stack->items[stack->count++] = (struct entered){medium, SCENE_NONE, material};
    }
}

// Returns whether a line hits a distance field. Rays leave a distance field by error bounds that
// only the kernels compute.
static bool meets_field(const struct survey *survey, const struct sightline *line)
{
    uint32_t instances = survey->scene->instance_count;
    for (uint32_t i = 0; i < line->count; i++) {
        uint32_t object = line->steps[i].object;
        if (object >= instances && survey->scene->shapes[object - instances].kind == SHAPE_SDF)
            return true;
    }
    return false;
}

// Follows a line of a pixel, starting with the media that were entered before it, and records
// inconsistencies.
static void look_at_line(struct media_search *search, struct ways *ways,
                         const struct sightline *line, uint32_t pixel, struct stack *stack)
{
    if (meets_field(search->survey, line))
        return;
    for (uint32_t i = 0; i < line->count; i++) {
        const struct sighting *at = &line->steps[i];
        const struct entered body = {search->materials[at->material].medium, at->object,
                                     at->material};
        if (body.medium == 0)
            continue;
        if (!at->is_front) {
            leave(search, ways, stack, &body, pixel);
            continue;
        }
        if (stack->count >= NESTING_MAX)
            note(ways, LOSS_NESTED, &body, pixel);
        if (stack->count < STACK_MOST)
            stack->items[stack->count++] = body;
    }
    // A line enters an inside-out body after leaving it; the record of leaving is enough.
    bool goes_on = line->is_open && !has_left(ways, pixel);
    for (uint32_t i = 0; goes_on && i < stack->count; i++)
        if (stack->items[i].object != SCENE_NONE &&
            !is_infinite(search->survey, stack->items[i].object))
            note(ways, LOSS_OPEN, &stack->items[i], pixel);
}

// --- lines in other directions -------------------------------------------------------------------

// Lines that start at surfaces which other lines of the same pixels have hit.
struct branches {
    struct sightline *lines;
    uint32_t *pixels;
    struct stack *stacks; // one for each line
    uint32_t count;
};

static bool make_branches(struct survey *survey, struct branches *out, struct err *err)
{
    uint32_t most = survey->line_count;
    *out = (struct branches){
        .lines = ARENA_NEW(&survey->scratch, struct sightline, most),
        .pixels = ARENA_NEW(&survey->scratch, uint32_t, most),
        .stacks = ARENA_NEW(&survey->scratch, struct stack, most),
    };
    return (out->lines && out->pixels && out->stacks) ||
           err_memory(err, "sight lines", most * sizeof *out->lines);
}

// Adds a line that leaves a surface on one of its sides, in the direction with this number.
static void add_branch(struct branches *branches, const struct sighting *from, bool to_front,
                       uint32_t number, uint32_t pixel, const struct stack *stack)
{
    struct sightline *line = &branches->lines[branches->count];
    double normal[3];
    for (int c = 0; c < 3; c++)
        normal[c] = to_front ? from->normal[c] : -from->normal[c];
    *line = (struct sightline){.from = from, .length = INFINITY};
    sighting_scatter(normal, number, line->direction);
    branches->pixels[branches->count] = pixel;
    branches->stacks[branches->count++] = *stack;
}

static bool trace_branches(struct media_search *search, struct ways *ways,
                           struct branches *branches, struct coincidences *upon, struct err *err)
{
    if (!sightlines_trace(search->survey, branches->lines, branches->count, err) ||
        !coincidences_find(search->survey, branches->lines, branches->count, upon, err))
        return false;
    for (uint32_t i = 0; i < branches->count; i++)
        if (!upon->through[i])
            look_at_line(search, ways, &branches->lines[i], branches->pixels[i],
                         &branches->stacks[i]);
    return true;
}

// All lines of an orthographic camera are parallel, so bodies that overlap sideways look nested.
// Therefore, from the first medium that each line enters, another line continues into the medium in
// another direction, as after a reflection from a rough surface.
static void branch_aside(struct media_search *search, uint32_t pixel, struct branches *branches)
{
    const struct sightline *seen = &search->survey->lines[pixel];
    const struct sighting *at = seen->steps;
    struct stack stack;
    if (seen->count == 0 || search->materials[at->material].medium == 0 || !at->is_front ||
        search->survey->through_faces[pixel])
        return;
    begin(search, seen, &stack);
    stack.items[stack.count++] =
        (struct entered){search->materials[at->material].medium, at->object, at->material};
    add_branch(branches, at, false, pixel, pixel, &stack);
}

static bool look_aside(struct media_search *search, struct err *err)
{
    struct survey *survey = search->survey;
    struct branches branches;
    struct coincidences upon;
    uint8_t *touched = survey_flags(survey);
    if (!touched)
        return err_memory(err, "sight lines", survey->line_count);
    if (!make_branches(survey, &branches, err))
        return false;
    for (uint32_t i = 0; i < survey->line_count; i++)
        branch_aside(search, i, &branches);
    if (!trace_branches(search, &search->sight, &branches, &upon, err))
        return false;
    for (uint32_t i = 0; i < branches.count; i++)
        touched[branches.pixels[i]] |= upon.touched[i];
    return coincidences_add(survey, &upon, touched, err);
}

// --- paths ---------------------------------------------------------------------------------------

// The number of bounces of paths. No line leaves a closed room, so none shows that a medium in the
// room is open, and the camera's lines may miss the medium. But a path in the room hits both sides
// of the medium's surface, and in the end leaves a medium that it did not enter. This does not
// happen if the medium is closed, by itself or by the surrounding walls.
#define PATH_BOUNCES 8u

// Continues a path from the end of a line, on the side from which it came.
static void bounce(struct media_search *search, const struct sightline *line,
                   const struct stack *stack, uint32_t pixel, uint32_t bounces,
                   struct branches *out)
{
    const struct survey *survey = search->survey;
    const struct sighting *at = sightline_lit_place(survey, line);
    if (at && stack->count <= NESTING_MAX && !has_left(&search->sight, pixel) &&
        !has_left(&search->paths, pixel) && !meets_field(survey, line))
        add_branch(out, at, at->is_front, pixel + bounces * survey->line_count, pixel, stack);
}

static bool follow_paths(struct media_search *search, struct err *err)
{
    struct survey *survey = search->survey;
    const struct settings *settings = &survey->settings;
    struct branches now, next;
    struct coincidences upon;
    if (settings_integrator(settings) != INTEGRATOR_PATH)
        return true;
    if (!make_branches(survey, &now, err) || !make_branches(survey, &next, err))
        return false;
    for (uint32_t i = 0; i < survey->line_count; i++)
        if (!survey->through_faces[i])
            bounce(search, &survey->lines[i], &search->stacks[i], i, 0, &now);
    for (uint32_t k = 1; k <= PATH_BOUNCES && k <= settings->max_bounces && now.count > 0; k++) {
        if (!trace_branches(search, &search->paths, &now, &upon, err))
            return false;
        next.count = 0;
        for (uint32_t i = 0; i < now.count; i++)
            if (!upon.through[i])
                bounce(search, &now.lines[i], &now.stacks[i], now.pixels[i], k, &next);
        struct branches last = now;
        now = next;
        next = last;
    }
    return true;
}

// --- texts ---------------------------------------------------------------------------------------

// The objects in a finding.
struct unclosed {
    uint32_t first, count; // the object with most pixels; the number of objects
    bool *marked;          // one flag for each object
};

// Rounding may have let a single line through an edge, but hardly two lines.
#define OPEN_LINES_MIN 2u

static bool list_unclosed(const struct media_search *search, const struct ways *ways,
                          enum loss_kind kind, struct unclosed *out, struct err *err)
{
    struct survey *survey = search->survey;
    uint32_t objects = survey_object_count(survey);
    uint32_t least = kind == LOSS_OPEN || ways == &search->paths ? OPEN_LINES_MIN : 1u;
    const struct losses *losses = ways->losses[kind];
    *out = (struct unclosed){.marked = ARENA_NEW(&survey->scratch, bool, objects)};
    if (!out->marked)
        return err_memory(err, "marks of objects", objects);
    for (uint32_t i = 0; i < objects; i++) {
        if (losses[i].count < least)
            continue;
        out->marked[i] = true;
        if (out->count++ == 0 || losses[i].count > losses[out->first].count)
            out->first = i;
    }
    return true;
}

static const char *place_of(const struct media_search *search, const struct ways *ways,
                            enum loss_kind kind, const struct unclosed *list)
{
    struct survey *survey = search->survey;
    const char *object = survey_object_name(survey, list->first);
    const char *material = survey_material_name(survey, ways->losses[kind][list->first].material);
    if (!object || !material)
        return NULL;
    return list->count == 1 ? arena_printf(survey->arena, "%s, %s", object, material)
                            : arena_printf(survey->arena, "%s, %s, and %u more", object, material,
                                           list->count - 1);
}

// Flags the pixels that are affected by the loss of a medium: those whose path shows it, and those
// in which the medium's object is visible.
static const uint8_t *touched_by(const struct media_search *search, const struct ways *ways,
                                 enum loss_kind kind, const struct unclosed *list)
{
    struct survey *survey = search->survey;
    uint8_t *flags = survey_flags(survey);
    const uint8_t *seen =
        ways == &search->paths ? survey_touched_by_objects(survey, list->marked) : NULL;
    for (uint32_t i = 0; flags && i < survey->line_count; i++)
        flags[i] = (ways->told[i] >> kind & 1u) | (seen ? seen[i] : 0u);
    return flags;
}

static bool add_unclosed(struct media_search *search, const struct ways *ways, enum loss_kind kind,
                         struct err *err)
{
    struct survey *survey = search->survey;
    struct unclosed list;
    bool is_left = kind == LOSS_LEFT;
    if (!list_unclosed(search, ways, kind, &list, err))
        return false;
    // media_lost is the number of times that paths of the renders so far have left a medium without
    // having entered it.
    if (list.count == 0 || (is_left && survey->job.renderer.stats.media_lost == 0))
        return true;
    const uint8_t *touched = touched_by(search, ways, kind, &list);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = is_left ? "medium-not-entered" : "medium-not-left",
            .level = FINDING_WRONG,
            .place = place_of(search, ways, kind, &list),
            .figure = arena_printf(
                survey->arena, "%u of %u %s %s%s", ways->losses[kind][list.first].count,
                survey->line_count,
                ways == &search->sight ? "lines of sight" : "paths that were followed",
                is_left ? "leave it without having entered it" : "enter it and never leave it",
                list.count == 1 ? "" : ", more than any other"),
            .consequence =
                "The surface of this medium is open, or its faces point inwards: refraction "
                "and absorption are wrong.",
            .remedy = "Close the mesh with its corners counter-clockwise from outside, or make the "
                      "material \"thin\".",
            .share = survey_share(survey, touched),
            .pixels = touched,
        },
        err);
}

static bool add_nested(struct media_search *search, struct err *err)
{
    struct survey *survey = search->survey;
    struct unclosed list;
    if (!list_unclosed(search, &search->sight, LOSS_NESTED, &list, err))
        return false;
    if (list.count == 0)
        return true;
    const uint8_t *touched = touched_by(search, &search->sight, LOSS_NESTED, &list);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "media-nested",
            .level = FINDING_WRONG,
            .place = place_of(search, &search->sight, LOSS_NESTED, &list),
            .figure = "a fifth medium inside of four others",
            .consequence =
                "A path keeps track of at most four media, so the medium there is uncertain.",
            .remedy = "Nest at most four closed surfaces with media.",
            .share = survey_share(survey, touched),
            .pixels = touched,
        },
        err);
}

static bool make_ways(struct survey *survey, struct ways *ways, struct err *err)
{
    uint32_t objects = survey_object_count(survey);
    bool ok = true;
    ways->lost = ARENA_NEW(&survey->scratch, uint32_t, survey->line_count);
    ways->told = ARENA_NEW(&survey->scratch, uint32_t, survey->line_count);
    for (int kind = 0; kind < LOSS_KINDS; kind++) {
        ways->losses[kind] = ARENA_NEW(&survey->scratch, struct losses, objects);
        ok = ok && ways->losses[kind];
    }
    return (ok && ways->lost && ways->told) ||
           err_memory(err, "losses of media", objects * sizeof(struct losses));
}

// Marks the objects that lines of sight have found to be open, so that the finding from paths names
// only other objects.
static bool name_seen(struct media_search *search, struct err *err)
{
    struct unclosed left, open;
    if (!list_unclosed(search, &search->sight, LOSS_LEFT, &left, err) ||
        !list_unclosed(search, &search->sight, LOSS_OPEN, &open, err))
        return false;
    for (uint32_t i = 0; i < survey_object_count(search->survey); i++)
        left.marked[i] |= open.marked[i];
    search->paths.named = left.marked;
    return true;
}

static void look_along_lines(struct media_search *search)
{
    const struct survey *survey = search->survey;
    for (uint32_t i = 0; i < survey->line_count; i++) {
        if (survey->through_faces[i])
            continue;
        begin(search, &survey->lines[i], &search->stacks[i]);
        look_at_line(search, &search->sight, &survey->lines[i], i, &search->stacks[i]);
    }
}

bool find_media(struct survey *survey, struct err *err)
{
    struct media_search search = {
        .survey = survey,
        .materials = survey_gpu_materials(survey),
    };
    if (survey->job.renderer.tables.medium_count == 0)
        return true;
    search.stacks = ARENA_NEW(&survey->scratch, struct stack, survey->line_count);
    if (!search.stacks)
        return err_memory(err, "sight lines", survey->line_count * sizeof *search.stacks);
    if (!make_ways(survey, &search.sight, err) || !make_ways(survey, &search.paths, err))
        return false;
    look_along_lines(&search);
    return look_aside(&search, err) && name_seen(&search, err) && follow_paths(&search, err) &&
           overlaps_add(survey, &search.overlaps, err) &&
           add_unclosed(&search, &search.sight, LOSS_LEFT, err) &&
           add_unclosed(&search, &search.sight, LOSS_OPEN, err) &&
           add_unclosed(&search, &search.paths, LOSS_LEFT, err) &&
           add_unclosed(&search, &search.paths, LOSS_OPEN, err) && add_nested(&search, err);
}
