// Surfaces that bound a medium without closing it, face the wrong way or overlap, as lines from the
// camera and from what it sees meet them. Lines by way of glass that lies upon another surface tell
// nothing of media: rounding decides there what they enter and leave (find_coincident.c).
#include "check/scene/survey.h"

#include "base/maths.h"
#include "shared/types.h"
#include <string.h>

#define NESTING_MAX 4 // of the stack in lib/media.glsl

// What went wrong with media along the lines.
enum loss_kind { LOSS_LEFT, LOSS_OPEN, LOSS_NESTED, LOSS_KINDS };
struct losses {
    uint32_t object, material; // of the first one
    uint32_t count;            // of lines
};

// Two media of one priority, by materials, of which the first one's number is the higher.
struct overlap {
    uint32_t upper, lower, object; // an object of the lower one
    uint32_t crossed;   // times that a line left one within the other and the other later
    uint32_t swallowed; // times that the lower one lay within the upper one
};
#define OVERLAPS_MAX 16

struct media_search {
    struct survey *survey;
    const struct gpu_material *materials; // as uploaded, with their media's numbers
    struct losses losses[LOSS_KINDS];
    uint32_t *lost; // by each line: the kinds, as bits
    struct overlap overlaps[OVERLAPS_MAX];
    uint32_t overlap_count;
};

static bool is_infinite(const struct survey *survey, uint32_t object)
{
    uint32_t shape = object - survey->scene->instance_count;
    return !survey_is_instance(survey, object) && survey->scene->shapes[shape].kind == SHAPE_PLANE;
}

struct entered {
    uint32_t medium, object, material;
};
#define STACK_MOST (2 * SIGHTING_STEPS)
struct stack {
    struct entered items[STACK_MOST];
    uint32_t count;
};

static void note(struct media_search *search, enum loss_kind kind, const struct entered *what,
                 uint32_t *lost)
{
    struct losses *losses = &search->losses[kind];
    if (losses->count == 0) {
        losses->object = what->object;
        losses->material = what->material;
    }
    losses->count += !(*lost >> kind & 1u);
    *lost |= 1u << kind;
}

static struct overlap *overlap_of(struct media_search *search, const struct entered *upper,
                                  const struct entered *lower)
{
    for (uint32_t i = 0; i < search->overlap_count; i++)
        if (search->overlaps[i].upper == upper->material &&
            search->overlaps[i].lower == lower->material)
            return &search->overlaps[i];
    if (search->overlap_count == OVERLAPS_MAX)
        return NULL;
    search->overlaps[search->overlap_count] =
        (struct overlap){upper->material, lower->material, lower->object, 0, 0};
    return &search->overlaps[search->overlap_count++];
}

// Bodies overlap where one is left while another, which was entered inside of it, goes on; one lies
// within another where it is left while the other, which was entered before, goes on. With equal
// priorities the one that comes later in the file is there (lib/media.glsl).
static void look_at_overlaps(struct media_search *search, const struct stack *stack, uint32_t left)
{
    const struct scene *scene = search->survey->scene;
    const struct entered *body = &stack->items[left];
    for (uint32_t i = 0; i < stack->count; i++) {
        const struct entered *other = &stack->items[i];
        if (other->medium == body->medium || other->object == SCENE_NONE ||
            body->object == SCENE_NONE ||
            scene->materials[other->material].medium_priority !=
                scene->materials[body->material].medium_priority)
            continue;
        bool is_upper = body->medium > other->medium, is_within = i < left;
        struct overlap *overlap =
            overlap_of(search, is_upper ? body : other, is_upper ? other : body);
        if (overlap && !is_within)
            overlap->crossed++;
        else if (overlap && !is_upper)
            overlap->swallowed++;
    }
}

static void leave(struct media_search *search, struct stack *stack, const struct entered *body,
                  uint32_t *lost)
{
    uint32_t at = stack->count;
    while (at > 0 && stack->items[at - 1].medium != body->medium)
        at--;
    if (at == 0) {
        note(search, LOSS_LEFT, body, lost);
        return;
    }
    look_at_overlaps(search, stack, at - 1);
    memmove(&stack->items[at - 1], &stack->items[at], (stack->count - at) * sizeof stack->items[0]);
    stack->count--;
}

static void begin(const struct sightline *line, struct stack *stack)
{
    *stack = (struct stack){0};
    for (uint32_t i = NESTING_MAX; i-- > 0;)
        if (line->media >> 8u * i & 255u)
            stack->items[stack->count++] =
                (struct entered){line->media >> 8u * i & 255u, SCENE_NONE, SCENE_NONE};
}

// Rays leave a distance field by bounds that only the kernels know.
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

// Goes along a line with what was entered before; *lost notes what goes wrong, a bit a kind.
static void look_at_line(struct media_search *search, const struct sightline *line,
                         struct stack *stack, uint32_t *lost)
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
            leave(search, stack, &body, lost);
            continue;
        }
        if (stack->count >= NESTING_MAX)
            note(search, LOSS_NESTED, &body, lost);
        if (stack->count < STACK_MOST)
            stack->items[stack->count++] = body;
    }
    // What is inside out is left before it is entered, which says all of it.
    bool goes_on = line->is_open && !(*lost >> LOSS_LEFT & 1u);
    for (uint32_t i = 0; goes_on && i < stack->count; i++)
        if (stack->items[i].object != SCENE_NONE &&
            !is_infinite(search->survey, stack->items[i].object))
            note(search, LOSS_OPEN, &stack->items[i], lost);
}

// --- lines in other directions -------------------------------------------------------------------

// All lines of an orthographic camera are parallel, and bodies that overlap beside each other look
// nested along them. So from the first medium that each line enters another one goes on, in some
// direction to the inside: as a rough surface would send it.
struct branch {
    uint32_t line;
    struct stack stack;
};

static bool begin_branch(struct media_search *search, uint32_t number, struct branch *branch,
                         struct sightline *line)
{
    const struct sightline *seen = &search->survey->lines[number];
    const struct sighting *at = seen->steps;
    if (seen->count == 0 || search->materials[at->material].medium == 0 || !at->is_front ||
        search->survey->through_faces[number])
        return false;
    double inwards[3];
    for (int c = 0; c < 3; c++)
        inwards[c] = -at->normal[c];
    *line = (struct sightline){.from = at, .length = INFINITY};
    sighting_scatter(inwards, number, line->direction);
    branch->line = number;
    begin(seen, &branch->stack);
    branch->stack.items[branch->stack.count++] =
        (struct entered){search->materials[at->material].medium, at->object, at->material};
    return true;
}

static bool look_aside(struct media_search *search, struct err *err)
{
    struct survey *survey = search->survey;
    uint32_t count = 0;
    struct branch *branches = ARENA_NEW(&survey->scratch, struct branch, survey->line_count);
    struct sightline *lines = ARENA_NEW(&survey->scratch, struct sightline, survey->line_count);
    if (!branches || !lines)
        return err_memory(err, "sight lines", survey->line_count * sizeof *lines);
    for (uint32_t i = 0; i < survey->line_count; i++)
        count += begin_branch(search, i, &branches[count], &lines[count]);
    struct coincidences upon;
    uint8_t *touched = survey_flags(survey);
    if (!sightlines_trace(survey, lines, count, err) ||
        !coincidences_find(survey, lines, count, &upon, err))
        return false;
    if (!touched)
        return err_memory(err, "sight lines", survey->line_count);
    for (uint32_t i = 0; i < count; i++) {
        touched[branches[i].line] |= upon.touched[i];
        if (!upon.through[i])
            look_at_line(search, &lines[i], &branches[i].stack, &search->lost[branches[i].line]);
    }
    return coincidences_add(survey, &upon, touched, err);
}

// --- what is said --------------------------------------------------------------------------------

static const char *place_of(const struct media_search *search, const struct losses *losses)
{
    const char *object = survey_object_name(search->survey, losses->object);
    const char *material = survey_material_name(search->survey, losses->material);
    return object && material ? arena_printf(search->survey->arena, "%s, %s", object, material)
                              : NULL;
}

static const uint8_t *lines_that_lost(const struct media_search *search, enum loss_kind kind)
{
    uint8_t *flags = survey_flags(search->survey);
    for (uint32_t i = 0; flags && i < search->survey->line_count; i++)
        flags[i] = search->lost[i] >> kind & 1u;
    return flags;
}

// One line may leave by an edge that rounding has opened; two hardly do.
#define OPEN_LINES_MIN 2u

static bool add_unclosed(struct media_search *search, enum loss_kind kind, struct err *err)
{
    struct survey *survey = search->survey;
    const struct losses *losses = &search->losses[kind];
    bool is_left = kind == LOSS_LEFT;
    // The renders so far have counted what paths have left without having entered.
    bool is_confirmed =
        is_left ? survey->job.renderer.stats.media_lost > 0 : losses->count >= OPEN_LINES_MIN;
    if (losses->count == 0 || !is_confirmed)
        return true;
    const uint8_t *touched = lines_that_lost(search, kind);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = is_left ? "medium-not-entered" : "medium-not-left",
            .level = FINDING_WRONG,
            .place = place_of(search, losses),
            .figure =
                arena_printf(survey->arena,
                             is_left ? "%u of %u lines of sight leave it without having entered"
                                     : "%u of %u lines of sight enter it and never leave",
                             losses->count, survey->line_count),
            .consequence =
                "What bounds this medium is open, or its faces point inwards: refraction "
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
    const struct losses *losses = &search->losses[LOSS_NESTED];
    if (losses->count == 0)
        return true;
    const uint8_t *touched = lines_that_lost(search, LOSS_NESTED);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "media-nested",
            .level = FINDING_WRONG,
            .place = place_of(search, losses),
            .figure = "a fifth medium inside of four others",
            .consequence = "Paths remember four media: what is inside is not certain there.",
            .remedy = "Let fewer closed surfaces with media lie within each other.",
            .share = survey_share(survey, touched),
            .pixels = touched,
        },
        err);
}

// What is swallowed everywhere was meant to be there; what is crossed sticks out.
static bool add_overlap(struct media_search *search, const struct overlap *overlap, struct err *err)
{
    struct survey *survey = search->survey;
    struct material *lower = &survey->scene->materials[overlap->lower];
    bool vanishes = overlap->crossed == 0;
    if (overlap->crossed + overlap->swallowed == 0)
        return true;
    const char *object = survey_object_name(survey, overlap->object);
    const char *materials[] = {survey_material_name(survey, overlap->lower),
                               survey_material_name(survey, overlap->upper)};
    if (!object || !materials[0] || !materials[1])
        return err_memory(err, "names", 0);
    uint32_t priority = lower->medium_priority;
    bool can_fix = vanishes && priority < 255;
    if (can_fix && survey->params->fixes)
        lower->medium_priority = priority + 1;
    const uint8_t *touched = survey_touched_by_object(survey, overlap->object);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "media-overlap",
            .level = vanishes ? FINDING_WRONG : FINDING_REMARK,
            .place =
                arena_printf(survey->arena, "%s, %s, and %s", object, materials[0], materials[1]),
            .figure = arena_printf(survey->arena, "both have \"priority\" %u", priority),
            .consequence = vanishes ? "The one inside is taken for the one around it: it vanishes."
                                    : "Where they overlap, the order of the file's materials "
                                      "decides which one is there.",
            .remedy = "Give the one that is to be there the higher \"priority\".",
            .share = survey_share(survey, touched),
            .pixels = touched,
            .change = can_fix ? "the inner one has the higher priority" : NULL,
        },
        err);
}

bool find_media(struct survey *survey, struct err *err)
{
    const struct shading_tables *tables = &survey->job.renderer.tables;
    struct media_search search = {
        .survey = survey,
        .materials =
            (const void *)((const char *)tables->materials + sizeof(struct gpu_material_header)),
    };
    if (tables->medium_count == 0)
        return true;
    search.lost = ARENA_NEW(&survey->scratch, uint32_t, survey->line_count);
    if (!search.lost)
        return err_memory(err, "sight lines", survey->line_count * sizeof *search.lost);
    for (uint32_t i = 0; i < survey->line_count; i++) {
        struct stack stack;
        if (survey->through_faces[i])
            continue;
        begin(&survey->lines[i], &stack);
        look_at_line(&search, &survey->lines[i], &stack, &search.lost[i]);
    }
    if (!look_aside(&search, err))
        return false;
    for (uint32_t i = 0; i < search.overlap_count; i++)
        if (!add_overlap(&search, &search.overlaps[i], err))
            return false;
    return add_unclosed(&search, LOSS_LEFT, err) && add_unclosed(&search, LOSS_OPEN, err) &&
           add_nested(&search, err);
}
