// Tests sphere tracing in the kernels against marches in double precision that take half the steps.
#include "render/probe/ray_probe.h"
#include "render/sdf_inline.h"
#include "sdf_programs.h"

enum { RAYS = 3072 }; // rays per program

static struct probe_ray rays[RAYS];
static struct probe_hit hits[RAYS];

// This budget suffices for the longest marches, which would otherwise be suspended: lavapipe's
// limit is 65,535 iterations of all loops of a subgroup, whose rays march together.
enum { BUDGET = 60000 };

static void widen_budget(struct setup *setup)
{
    struct err err = {0};
    setup->r.specialization.iteration_budget = BUDGET;
    bool ok = renderer_resize(&setup->r, RAYS, setup->r.specialization.workgroup, &err);
    REQUIRE(ok, "%s", err.msg);
}

static bool trace_part(struct renderer *r, struct probe_ray *from, uint32_t count,
                       struct probe_hit *to)
{
    struct err err = {0};
    bool complete = true;
    double ms;
    bool ok = ray_probe_trace(r, KERNEL_intersect_closest, from, count, to, &ms, &complete, &err);
    CHECK(ok, "%s", err.msg);
    return complete;
}

// Traces the rays that hit nothing again, one per subgroup: rays that reach a field at different
// times use up the limit of their subgroup together.
static void trace_misses(struct renderer *r)
{
    static struct probe_ray spread[RAYS];
    static struct probe_hit found[RAYS];
    uint32_t stride = r->gpu->subgroup_size, missed[RAYS], count = 0;
    for (uint32_t i = 0; i < RAYS; i++)
        if (hits[i].primitive == NO_PRIMITIVE)
            missed[count++] = i;
    for (uint32_t first = 0; first < count; first += RAYS / stride) {
        uint32_t part = count - first < RAYS / stride ? count - first : RAYS / stride;
        for (uint32_t i = 0; i < part * stride; i++)
            spread[i] = (struct probe_ray){.origin = {0, 1e6f, 0}, .direction = {0, 1, 0}};
        for (uint32_t i = 0; i < part; i++)
            spread[i * stride] = rays[missed[first + i]];
        bool complete = trace_part(r, spread, part * stride, found);
        CHECK(complete, "a ray ran out of its budget by itself");
        for (uint32_t i = 0; i < part; i++)
            hits[missed[first + i]] = found[i * stride];
    }
}

static void trace(struct renderer *r)
{
    bool complete = true;
    for (uint32_t first = 0; first < RAYS; first += r->plan.wave_slots) {
        uint32_t part = RAYS - first < r->plan.wave_slots ? RAYS - first : r->plan.wave_slots;
        complete &= trace_part(r, rays + first, part, hits + first);
    }
    if (!complete)
        trace_misses(r);
}

// --- one ray -------------------------------------------------------------------------------------

// A ray in the field's own space, in metres; the interval in which it is inside the box; and its
// possible error.
struct field_ray {
    double origin[3], direction[3], begin, end;
    double metres; // metres of the field per unit of t
    double slack;
};

static void field_point(const struct field_ray *ray, double x, double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = ray->origin[c] + x * ray->direction[c];
}

static struct field_ray into_field(const struct scene *scene, const struct shape *shape,
                                   const struct probe_ray *ray)
{
    const struct sdf *sdf = &scene->sdfs[shape->sdf];
    struct field_ray out = {.begin = 0, .end = INFINITY};
    double from[3], to[3], far = 0;
    for (int c = 0; c < 3; c++) {
        from[c] = (double)ray->origin[c];
        to[c] = from[c] + (double)ray->direction[c];
        far = fmax(far, fabs(from[c]) + fabs(shape->center[c]));
    }
    sdf_into(scene, shape, from, out.origin);
    sdf_into(scene, shape, to, out.direction);
    for (int c = 0; c < 3; c++)
        out.direction[c] -= out.origin[c];
    out.metres = vec3_norm(out.direction);
    for (int c = 0; c < 3; c++) {
        out.direction[c] /= out.metres;
        double t0 = (sdf->min[c] - out.origin[c]) / out.direction[c];
        double t1 = (sdf->max[c] - out.origin[c]) / out.direction[c];
        if (out.direction[c] != 0) {
            out.begin = fmax(out.begin, fmin(t0, t1));
            out.end = fmin(out.end, fmax(t0, t1));
        } else if (out.origin[c] < sdf->min[c] || out.origin[c] > sdf->max[c]) {
            out.end = -1;
        }
    }
    // The rounding of the field, and of the way to the box: 8 rounding errors of the world's
    // coordinates.
    out.slack = 0x1p-24 *
                (24 * sdf->magnitude + 8 * far / sdf_scale(scene, shape) + 8 * fmax(out.begin, 0));
    return out;
}

// Returns the first place from `from` on where the distance has the other sign, by more than
// `depth`; INFINITY if there is none before `to`. `side` is the sign at the beginning.
static double crossing(const struct sdf *sdf, const struct field_ray *ray, double from, double to,
                       double side, double depth)
{
    for (double x = from; x <= to;) {
        double p[3];
        field_point(ray, x, p);
        double d = side * sdf_evaluate(sdf, p);
        if (d < -depth)
            return x;
        x += fmax(0.5 * fabs(d), 0.25 * depth);
    }
    return INFINITY;
}

struct counts {
    uint32_t hits, inside;              // rays that hit, and rays that began inside
    uint32_t off, through, missed, far; // errors: hit not on the surface; behind another one;
                                        // missed; outside the interval
    double worst;                       // distance from the surface, in units of the slack
};

// A hit must be on the surface, with no certain surface before it. Without a hit there must be no
// certain surface.
static void judge(const struct scene *scene, const struct shape *shape, uint32_t number,
                  const struct probe_ray *ray, const struct probe_hit *hit, struct counts *counts)
{
    const struct sdf *sdf = &scene->sdfs[shape->sdf];
    struct field_ray r = into_field(scene, shape, ray);
    bool found = hit->primitive == (PRIMITIVE_SHAPE | number);
    double begin = fmax(r.begin, 0), x = found ? (double)hit->t * r.metres : r.end, p[3];
    double rounding = r.slack + (found ? 0x1p-22 * x : 0);
    field_point(&r, begin, p);
    double first = sdf_evaluate(sdf, p), side = first < 0 ? -1 : 1;
    counts->hits += found;
    counts->inside += first < 0;
    if (found) {
        field_point(&r, x, p);
        double d = fabs(sdf_evaluate(sdf, p));
        counts->worst = fmax(counts->worst, d / rounding);
        counts->off += !(d <= 2 * rounding);
        counts->far += !(x >= begin - 4 * rounding && x <= r.end + 4 * rounding);
    }
    // Rounding decides on which side a ray is that begins next to the surface.
    if (fabs(first) <= 4 * rounding)
        return;
    double before = crossing(sdf, &r, begin, x - 4 * rounding, side, 2 * rounding);
    counts->through += found && isfinite(before);
    counts->missed += !found && isfinite(before);
}

// --- rays ----------------------------------------------------------------------------------------

static void random_in_box(struct random *random, const struct shape *shape, double part,
                          double out[3])
{
    memcpy(out, shape->center, sizeof(double[3]));
    for (int j = 0; j < 3; j++) {
        double along = random_between(random, -part, part);
        for (int c = 0; c < 3; c++)
            out[c] += along * shape->axes[j][c];
    }
}

// Aims rays, in alternation, from around the box, from inside, along axes, from far away, and along
// its diagonals.
static void aim_rays(struct random *random, const struct shape *shape, double far,
                     struct probe_ray *out)
{
    for (uint32_t i = 0; i < RAYS; i++) {
        double from[3], to[3], away = i % 8 == 3 ? far : 1.8;
        float sphere[3];
        random_in_box(random, shape, 0.9, to);
        random_in_box(random, shape, 0.9, from);
        random_direction(random, sphere);
        double size = vec3_norm(shape->axes[0]);
        for (int c = 0; c < 3 && i % 8 != 1; c++)
            from[c] = shape->center[c] + away * 2 * size * (double)sphere[c];
        if (i % 8 == 2) { // along an axis of the world
            int axis = (int)(random_u32(random) % 3);
            memcpy(from, to, sizeof from);
            from[axis] += (i % 16 < 8 ? -1 : 1) * 3 * size;
        }
        if (i % 8 == 4) // exactly through the centre
            memcpy(to, shape->center, sizeof to);
        double v[3], squared = 0;
        for (int c = 0; c < 3; c++) {
            out[i].origin[c] = (float)from[c];
            v[c] = to[c] - (double)out[i].origin[c];
            squared += v[c] * v[c];
        }
        for (int c = 0; c < 3; c++)
            out[i].direction[c] =
                i % 8 == 2 && from[c] == to[c] ? 0 : (float)(v[c] / sqrt(squared));
        out[i].leaves = false;
    }
}

static void check_shape(const char *name, struct setup *setup, uint32_t number, double far,
                        struct random *random)
{
    const struct scene *scene = &setup->scene;
    const struct shape *shape = &scene->shapes[number];
    struct counts c = {0};
    aim_rays(random, shape, far, rays);
    trace(&setup->r);
    for (uint32_t i = 0; i < RAYS; i++)
        judge(scene, shape, number, &rays[i], &hits[i], &c);
    printf("  %-20s %4u hits, %4u begin inside; off by %.2f of what is allowed\n", name, c.hits,
           c.inside, c.worst / 2);
    CHECK(c.off + c.through + c.missed + c.far == 0,
          "%s: %u hits not on the surface, %u behind it, %u missing, %u outside of the box", name,
          c.off, c.through, c.missed, c.far);
    CHECK(c.hits > RAYS / 16, "%s: %u hits test little", name, c.hits);
}

// --- programs ------------------------------------------------------------------------------------

// Operations with loops slow down all others in the same kernel, so they get a kernel of their own.
static bool has_loops(const struct sdf_program *program)
{
    return program->is_fractal || (program->code[0].op & 0xffu) == SDF_METABALLS;
}

static void check_programs(bool with_loops, struct random *random)
{
    struct setup setup;
    uint32_t number = 0;
    scene_start(&setup.scene, 8, 8);
    for (uint32_t i = 0; i < sdf_program_count; i++)
        if (has_loops(&sdf_programs[i]) == with_loops)
            add_sdf(&setup.scene, &sdf_programs[i],
                    &(struct sdf_place){.center = {40.0 * (i % 6) - 100, 40.0 * (i / 6) - 100, 3},
                                        .scale = 1 + 0.1 * i,
                                        .turn = i});
    OPEN_SETUP(&setup, RAYS);
    widen_budget(&setup);
    for (uint32_t i = 0; i < sdf_program_count; i++)
        if (has_loops(&sdf_programs[i]) == with_loops)
            check_shape(sdf_programs[i].name, &setup, number++, 3, random);
    setup_close(&setup);
}

// Tests every operation and trees of operations, each alone.
TEST(every_program)
{
    struct random random = {81};
    check_programs(false, &random);
    check_programs(true, &random);
}

// Tests tiny, huge and distant fields.
TEST(places)
{
    static const char *const names[] = {"box", "torus", "tree", "menger"};
    static const struct {
        double scale, distance, far;
    } places[] = {{1e-4, 0, 3}, {1e4, 0, 3}, {1, 1e5, 3}, {1, 0, 1e5}};
    struct random random = {82};
    for (uint32_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        uint32_t program = sdf_program_named(names[i]);
        struct setup setup;
        scene_start(&setup.scene, 8, 8);
        // An object at the origin prevents the scene from being moved there.
        add_sdf(&setup.scene, &sdf_programs[program],
                &(struct sdf_place){.center = {places[i].distance, 0, places[i].distance / 2},
                                    .scale = places[i].scale,
                                    .turn = 1});
        add_sphere(&setup.scene, (double[3]){-1, 50 * places[i].scale, 0}, places[i].scale, 0);
        OPEN_SETUP(&setup, RAYS);
        widen_budget(&setup);
        widen_budget(&setup);
        printf("  scale %g, %g away, seen from %g:\n", places[i].scale, places[i].distance,
               places[i].far);
        check_shape(names[i], &setup, 0, places[i].far, &random);
        setup_close(&setup);
    }
}

// --- code and interpreter ------------------------------------------------------------------------

// Adds, far away, a program that is so long that no program of the scene is compiled to code
// (render/sdf_inline.h).
static void add_long_program(struct scene *scene)
{
    struct sdf_program sphere = sdf_programs[sdf_program_named("sphere")];
    add_sdf(scene, &sphere, &(struct sdf_place){.center = {1e3, 0, 0}, .scale = 1});
    struct sdf *sdf = &scene->sdfs[scene->sdf_count - 1];
    uint32_t rounds = SDF_INLINE_MOST;
    struct gpu_sdf_instruction *code = arena_alloc(&scene->arena, rounds + 1, sizeof *code);
    REQUIRE(code, "out of memory");
    code[0] = sphere.code[0];
    for (uint32_t i = 1; i <= rounds; i++)
        code[i] = (struct gpu_sdf_instruction){.op = SDF_ROUND};
    sdf->code = code;
    sdf->count = rounds + 1;
}

// Traces rays from around, some of which leave the surface that was hit before.
static void trace_program(uint32_t program, bool interpreted, struct probe_hit *out)
{
    struct setup setup;
    struct random random = {83};
    scene_start(&setup.scene, 8, 8);
    add_sdf(&setup.scene, &sdf_programs[program], &(struct sdf_place){.scale = 1.5, .turn = 2});
    add_sdf(&setup.scene, &sdf_programs[sdf_program_named("torus")],
            &(struct sdf_place){.center = {4, 0, 1}, .scale = 1, .turn = 1});
    if (interpreted)
        add_long_program(&setup.scene);
    CHECK(sdf_inline_fits(&setup.scene) == !interpreted, "not what is compared");
    OPEN_SETUP(&setup, RAYS);
    widen_budget(&setup);
    aim_rays(&random, &setup.scene.shapes[0], 3, rays);
    trace(&setup.r);
    memcpy(out, hits, sizeof hits);
    setup_close(&setup);
}

// Compiled and interpreted programs differ by rounding, which decides for rays that graze a
// surface.
TEST(code_is_what_is_interpreted)
{
    static const char *const names[] = {"smooth union", "metaballs", "tree"};
    static struct probe_hit results[2][RAYS];
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        uint32_t differ = 0, met = 0, program = sdf_program_named(names[i]);
        trace_program(program, false, results[0]);
        trace_program(program, true, results[1]);
        for (uint32_t k = 0; k < RAYS; k++) {
            bool is_hit = results[0][k].primitive != NO_PRIMITIVE;
            met += is_hit;
            differ += results[0][k].primitive != results[1][k].primitive ||
                      (is_hit && fabsf(results[0][k].t - results[1][k].t) > 1e-4f);
        }
        printf("  %-14s %u of %u hits differ by more than 1e-4\n", names[i], differ, met);
        CHECK(differ <= RAYS / 512 && met > RAYS / 16, "%s: %u of %u differ", names[i], differ,
              met);
    }
}

// --- a closed form -------------------------------------------------------------------------------

// Evaluates the quartic of a torus about y: (|p|^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + z^2). It is
// negative inside.
static double torus_quartic(const struct field_ray *ray, double x, double ring, double tube)
{
    double p[3];
    field_point(ray, x, p);
    double k = vec3_dot(p, p) + ring * ring - tube * tube;
    return k * k - 4 * ring * ring * (p[0] * p[0] + p[2] * p[2]);
}

// Returns the first root, by places so close to each other that only grazing rays can have two
// roots between them; INFINITY if there is none.
static double torus_root(const struct field_ray *ray, double ring, double tube)
{
    enum { PLACES = 8192 };
    double step = (ray->end - ray->begin) / PLACES;
    for (int i = 0; i < PLACES; i++) {
        double a = ray->begin + i * step, b = a + step;
        double at_a = torus_quartic(ray, a, ring, tube);
        if ((at_a < 0) == (torus_quartic(ray, b, ring, tube) < 0))
            continue;
        for (int k = 0; k < 60; k++) {
            double middle = (a + b) / 2;
            bool same = (torus_quartic(ray, middle, ring, tube) < 0) == (at_a < 0);
            a = same ? middle : a;
            b = same ? b : middle;
        }
        return a;
    }
    return INFINITY;
}

TEST(torus)
{
    const struct sdf_program *program = &sdf_programs[sdf_program_named("torus")];
    double ring = (double)program->code[0].a[0], tube = (double)program->code[0].a[1], worst = 0;
    struct setup setup;
    struct random random = {84};
    scene_start(&setup.scene, 8, 8);
    add_sdf(&setup.scene, program, &(struct sdf_place){.center = {1, 2, 3}, .scale = 2, .turn = 1});
    OPEN_SETUP(&setup, RAYS);
    widen_budget(&setup);
    const struct shape *shape = &setup.scene.shapes[0];
    aim_rays(&random, shape, 3, rays);
    trace(&setup.r);
    uint32_t wrong = 0, grazing = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        struct field_ray ray = into_field(&setup.scene, shape, &rays[i]);
        double root = torus_root(&ray, ring, tube), p[3], n[3];
        bool found = hits[i].primitive != NO_PRIMITIVE;
        field_point(&ray, found ? (double)hits[i].t * ray.metres : fmin(root, ray.end), p);
        sdf_normal(&setup.scene.sdfs[0], p, 1e-6, n);
        // Along a surface of curvature 1 / tube, rounding moves roots by its square root.
        if (fabs(vec3_dot(n, ray.direction)) < 0.03 &&
            fabs(sdf_evaluate(&setup.scene.sdfs[0], p)) < 1e-3) {
            grazing++;
            continue;
        }
        double off = found ? fabs((double)hits[i].t * ray.metres - root) : 0;
        wrong += found != isfinite(root) || !(off <= 2e-4);
        worst = fmax(worst, found ? off : 0);
    }
    printf("  %u of %u wrong, %u grazing; off by %.1e\n", wrong, RAYS, grazing, worst);
    CHECK(wrong == 0 && grazing < RAYS / 16, "%u wrong, %u grazing", wrong, grazing);
    setup_close(&setup);
}

// --- pictures ------------------------------------------------------------------------------------

struct picture {
    struct film_image image;
    uint64_t suspended;
    bool done;
};

static void render(const struct scene *scene, uint32_t wave, uint32_t budget, struct arena *arena,
                   struct picture *out)
{
    struct gpu gpu;
    struct renderer r;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    const struct renderer_params params = {.gpu = &gpu, .scene = scene, .wave = wave};
    bool ok = renderer_create(&params, &r, &err);
    if (ok && budget) {
        r.specialization.iteration_budget = budget;
        ok = renderer_resize(&r, wave, r.specialization.workgroup, &err);
    }
    out->done = ok && renderer_render(&r, &(struct render_call){.samples = 2}, &err) &&
                renderer_read(&r, arena, &out->image, &err);
    CHECK(out->done, "%s", err.msg);
    out->suspended = r.stats.suspended;
    renderer_finish(&r);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u validation messages", gpu.validation_messages);
}

// Marches that continue in later dispatches, and other wave sizes, do not change any bit.
TEST(suspended_marches)
{
    struct scene scene;
    struct arena arena = {0};
    static struct picture pictures[3];
    scene_start(&scene, 24, 24);
    scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    add_sdf(&scene, &sdf_programs[sdf_program_named("tree")],
            &(struct sdf_place){.center = {-0.8, 0, 0}, .scale = 1, .turn = 1});
    add_sdf(&scene, &sdf_programs[sdf_program_named("gyroid")],
            &(struct sdf_place){.center = {1, 0, 0}, .scale = 1, .turn = 2});
    static const struct {
        uint32_t wave, budget;
    } ways[3] = {{2048, 0}, {2048, 7}, {256, 0}};
    for (int i = 0; i < 3; i++)
        render(&scene, ways[i].wave, ways[i].budget, &arena, &pictures[i]);
    for (int i = 1; i < 3 && pictures[0].done && pictures[i].done; i++)
        CHECK(memcmp(pictures[0].image.mean, pictures[i].image.mean,
                     24 * 24 * sizeof *pictures[0].image.mean) == 0,
              "picture %d differs", i);
    CHECK(pictures[1].suspended > 24 * 24, "%llu suspended",
          (unsigned long long)pictures[1].suspended);
    arena_finish(&arena);
    scene_finish(&scene);
}

TEST_MAIN(TEST_CASE(every_program), TEST_CASE(places), TEST_CASE(code_is_what_is_interpreted),
          TEST_CASE(torus), TEST_CASE(suspended_marches))
