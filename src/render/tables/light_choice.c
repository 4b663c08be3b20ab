#include "render/tables/light_choice.h"

#include "shared/bindings.h"
#include "shared/methods.h"
#include <inttypes.h>
#include <stdio.h>

// The greatest number of lamps for which a shadow ray to each, from the first vertices of a path,
// reduces the error by more than it costs, according to measurements (docs/lighting.md).
#define FEW_LAMPS 5
#define FIRST_VERTICES 1
// The number of emitters from which the light tree is used for a single lamp. If the few emitters
// of a lamp have similar distances, the tree selects about as power does: on the Cornell box, whose
// lamp has two emitters, the error is the same and the tree takes 1.2 times the processor time.
#define MANY_EMITTERS 16

static bool is_one_simple_lamp(uint64_t emitters, const struct emitter_lamps *lamps)
{
    return lamps->count <= 1 && emitters < MANY_EMITTERS && !lamps->is_spread;
}

bool light_choice_asks_lamps(uint32_t setting)
{
    return setting == LIGHT_CHOICE_AUTO || setting == LIGHT_CHOICE_ALL ||
           setting == LIGHT_CHOICE_TREE;
}

struct light_choice light_choice_of(uint32_t setting, uint64_t emitters,
                                    const struct emitter_lamps *lamps)
{
    struct light_choice choice = {.way = setting, .rays = 1};
    if (setting == LIGHT_CHOICE_ALL && lamps->count > 0) {
        choice.vertices = ALL_VERTICES;
        choice.rays = lamps->count;
    }
    if (setting != LIGHT_CHOICE_AUTO)
        return choice;
    choice.way = is_one_simple_lamp(emitters, lamps) ? LIGHT_CHOICE_POWER : LIGHT_CHOICE_TREE;
    if (lamps->count > 1 && lamps->count <= FEW_LAMPS)
        choice = (struct light_choice){LIGHT_CHOICE_ALL, FIRST_VERTICES, lamps->count};
    return choice;
}

struct light_choice_text light_choice_print(uint32_t setting, uint64_t emitters,
                                            const struct emitter_lamps *lamps)
{
    struct light_choice choice = light_choice_of(setting, emitters, lamps);
    struct light_choice_text out;
    char *text = out.text;
    const size_t size = sizeof out.text;
    bool is_auto = setting == LIGHT_CHOICE_AUTO;
    if (choice.way == LIGHT_CHOICE_UNIFORM)
        snprintf(text, size, "one of %" PRIu64 " emitters, with equal probability", emitters);
    else if (choice.way == LIGHT_CHOICE_POWER)
        snprintf(text, size, "one of %" PRIu64 " emitters, by power%s", emitters,
                 !is_auto        ? ""
                 : emitters <= 1 ? ": there is only one"
                                 : ": they belong to one lamp");
    else if (choice.way == LIGHT_CHOICE_TREE)
        snprintf(text, size, "one of %" PRIu64 " emitters of %u lamp%s, by the light tree%s",
                 emitters, lamps->count, lamps->count == 1 ? "" : "s",
                 !is_auto                   ? ""
                 : lamps->count > FEW_LAMPS ? ", since there are many lamps"
                 : emitters < MANY_EMITTERS ? ", since each is small in its lamp"
                                            : "");
    else
        snprintf(text, size, "each of %u lamps, of %" PRIu64 " emitters%s", lamps->count, emitters,
                 is_auto ? ", from the first vertex, then one chosen by the light tree, since "
                           "there are few lamps"
                         : "");
    return out;
}
