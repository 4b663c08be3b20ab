// Tests distance fields from scene files to programs: that no value exceeds the distance, that
// nothing is outside the box, and the effect of repetition, twists and transforms. Documents that
// are refused are in bad_scenes.json.
#include "mesh_files.h"

#include "scene/core/affine.h"
#include "scene/sdf/sdf.h"
#include "scene/sdf/sdf_evaluate.h"

#include <stdarg.h>

#define FIELD_TEXT 60000

// Loads a scene with one distance field: `text` is the value of "field", and further members
// follow. The caller finishes it.
static bool load_field(struct scene *scene, const char *text, const char *more, struct err *err)
{
    static char document[FIELD_TEXT + 1000];
    snprintf(document, sizeof document,
             "{\"lampyris\": 1, \"materials\": {\"m\": {\"type\": \"diffuse\"}}, \"shapes\": [{"
             "\"type\": \"sdf\", \"material\": \"m\", \"field\": %s%s}]}",
             text, more);
    const struct scene_load_params params = {.path = write_text("field.json", document)};
    *err = (struct err){0};
    return scene_load(&params, scene, err);
}

static uint64_t state = 1;

static double uniform(void) // SplitMix64 (Steele, Lea and Flood 2014)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static double between(double low, double high)
{
    return low + (high - low) * uniform();
}

// Returns a random point of the box enlarged by `wide`.
static void point_near(const struct sdf *sdf, double wide, double p[3])
{
    for (int i = 0; i < 3; i++) {
        double middle = (sdf->min[i] + sdf->max[i]) / 2;
        p[i] = middle + between(-wide, wide) * (sdf->max[i] - sdf->min[i]) / 2;
    }
}

static bool is_within(const struct sdf *sdf, const double p[3])
{
    bool within = true;
    for (int i = 0; i < 3; i++)
        within = within && p[i] >= sdf->min[i] && p[i] <= sdf->max[i];
    return within;
}

// Returns the greatest change of the value per metre between points of the box, with distances from
// a millionth of the box to all of it.
static double steepest(const struct sdf *sdf, int pairs)
{
    double most = 0;
    for (int k = 0; k < pairs; k++) {
        double p[3], q[3], part = pow(10, between(-6, 0)), from[3];
        point_near(sdf, 1, p);
        point_near(sdf, 1, q);
        for (int i = 0; i < 3; i++)
            q[i] = p[i] + part * (q[i] - p[i]);
        vec3_subtract(p, q, from);
        double far = vec3_length(from);
        // Values have the rounding error of the largest coordinate in double precision.
        double change = fabs(sdf_evaluate(sdf, p) - sdf_evaluate(sdf, q));
        most = fmax(most, (change - 1e-14 * sdf->magnitude) / far);
    }
    return most;
}

static void check_field(const char *text, const char *more, int pairs)
{
    struct scene scene;
    struct err err;
    bool ok = load_field(&scene, text, more, &err);
    CHECK(ok, "%s: %s", text, err.msg);
    if (!ok)
        return;
    const struct sdf *sdf = &scene.sdfs[0];
    double most = steepest(sdf, pairs);
    CHECK(most <= 1 + 1e-6, "%s: falls by %.9g a metre", text, most);
    bool closed = !strstr(more, "bounds"), good = true;
    for (int k = 0; k < pairs && good; k++) {
        double p[3], largest = 0;
        point_near(sdf, 3, p);
        double value = sdf_evaluate(sdf, p);
        for (int i = 0; i < 3; i++)
            largest = fmax(largest, fabs(p[i]));
        good = isfinite(value) &&
               (is_within(sdf, p) ? largest <= sdf->magnitude : !closed || value > 0);
        CHECK(good, "%s: %g at (%g, %g, %g), the box [%g, %g, %g] .. [%g, %g, %g], magnitude %g",
              text, value, p[0], p[1], p[2], sdf->min[0], sdf->min[1], sdf->min[2], sdf->max[0],
              sdf->max[1], sdf->max[2], sdf->magnitude);
    }
    scene_finish(&scene);
}

#define SPHERE "{\"type\": \"sphere\", \"radius\": 0.7}"
#define BOX "{\"type\": \"box\", \"size\": [2, 1, 1.4]}"

static const struct field_case {
    const char *text, *more;
} fields[] = {
    {SPHERE, ""},
    {BOX, ""},
    {"{\"type\": \"box\", \"size\": [2, 1, 1.4], \"round\": 0.3}", ""},
    {"{\"type\": \"frame\", \"size\": [2, 1, 1.4], \"bar\": 0.2}", ""},
    {"{\"type\": \"torus\", \"radius\": 1, \"tube\": 0.3}", ""},
    {"{\"type\": \"torus\", \"radius\": 0.2, \"tube\": 0.3}", ""},
    {"{\"type\": \"capsule\", \"from\": [1, 2, 3], \"to\": [2, 2, 1], \"radius\": 0.3}", ""},
    {"{\"type\": \"capsule\", \"from\": [1, 2, 3], \"to\": [1, 2, 3], \"radius\": 0.3}", ""},
    {"{\"type\": \"cone\", \"radius\": 1, \"height\": 2}", ""},
    {"{\"type\": \"cone\", \"radius\": 0.3, \"top\": 1.2, \"height\": 0.5}", ""},
    {"{\"type\": \"cylinder\", \"radius\": 1, \"height\": 0.5}", ""},
    {"{\"type\": \"cylinder\", \"radius\": 0.5, \"height\": 3, \"round\": 0.5}", ""},
    {"{\"type\": \"solid_angle\", \"radius\": 1, \"degrees\": 30}", ""},
    {"{\"type\": \"solid_angle\", \"radius\": 1, \"degrees\": 90}", ""},
    {"{\"type\": \"solid_angle\", \"radius\": 1, \"degrees\": 140}", ""},
    {"{\"type\": \"solid_angle\", \"radius\": 1, \"degrees\": 180}", ""},
    {"{\"type\": \"plane\", \"normal\": [1, 2, 3], \"height\": 0.2}",
     ", \"bounds\": {\"min\": [-1, -1, -1], \"max\": [1, 2, 1]}"},
    {"{\"type\": \"gyroid\", \"period\": 1, \"thickness\": 0.1}",
     ", \"bounds\": {\"min\": [-1, -1, -1], \"max\": [1, 2, 1]}"},
    {"{\"type\": \"metaballs\", \"balls\": [[0, 0, 0, 1]]}", ""},
    {"{\"type\": \"metaballs\", \"threshold\": 0.3, \"balls\": [[0, 0, 0, 1], [0.8, 0, 0, 1.2], "
     "[0, 0.5, 0.1, 0.4], [0.1, 0.4, 0, 0.5], [-1, 0.1, 0, 0.7]]}",
     ""},
    {"{\"type\": \"menger\", \"size\": 2, \"iterations\": 3}", ""},
    {"{\"type\": \"menger\", \"size\": 2, \"iterations\": 0}", ""},
    {"{\"type\": \"pyramid\", \"size\": 2, \"iterations\": 5}", ""},
    {"{\"type\": \"union\", \"of\": [" SPHERE ", " BOX "], \"smooth\": 0.5}", ""},
    {"{\"type\": \"union\", \"of\": [" SPHERE ", " BOX ", " SPHERE "]}", ""},
    {"{\"type\": \"intersection\", \"of\": [" SPHERE ", " BOX "], \"smooth\": 0.3}", ""},
    {"{\"type\": \"intersection\", \"of\": [" SPHERE ", {\"type\": \"plane\", \"normal\": [0, 1, "
     "0]}]}",
     ""},
    {"{\"type\": \"difference\", \"of\": [" BOX ", " SPHERE ", {\"type\": \"plane\", \"normal\": "
     "[0, -1, 0]}], \"smooth\": 0.2}",
     ""},
    {"{\"type\": \"round\", \"radius\": 0.2, \"of\": {\"type\": \"intersection\", \"of\": [" SPHERE
     ", " BOX "]}}",
     ""},
    {"{\"type\": \"shell\", \"thickness\": 0.2, \"of\": " BOX "}", ""},
    {"{\"type\": \"repeat\", \"spacing\": [2, 1.5, 0], \"counts\": [3, 5, 1], \"of\": " SPHERE "}",
     ""},
    {"{\"type\": \"repeat\", \"spacing\": [0.8, 0, 1], \"of\": " SPHERE "}",
     ", \"bounds\": {\"min\": [-2, -2, -2], \"max\": [2.1, 2, 2]}"},
    {"{\"type\": \"repeat\", \"spacing\": [2.5, 1, 2], \"counts\": [3, 1, 3], \"of\": {\"type\": "
     "\"cone\", \"radius\": 0.6, \"height\": 1, \"transform\": {\"translate\": [0.5, 0.2, 0]}}}",
     ""},
    {"{\"type\": \"twist\", \"degrees\": 90, \"of\": {\"type\": \"box\", \"size\": [1, 3, 0.5]}}",
     ""},
    {"{\"type\": \"round\", \"radius\": 0.05, \"of\": {\"type\": \"twist\", \"degrees\": -60, "
     "\"of\": {\"type\": \"torus\", \"radius\": 1, \"tube\": 0.2, \"transform\": {\"rotate\": "
     "{\"axis\": [1, 0, 0], \"degrees\": 90}}}}}",
     ""},
    {"{\"type\": \"mirror\", \"axes\": \"xz\", \"of\": {\"type\": \"capsule\", \"from\": [1, 0, "
     "0.2], \"to\": [0.5, 1, 2], \"radius\": 0.3}}",
     ""},
    {"{\"type\": \"union\", \"of\": [" SPHERE ", {\"type\": \"frame\", \"size\": [1, 1, 1], "
     "\"bar\": 0.1, \"transform\": [{\"scale\": 3}, {\"rotate\": {\"axis\": [1, 2, 3], "
     "\"degrees\": 40}}, {\"translate\": [1, 2, 3]}, {\"scale\": [-1, 1, 1]}]}]}",
     ""},
};

TEST(values_stay_below_the_distance)
{
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        state = i + 1;
        check_field(fields[i].text, fields[i].more, 20000);
    }
}

// --- random trees --------------------------------------------------------------------------------

struct text {
    char *at, *end;
};

static void say(struct text *out, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void say(struct text *out, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(out->at, (size_t)(out->end - out->at), format, arguments);
    va_end(arguments);
    out->at += length < out->end - out->at ? length : 0;
}

static void say_transform(struct text *out)
{
    if (uniform() < 0.5)
        return;
    say(out, ", \"transform\": [{\"scale\": %g}", between(0.4, 1.6));
    if (uniform() < 0.5)
        say(out, ", {\"rotate\": {\"axis\": [%g, %g, 1], \"degrees\": %g}}", between(-1, 1),
            between(-1, 1), between(-180, 180));
    if (uniform() < 0.7)
        say(out, ", {\"translate\": [%g, %g, %g]}", between(-1, 1), between(-1, 1), between(-1, 1));
    say(out, "]");
}

static void say_shape(struct text *out)
{
    switch ((int)between(0, 7)) {
    case 0:
        say(out, "{\"type\": \"sphere\", \"radius\": %g", between(0.2, 1));
        break;
    case 1:
        say(out, "{\"type\": \"box\", \"size\": [1, %g, %g], \"round\": 0.05", between(0.2, 2),
            between(0.2, 2));
        break;
    case 2:
        say(out, "{\"type\": \"torus\", \"radius\": %g, \"tube\": 0.2", between(0.1, 1));
        break;
    case 3:
        say(out, "{\"type\": \"cone\", \"radius\": %g, \"top\": %g, \"height\": 1", between(0.1, 1),
            between(0, 1));
        break;
    case 4:
        say(out, "{\"type\": \"metaballs\", \"balls\": [[0, 0, 0, %g], [%g, 0.3, 0, 0.7]]",
            between(0.5, 1), between(0.1, 1));
        break;
    case 5:
        say(out, "{\"type\": \"menger\", \"size\": %g, \"iterations\": 2", between(0.5, 2));
        break;
    default:
        say(out, "{\"type\": \"frame\", \"size\": [1, 1, %g], \"bar\": 0.1", between(0.2, 2));
        break;
    }
    say_transform(out);
    say(out, "}");
}

static void say_tree(struct text *out, int depth)
{
    static const char *const joints[] = {"union", "intersection", "difference"};
    int kind = depth > 0 ? (int)between(0, 9) : 9;
    switch (kind) {
    case 0:
    case 1:
    case 2:
    case 3:
        // Intersections of arbitrary fields are often empty, which is refused.
        say(out, "{\"type\": \"%s\", \"of\": [", joints[kind % 2 * 2]);
        say_tree(out, depth - 1);
        say(out, ", ");
        say_tree(out, depth - 1);
        say(out, "], \"smooth\": %g", uniform() < 0.5 ? 0 : between(0, 0.5));
        break;
    case 4:
        say(out, "{\"type\": \"round\", \"radius\": %g, \"of\": ", between(0.01, 0.1));
        say_tree(out, depth - 1);
        break;
    case 5:
        say(out, "{\"type\": \"shell\", \"thickness\": %g, \"of\": ", between(0.01, 0.1));
        say_tree(out, depth - 1);
        break;
    case 6:
        say(out, "{\"type\": \"repeat\", \"spacing\": [%g, 0, %g], \"counts\": [3, 1, 3], \"of\": ",
            between(0.5, 3), between(0.5, 3));
        say_tree(out, depth > 1 ? 1 : 0);
        break;
    case 7:
        say(out, "{\"type\": \"twist\", \"degrees\": %g, \"of\": ", between(-30, 30));
        say_tree(out, depth - 1);
        break;
    case 8:
        say(out, "{\"type\": \"mirror\", \"axes\": \"%c\", \"of\": ", "xyz"[(int)between(0, 3)]);
        say_tree(out, depth - 1);
        break;
    default:
        say_shape(out);
        return;
    }
    say_transform(out);
    say(out, "}");
}

TEST(values_of_random_trees_stay_below_the_distance)
{
    static char buffer[FIELD_TEXT];
    struct scene scene;
    int refused = 0;
    struct err err;
    for (int k = 0; k < 150; k++) {
        struct text out = {buffer, buffer + sizeof buffer};
        state = 1000 + (uint64_t)k;
        say_tree(&out, 4);
        if (!load_field(&scene, buffer, "", &err)) {
            // The field is too long, too deep, twisted too much, or empty; the error names the
            // place.
            CHECK(strstr(err.msg, "shapes[0].field") && err.code == ERR_INPUT, "%s: %s", buffer,
                  err.msg);
            refused++;
            continue;
        }
        scene_finish(&scene);
        check_field(buffer, "", 1000);
    }
    CHECK(refused < 30, "%d refused, the last: %s", refused, err.msg);
}

// --- what operations mean ------------------------------------------------------------------------

static double value_at(const struct scene *scene, double x, double y, double z)
{
    return sdf_evaluate(&scene->sdfs[0], (double[3]){x, y, z});
}

// All copies of an asymmetric field in a cell must exist: the result equals their union.
TEST(repetition_is_the_union_of_its_copies)
{
    static const char lopsided[] = "{\"type\": \"cone\", \"radius\": 0.4, \"height\": 1, "
                                   "\"transform\": {\"translate\": [%g, 0, 0]}}";
    static const double offsets[] = {0, 0.55, 1.4}; // with the last offset the field exceeds its
                                                    // cell
    for (int k = 0; k < 3; k++) {
        char child[400], text[2000];
        struct scene repeated, one;
        struct err err;
        snprintf(child, sizeof child, lopsided, offsets[k]);
        snprintf(text, sizeof text,
                 "{\"type\": \"repeat\", \"spacing\": [2, 0, 1.5], \"counts\": [5, 1, 3], \"of\": "
                 "%s}",
                 child);
        REQUIRE(load_field(&repeated, text, "", &err), "%s", err.msg);
        REQUIRE(load_field(&one, child, "", &err), "%s", err.msg);
        CHECK((repeated.sdfs[0].count < 8) == (k == 0), "%u instructions", repeated.sdfs[0].count);
        for (int i = 0; i < 20000; i++) {
            double p[3], nearest = INFINITY;
            point_near(&repeated.sdfs[0], 1.5, p);
            for (int x = -2; x <= 2; x++)
                for (int z = -1; z <= 1; z++)
                    nearest = fmin(nearest, value_at(&one, p[0] - 2 * x, p[1], p[2] - 1.5 * z));
            double value = sdf_evaluate(&repeated.sdfs[0], p);
            bool same = fabs(value - nearest) < 1e-6;
            CHECK(same, "(%g, %g, %g): %g, nearest copy %g", p[0], p[1], p[2], value, nearest);
        }
        scene_finish(&repeated);
        scene_finish(&one);
    }
}

// The Lipschitz constant of a twist follows from its Jacobian where that is greatest: at the edge
// of the box.
TEST(twists_are_slowed_as_much_as_they_stretch)
{
    struct scene scene;
    struct err err;
    REQUIRE(load_field(&scene,
                       "{\"type\": \"twist\", \"degrees\": 100, \"of\": {\"type\": \"box\", "
                       "\"size\": [2, 1, 1]}}",
                       "", &err),
            "%s", err.msg);
    const struct sdf *sdf = &scene.sdfs[0];
    double radius = hypot(sdf->max[0], sdf->max[2]), k = 100 * M_PI / 180, most = 0;
    // Numerically, the longest image of a unit vector in the tangent plane of a cylinder.
    for (int i = 0; i < 10000; i++) {
        double angle = M_PI * i / 10000, across = cos(angle), up = sin(angle);
        most = fmax(most, hypot(across + k * radius * up, up));
    }
    CHECK(fabs(sdf->lipschitz / most - 1) < 1e-5, "%g, expected %g", sdf->lipschitz, most);
    scene_finish(&scene);
}

TEST(the_gradient_of_metaballs_is_bounded_closely)
{
    for (int k = 0; k < 8; k++) {
        double balls[12][4], found = 0;
        state = 77 + (uint64_t)k;
        uint32_t count = 1 + (uint32_t)between(0, 12);
        for (uint32_t i = 0; i < count; i++)
            for (int c = 0; c < 4; c++)
                balls[i][c] = c < 3 ? between(-1, 1) : between(0.3, 1);
        double bound = sdf_metaballs_gradient((const double(*)[4])balls, count);
        for (int i = 0; i < 100000; i++) {
            double p[3] = {between(-1, 1), between(-1, 1), between(-1, 1)}, gradient[3] = {0};
            for (uint32_t b = 0; b < count; b++) {
                double from[3], r = balls[b][3];
                vec3_subtract(p, balls[b], from);
                double rest = fmax(0, 1 - vec3_dot(from, from) / (r * r));
                for (int c = 0; c < 3; c++)
                    gradient[c] -= 6 * rest * rest * from[c] / (r * r);
            }
            found = fmax(found, vec3_length(gradient));
        }
        CHECK(found <= bound && bound <= 1.15 * found, "%u balls: %g, bound %g", count, found,
              bound);
    }
}

TEST(transforms_place_fields)
{
    struct scene scene;
    struct err err;
    REQUIRE(load_field(&scene, BOX,
                       ", \"transform\": [{\"scale\": [2, 2, -2]}, {\"rotate\": {\"axis\": [0, 1, "
                       "0], \"degrees\": 90}}, {\"translate\": [10, 20, 30]}]",
                       &err),
            "%s", err.msg);
    double m[3][4], p[3] = {1, 0.5, 0.7};
    sdf_to_world(&scene.sdfs[0], &scene.shapes[0], m);
    affine_point(m, p, p);
    CHECK(fabs(p[0] - 8.6) < 1e-9 && fabs(p[1] - 21) < 1e-9 && fabs(p[2] - 28) < 1e-9,
          "(%.12g, %.12g, %.12g)", p[0], p[1], p[2]);
    CHECK(fabs(affine_determinant(m) + 8) < 1e-9, "mirrored, twice as large: %g",
          affine_determinant(m));
    scene_finish(&scene);
}

// If bounds cut the solid, there is a hole, which is noted.
TEST(open_cuts_are_noted)
{
    struct scene scene;
    struct err err;
    static const char *const bounds[] = {
        ", \"bounds\": {\"min\": [-1, -1, -1], \"max\": [1, 1, 1]}",
        ", \"bounds\": {\"min\": [-1, -1, -1], \"max\": [0.1, 1, 1]}"};
    for (int k = 0; k < 2; k++) {
        REQUIRE(load_field(&scene, SPHERE, bounds[k], &err), "%s", err.msg);
        bool noted = false;
        for (uint32_t i = 0; i < scene.note_count; i++)
            noted = noted || strstr(scene.notes[i], "cuts the field open");
        CHECK(noted == (k == 1), "%u notes", scene.note_count);
        scene_finish(&scene);
    }
}

static int run_all(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(values_stay_below_the_distance),
        TEST_CASE(values_of_random_trees_stay_below_the_distance),
        TEST_CASE(repetition_is_the_union_of_its_copies),
        TEST_CASE(twists_are_slowed_as_much_as_they_stretch),
        TEST_CASE(the_gradient_of_metaballs_is_bounded_closely),
        TEST_CASE(transforms_place_fields),
        TEST_CASE(open_cuts_are_noted),
    };
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}

int main(int argc, char **argv)
{
    return begin_mesh_tests() ? run_all(argc, argv) : 1;
}
