#include "subjects.h"

#include "render_fixture.h"
#include <stdio.h>
#include <string.h>

static const struct subject subjects[] = {
    {"cornell", "scenes/cornell.json", NULL, NULL},
    {"gloss_room", "tests/coverage/gloss_room.json", NULL, NULL},
    {"small_lamps", "tests/coverage/small_lamps.json", NULL, NULL},
    {"blurred_lamps", "tests/coverage/blurred_lamps.json", NULL, NULL},
    {"blurred_gauss", "tests/coverage/blurred_lamps.json", "settings.filter", "gaussian"},
    {"sun_sky", "tests/coverage/sun_sky.json", NULL, NULL},
    {"caustic", "tests/render/scenes/caustic.json", NULL, NULL},
    {"defocus", "tests/coverage/defocus.json", NULL, NULL},
    {"many_lamps", "tests/coverage/many_lamps.json", NULL, NULL},
    {"fine_alpha", "tests/coverage/fine_alpha.json", NULL, NULL},
    {"sliver", "tests/coverage/sliver.json", NULL, NULL},
    {"fog", "tests/coverage/fog.json", NULL, NULL},
    {"distant_lamps", "tests/coverage/distant_lamps.json", NULL, NULL},
    {"sun_in_view", "tests/coverage/sun_in_view.json", NULL, NULL},
    {"rough_sun", "tests/coverage/rough_sun.json", NULL, NULL},
};
enum { SUBJECTS = sizeof subjects / sizeof *subjects };

static bool visit_named(const char *name, subject_fn visit, void *context, struct err *err)
{
    for (int i = 0; i < SUBJECTS; i++)
        if (strcmp(name, subjects[i].name) == 0)
            return visit(context, &subjects[i], err);
    const char *slash = strrchr(name, '/');
    if (!slash)
        return err_set(err, ERR_USAGE, "\"%s\" is neither a scene of the table nor a path", name);
    char stem[256];
    snprintf(stem, sizeof stem, "%s", slash + 1);
    stem[strcspn(stem, ".")] = '\0';
    const struct subject file = {stem, name, NULL, NULL};
    return visit(context, &file, err);
}

bool subjects_visit(char **names, subject_fn visit, void *context, struct err *err)
{
    for (int i = 0; !*names && i < SUBJECTS; i++)
        if (!visit(context, &subjects[i], err))
            return false;
    for (; *names; names++)
        if (!visit_named(*names, visit, context, err))
            return false;
    return true;
}

bool studio_open(const struct subject *subject, uint32_t size, struct studio *out, struct err *err)
{
    char side[16];
    snprintf(side, sizeof side, "%u", size);
    const struct scene_override overrides[] = {
        {"film.width", side}, {"film.height", side}, {subject->key, subject->value}, {0}};
    const struct gpu_params any_gpu = {0};
    const struct renderer_params params = {.gpu = &out->gpu, .scene = &out->scene};
    memset(out, 0, sizeof *out);
    return gpu_open(&any_gpu, &out->gpu, err) &&
           load_scene(subject->path, overrides, &out->scene, err) &&
           renderer_create(&params, &out->renderer, err);
}

void studio_close(struct studio *studio)
{
    renderer_finish(&studio->renderer);
    scene_finish(&studio->scene);
    gpu_close(&studio->gpu);
}
