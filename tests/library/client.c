// Renders a scene and prints the error of the picture: `client SCENE.json OUT.exr`.
#include <lampyris/lampyris.h>
#include <stdio.h>

static int fail(struct lampyris_context *context)
{
    struct lampyris_error error = {.size = sizeof error};
    lampyris_context_error(context, &error);
    fprintf(stderr, "%s\n", error.message);
    return error.status;
}

static bool show(void *user, const struct lampyris_moment *moment)
{
    (void)user;
    fprintf(stderr, "\r%s: %3.0f %%", moment->phase, 100.0 * moment->fraction);
    return true; // returning false would stop the render
}

int main(int argc, char **argv)
{
    const struct lampyris_progress progress = {.size = sizeof progress, .report = show};
    struct lampyris_context *context = NULL;
    struct lampyris_scene *scene = NULL;
    struct lampyris_render *render = NULL;
    struct lampyris_state state = {.size = sizeof state};
    if (argc != 3 || lampyris_context_create(NULL, &context) != LAMPYRIS_OK)
        return 2;
    int code = 0;
    if (lampyris_scene_load(context, argv[1], NULL, &scene) ||
        lampyris_render_begin(scene, "{\"spp\": 16, \"width\": 64, \"height\": 64}", &progress,
                              &render) ||
        lampyris_render_step(render, NULL, &progress) || lampyris_render_state(render, &state) ||
        lampyris_render_save(render, argv[2], NULL))
        code = fail(context);
    else
        printf("local relMSE %.3g (%.3g to %.3g), %.3f s, hash %016llx\n", state.error,
               state.error_low, state.error_high, state.seconds_render,
               (unsigned long long)state.hash);
    lampyris_render_release(render);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
    return code;
}
