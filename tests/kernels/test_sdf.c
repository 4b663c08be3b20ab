// Tests the programs of distance fields: the kernels' values and surfaces against double precision.
#include "library_fixture.h"
#include "sdf_programs.h"

enum { POINTS = 10000 };

static union words items[POINTS], inputs[POINTS];

// Adds all programs to one scene, far enough apart to aim rays at one of them.
static void add_all(struct scene *scene)
{
    scene_start(scene, 8, 8);
    for (uint32_t i = 0; i < sdf_program_count; i++)
        add_sdf(scene, &sdf_programs[i],
                &(struct sdf_place){.center = {16.0 * (i % 6), 16.0 * (i / 6), 0}, .scale = 1});
}

// Every value is within the bound that marching assumes for its rounding; most are well within.
TEST(values)
{
    struct setup setup;
    struct random random = {71};
    add_all(&setup.scene);
    OPEN_SETUP(&setup, POINTS);
    for (uint32_t i = 0; i < sdf_program_count; i++) {
        const struct sdf *sdf = &setup.scene.sdfs[i];
        double reach = 1.1 * sdf_programs[i].half, worst = 0, sum = 0;
        for (uint32_t k = 0; k < POINTS; k++) {
            for (int c = 0; c < 3; c++)
                items[k].f[0][c] = (float)random_between(&random, -reach, reach);
            // Also on planes and axes of symmetry.
            items[k].f[0][k % 3] *= k % 16 == 0 ? 0.0f : 1.0f;
            items[k].f[0][(k + 1) % 3] *= k % 64 == 0 ? 0.0f : 1.0f;
            items[k].u[0][3] = i;
        }
        memcpy(inputs, items, sizeof inputs);
        REQUIRE(library_run(&setup, ROUTINE_SDF_VALUE, items, POINTS), "not run");
        for (uint32_t k = 0; k < POINTS; k++) {
            const float *in = inputs[k].f[0];
            const double p[3] = {(double)in[0], (double)in[1], (double)in[2]};
            double exact = sdf_evaluate(sdf, p);
            double error = fabs((double)items[k].f[0][0] - exact);
            // Distances of fractals are divided by a slope, which is rounded, too; this does not
            // move the surface.
            error -= sdf_programs[i].is_fractal ? 1e-4 * fabs(exact) : 0;
            worst = fmax(worst, error);
            sum += error;
            CHECK(isfinite(items[k].f[0][0]), "%s: not finite", sdf_programs[i].name);
        }
        double unit = 0x1p-24 * sdf->magnitude;
        printf("  %-20s roundings: mean %5.2f, worst %5.2f\n", sdf_programs[i].name,
               sum / POINTS / unit, worst / unit);
        CHECK(worst <= 16 * unit, "%s: %g roundings", sdf_programs[i].name, worst / unit);
    }
    setup_close(&setup);
}

// Values differ by no more than the distance of their points, otherwise steps would not be safe.
TEST(values_are_distances)
{
    struct scene scene;
    struct random random = {72};
    add_all(&scene);
    for (uint32_t i = 0; i < sdf_program_count; i++) {
        double worst = 0, reach = sdf_programs[i].half;
        for (uint32_t k = 0; k < 2 * POINTS; k++) {
            double a[3], b[3], apart[3], size = reach * pow(10, random_between(&random, -5, 0));
            float direction[3];
            random_direction(&random, direction);
            for (int c = 0; c < 3; c++) {
                a[c] = random_between(&random, -reach, reach);
                b[c] = a[c] + size * (double)direction[c];
                apart[c] = b[c] - a[c];
            }
            double x = sdf_evaluate(&scene.sdfs[i], a), y = sdf_evaluate(&scene.sdfs[i], b);
            // The field of a Mandelbulb is a distance only outside of it.
            bool counts = x > 0 || (sdf_programs[i].code[0].op & 0xffu) != SDF_MANDELBULB;
            // A surface between them is at most as far from a as b is; the field may bend at folds.
            if (counts && (!sdf_programs[i].is_fractal || (x > 0) != (y > 0)))
                worst = fmax(worst, (sdf_programs[i].is_fractal ? fabs(x) : fabs(x - y)) /
                                        vec3_norm(apart));
        }
        CHECK(worst <= 1 + 1e-6, "%s: %g", sdf_programs[i].name, worst);
        CHECK(worst > 0.05, "%s: %g tests little", sdf_programs[i].name, worst);
    }
    scene_finish(&scene);
}

// --- surfaces ------------------------------------------------------------------------------------

// Finds a point within `off` of the surface, by bisection between points of different sign.
static bool random_surface_point(struct random *random, const struct sdf *sdf, double reach,
                                 double out[3])
{
    double inside[3], outside[3];
    for (int tries = 0; tries < 1000; tries++) {
        for (int c = 0; c < 3; c++) {
            inside[c] = random_between(random, -reach, reach);
            outside[c] = random_between(random, -reach, reach);
        }
        if (sdf_evaluate(sdf, inside) < 0 && sdf_evaluate(sdf, outside) > 0)
            break;
        if (tries == 999)
            return false;
    }
    for (int k = 0; k < 40; k++) {
        for (int c = 0; c < 3; c++)
            out[c] = (inside[c] + outside[c]) / 2;
        memcpy(sdf_evaluate(sdf, out) < 0 ? inside : outside, out, sizeof inside);
    }
    return true;
}

struct surface_counts {
    uint32_t smooth; // points at which the gradient does not change within reach of the kernel's
                     // differences
    uint32_t beyond, wrong_side, turned; // position error larger than reported; ray on the wrong
                                         // side; wrong normal
    double worst;                        // greatest angle between normals
};

// Converts points from the kernel's coordinates, which have an origin and a unit that suit the
// scene.
static void kernel_to_world(const struct flat_scene *flat, const float point[4], double out[3])
{
    const double in[3] = {(double)point[0], (double)point[1], (double)point[2]};
    flat_to_world(flat, in, out);
}

// Evaluates the kernel's results for a point near the surface.
static void judge_surface(const struct setup *setup, uint32_t number, const union words *in,
                          const union words *out, struct surface_counts *counts)
{
    const struct scene *scene = &setup->scene;
    const struct flat_scene *flat = &setup->r.flat;
    const struct shape *shape = &scene->shapes[number];
    const struct sdf *sdf = &scene->sdfs[shape->sdf];
    const double h = sdf->magnitude / 2048, scale = sdf_scale(scene, shape);
    double world[4][3], p[3], q[3], fine[3], coarse[3], turned[3], normal[3] = {0}, off = 0;
    kernel_to_world(flat, out->f[0], world[0]);
    kernel_to_world(flat, out->f[3], world[1]);
    for (int c = 0; c < 3; c++) {
        off += (double)out->f[1][c] * fabs((double)out->f[2][c]) / flat->scale;
        for (int j = 0; j < 3; j++)
            normal[j] += shape->axes[j][c] / vec3_norm(shape->axes[j]) * (double)out->f[2][c];
    }
    sdf_into(scene, shape, world[0], p);
    sdf_into(scene, shape, world[1], q);
    counts->beyond += !(fabs(sdf_evaluate(sdf, p)) * scale <= off);
    // The field is smooth if differences of four times the kernel's width agree with those of a
    // hundredth of it.
    sdf_normal(sdf, p, h / 100, fine);
    sdf_normal(sdf, p, 4 * h, coarse);
    vec3_cross(fine, coarse, turned);
    if (vec3_norm(turned) > 0.02 || vec3_dot(fine, coarse) < 0)
        return;
    counts->smooth++;
    vec3_cross(fine, normal, turned);
    double angle = atan2(vec3_norm(turned), vec3_dot(fine, normal));
    counts->worst = fmax(counts->worst, angle);
    counts->turned += angle > 2e-3;
    double side[3] = {0};
    for (int j = 0; j < 3; j++)
        for (int c = 0; c < 3; c++)
            side[j] += shape->axes[j][c] * (double)in->f[1][c];
    double outwards = vec3_dot(side, fine) < 0 ? -1 : 1;
    if (fabs(vec3_dot(side, fine)) > 0.01 * vec3_norm(side))
        counts->wrong_side += !(outwards * sdf_evaluate(sdf, q) > 0x1p-20 * sdf->magnitude);
}

// Positions are as near to the surface as reported, normals equal those of double precision, and
// rays begin where a march cannot find the same surface again.
TEST(surfaces)
{
    struct setup setup;
    struct random random = {73};
    static const double scales[] = {1, 1e-4, 1e4};
    scene_start(&setup.scene, 8, 8);
    for (uint32_t i = 0; i < sdf_program_count; i++) {
        double scale = scales[i % 3], at = 100 * (i % 6) * scale;
        add_sdf(&setup.scene, &sdf_programs[i],
                &(struct sdf_place){.center = {at, -at, 3 * scale}, .scale = scale, .turn = i});
    }
    OPEN_SETUP(&setup, POINTS);
    for (uint32_t i = 0; i < sdf_program_count; i++) {
        const struct shape *shape = &setup.scene.shapes[i];
        const struct sdf *sdf = &setup.scene.sdfs[i];
        struct surface_counts counts = {0};
        for (uint32_t k = 0; k < POINTS / 4; k++) {
            double p[3];
            REQUIRE(random_surface_point(&random, sdf, sdf_programs[i].half, p), "no surface");
            memset(&items[k], 0, sizeof items[k]);
            random_direction(&random, items[k].f[1]);
            items[k].u[0][3] = i;
            // The error is what the rounding of t may cause for a ray from a distance of ten sizes.
            double at[3];
            for (int c = 0; c < 3; c++) {
                at[c] = shape->center[c];
                for (int j = 0; j < 3; j++)
                    at[c] += shape->axes[j][c] * p[j] / sdf->max[j];
                at[c] += sdf_scale(&setup.scene, shape) * random_between(&random, -1, 1) * 1e-6;
            }
            flat_from_world(&setup.r.flat, at, at);
            for (int c = 0; c < 3; c++)
                items[k].f[0][c] = (float)at[c];
        }
        memcpy(inputs, items, sizeof inputs);
        REQUIRE(library_run(&setup, ROUTINE_SDF_SURFACE, items, POINTS / 4), "not run");
        for (uint32_t k = 0; k < POINTS / 4; k++)
            judge_surface(&setup, i, &inputs[k], &items[k], &counts);
        printf("  %-20s %4u of %u smooth; normals off by %.1e\n", sdf_programs[i].name,
               counts.smooth, POINTS / 4, counts.worst);
        // Some places seem smooth but are not, because a fold lies between the two widths.
        uint32_t folds = sdf_programs[i].is_fractal ? counts.smooth / 100 : counts.smooth / 1000;
        CHECK(counts.turned <= folds, "%s: %u normals", sdf_programs[i].name, counts.turned);
        CHECK(counts.beyond + counts.wrong_side == 0,
              "%s: %u beyond their error, %u rays on the wrong side", sdf_programs[i].name,
              counts.beyond, counts.wrong_side);
    }
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(values), TEST_CASE(values_are_distances), TEST_CASE(surfaces))
