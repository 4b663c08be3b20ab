// Tests generated meshes: the blob is closed, has the requested size and correct normals, and the
// teapot is the well-known one.
#include "base/maths.h"
#include "base/memory.h"
#include "scene/generate/generate.h"
#include "test.h"

static bool make_blob(struct scene *scene, uint32_t triangles, uint32_t *mesh, struct err *err)
{
    *scene = (struct scene){0};
    *err = (struct err){0};
    return scene_add_material(scene, NULL) && generate_blob(scene, triangles, 0, mesh, err);
}

// Computes twice the area times the unit normal of a triangle.
static void area_vector(const struct mesh *mesh, uint32_t triangle, double out[3])
{
    const uint32_t *corners = mesh->indices[triangle];
    double e[2][3];
    for (int i = 0; i < 2; i++) {
        for (int c = 0; c < 3; c++)
            e[i][c] = (double)mesh->positions[corners[i + 1]][c] - mesh->positions[corners[0]][c];
    }
    out[0] = e[0][1] * e[1][2] - e[0][2] * e[1][1];
    out[1] = e[0][2] * e[1][0] - e[0][0] * e[1][2];
    out[2] = e[0][0] * e[1][1] - e[0][1] * e[1][0];
}

TEST(sizes)
{
    static const uint32_t wanted[] = {0, 8, 24, 100, 1000, 99999, 1000000};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        struct scene scene;
        struct err err;
        uint32_t index;
        bool is_made = make_blob(&scene, wanted[i], &index, &err);
        REQUIRE(is_made, "%s", err.msg);
        uint32_t got = scene.meshes[index].triangle_count;
        // Neighbouring grids differ by 8 n triangles, where 4 n^2 are requested.
        CHECK(got >= 8 && (got <= wanted[i] || got == 8), "%u", got);
        CHECK((double)got + 4.0 * sqrt((double)got) + 8.0 >= (double)wanted[i], "%u for %u", got,
              wanted[i]);
        scene_finish(&scene);
    }
}

// Each directed edge occurs once, and so does its opposite: the surface is closed and oriented.
TEST(the_surface_is_closed)
{
    struct scene scene;
    struct err err;
    uint32_t index;
    bool is_made = make_blob(&scene, 500, &index, &err);
    REQUIRE(is_made, "%s", err.msg);
    const struct mesh *mesh = &scene.meshes[index];
    uint32_t n = mesh->vertex_count;
    unsigned char *edges = calloc(n, n);
    REQUIRE(edges, "out of memory");
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int c = 0; c < 3; c++)
            edges[mesh->indices[t][c] * n + mesh->indices[t][(c + 1) % 3]]++;
    }
    for (uint32_t a = 0; a < n; a++) {
        for (uint32_t b = 0; b < n; b++)
            CHECK(edges[a * n + b] <= 1 && edges[a * n + b] == edges[b * n + a], "%u %u", a, b);
    }
    CHECK(mesh->triangle_count == 2 * (n - 2), "Euler: %u, %u", mesh->triangle_count, n);
    free(edges);
    scene_finish(&scene);
}

TEST(radius_and_normals)
{
    struct scene scene;
    struct err err;
    uint32_t index;
    bool is_made = make_blob(&scene, 100000, &index, &err);
    REQUIRE(is_made, "%s", err.msg);
    const struct mesh *mesh = &scene.meshes[index];
    // Computes the mean radius over solid angle. A triangle with area A, normal n and centre p
    // subtends about A (n . p) / |p|^3.
    double solid_angle = 0.0, mean = 0.0, worst = 1.0, smallest = INFINITY, largest = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double area[3], center[3] = {0.0, 0.0, 0.0};
        area_vector(mesh, t, area);
        for (int c = 0; c < 9; c++)
            center[c % 3] += (double)mesh->positions[mesh->indices[t][c / 3]][c % 3] / 3.0;
        double radius = sqrt(vec3_dot(center, center));
        double weight = 0.5 * vec3_dot(area, center) / (radius * radius * radius);
        CHECK(weight > 0.0, "triangle %u faces inwards", t);
        solid_angle += weight;
        mean += weight * radius;
        double length = sqrt(vec3_dot(area, area));
        smallest = fmin(smallest, length);
        largest = fmax(largest, length);
        for (int i = 0; i < 3; i++) {
            double normal[3];
            for (int c = 0; c < 3; c++)
                normal[c] = (double)mesh->normals[mesh->indices[t][i]][c];
            CHECK(fabs(vec3_dot(normal, normal) - 1.0) < 1e-6, "triangle %u", t);
            worst = fmin(worst, vec3_dot(normal, area) / length);
        }
    }
    CHECK(fabs(solid_angle - 4.0 * M_PI) < 1e-2, "%g", solid_angle);
    CHECK(fabs(mean / solid_angle - 1.0) < 1e-3, "%g", mean / solid_angle);
    // With 1e5 triangles edges are about 0.02 long, and normals turn by a few degrees along them.
    CHECK(worst > 0.97, "a normal is off by acos(%g)", worst);
    CHECK(largest > 10.0 * smallest, "sizes %g to %g", smallest, largest);
    scene_finish(&scene);
}

TEST(the_same_every_time)
{
    struct scene scenes[2];
    struct err err;
    uint32_t index;
    for (int i = 0; i < 2; i++) {
        bool is_made = make_blob(&scenes[i], 1000, &index, &err);
        REQUIRE(is_made, "%s", err.msg);
    }
    const struct mesh *a = &scenes[0].meshes[0], *b = &scenes[1].meshes[0];
    CHECK(a->vertex_count == b->vertex_count &&
          memcmp(a->positions, b->positions, a->vertex_count * sizeof *a->positions) == 0);
    for (int i = 0; i < 2; i++)
        scene_finish(&scenes[i]);
}

TEST(too_large_is_an_error)
{
    struct scene scene = {0};
    struct err err = {0};
    uint32_t index;
    memory_set_budget(1 << 20);
    CHECK(!generate_blob(&scene, UINT32_MAX, 0, &index, &err) && err.code == ERR_BUDGET, "%s",
          err.msg);
    memory_set_budget(0);
    scene_finish(&scene);
}

// --- teapot --------------------------------------------------------------------------------------

static struct mesh make_teapot(struct scene *scene, uint32_t resolution)
{
    struct err err = {0};
    uint32_t index = 0;
    *scene = (struct scene){0};
    bool is_made =
        scene_add_material(scene, NULL) && generate_teapot(scene, resolution, 0, &index, &err);
    CHECK(is_made, "%s", err.msg);
    return is_made ? scene->meshes[index] : (struct mesh){0};
}

// There are 32 patches of n^2 cells with two triangles each, except for cells at a pole, which have
// one; eight patches have such cells.
TEST(teapot_sizes)
{
    for (uint32_t n = 1; n < 20; n++) {
        struct scene scene;
        const struct mesh mesh = make_teapot(&scene, n);
        CHECK(mesh.vertex_count == 32 * (n + 1) * (n + 1), "%u", mesh.vertex_count);
        CHECK(mesh.triangle_count == 64 * n * n - 8 * n, "%u", mesh.triangle_count);
        for (uint32_t t = 0; t < mesh.triangle_count; t++)
            for (int c = 0; c < 3; c++)
                CHECK(mesh.indices[t][c] < mesh.vertex_count);
        scene_finish(&scene);
    }
}

// In the plane of symmetry, the outline of the spout ends with the cubic of x = 3.3, 3.525, 3.45,
// 3.2, whose derivative is 3 (0.225 - 0.6 t + 0.125 t^2). x is greatest at t = (0.6 - sqrt(0.2475))
// / 0.25.
TEST(teapot_extents)
{
    struct scene scene;
    const struct mesh mesh = make_teapot(&scene, 64);
    double t = (0.6 - sqrt(0.2475)) / 0.25, s = 1 - t;
    double tip = 3.3 * s * s * s + 3 * 3.525 * s * s * t + 3 * 3.45 * s * t * t + 3.2 * t * t * t;
    const double expected[2][3] = {{-3, 0, -2}, {tip, 3.15, 2}};
    double found[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t v = 0; v < mesh.vertex_count; v++) {
        for (int i = 0; i < 3; i++) {
            found[0][i] = fmin(found[0][i], (double)mesh.positions[v][i]);
            found[1][i] = fmax(found[1][i], (double)mesh.positions[v][i]);
        }
    }
    CHECK(fabs(tip - 3.434) < 1e-4, "%g", tip);
    for (int i = 0; i < 3; i++) {
        // The tip is up to 1/128 of the parameter away from a vertex. The second derivative of the
        // curve there is 3 (-0.6 + 0.25 t), about 1.5.
        double below = i == 0 ? 1.5 / 2 / 128 / 128 : 0;
        CHECK(fabs(found[0][i] - expected[0][i]) < 1e-6, "%d: %.9g", i, found[0][i]);
        CHECK(found[1][i] < expected[1][i] + 1e-6 && found[1][i] > expected[1][i] - below - 1e-6,
              "%d: %.9g", i, found[1][i]);
    }
    scene_finish(&scene);
}

// Normals are unit vectors on the side from which triangles are counter-clockwise. Patches of a
// body of revolution meet in the same points, with the same normals; this includes the poles.
TEST(teapot_normals)
{
    struct scene scene;
    const uint32_t n = 16, patch_vertices = (n + 1) * (n + 1);
    const struct mesh mesh = make_teapot(&scene, n);
    for (uint32_t t = 0; t < mesh.triangle_count; t++) {
        double area[3];
        area_vector(&mesh, t, area);
        double length = sqrt(vec3_dot(area, area));
        CHECK(length > 0, "triangle %u has no area", t);
        for (int c = 0; c < 3; c++) {
            const float *f = mesh.normals[mesh.indices[t][c]];
            const double normal[3] = {(double)f[0], (double)f[1], (double)f[2]};
            CHECK(fabs(vec3_dot(normal, normal) - 1) < 1e-6, "triangle %u", t);
            CHECK(vec3_dot(area, normal) > 0.5 * length, "triangle %u: %g", t,
                  vec3_dot(area, normal) / length);
        }
    }
    uint32_t shared = 0;
    for (uint32_t a = 0; a < 24 * patch_vertices; a++) {
        for (uint32_t b = a + 1; b < 24 * patch_vertices; b++) {
            if (memcmp(mesh.positions[a], mesh.positions[b], sizeof *mesh.positions) != 0)
                continue;
            shared++;
            for (int i = 0; i < 3; i++)
                CHECK(fabsf(mesh.normals[a][i] - mesh.normals[b][i]) < 1e-5f, "%u and %u", a, b);
        }
    }
    // At least the four profiles of six patches, the three circles between patches, and the circle
    // between body and bottom are shared.
    CHECK(shared >= (4 * 6 + 4 * 4) * (n + 1), "%u", shared);
    scene_finish(&scene);
}

// Seen from outside, the image is not mirrored: s increases to the right where t increases
// downwards.
TEST(teapot_coordinates)
{
    struct scene scene;
    const struct mesh mesh = make_teapot(&scene, 8);
    for (uint32_t t = 0; t < mesh.triangle_count; t++) {
        const float *a = mesh.uvs[0][mesh.indices[t][0]], *b = mesh.uvs[0][mesh.indices[t][1]],
                    *c = mesh.uvs[0][mesh.indices[t][2]];
        float area = (b[0] - a[0]) * (a[1] - c[1]) - (c[0] - a[0]) * (a[1] - b[1]);
        CHECK(area > 0, "triangle %u", t);
    }
    scene_finish(&scene);
}

// --- torus ---------------------------------------------------------------------------------------

// The area vectors cancel, as for closed surfaces. By the divergence theorem it encloses 2 pi^2
// tube^2, so it faces outwards.
TEST(torus_is_closed)
{
    const struct torus torus = {.tube = 0.3, .segments = 400, .tube_segments = 200};
    struct scene scene = {0};
    struct err err = {0};
    uint32_t index;
    bool is_made =
        scene_add_material(&scene, NULL) && generate_torus(&scene, &torus, 0, &index, &err);
    REQUIRE(is_made, "%s", err.msg);
    const struct mesh *mesh = &scene.meshes[index];
    double volume = 0, sum[3] = {0, 0, 0};
    CHECK(mesh->triangle_count == 160000 && mesh->vertex_count == 80000, "%u triangles",
          mesh->triangle_count);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double area[3], corner[3], facing = 0;
        area_vector(mesh, t, area);
        for (int c = 0; c < 3; c++) {
            corner[c] = (double)mesh->positions[mesh->indices[t][0]][c];
            facing += area[c] * (double)mesh->normals[mesh->indices[t][0]][c];
            sum[c] += area[c];
        }
        volume += vec3_dot(corner, area) / 6;
        CHECK(facing > 0, "triangle %u faces inwards", t);
    }
    CHECK(fabs(volume / (2 * M_PI * M_PI * 0.09) - 1) < 1e-3, "volume %g", volume);
    CHECK(vec3_dot(sum, sum) < 1e-10, "%g %g %g", sum[0], sum[1], sum[2]);
    scene_finish(&scene);
}

// --- stadium -------------------------------------------------------------------------------------

// The area vectors of a surface with a plane opening sum to that of the opening. The volume that it
// encloses with that plane is the ground below each step times its height.
static void check_stadium(const struct stadium *stadium)
{
    struct scene scene = {0};
    struct err err = {0};
    uint32_t index;
    bool is_made =
        scene_add_material(&scene, NULL) && generate_stadium(&scene, stadium, 0, &index, &err);
    REQUIRE(is_made, "%s", err.msg);
    const struct mesh *mesh = &scene.meshes[index];
    uint32_t n = stadium->steps, segments = stadium->segments;
    CHECK(mesh->triangle_count == segments * (4 * n + 3), "%u triangles", mesh->triangle_count);
    double volume = 0, sum[3] = {0, 0, 0};
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double area[3], corner[3];
        area_vector(mesh, t, area);
        CHECK(vec3_dot(area, area) > 0, "triangle %u has no area", t);
        for (int c = 0; c < 3; c++) {
            corner[c] = (double)mesh->positions[mesh->indices[t][0]][c];
            sum[c] += area[c] / 2;
        }
        volume += vec3_dot(corner, area) / 6;
    }
    double of_circle = segments * sin(2 * M_PI / segments) / 2, expected = 0;
    for (uint32_t i = 0; i < n; i++) {
        double in = 0.4 * i / n, out = 0.4 * (i + 1) / n, rise = 0.25 * (i + 1) / n;
        expected += of_circle * ((0.6 + out) * (0.4 + out) - (0.6 + in) * (0.4 + in)) * rise;
    }
    CHECK(fabs(volume / expected - 1) < 1e-5, "volume %g, expected %g", volume, expected);
    CHECK(fabs(sum[0]) < 1e-5 && fabs(sum[2]) < 1e-5 && fabs(sum[1] / (0.8 * of_circle) - 1) < 1e-5,
          "%g %g %g", sum[0], sum[1], sum[2]);
    scene_finish(&scene);
}

TEST(stadium_is_open_beneath)
{
    check_stadium(&(struct stadium){.steps = 1, .segments = 3});
    check_stadium(&(struct stadium){.steps = 16, .segments = 96});
    check_stadium(&(struct stadium){.steps = 200, .segments = 31});
}

TEST_MAIN(TEST_CASE(torus_is_closed), TEST_CASE(stadium_is_open_beneath), TEST_CASE(sizes),
          TEST_CASE(the_surface_is_closed), TEST_CASE(radius_and_normals),
          TEST_CASE(the_same_every_time), TEST_CASE(too_large_is_an_error), TEST_CASE(teapot_sizes),
          TEST_CASE(teapot_extents), TEST_CASE(teapot_normals), TEST_CASE(teapot_coordinates))
