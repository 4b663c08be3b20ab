// Tests scattered spheres: none overlaps another, all are on the disc, and they are the same on
// every machine.
#include "scene/generate/phong_spheres.h"
#include "scene/generate/scatter.h"
#include "test.h"

#include <stdlib.h>

#define COUNT 3000

static const struct scatter plain = {
    .count = COUNT, .seed = 1, .disc_radius = 40, .min_radius = 0.1, .max_radius = 1};

static uint32_t strew(const struct scatter *scatter, struct scattered_sphere *out)
{
    struct arena scratch = {0};
    struct err err = {0};
    uint32_t placed = 0;
    CHECK(scatter_spheres(scatter, &scratch, out, &placed, &err), "%s", err.msg);
    arena_finish(&scratch);
    return placed;
}

// Counts overlaps by brute force, by the distance in space instead of that of the points on the
// disc.
static uint32_t count_overlaps(const struct scattered_sphere *s, uint32_t count)
{
    uint32_t overlaps = 0;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < i; j++) {
            double square = 0, reach = s[i].radius + s[j].radius;
            for (int c = 0; c < 3; c++)
                square += (s[i].center[c] - s[j].center[c]) * (s[i].center[c] - s[j].center[c]);
            overlaps += square < reach * reach * (1 - 1e-12);
        }
    return overlaps;
}

static void check_places(const struct scatter *scatter, const struct scattered_sphere *spheres,
                         uint32_t placed)
{
    for (uint32_t i = 0; i < placed; i++) {
        const struct scattered_sphere *s = &spheres[i];
        double edge = hypot(s->center[0], s->center[2]) + s->radius;
        CHECK(s->radius >= scatter->min_radius && s->radius <= scatter->max_radius, "%u: %g", i,
              s->radius);
        CHECK(edge <= scatter->disc_radius * (1 + 1e-12) && s->center[1] == s->radius,
              "sphere %u reaches %g", i, edge);
    }
    CHECK(count_overlaps(spheres, placed) == 0);
}

TEST(places)
{
    static struct scattered_sphere spheres[COUNT];
    uint32_t placed = strew(&plain, spheres);
    CHECK(placed == COUNT, "%u", placed);
    check_places(&plain, spheres, placed);
}

// More spheres than fit; equal radii, and radii over six orders of magnitude; a sphere as large as
// the disc; a disc much larger than its spheres.
TEST(stiff_places)
{
    static struct scattered_sphere spheres[COUNT];
    const struct scatter crowded = {COUNT, 2, 10, 0.5, 1}, equal = {500, 3, 30, 1, 1},
                         varied = {COUNT, 4, 40, 1e-6, 1}, one = {2, 5, 1, 1, 1},
                         wide = {COUNT, 6, 1e6, 1e-3, 1e-3};
    uint32_t placed = strew(&crowded, spheres);
    CHECK(placed > 100 && placed < COUNT, "%u", placed);
    check_places(&crowded, spheres, placed);
    placed = strew(&equal, spheres);
    CHECK(placed > 350, "%u", placed);
    check_places(&equal, spheres, placed);
    placed = strew(&varied, spheres);
    CHECK(placed == COUNT, "%u", placed);
    check_places(&varied, spheres, placed);
    CHECK(strew(&one, spheres) == 1 && spheres[0].center[0] == 0 && spheres[0].center[2] == 0);
    CHECK(strew(&wide, spheres) == COUNT);
}

// Returns the FNV-1a hash of the bits, which must be the same on every machine.
static uint64_t hash_of(const struct scatter *scatter)
{
    static struct scattered_sphere spheres[COUNT];
    uint32_t placed = strew(scatter, spheres);
    uint64_t hash = 0xcbf29ce484222325u;
    for (uint32_t i = 0; i < placed; i++) {
        uint64_t words[5] = {0};
        memcpy(words, spheres[i].center, 24);
        memcpy(words + 3, &spheres[i].radius, 8);
        words[4] = spheres[i].choice;
        for (int w = 0; w < 5; w++)
            hash = (hash ^ words[w]) * 0x100000001b3u;
    }
    return hash;
}

TEST(the_seed_decides)
{
    struct scatter other = plain;
    other.seed = 2;
    uint64_t hash = hash_of(&plain);
    CHECK(hash == 0x1ef11a89c43d4fc0u, "0x%llx", (unsigned long long)hash);
    CHECK(hash_of(&plain) == hash);
    CHECK(hash_of(&other) != hash);
}

// Radii have the distribution min + (max - min) u^3, choices are uniform, and places fill the disc.
// The limit of each count is 5 standard deviations.
TEST(distributions)
{
    static struct scattered_sphere spheres[COUNT];
    const struct scatter sparse = {COUNT, 7, 1e4, 1, 2};
    uint32_t small = 0, even = 0, inside = 0;
    REQUIRE(strew(&sparse, spheres) == COUNT);
    for (uint32_t i = 0; i < COUNT; i++) {
        small += spheres[i].radius < 1.125;
        even += spheres[i].choice < 1u << 31;
        inside += hypot(spheres[i].center[0], spheres[i].center[2]) < 1e4 * sqrt(0.5);
    }
    double bound = 5 * sqrt(COUNT / 4.0), half = COUNT / 2.0;
    CHECK(fabs(small - half) < bound && fabs(even - half) < bound && fabs(inside - half) < bound,
          "%u, %u, %u of %u", small, even, inside, COUNT);
}

static void check_icosphere(uint32_t subdivision, double volume_min)
{
    struct scene scene = {0};
    struct err err = {0};
    uint32_t index;

    REQUIRE(generate_icosphere(&scene, subdivision, &index, &err), "%s", err.msg);
    const struct mesh *mesh = &scene.meshes[index];
    CHECK(mesh->triangle_count == 20u << 2 * subdivision, "%u", mesh->triangle_count);
    double volume = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const float *a = mesh->positions[mesh->indices[t][0]],
                    *b = mesh->positions[mesh->indices[t][1]],
                    *c = mesh->positions[mesh->indices[t][2]];
        double part = (double)a[0] * (b[1] * c[2] - b[2] * c[1]) +
                      (double)a[1] * (b[2] * c[0] - b[0] * c[2]) +
                      (double)a[2] * (b[0] * c[1] - b[1] * c[0]);
        CHECK(part > 0, "triangle %u is seen from inside", t);
        volume += part / 6;
    }
    // All vertices are on the sphere, and the triangles approximate it from inside.
    double whole = 4.0 / 3.0 * acos(-1.0);
    CHECK(volume < whole && volume > volume_min * whole, "%g of %g", volume, whole);
    scene_finish(&scene);
}

// An icosahedron fills 0.6055 of its sphere; each step leaves a quarter of the missing part.
TEST(icospheres)
{
    check_icosphere(0, 0.605);
    check_icosphere(2, 0.96);
    check_icosphere(5, 0.999);
}

// --- spheres of Phong's model --------------------------------------------------------------------

#define TRIED 10000

static const struct phong_spheres published = {
    .count = TRIED, .seed = 1223832719, .min_radius = 5, .max_radius = 30, .disc_radius = 100};

static uint32_t place(const struct phong_spheres *params, struct phong_sphere *out)
{
    struct err err = {0};
    uint32_t placed = 0;
    CHECK(phong_spheres_place(params, out, &placed, &err), "%s", err.msg);
    return placed;
}

static bool is_near(const float *a, const double *b, int count)
{
    for (int i = 0; i < count; i++)
        if (fabs((double)a[i] - b[i]) > 4e-6 * fmax(1, fabs(b[i])))
            return false;
    return true;
}

// The first, the second and the last sphere, and the number of each kind, from the published
// sequence and formulas, computed independently of this program in double precision.
TEST(the_published_spheres)
{
    static struct phong_sphere s[TRIED];
    uint32_t placed = place(&published, s), metals = 0, glowing = 0;
    REQUIRE(placed == 86, "%u", placed);
    CHECK(is_near(s[0].center, (double[]){11.5694541, 27.6579636, 71.4071562}, 3) &&
          is_near(s[0].specular_color, (double[]){0.29364777, 0.19712296, 0.72395366}, 3) &&
          is_near(&s[0].smoothness, (double[]){0.20850828}, 1));
    CHECK(is_near(s[1].center, (double[]){-26.7930426, 12.2408326, -49.3237046}, 3) &&
          is_near(s[1].base_color, (double[]){0.2799795, 0.22534157, 0.38303655}, 3) &&
          is_near(s[1].specular_color, (double[]){0.04, 0.04, 0.04}, 3) &&
          is_near(&s[1].smoothness, (double[]){0.93043983}, 1));
    CHECK(is_near(s[85].center, (double[]){-21.158817, 5.69574723, 71.6926855}, 3));
    for (uint32_t i = 0; i < placed; i++) {
        metals += s[i].specular_color[0] > 0 && s[i].base_color[0] == 0 && s[i].base_color[1] == 0;
        glowing += s[i].emission[0] > 0;
    }
    CHECK(metals == 31 && glowing == 15, "%u, %u", metals, glowing);
}

TEST(phong_spheres_keep_their_ranges)
{
    static struct phong_sphere s[TRIED];
    struct phong_spheres params = published;
    for (params.seed = 0; params.seed < 20; params.seed++) {
        uint32_t placed = place(&params, s);
        CHECK(placed > 40 && placed < 200, "seed %u: %u", params.seed, placed);
        for (uint32_t i = 0; i < placed; i++) {
            double foot = hypot((double)s[i].center[0], (double)s[i].center[2]);
            CHECK(s[i].radius >= 5 && s[i].radius <= 30 && s[i].center[1] == s[i].radius &&
                  foot < 100.001);
            CHECK(s[i].smoothness >= 0 && s[i].smoothness <= 1);
            float brightest = fmaxf(s[i].emission[0], fmaxf(s[i].emission[1], s[i].emission[2]));
            CHECK(brightest == 0 || (brightest >= 3 && brightest <= 8), "%g", (double)brightest);
            for (int c = 0; c < 3; c++)
                CHECK(s[i].base_color[c] >= 0 && s[i].specular_color[c] >= 0 &&
                      s[i].base_color[c] + s[i].specular_color[c] <= 1);
            for (uint32_t k = 0; k < i; k++) {
                double square = 0, reach = (double)s[i].radius + (double)s[k].radius;
                for (int c = 0; c < 3; c++)
                    square += pow((double)s[i].center[c] - (double)s[k].center[c], 2);
                CHECK(square > reach * reach * (1 - 1e-6));
            }
        }
    }
    CHECK(phong_exponent(0) == 1 && fabs(phong_exponent(1) - 1000) < 1e-9);
}

TEST_MAIN(TEST_CASE(places), TEST_CASE(stiff_places), TEST_CASE(the_seed_decides),
          TEST_CASE(distributions), TEST_CASE(icospheres), TEST_CASE(the_published_spheres),
          TEST_CASE(phong_spheres_keep_their_ranges))
