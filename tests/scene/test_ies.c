// Tests photometric profiles: variants of the formats, symmetries, integrals, and invalid files.
#define _GNU_SOURCE // memfd_create
#include "ies_reference.h"
#include "test.h"
#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static bool load_text(struct scene *scene, const char *text, size_t size,
                      const struct light_profile **out, struct err *err)
{
    int fd = memfd_create("profile", 0);
    if (fd < 0 || write(fd, text, size) != (ssize_t)size)
        abort();
    char path[64];
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    scene->profiles = NULL; // the next file has the same path
    bool ok = ies_load(scene, path, out, err);
    close(fd);
    return ok;
}

static const struct light_profile *load(struct scene *scene, const char *text)
{
    const struct light_profile *profile = NULL;
    struct err err = {0};
    if (!load_text(scene, text, strlen(text), &profile, &err)) {
        fprintf(stderr, "%s\n", err.msg);
        abort();
    }
    return profile;
}

#define HEAD "IESNA:LM-63-2002\n[TEST] own\nTILT=NONE\n"
#define SIZES " 2 0.1 0.1 0 1 1 50\n"

static void check_near(const char *what, double value, double expected, double tolerance)
{
    CHECK(fabs(value - expected) <= tolerance, "%s: %.9g, expected %.9g", what, value, expected);
}

TEST(values)
{
    struct scene scene = {0};
    // The values are candela times the multiplier and both ballast factors, over 683. Commas are
    // separators, too.
    const struct light_profile *p =
        load(&scene, HEAD "1 1000 2 3 1 1 2 .1 .1 0\n0.5 0.25 50\n0,45,90\n0\n1366 683\n0\n");
    check_near("greatest", p->greatest, 2 * 0.5 * 0.25 * 2, 1e-9);
    CHECK(p->horizontal_count == 1 && p->vertical_count == 3, "%u x %u", p->horizontal_count,
          p->vertical_count);
    check_near("at 0", ies_relative(p, 0, 77), 1, 0);
    check_near("at 22.5", ies_relative(p, 22.5, 200), 0.75, 1e-7);
    check_near("at 67.5", ies_relative(p, 67.5, 200), 0.25, 1e-7);
    check_near("at 90.1", ies_relative(p, 90.1, 200), 0, 0);
    // A file without a header, with the lamp's tilt, whose values are read but not used.
    p = load(&scene,
             "a lamp\nTILT=INCLUDE\n1\n2\n0 90\n1 0.9\n1 1 1 2 1 1" SIZES "0 180\n0\n5 5\n");
    check_near("sphere", p->solid_angle, 4 * M_PI, 1e-6);
    check_near("greatest", p->greatest, 5 / 683.0, 1e-9);
    scene_finish(&scene);
}

// Values that differ between planes, for each symmetry that files use: at 0, 30, 90, 150, 200, 270,
// 330 and 360 degrees.
static const struct {
    const char *name, *text;
    double expected[8];
} symmetries[] = {
    {"quarter",
     HEAD "1 1 1 2 3 1" SIZES "0 90\n0 45 90\n1 1 4 4 10 10\n",
     {1, 3, 10, 3, 1 + 3 * 20 / 45.0, 10, 3, 1}},
    {"half",
     HEAD "1 1 1 2 4 1" SIZES "0 90\n0 60 120 180\n1 1 3 3 5 5 10 10\n",
     {1, 2, 4, 7.5, 10 - 5 * 20 / 60.0, 4, 2, 1}},
    {"half, sideways",
     HEAD "1 1 1 2 3 1" SIZES "0 90\n90 180 270\n1 1 4 4 10 10\n",
     {4, 3, 1, 3, 4 + 6 * 20 / 90.0, 10, 6, 4}},
    {"all round",
     HEAD "1 1 1 2 3 1" SIZES "0 90\n0 180 360\n1 1 10 10 1 1\n",
     {1, 2.5, 5.5, 8.5, 9, 5.5, 2.5, 1}},
    {"all round, not closed",
     HEAD "1 1 1 2 4 1" SIZES "0 90\n0 90 180 270\n10 10 1 1 4 4 7 7\n",
     {10, 7, 1, 3, 4 + 3 * 20 / 90.0, 7, 9, 10}},
};

TEST(symmetry)
{
    static const double angles[8] = {0, 30, 90, 150, 200, 270, 330, 360};
    struct scene scene = {0};
    for (size_t i = 0; i < sizeof symmetries / sizeof symmetries[0]; i++) {
        const struct light_profile *p = load(&scene, symmetries[i].text);
        for (int a = 0; a < 8; a++)
            check_near(symmetries[i].name, 10 * ies_relative(p, 45, angles[a]),
                       symmetries[i].expected[a], 2e-6);
        CHECK(p->horizontal[0] == 0 && p->horizontal[p->horizontal_count - 1] == 360,
              "%s: from %g to %g", symmetries[i].name, (double)p->horizontal[0],
              (double)p->horizontal[p->horizontal_count - 1]);
    }
    scene_finish(&scene);
}

// Compares the integral with a sum over many small patches.
TEST(integral)
{
    struct scene scene = {0};
    for (size_t i = 0; i < sizeof symmetries / sizeof symmetries[0]; i++) {
        const struct light_profile *p = load(&scene, symmetries[i].text);
        double sum = 0;
        for (int v = 0; v < 1800; v++)
            for (int h = 0; h < 360; h++)
                sum += ies_relative(p, (v + 0.5) / 10, h + 0.5) * sin((v + 0.5) * M_PI / 1800) *
                       (M_PI / 1800) * (M_PI / 180);
        check_near(symmetries[i].name, p->solid_angle / sum, 1, 1e-4);
    }
    scene_finish(&scene);
}

// A profile whose flux agrees with its header: a cosine with 1000 lm from 1000 / pi cd.
TEST(flux)
{
    char text[4096];
    size_t at = (size_t)snprintf(text, sizeof text, HEAD "1 1000 1 91 1 1" SIZES);
    for (int v = 0; v <= 90; v++)
        at += (size_t)snprintf(text + at, sizeof text - at, "%d ", v);
    at += (size_t)snprintf(text + at, sizeof text - at, "\n0\n");
    for (int v = 0; v <= 90; v++)
        at += (size_t)snprintf(text + at, sizeof text - at, "%.6f ",
                               1000 / M_PI * cos(v * M_PI / 180));
    struct scene scene = {0};
    const struct light_profile *p = load(&scene, text);
    check_near("flux", p->greatest * p->solid_angle * LUMENS_A_WATT, 1000, 1);
    scene_finish(&scene);
}

static const char good[] =
    HEAD "1 1000 1 3 2 1 2 0.1 0.1 0.05\n1 1 20\n0 45 90\n0 90\n1000 500 100\n900 400 200\n";

static const struct {
    const char *text, *message;
} bad[] = {
    {"", "TILT="},
    {"IESNA:LM-63-1995\n", "TILT="},
    {"TILT=lamp.tlt\n", "TILT=NONE"},
    {HEAD "1 1 nan 2 1 1" SIZES "0 90\n0\n1 1\n", "multiplier"},
    {HEAD "1 1 -1 2 1 1" SIZES "0 90\n0\n1 1\n", "multiplier"},
    {HEAD "1 1 1 1000000000 1 1" SIZES, "vertical angles"},
    {HEAD "1 1 1 2 1000000000 1" SIZES, "horizontal angles"},
    {HEAD "1 1 1 4096 4096 1" SIZES, "too many"},
    {HEAD "1 1 1 0 1 1" SIZES, "vertical angles"},
    {HEAD "1 1 1 2 1 2" SIZES "0 90\n0\n1 1\n", "type 2 (B)"},
    {HEAD "1 1 1 2 1 3" SIZES "0 90\n0\n1 1\n", "type 3 (A)"},
    {HEAD "1 1 1 2 1 4" SIZES "0 90\n0\n1 1\n", "photometric type"},
    {HEAD "1 1 1 2 1 1" SIZES "0 181\n0\n1 1\n", "vertical angle"},
    {HEAD "1 1 1 2 1 1" SIZES "90 0\n0\n1 1\n", "ascending"},
    {HEAD "1 1 1 2 1 1" SIZES "0 0\n0\n1 1\n", "ascending"},
    {HEAD "1 1 1 2 2 1" SIZES "0 90\n0 45\n1 1 1 1\n", "0 to 90"},
    {HEAD "1 1 1 2 2 1" SIZES "0 90\n90 270\n1 1 1 1\n", "including 180"},
    {HEAD "1 1 1 2 1 1" SIZES "0 90\n0\n1 -1\n", "candela"},
    {HEAD "1 1 1 2 1 1" SIZES "0 90\n0\n1 inf\n", "candela"},
    {HEAD "1 1 1 2 1 1" SIZES "0 90\n0\n1 x\n", "candela"},
    {HEAD "1 1 1e20 2 1 1" SIZES "0 90\n0\n1 1e20\n", "intensity"},
};

TEST(bad_files)
{
    struct scene scene = {0};
    const struct light_profile *p;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct err err = {0};
        bool ok = load_text(&scene, bad[i].text, strlen(bad[i].text), &p, &err);
        CHECK(!ok && err.code == ERR_INPUT && strstr(err.msg, bad[i].message), "%zu: %s", i,
              ok ? "was read" : err.msg);
    }
    // The file is truncated anywhere before the last value.
    for (size_t size = 0; size + 4 < sizeof good; size++) {
        struct err err = {0};
        bool ok = load_text(&scene, good, size, &p, &err);
        CHECK(!ok && err.code == ERR_INPUT, "cut off at byte %zu", size);
    }
    // One byte in the middle is damaged: the result is an error of the input, or values.
    for (size_t i = 0; i + 1 < sizeof good; i++) {
        char text[sizeof good];
        for (int byte = 0; byte < 256; byte += 5) {
            struct err err = {0};
            memcpy(text, good, sizeof good);
            text[i] = (char)byte;
            bool ok = load_text(&scene, text, sizeof good - 1, &p, &err);
            CHECK(ok || err.code == ERR_INPUT, "byte %zu as %d: %s", i, byte, err.msg);
        }
    }
    scene_finish(&scene);
}

TEST_MAIN(TEST_CASE(values), TEST_CASE(symmetry), TEST_CASE(integral), TEST_CASE(flux),
          TEST_CASE(bad_files))
