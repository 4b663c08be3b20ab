// Tests the renderer's routines that must be correct for every number: origins of rays that leave a
// surface, octahedral normals, and the test for finite numbers.
#include "library_fixture.h"
#include "render/tables/octahedral.h"

enum { COUNT = 100000 };

static union words items[COUNT], inputs[COUNT];

static void to_double(const float v[3], double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (double)v[c];
}

static float signed_magnitude(struct random *random, double low, double high)
{
    double magnitude = pow(10, random_between(random, low, high));
    return (float)(random_u32(random) & 1u ? -magnitude : magnitude);
}

// --- leaving a point -----------------------------------------------------------------------------

// A point is known within +-error. No point of that box may be on the wrong side of the plane
// through the new origin, in double precision, with the rounded normal.
TEST(offset_origin)
{
    struct setup setup;
    struct random random = {41};
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    for (uint32_t i = 0; i < COUNT; i++) {
        float(*in)[4] = items[i].f;
        for (int c = 0; c < 3; c++) {
            in[0][c] = i % 16 == 0 ? 0.0f : signed_magnitude(&random, -6, 6);
            // Surfaces report an error of a few roundings of the coordinates, or none.
            in[1][c] = fabsf(in[0][c]) * (float)random_between(&random, 0, 7) * 0x1p-24f;
        }
        random_direction(&random, in[2]);
        if (i % 8 == 0) { // along an axis
            memset(in[2], 0, sizeof(float[3]));
            in[2][random_u32(&random) % 3] = random_u32(&random) & 1u ? -1.0f : 1.0f;
        }
        random_direction(&random, in[3]);
    }
    memcpy(inputs, items, sizeof inputs);
    REQUIRE(library_run(&setup, ROUTINE_OFFSET, items, COUNT), "not run");
    uint32_t wrong = 0, far = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        double normal[3], side[3], moved[3], box = 0, ulps = 0;
        to_double(inputs[i].f[2], normal);
        to_double(inputs[i].f[3], side);
        subtract(items[i].f[0], inputs[i].f[0], moved);
        double sign = vec3_dot(normal, side) < 0 ? -1 : 1;
        for (int c = 0; c < 3; c++) {
            box += fabs(normal[c]) * (double)inputs[i].f[1][c];
            ulps += fabs((double)inputs[i].f[0][c]) * 0x1p-22;
        }
        double height = sign * vec3_dot(normal, moved);
        wrong += !(height >= box);
        // The origin must not move farther than necessary: the box, once along the normal, and two
        // steps.
        far += !(vec3_norm(moved) <= 1.001 * box + ulps + 2e-38);
    }
    CHECK(wrong == 0, "%u of %u on the wrong side", wrong, COUNT);
    CHECK(far == 0, "%u of %u too far away", far, COUNT);
    setup_close(&setup);
}

// --- leaving a triangle --------------------------------------------------------------------------

static void random_triangle(struct random *random, struct gpu_triangle *out)
{
    float *const corners[3] = {out->v0, out->v1, out->v2};
    double size = pow(10, random_between(random, -6, 6));
    double distance = size * pow(10, random_between(random, -3, 3));
    float away[3], direction[3];
    random_direction(random, away);
    for (int v = 0; v < 3; v++) {
        random_direction(random, direction);
        for (int c = 0; c < 3; c++)
            corners[v][c] = (float)((double)away[c] * distance + (double)direction[c] * size);
    }
}

// Makes barycentric coordinates of corners 1 and 2: inside, on edges and at corners.
static void random_barycentrics(struct random *random, float uv[2])
{
    double u = random_unit(random), v = random_unit(random);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    uint32_t kind = random_u32(random) % 8;
    uv[0] = kind == 0 ? 0.0f : (float)u;
    uv[1] = kind <= 1 ? 0.0f : kind == 2 ? 1.0f - uv[0] : (float)v;
}

static struct gpu_triangle triangles[COUNT];

// Makes a scene with this many triangles, which are replaced by those of the test when it runs, and
// `inputs`.
static void start_to_leave(struct scene *scene)
{
    struct random random = {42};
    static float dummies[COUNT][3][3];
    scene_start(scene, 8, 8);
    for (uint32_t i = 0; i < COUNT; i++) {
        dummies[i][1][0] = dummies[i][2][1] = 1;
        random_triangle(&random, &triangles[i]);
    }
    add_triangles(scene, (const float(*)[3][3])dummies, COUNT, 0);
    for (uint32_t i = 0; i < COUNT; i++) {
        random_barycentrics(&random, inputs[i].f[0]);
        random_direction(&random, inputs[i].f[1]);
    }
}

// Computes `items` from `inputs`. A triangle's number is that of its thread, so as many run at a
// time as there are slots.
static bool leave_triangles(struct setup *setup)
{
    struct err err = {0};
    struct gpu_buffer *buffer = &setup->r.buffers[BINDING_TRIANGLES];
    uint32_t most = setup->r.plan.wave_slots;
    bool ok = true;
    memcpy(items, inputs, sizeof items);
    for (uint32_t first = 0, part; ok && first < COUNT; first += part) {
        part = COUNT - first < most ? COUNT - first : most;
        ok =
            gpu_upload(&setup->gpu, buffer, 0, triangles + first, part * sizeof *triangles, &err) &&
            library_run(setup, ROUTINE_LEAVE_TRIANGLE, items + first, part);
    }
    CHECK(ok, "%s", err.msg);
    return ok;
}

// The origin of a ray that leaves a triangle is on that side of the exact plane to which the normal
// in single precision points. The reported error bounds the distance to the plane.
TEST(leave_triangle)
{
    struct setup setup;
    start_to_leave(&setup.scene);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    REQUIRE(leave_triangles(&setup), "not run");

    uint32_t wrong = 0, unbounded = 0, tested = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        double edge[2][3], normal[3], side[3], from_plane[3], origin[3];
        subtract(triangles[i].v1, triangles[i].v0, edge[0]);
        subtract(triangles[i].v2, triangles[i].v0, edge[1]);
        vec3_cross(edge[0], edge[1], normal);
        double area = vec3_norm(normal);
        to_double(inputs[i].f[1], side);
        double slope = vec3_dot(normal, side) / area;
        // The side is not defined if the direction is in the plane, within the normal's own
        // rounding, which increases with coordinates relative to size.
        if (!(area > 1e-3 * vec3_norm(edge[0]) * vec3_norm(edge[1])) || fabs(slope) < 1e-3)
            continue;
        tested++;
        subtract(items[i].f[0], triangles[i].v0, from_plane);
        subtract(items[i].f[2], triangles[i].v0, origin);
        double bound = 0;
        for (int c = 0; c < 3; c++)
            bound += fabs(normal[c]) / area * (double)items[i].f[1][c];
        unbounded += !(fabs(vec3_dot(from_plane, normal)) / area <= bound);
        wrong += !(vec3_dot(origin, normal) * slope > 0);
    }
    printf("  %u triangles of 1e-6 to 1e6\n", tested);
    CHECK(wrong == 0, "%u of %u on the wrong side", wrong, tested);
    CHECK(unbounded == 0, "%u of %u further from the plane than the error bound", unbounded,
          tested);
    CHECK(tested > COUNT / 2, "%u", tested);
    setup_close(&setup);
}

// --- normals -------------------------------------------------------------------------------------

// Rounding to 16 bits moves each of two coordinates on the octahedron by up to h = 2^-1 / 32767. On
// the octahedron's faces this is at most sqrt(6) h along the face, which at its centre, 1 / sqrt(3)
// from the origin, is an angle of sqrt(18) h = 6.48e-5. Single precision adds about 1e-7.
TEST(octahedral_normals)
{
    struct setup setup;
    struct random random = {43};
    double bound = sqrt(18) * 0.5 / 32767 + 5e-7, worst = 0;
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    static float normals[COUNT][3];
    for (uint32_t i = 0; i < COUNT; i++) {
        random_direction(&random, normals[i]);
        // Along axes, in planes of two axes, and next to them.
        for (int c = 0; c < 3 && i < 4096; c++)
            if (i >> (2 * c) & 3u)
                normals[i][c] *= i >> (2 * c) & 1u ? 0.0f : 1e-5f;
        double exact[3];
        to_double(normals[i], exact);
        if (!(vec3_norm(exact) > 0))
            exact[2] = -1;
        for (int c = 0; c < 3; c++)
            normals[i][c] = (float)(exact[c] / vec3_norm(exact));
        items[i].u[0][0] = encode_normal(normals[i]);
        CHECK(items[i].u[0][0] != NORMAL_FLAT, "a normal is encoded as missing");
    }
    REQUIRE(library_run(&setup, ROUTINE_DECODE_NORMAL, items, COUNT), "not run");
    for (uint32_t i = 0; i < COUNT; i++) {
        double decoded[3], exact[3], turn[3];
        to_double(items[i].f[0], decoded);
        to_double(normals[i], exact);
        vec3_cross(decoded, exact, turn);
        double angle = atan2(vec3_norm(turn), vec3_dot(decoded, exact));
        worst = fmax(worst, angle);
        CHECK(fabs(vec3_norm(decoded) - 1) <= 1e-6, "length %.9g", vec3_norm(decoded));
    }
    printf("  worst angle of %d normals: %.3g, bound %.3g\n", COUNT, worst, bound);
    CHECK(worst <= bound, "%g", worst);
    setup_close(&setup);
}

// --- finite numbers ------------------------------------------------------------------------------

TEST(is_finite)
{
    static const uint32_t patterns[] = {
        0x00000000u, 0x80000000u,                           // zeros
        0x00000001u, 0x807fffffu,                           // subnormals
        0x00800000u, 0x3f800000u, 0xff7fffffu, 0x7f7fffffu, // normal numbers, up to the largest
        0x7f800000u, 0xff800000u,                           // infinities
        0x7fc00000u, 0xffc00000u, 0x7f800001u, 0xff800001u,
        0x7fffffffu, // quiet and signalling NaNs
    };
    enum { PATTERNS = sizeof patterns / sizeof patterns[0], FINITE = 8 };
    struct setup setup;
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    memset(items, 0, sizeof items);
    for (uint32_t i = 0; i < 3 * PATTERNS; i++)
        items[i].u[0][i % 3] = patterns[i / 3];
    REQUIRE(library_run(&setup, ROUTINE_IS_FINITE, items, 3 * PATTERNS), "not run");
    for (uint32_t i = 0; i < 3 * PATTERNS; i++) {
        bool finite = items[i].f[0][0] == 1.0f;
        CHECK(finite == (i / 3 < FINITE), "0x%08x in component %u: %d", patterns[i / 3], i % 3,
              finite);
    }
    setup_close(&setup);
}

// If a device may round to either neighbour, bounds are twice as wide.
TEST(bounds_of_any_rounding)
{
    static union words nearest[COUNT];
    struct setup setup;
    start_to_leave(&setup.scene);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    struct specialization *s = &setup.r.specialization;
    CHECK(s->rounding == (setup.gpu.rounds_to_nearest ? ROUNDING_NEAREST : ROUNDING_ANY));
    s->rounding = ROUNDING_NEAREST;
    REQUIRE(leave_triangles(&setup), "not run");
    memcpy(nearest, items, sizeof nearest);
    s->rounding = ROUNDING_ANY;
    REQUIRE(leave_triangles(&setup), "not run");
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++) {
            double error = (double)nearest[i].f[1][c];
            wrong += !(fabs((double)items[i].f[1][c] - 2 * error) <= 1e-5 * error);
        }
    CHECK(wrong == 0, "%u of %u bounds are not doubled", wrong, 3 * COUNT);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(offset_origin), TEST_CASE(leave_triangle), TEST_CASE(bounds_of_any_rounding),
          TEST_CASE(octahedral_normals), TEST_CASE(is_finite))
