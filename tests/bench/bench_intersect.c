// Measures the traversal kernels in Mrays/s beside Embree's rtcIntersect1 and rtcOccluded1, on the
// same rays, with the same number of threads, in alternation.
//
//   bench_intersect [TRIANGLES…]     meshes of about so many triangles in a room; 100000 1000000
#include "base/parallel.h"
#include "bench.h"
#include "scene/generate/generate.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 512u
#define HEIGHT 512u
#define SAMPLES 4u
#define RAYS (WIDTH * HEIGHT * SAMPLES)
#define ROUNDS 7

static const float light[3][3] = {{-1, 5.9f, -1}, {2, 0, 0}, {0, 0, 2}};

// --- the scene: a bumpy sphere in a closed room with a light at the ceiling ----------------------

static bool add_quad(struct scene *scene, uint32_t material, const float corner[3],
                     const float u[3], const float v[3])
{
    uint32_t index;
    struct mesh *mesh = scene_add_mesh(scene, &index);
    struct instance *instance = scene_add_instance(scene, NULL);
    if (!mesh || !instance)
        return false;
    mesh->name = "quad";
    mesh->vertex_count = 4;
    mesh->triangle_count = 2;
    mesh->positions = arena_alloc(&scene->arena, 4, sizeof *mesh->positions);
    mesh->indices = arena_alloc(&scene->arena, 2, sizeof *mesh->indices);
    mesh->material = material;
    if (!mesh->positions || !mesh->indices)
        return false;
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++)
            mesh->positions[i][c] = corner[c] + (i == 1 || i == 2 ? u[c] : 0) + (i >= 2 ? v[c] : 0);
    memcpy(mesh->indices[0], (uint32_t[]){0, 1, 2}, sizeof mesh->indices[0]);
    memcpy(mesh->indices[1], (uint32_t[]){0, 2, 3}, sizeof mesh->indices[1]);
    *instance = (struct instance){.mesh = index, .material = SCENE_NONE};
    for (int i = 0; i < 3; i++)
        instance->transform[i][i] = 1.0;
    return true;
}

static bool make_scene(uint32_t triangles, struct scene *scene, struct err *err)
{
    *scene = (struct scene){.path = "benchmark", .settings = settings_default()};
    uint32_t grey, lamp, blob;
    struct material *m = scene_add_material(scene, &grey);
    if (m)
        *m = (struct material){.name = "grey", .base_color = {0.7f, 0.7f, 0.7f}};
    m = m ? scene_add_material(scene, &lamp) : NULL;
    if (!m)
        return err_memory(err, "scene", sizeof *m);
    *m = (struct material){.name = "lamp", .emission = {10, 10, 10}};
    static const float quads[6][3][3] = {
        {{-4, -2, -4}, {8, 0, 0}, {0, 0, 8}}, {{-4, 6, -4}, {8, 0, 0}, {0, 0, 8}},
        {{-4, -2, -4}, {0, 8, 0}, {0, 0, 8}}, {{4, -2, -4}, {0, 8, 0}, {0, 0, 8}},
        {{-4, -2, -4}, {8, 0, 0}, {0, 8, 0}}, {{-4, -2, 4}, {8, 0, 0}, {0, 8, 0}},
    };
    bool ok = generate_blob(scene, triangles, grey, &blob, err) &&
              add_quad(scene, lamp, light[0], light[1], light[2]);
    for (int i = 0; i < 6 && ok; i++)
        ok = add_quad(scene, grey, quads[i][0], quads[i][1], quads[i][2]);
    struct instance *instance = ok ? scene_add_instance(scene, NULL) : NULL;
    struct camera *camera = instance ? scene_add_camera(scene, NULL) : NULL;
    if (!camera)
        return err_memory(err, "scene", sizeof *camera);
    *instance = (struct instance){.mesh = blob, .material = SCENE_NONE};
    for (int i = 0; i < 3; i++)
        instance->transform[i][i] = 1.6;
    *camera = (struct camera){
        .position = {0.5, 1.0, 3.8}, .direction = {0, 0, -1}, .up = {0, 1, 0}, .fov_y = 1.1};
    return true;
}

// --- measuring -----------------------------------------------------------------------------------

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count)
{
    qsort(values, count, sizeof *values, by_value);
    return values[count / 2];
}

static bool trace_all(struct renderer *r, bool shadow, const struct probe_ray *rays, uint32_t count,
                      struct probe_hit *hits, double *seconds, struct err *err)
{
    enum kernel_id kernel = shadow ? KERNEL_intersect_shadow : KERNEL_intersect_closest;
    *seconds = 0.0;
    for (uint32_t first = 0; first < count; first += r->plan.wave_slots) {
        uint32_t n = count - first < r->plan.wave_slots ? count - first : r->plan.wave_slots;
        double ms;
        bool complete;
        if (!ray_probe_trace(r, kernel, rays + first, n, hits + first, &ms, &complete, err))
            return false;
        if (!complete)
            return err_set(err, ERR_BUG, "a ray ran out of its budget");
        *seconds += ms * 1e-3;
    }
    return true;
}

static uint32_t disagreements(bool shadow, const struct probe_hit *a, const struct probe_hit *b,
                              uint32_t count)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool hit_a = a[i].primitive != NO_PRIMITIVE, hit_b = b[i].primitive != NO_PRIMITIVE;
        n += hit_a != hit_b ||
             (!shadow && hit_a && fabsf(a[i].t - b[i].t) > 1e-4f * fabsf(b[i].t) + 1e-6f);
    }
    return n;
}

struct bench {
    struct scene scene;
    struct gpu gpu;
    struct renderer r;
    struct yardstick *yardstick;
    struct probe_ray *rays[RAY_KINDS];
    uint32_t counts[RAY_KINDS];
    struct probe_hit *hits, *reference;
};

static bool measure(struct bench *b, enum ray_kind kind, struct err *err)
{
    static const char *const names[] = {"primary", "diffuse", "shadow"};
    bool shadow = kind == RAYS_SHADOW;
    uint32_t count = b->counts[kind];
    double ours[ROUNDS], theirs[ROUNDS], ratios[ROUNDS];
    for (int round = 0; round < ROUNDS; round++) {
        if (!trace_all(&b->r, shadow, b->rays[kind], count, b->hits, &ours[round], err))
            return false;
        theirs[round] = NAN;
        if (b->yardstick)
            theirs[round] =
                yardstick_trace(b->yardstick, shadow, b->rays[kind], count, b->reference);
        ratios[round] = theirs[round] / ours[round];
    }
    double mrays = count * 1e-6;
    printf("  %-8s %8.2f Mrays/s", names[kind], mrays / median(ours, ROUNDS));
    if (b->yardstick) {
        uint32_t wrong = disagreements(shadow, b->hits, b->reference, count);
        double ratio = median(ratios, ROUNDS); // median() sorts the ratios
        printf("   Embree %8.2f   ratio %.2f (%.2f to %.2f)   %u of %u hits differ",
               mrays / median(theirs, ROUNDS), ratio, ratios[0], ratios[ROUNDS - 1], wrong, count);
    }
    putchar('\n');
    fflush(stdout);
    return true;
}

static bool allocate(struct bench *b, struct err *err)
{
    struct arena *arena = &b->scene.arena;
    b->hits = ARENA_NEW(arena, struct probe_hit, RAYS);
    b->reference = ARENA_NEW(arena, struct probe_hit, RAYS);
    for (int kind = 0; kind < RAY_KINDS; kind++) {
        b->rays[kind] = ARENA_NEW(arena, struct probe_ray, RAYS);
        if (!b->rays[kind])
            return err_memory(err, "rays", RAYS * sizeof **b->rays);
    }
    return (b->hits && b->reference) || err_memory(err, "hits", RAYS * sizeof *b->hits);
}

static bool make_rays(struct bench *b, struct err *err)
{
    const struct flat_scene *flat = &b->r.flat;
    struct probe_ray **rays = b->rays;
    double seconds;
    rays_primary(&b->scene.cameras[0], flat->origin, WIDTH, HEIGHT, SAMPLES, rays[RAYS_PRIMARY]);
    b->counts[RAYS_PRIMARY] = RAYS;
    if (!trace_all(&b->r, false, rays[RAYS_PRIMARY], RAYS, b->hits, &seconds, err))
        return false;
    b->counts[RAYS_DIFFUSE] =
        rays_diffuse(flat, rays[RAYS_PRIMARY], b->hits, RAYS, rays[RAYS_DIFFUSE]);
    float local[3][3];
    memcpy(local, light, sizeof local);
    for (int c = 0; c < 3; c++)
        local[0][c] -= (float)flat->origin[c];
    b->counts[RAYS_SHADOW] = rays_shadow(flat, rays[RAYS_PRIMARY], b->hits, RAYS,
                                         (const float(*)[3])local, rays[RAYS_SHADOW]);
    return true;
}

static bool bench_mesh(uint32_t triangles, struct err *err)
{
    struct bench b = {0};
    const char *wave = getenv("LAMPYRIS_BENCH_WAVE");
    bool ok = make_scene(triangles, &b.scene, err) && allocate(&b, err) &&
              gpu_open(&(struct gpu_params){0}, &b.gpu, err) &&
              renderer_create(&(struct renderer_params){.gpu = &b.gpu,
                                                        .scene = &b.scene,
                                                        .wave = wave ? (uint32_t)atoi(wave) : 0},
                              &b.r, err);
    if (ok) {
        unsigned threads = cpu_count();
        b.yardstick = yardstick_create(&b.r.flat, threads);
        const struct bvh_stats *stats = &b.r.bvh.stats;
        printf("%u triangles, %u nodes, SAH cost %.2f, built in %.2f s; %s, %u CPU threads, wave "
               "of %u\n",
               b.r.flat.triangle_count, stats->node_count, stats->sah_cost, stats->build_seconds,
               b.gpu.info.name, threads, b.r.plan.wave_slots);
        ok = make_rays(&b, err);
        for (int kind = 0; kind < RAY_KINDS && ok; kind++)
            ok = measure(&b, (enum ray_kind)kind, err);
    }
    yardstick_destroy(b.yardstick);
    renderer_finish(&b.r);
    gpu_close(&b.gpu);
    scene_finish(&b.scene);
    return ok;
}

int main(int argc, char **argv)
{
    static const uint32_t usual[] = {100000, 1000000};
    struct err err = {0};
    int count = argc > 1 ? argc - 1 : 2;
    for (int i = 0; i < count; i++) {
        uint32_t triangles = argc > 1 ? (uint32_t)strtoul(argv[i + 1], NULL, 10) : usual[i];
        if (!bench_mesh(triangles, &err)) {
            fprintf(stderr, "bench_intersect: %s\n", err.msg);
            return err.code == ERR_NO_VULKAN ? 77 : 1;
        }
    }
    return 0;
}
