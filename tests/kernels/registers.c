// Reports how a driver's compiler translates the kernels of scenes: prints device and driver, and
// for each kernel of each scene the driver's statistics, separated by tabs. Only pipelines are
// created: no memory is mapped and nothing is submitted, so that a driver without hardware
// suffices.
//
//   registers SCENE[,KEY=VALUE] ...     scenes by their path from the source root
//
// KEY is a value of the scene's file, or stack_entries: as if its hierarchy were that deep.
#include "flatten/geometry.h"
#include "render/render.h"
#include "render/wave.h"
#include "render_fixture.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool print_kernel(struct gpu *gpu, const char *scene, const struct gpu_kernel *kernel,
                         struct err *err)
{
    struct gpu_statistic found[GPU_MAX_STATISTICS];
    uint32_t count;
    if (!gpu_kernel_statistics(gpu, kernel, found, &count, err))
        return false;
    printf("%s\t%s", scene, kernel->name);
    for (uint32_t i = 0; i < count; i++)
        printf("\t%s=%.0f", found[i].name, found[i].value);
    printf("\n");
    return true;
}

// Makes the decisions of renderer_prepare() about kernels without planning memory, because a driver
// without hardware has none.
static bool prepare(struct gpu *gpu, const struct scene *scene, struct renderer *r, struct err *err)
{
    *r = (struct renderer){.gpu = gpu, .scene = scene, .camera = scene->cameras[0]};
    const struct geometry_params geometry = {.scene = scene, .camera = &r->camera};
    if (!geometry_prepare(&geometry, &r->arena, &r->flat, &r->bvh, err))
        return false;
    r->specialization = specialize(&(struct specialize_params){
        .scene = scene,
        .flat = &r->flat,
        .bvh = &r->bvh,
        .gpu = gpu,
        .camera = &r->camera,
    });
    return true;
}

static bool print_kernels(const char *word, struct renderer *r, struct err *err)
{
    bool ok = wave_create_kernels(r, err);
    for (int id = 0; id < KERNEL_COUNT && ok; id++)
        ok = !r->kernels[id].pipeline || print_kernel(r->gpu, word, &r->kernels[id], err);
    for (int id = 0; id < KERNEL_COUNT; id++)
        gpu_kernel_finish(r->gpu, &r->kernels[id]);
    return ok;
}

static bool print_scene(struct gpu *gpu, const char *word, struct err *err)
{
    char path[256];
    snprintf(path, sizeof path, "%s", word);
    char *key = strchr(path, ','), *value = key ? strchr(key, '=') : NULL;
    if (value)
        *key++ = *value++ = '\0';
    bool is_depth = value && strcmp(key, "stack_entries") == 0;
    const struct scene_override overrides[] = {{is_depth ? NULL : key, value}, {0}};
    struct scene scene;
    struct renderer r;
    if (!load_scene(path, value ? overrides : NULL, &scene, err))
        return false;
    bool ok = prepare(gpu, &scene, &r, err);
    if (ok && is_depth) {
        r.specialization.stack_entries = (uint32_t)strtoul(value, NULL, 10);
        specialization_set_workgroup(&r.specialization, gpu, r.specialization.workgroup);
    }
    ok = ok && print_kernels(word, &r, err);
    arena_finish(&r.arena);
    scene_finish(&scene);
    return ok;
}

int main(int argc, char **argv)
{
    struct gpu gpu;
    struct err err = {0};
    if (!gpu_open(&(struct gpu_params){.statistics = true}, &gpu, &err)) {
        fprintf(stderr, "%s\n", err.msg);
        return err.code == ERR_NO_VULKAN ? 77 : 1;
    }
    printf("%s\t%s\n", gpu.info.name, gpu.info.driver);
    bool ok = true;
    for (int i = 1; i < argc && ok; i++)
        ok = print_scene(&gpu, argv[i], &err);
    if (!ok)
        fprintf(stderr, "%s\n", err.msg);
    fflush(stdout);
    gpu.abandoned = true; // a device without hardware never becomes idle
    gpu_close(&gpu);
    return ok ? 0 : 1;
}
