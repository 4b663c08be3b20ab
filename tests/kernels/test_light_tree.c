// Tests the choice of an emitter by the light tree, with the renderer's routines, against a
// reference in double precision: the probabilities, the choices, and that every emitter that sends
// light can be chosen.
#include "library_fixture.h"
#include "metrics/metrics.h"

// --- scenes --------------------------------------------------------------------------------------

static uint32_t add_emitter(struct scene *scene, double radiance)
{
    struct material material;
    material_init(&material);
    for (int c = 0; c < 3; c++)
        material.emission[c] = (float)radiance;
    return add_material(scene, &material);
}

static void add_light(struct scene *scene, uint32_t kind, struct random *random)
{
    struct light *light = scene_add_light(scene, NULL);
    REQUIRE(light, "out of memory");
    float direction[3];
    random_direction(random, direction);
    *light = (struct light){.name = "", .kind = kind, .range = INFINITY, .outer_angle = 1};
    for (int c = 0; c < 3; c++) {
        light->position[c] = random_between(random, -2, 2);
        light->direction[c] = (double)direction[c];
        light->radiant[c] = (float)random_between(random, 0.1, 3);
    }
    light->inner_angle = (float)random_between(random, 0, 0.9);
}

static void add_random_triangles(struct scene *scene, uint32_t count, double size,
                                 struct random *random)
{
    float(*vertices)[3][3] = calloc(count, sizeof *vertices);
    REQUIRE(vertices, "out of memory");
    for (uint32_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++) {
            double middle = random_between(random, -2, 2);
            for (int v = 0; v < 3; v++)
                vertices[i][v][c] = (float)(middle + size * random_between(random, -1, 1));
        }
    add_triangles(scene, (const float(*)[3][3])vertices, count,
                  add_emitter(scene, random_between(random, 0.1, 5)));
    free(vertices);
}

// Makes triangles, spheres, discs, points, spots and directional lights.
static void make_mixture(struct scene *scene, uint32_t count)
{
    struct random random = {count};
    scene_start(scene, 8, 8);
    scene->settings.light_choice = LIGHT_CHOICE_TREE;
    add_random_triangles(scene, count, 0.3, &random);
    add_random_triangles(scene, count, 0.02, &random);
    for (uint32_t i = 0; i < count; i++) {
        double at[3], normal[3];
        float direction[3];
        random_direction(&random, direction);
        for (int c = 0; c < 3; c++) {
            at[c] = random_between(&random, -2, 2);
            normal[c] = (double)direction[c];
        }
        uint32_t material = add_emitter(scene, random_between(&random, 0.01, 2));
        if (i % 2)
            add_sphere(scene, at, random_between(&random, 0.001, 0.2), material);
        else
            add_disc(scene, at, normal, random_between(&random, 0.001, 0.2), material);
        add_light(scene, i % 3 ? LIGHT_SPOT : LIGHT_POINT, &random);
    }
    add_light(scene, LIGHT_DIRECTIONAL, &random);
    add_light(scene, LIGHT_DIRECTIONAL, &random);
}

// --- the reference -------------------------------------------------------------------------------

struct place {
    double position[3], normal[3]; // (0, 0, 0): any direction counts
    bool two_sided;
};

static void decode_axis(uint32_t word, double n[3])
{
    double x = (int16_t)(word & 0xffff) / 32767.0, y = (int16_t)(word >> 16) / 32767.0;
    n[0] = x;
    n[1] = y;
    n[2] = 1 - fabs(x) - fabs(y);
    if (n[2] < 0) {
        n[0] = copysign(1 - fabs(y), x);
        n[1] = copysign(1 - fabs(x), y);
    }
    double size = vec3_norm(n);
    for (int c = 0; c < 3; c++)
        n[c] /= size;
}

// Computes with angles; the kernels use cosines.
static double importance(const struct gpu_light_bounds *b, const struct place *p)
{
    double to[3], axis[3], distance, bound = M_PI;
    for (int c = 0; c < 3; c++)
        to[c] = p->position[c] - (double)b->center[c];
    distance = vec3_norm(to);
    decode_axis(b->axis, axis);
    double radius = (double)b->radius;
    double o = acos(fmin(1, (b->cosines & 0xffff) * (2 / LIGHT_COS_O_SCALE) - 1));
    double e = acos(fmin(1, (b->cosines >> 16 & 0x7fff) * (2 / LIGHT_COS_E_SCALE) - 1));
    double w = 0, n = 0;
    if (distance > radius) {
        bound = asin(radius / distance);
        double cosine = vec3_dot(to, axis) / distance, side = -vec3_dot(to, p->normal) / distance;
        w = acos(fmax(-1, fmin(1, b->cosines & LIGHT_TWO_SIDED ? fabs(cosine) : cosine)));
        n = acos(fmax(-1, fmin(1, p->two_sided ? fabs(side) : side)));
    }
    double emitted = fmax(0, w - o - bound), received = fmax(0, n - bound);
    if (vec3_norm(p->normal) == 0)
        received = 0;
    double nearest = fmax(distance, radius);
    return emitted >= e
               ? 0
               : (double)b->power * cos(emitted) * fmax(0, cos(received)) / (nearest * nearest);
}

struct tree {
    const struct gpu_light_tree *header;
    const struct gpu_light_bounds *nodes;
    const struct gpu_light_trail *trails;
    const struct gpu_emitter *bins;
    const struct emitters *emitters;
};

static struct tree tree_of(const struct renderer *r)
{
    const char *data = r->tables.emitters.data;
    const struct gpu_light_tree *header = (const void *)data;
    return (struct tree){header, (const void *)(data + sizeof *header),
                         (const void *)(data + 16 * (size_t)header->trails),
                         (const void *)(data + 16 * (size_t)header->infinite), &r->tables.emitters};
}

static uint32_t number_of(const struct tree *t, uint32_t primitive)
{
    uint32_t number = 0;
    while (t->emitters->primitives[number] != primitive)
        number++;
    return number;
}

// Adds the probabilities of a subtree's emitters, by number. Returns the probability that none is
// chosen, which occurs if bounds promise more than the emitters inside them send.
static double add_subtree(const struct tree *t, uint32_t word, const struct place *p, double width,
                          double *out)
{
    if (word & LIGHT_LEAF) {
        out[number_of(t, word & ~LIGHT_LEAF)] += width;
        return 0;
    }
    const struct gpu_light_bounds *pair = &t->nodes[2 * (size_t)word];
    double a = importance(&pair[0], p), b = importance(&pair[1], p);
    if (!(a + b > 0))
        return width;
    return add_subtree(t, pair[0].child, p, width * a / (a + b), out) +
           add_subtree(t, pair[1].child, p, width * b / (a + b), out);
}

static double probabilities(const struct tree *t, const struct place *p, double *out)
{
    double share = (double)t->header->infinite_share, none = 0;
    if (share < 1)
        none = add_subtree(t, t->header->root, p, 1 - share, out);
    for (uint32_t i = 0; i < t->header->infinite_count; i++) {
        double own = (double)t->bins[i].threshold, bin = share / t->header->infinite_count;
        out[number_of(t, t->bins[i].primitive)] += bin * own;
        out[number_of(t, t->bins[i].alias_primitive)] += bin * (1 - own);
    }
    return none;
}

// --- places --------------------------------------------------------------------------------------

static void random_place(struct random *random, struct place *p)
{
    float normal[3];
    double extent = random_u32(random) % 4 ? 2.5 : 40;
    random_direction(random, normal);
    *p = (struct place){.two_sided = random_u32(random) % 3 == 0};
    bool anywhere = random_u32(random) % 8 == 0;
    for (int c = 0; c < 3; c++) {
        p->position[c] = (double)(float)random_between(random, -extent, extent);
        p->normal[c] = anywhere ? 0 : (double)normal[c];
    }
}

static void set_item(union words *item, const struct place *p)
{
    for (int c = 0; c < 3; c++) {
        item->f[0][c] = (float)p->position[c];
        item->f[1][c] = (float)p->normal[c];
    }
    item->f[0][3] = p->two_sided;
}

static float uniform(struct random *random)
{
    return (float)(random_u32(random) >> 8) * 0x1p-24f;
}

// --- tests ---------------------------------------------------------------------------------------

static union words items[1 << 16];

// The probabilities of all emitters, and of none, sum to 1, and each equals the reference's.
TEST(probabilities_are_those_of_the_bounds)
{
    enum { PLACES = 500 };
    struct setup setup;
    make_mixture(&setup.scene, 12);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    const struct tree t = tree_of(&setup.r);
    struct random random = {5};
    static struct place places[PLACES];
    uint32_t surfaces = t.emitters->surface_count, count = t.emitters->count;
    REQUIRE(count <= 128, "%u emitters", count);
    for (uint32_t n = 0; n < PLACES; n++) {
        random_place(&random, &places[n]);
        for (uint32_t i = 0; i < surfaces; i++) {
            set_item(&items[n * surfaces + i], &places[n]);
            items[n * surfaces + i].u[2][0] = i;
        }
    }
    REQUIRE(library_run(&setup, ROUTINE_TREE_PROBABILITY, items, PLACES * surfaces), "not run");
    double worst = 0, worst_sum = 0, most_lost = 0;
    for (uint32_t n = 0; n < PLACES; n++) {
        double expected[128] = {0}, lost = probabilities(&t, &places[n], expected), sum = lost;
        for (uint32_t i = 0; i < count; i++) {
            double found = i < surfaces ? (double)items[n * surfaces + i].f[3][0] : expected[i];
            worst = fmax(worst, fabs(found - expected[i]));
            sum += found;
        }
        worst_sum = fmax(worst_sum, fabs(sum - 1));
        most_lost = fmax(most_lost, lost);
    }
    printf("  %u emitters, %d places: off by %.2g at most, sums by %.2g; none chosen up to %.2g\n",
           count, PLACES, worst, worst_sum, most_lost);
    CHECK(worst <= 2e-6 && worst_sum <= 1e-5, "%g, sums %g", worst, worst_sum);
    setup_close(&setup);
}

// An emitter is chosen with the probability that the MIS weight of a hit uses, and with that
// frequency.
TEST(choices_follow_the_probabilities)
{
    enum { SAMPLES = 1 << 16, PLACES = 6 };
    struct setup setup;
    make_mixture(&setup.scene, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    const struct tree t = tree_of(&setup.r);
    struct random random = {6};
    for (int n = 0; n < PLACES; n++) {
        struct place p;
        double expected[128] = {0}, seen[128] = {0}, statistic = 0, used = 0, worst = 0;
        random_place(&random, &p);
        probabilities(&t, &p, expected);
        for (uint32_t i = 0; i < SAMPLES; i++) {
            set_item(&items[i], &p);
            items[i].f[2][0] = uniform(&random);
            items[i].f[2][1] = uniform(&random);
        }
        REQUIRE(library_run(&setup, ROUTINE_TREE_CHOICE, items, SAMPLES), "not run");
        float picked[128] = {0};
        for (uint32_t i = 0; i < SAMPLES; i++) {
            if (!(items[i].f[3][1] > 0))
                continue;
            uint32_t number = number_of(&t, items[i].u[3][0]);
            seen[number]++;
            picked[number] = items[i].f[3][1];
        }
        for (uint32_t i = 0; i < t.emitters->surface_count; i++) {
            set_item(&items[i], &p);
            items[i].u[2][0] = i;
        }
        uint32_t surfaces = t.emitters->surface_count;
        REQUIRE(library_run(&setup, ROUTINE_TREE_PROBABILITY, items, surfaces), "not run");
        for (uint32_t i = 0; i < surfaces; i++)
            if (picked[i] > 0)
                worst = fmax(worst, fabs((double)items[i].f[3][0] / (double)picked[i] - 1));
        CHECK(worst <= 1e-5, "place %d: a hit's probability is off by %g", n, worst);
        double rest = 0, rest_seen = 0;
        for (int i = 0; i < 128; i++) {
            double e = expected[i] * SAMPLES;
            if (e < 5) {
                rest += e;
                rest_seen += seen[i];
                continue;
            }
            statistic += (seen[i] - e) * (seen[i] - e) / e;
            used++;
        }
        if (rest >= 5)
            statistic += (rest_seen - rest) * (rest_seen - rest) / rest, used++;
        // Wilson and Hilferty 1931.
        double degrees = fmax(1, used - 1), k = 2 / (9 * degrees);
        double deviate = (cbrt(statistic / degrees) - (1 - k)) / sqrt(k);
        printf("  place %d: %.0f cells, %.2f deviations; hits off by %.2g\n", n, used, deviate,
               worst);
        CHECK(deviate <= 3.5, "place %d: %g deviations", n, deviate);
    }
    setup_close(&setup);
}

// If no emitter sends light, no emitter's record may be read: the chosen word names none, and a
// record at that place may be beyond the end of the buffer.
TEST(without_light_nothing_is_sampled)
{
    enum { SAMPLES = 256 };
    struct setup setup;
    struct random random = {11};
    scene_start(&setup.scene, 8, 8);
    setup.scene.settings.light_choice = LIGHT_CHOICE_TREE;
    add_random_triangles(&setup.scene, 12, 0.3, &random);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    for (int faces = 0; faces < 2; faces++) {
        const struct place p = {.position = {0, 0, -10}, .normal = {0, 0, faces ? 1 : -1}};
        uint32_t sampled = 0, positive = 0;
        for (uint32_t i = 0; i < SAMPLES; i++) {
            set_item(&items[i], &p);
            for (int c = 0; c < 4; c++)
                items[i].f[2][c] = uniform(&random);
        }
        REQUIRE(library_run(&setup, ROUTINE_TREE_SAMPLE, items, SAMPLES), "not run");
        for (uint32_t i = 0; i < SAMPLES; i++) {
            const float *found = items[i].f[3];
            positive += found[0] > 0;
            sampled += !(found[1] == 0 && found[2] == 0 && found[3] == 0);
        }
        uint32_t expected = faces ? SAMPLES : 0;
        CHECK(sampled == expected && positive == expected,
              "%u of %d points are on an emitter, %u with a density", sampled, SAMPLES, positive);
    }
    setup_close(&setup);
}

// Returns a point of an emitter, and the direction in which it emits; a normal of (0, 0, 0) means
// all directions.
static void point_of(const struct renderer *r, uint32_t primitive, struct random *random,
                     double point[3], double normal[3])
{
    float direction[3];
    random_direction(random, direction);
    if (primitive & PRIMITIVE_SHAPE) {
        const struct flat_shape *shape = &r->flat.shapes[primitive & ~PRIMITIVE_SHAPE];
        double across[3] = {0}, n[3], d[3];
        for (int c = 0; c < 3; c++) {
            n[c] = (double)shape->normal[c];
            d[c] = (double)direction[c];
        }
        vec3_cross(n, d, across);
        for (int c = 0; c < 3; c++) {
            bool is_sphere = shape->kind == SHAPE_SPHERE;
            normal[c] = is_sphere ? d[c] : n[c];
            point[c] = (double)shape->center[c] +
                       (double)shape->radius * (is_sphere ? d[c] : 0.99 * across[c]);
        }
        return;
    }
    const struct flat_triangle *triangle = &r->flat.triangles[r->bvh.triangle_order[primitive]];
    double u = random_unit(random), v = random_unit(random) * (1 - u), e[2][3];
    subtract(triangle->v[1], triangle->v[0], e[0]);
    subtract(triangle->v[2], triangle->v[0], e[1]);
    vec3_cross(e[0], e[1], normal);
    double size = vec3_norm(normal);
    for (int c = 0; c < 3; c++) {
        normal[c] /= size;
        point[c] = (double)triangle->v[0][c] + u * e[0][c] + v * e[1][c];
    }
}

// Returns whether light from the point reaches the receiver on the required side, with a margin for
// rounding.
static bool sends(const struct place *p, const double point[3], const double normal[3],
                  bool is_sphere)
{
    double way[3];
    for (int c = 0; c < 3; c++)
        way[c] = p->position[c] - point[c];
    double distance = vec3_norm(way), leaves = vec3_dot(way, normal) / distance;
    double arrives = -vec3_dot(way, p->normal) / distance;
    if (vec3_norm(p->normal) == 0)
        arrives = 1;
    return (is_sphere ? leaves : fabs(leaves)) > 1e-3 &&
           (p->two_sided ? fabs(arrives) : arrives) > 1e-3;
}

// By brute force: no emitter that sends light to a place may have probability 0 there.
TEST(none_is_left_out)
{
    enum { SAMPLES = 1 << 16, POINTS = 8 };
    struct setup setup;
    make_mixture(&setup.scene, 40);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    const struct renderer *r = &setup.r;
    const struct tree t = tree_of(r);
    static bool lit[SAMPLES];
    struct random random = {7};
    for (uint32_t i = 0; i < SAMPLES; i++) {
        struct place p;
        uint32_t number = random_u32(&random) % t.emitters->surface_count;
        uint32_t primitive = t.emitters->primitives[number];
        bool is_sphere = (primitive & PRIMITIVE_SHAPE) &&
                         r->flat.shapes[primitive & ~PRIMITIVE_SHAPE].kind == SHAPE_SPHERE;
        random_place(&random, &p);
        set_item(&items[i], &p);
        items[i].u[2][0] = number;
        lit[i] = false;
        for (int n = 0; n < POINTS; n++) {
            double point[3], normal[3];
            point_of(r, primitive, &random, point, normal);
            lit[i] |= sends(&p, point, normal, is_sphere);
        }
    }
    REQUIRE(library_run(&setup, ROUTINE_TREE_PROBABILITY, items, SAMPLES), "not run");
    uint32_t left_out = 0, lit_count = 0, spared = 0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        lit_count += lit[i];
        left_out += lit[i] && !(items[i].f[3][0] > 0);
        spared += !lit[i] && !(items[i].f[3][0] > 0);
    }
    printf("  %u of %d lit; %u left out, %u rightly\n", lit_count, SAMPLES, left_out, spared);
    CHECK(left_out == 0, "%u emitters are left out", left_out);
    CHECK(lit_count > SAMPLES / 4 && spared > 0, "%u lit, %u spared: no test", lit_count, spared);
    setup_close(&setup);
}

// --- structure -----------------------------------------------------------------------------------

static uint32_t check_subtree(const struct tree *t, uint32_t word, uint64_t trail, uint32_t depth,
                              uint32_t *bad)
{
    if (word & LIGHT_LEAF) {
        uint32_t number = number_of(t, word & ~LIGHT_LEAF);
        if (number >= t->emitters->surface_count)
            return 1;
        const struct gpu_light_trail *own = &t->trails[number];
        *bad += own->depth != depth || own->low != (uint32_t)trail ||
                own->high != (uint32_t)(trail >> 32) || depth > 64;
        return 1;
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < 2; i++)
        count += check_subtree(t, t->nodes[2 * (size_t)word + i].child,
                               trail | (uint64_t)i << depth, depth + 1, bad);
    return count;
}

// Each emitter must be in the tree once, and its trail must lead to it, for any kind of scene.
static void check_structure(const char *name, struct scene *scene, uint32_t expected)
{
    struct setup setup = {.scene = *scene};
    OPEN_SETUP(&setup, 1024);
    const struct tree t = tree_of(&setup.r);
    uint32_t bad = 0, deepest = 0;
    uint32_t count = check_subtree(&t, t.header->root, 0, 0, &bad);
    for (uint32_t i = 0; i < t.emitters->surface_count; i++)
        if (t.trails[i].depth != LIGHT_NOWHERE && t.trails[i].depth > deepest)
            deepest = t.trails[i].depth;
    printf("  %-24s %u emitters, depth %u\n", name, count, deepest);
    CHECK(count == expected && bad == 0, "%s: %u emitters of %u, %u bad trails", name, count,
          expected, bad);
    setup_close(&setup);
}

static void start_structure(struct scene *scene)
{
    scene_start(scene, 8, 8);
    scene->settings.light_choice = LIGHT_CHOICE_TREE;
}

TEST(structure)
{
    struct scene scene;
    make_mixture(&scene, 10);
    check_structure("mixture", &scene, 40);
    start_structure(&scene);
    add_sphere(&scene, (double[3]){0, 0, 0}, 1, add_emitter(&scene, 1));
    check_structure("one", &scene, 1);
    start_structure(&scene);
    for (int i = 0; i < 1000; i++)
        add_sphere(&scene, (double[3]){1, 2, 3}, 1, add_emitter(&scene, 1));
    check_structure("the same place", &scene, 1000);
    start_structure(&scene);
    for (int i = 0; i < 1000; i++)
        add_sphere(&scene, (double[3]){i * 0.1, 0, 0}, 0.01, add_emitter(&scene, 1));
    check_structure("in a line", &scene, 1000);
    // Each emitter is half as far away as the previous one, so halving the space does not make
    // subtrees much smaller.
    start_structure(&scene);
    for (int i = 0; i < 100; i++)
        add_sphere(&scene, (double[3]){ldexp(1, 20 - i / 2), 0, 0}, ldexp(1, 10 - i / 2),
                   add_emitter(&scene, ldexp(1, i)));
    check_structure("a geometric series", &scene, 100);
    start_structure(&scene);
    struct random random = {9};
    add_random_triangles(&scene, 20000, 0.01, &random);
    check_structure("by several threads", &scene, 20000);
}

// A lamp without power has no tree of its own; the words that are read if it is chosen belong to no
// emitter.
TEST(lamp_without_power)
{
    struct scene scene;
    struct random random = {12};
    scene_start(&scene, 8, 8);
    scene.settings.light_choice = LIGHT_CHOICE_ALL;
    add_sphere(&scene, (double[3]){0, 0, 0}, 1, add_emitter(&scene, 1));
    add_light(&scene, LIGHT_POINT, &random);
    for (int c = 0; c < 3; c++)
        scene.lights[0].radiant[c] = 0;
    struct setup setup = {.scene = scene};
    OPEN_SETUP(&setup, 1024);
    const struct gpu_light_tree *header = setup.r.tables.emitters.data;
    const struct gpu_lamp *lamps = (const struct gpu_lamp *)header + header->lamps;
    uint32_t dark = 0;
    for (int i = 0; i < 2; i++) {
        dark += lamps[i].depth == LIGHT_NOWHERE;
        CHECK(lamps[i].depth != LIGHT_NOWHERE || lamps[i].child == LIGHT_LEAF,
              "lamp %d begins with pair %u", i, lamps[i].child);
    }
    CHECK(dark == 1, "%u lamps without power", dark);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(probabilities_are_those_of_the_bounds),
          TEST_CASE(choices_follow_the_probabilities), TEST_CASE(without_light_nothing_is_sampled),
          TEST_CASE(none_is_left_out), TEST_CASE(structure), TEST_CASE(lamp_without_power))
