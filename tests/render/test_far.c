// Objects far from the origin of their file or of the scene must give the same picture as near the
// origin.
#define _XOPEN_SOURCE 700 // nftw
#define _DEFAULT_SOURCE

#include "../base/temporary_folder.h"
#include "base/log.h"
#include "render_fixture.h"
#include <math.h>

// --- meshes in files -----------------------------------------------------------------------------

// An octahedron about the origin with coordinates that are multiples of 2^-6, translated.
#define CORNERS 6
#define FACES 8

static const double corners[CORNERS][3] = {
    {0.890625, 0, 0.015625}, {-0.890625, 0, -0.015625}, {0, 0.703125, 0},
    {0, -0.703125, 0},       {0.25, 0, 0.578125},       {-0.25, 0, -0.578125},
};
static const int faces[FACES][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

static void write_obj(FILE *file, const double offset[3])
{
    for (int v = 0; v < CORNERS; v++)
        fprintf(file, "v %.9f %.9f %.9f\n", corners[v][0] + offset[0], corners[v][1] + offset[1],
                corners[v][2] + offset[2]);
    for (int f = 0; f < FACES; f++)
        fprintf(file, "f %d %d %d\n", faces[f][0] + 1, faces[f][1] + 1, faces[f][2] + 1);
}

static void write_ply_header(FILE *file, const char *format)
{
    fprintf(file,
            "ply\nformat %s 1.0\nelement vertex %d\nproperty double x\nproperty double y\n"
            "property double z\nelement face %d\nproperty list uchar int vertex_indices\n"
            "end_header\n",
            format, CORNERS, FACES);
}

static void write_ascii_ply(FILE *file, const double offset[3])
{
    write_ply_header(file, "ascii");
    for (int v = 0; v < CORNERS; v++)
        fprintf(file, "%.9f %.9f %.9f\n", corners[v][0] + offset[0], corners[v][1] + offset[1],
                corners[v][2] + offset[2]);
    for (int f = 0; f < FACES; f++)
        fprintf(file, "3 %d %d %d\n", faces[f][0], faces[f][1], faces[f][2]);
}

static void write_binary_ply(FILE *file, const double offset[3])
{
    const uint16_t probe = 1;
    bool is_little = *(const unsigned char *)&probe == 1;
    write_ply_header(file, is_little ? "binary_little_endian" : "binary_big_endian");
    for (int v = 0; v < CORNERS; v++)
        for (int c = 0; c < 3; c++) {
            double value = corners[v][c] + offset[c];
            fwrite(&value, sizeof value, 1, file);
        }
    for (int f = 0; f < FACES; f++) {
        fputc(3, file);
        fwrite(faces[f], sizeof faces[f], 1, file);
    }
}

static const struct mesh_format {
    const char *name;
    void (*write)(FILE *file, const double offset[3]);
} formats[] = {
    {"far.obj", write_obj},
    {"ascii.ply", write_ascii_ply},
    {"binary.ply", write_binary_ply},
};

static bool write_mesh(const struct mesh_format *format, const double offset[3])
{
    char text[2048];
    FILE *file = fopen(format->name, "wb");
    if (!file)
        return false;
    format->write(file, offset);
    snprintf(
        text, sizeof text,
        "{\"lampyris\": 1, \"film\": {\"width\": 16, \"height\": 16}, \"camera\": {\"position\": "
        "[%.9f, %.9f, %.9f], \"direction\": [0, 0, -1], \"fov_degrees\": 45}, \"environment\": "
        "{\"radiance\": [1, 1, 1]}, \"materials\": {\"grey\": {\"base_color\": [0.5, 0.6, "
        "0.7]}}, \"shapes\": [{\"type\": \"mesh\", \"file\": \"%s\", \"material\": \"grey\"}, "
        "{\"type\": \"sphere\", \"radius\": 0.5, \"center\": [%.9f, %.9f, %.9f], \"material\": "
        "\"grey\"}]}",
        offset[0], offset[1], offset[2] + 3, format->name, offset[0], offset[1] + 0.5, offset[2]);
    return fclose(file) == 0 && temporary_write("far.json", text);
}

static void render_samples(struct gpu *gpu, enum instancing instancing, uint64_t samples,
                           struct arena *arena, struct film_image *film)
{
    const struct scene_load_params load = {.path = "far.json"};
    struct scene scene;
    struct err err = {0};
    REQUIRE_OK(scene_load(&load, &scene, &err));
    const struct renderer_params params = {.gpu = gpu, .scene = &scene, .instancing = instancing};
    REQUIRE_OK(render_film(&params, samples, arena, film, NULL, &err));
    scene_finish(&scene);
}

static void render_file(struct gpu *gpu, enum instancing instancing, struct arena *arena,
                        struct film_image *film)
{
    render_samples(gpu, instancing, 4, arena, film);
}

static bool same_means(const struct film_image *a, const struct film_image *b)
{
    return memcmp(a->mean, b->mean, (size_t)a->width * a->height * sizeof *a->mean) == 0;
}

TEST(files)
{
    static const double places[][3] = {{0, 0, 0}, {1e7, 0, 0}, {500000, 5400000, 100}};
    char folder[256];
    struct arena arena = {0};
    struct film_image films[3];
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    REQUIRE(temporary_enter(folder, sizeof folder), "no folder");
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        for (int place = 0; place < 3; place++) {
            REQUIRE(write_mesh(&formats[i], places[place]), "%s", formats[i].name);
            render_file(&gpu, INSTANCING_AUTO, &arena, &films[place]);
            CHECK(same_means(&films[0], &films[place]), "%s at %g: another picture",
                  formats[i].name, places[place][0]);
        }
    CHECK(films[0].mean[8 * 16 + 8][0] < 0.9f, "the mesh is seen");
    temporary_leave(folder);
    gpu_close(&gpu);
    arena_finish(&arena);
}

// --- objects far apart ---------------------------------------------------------------------------

// One object of each kind.
static const char *const kinds[] = {
    "\"type\": \"sphere\", \"radius\": 0.5, \"center\": [-1.5, 0.5, 0]",
    "\"type\": \"disc\", \"radius\": 0.5, \"normal\": [0, 1, 0], \"center\": [0, 1.25, 0]",
    "\"type\": \"quad\", \"as\": \"analytic\", \"corner\": [-3, 0, 2], \"u\": [6, 0, 0], \"v\": "
    "[0, "
    "0, -4]",
    "\"type\": \"quad\", \"corner\": [-3, 0, -1], \"u\": [6, 0, 0], \"v\": [0, 2, 0]",
    "\"type\": \"box\", \"as\": \"analytic\", \"min\": [-0.75, 0, 0.5], \"max\": [-0.25, 0.5, 1]",
    "\"type\": \"box\", \"min\": [0.25, 0, 0.5], \"max\": [0.75, 0.5, 1]",
    "\"type\": \"cylinder\", \"radius\": 0.25, \"from\": [1, 0, 0], \"to\": [1, 1, 0]",
    "\"type\": \"cylinder\", \"caps\": false, \"radius\": 0.25, \"from\": [2, 0, 0], \"to\": [2, "
    "1, 0]",
    "\"type\": \"sdf\", \"field\": {\"type\": \"sphere\", \"radius\": 0.375}",
    "\"type\": \"sphere\", \"as\": \"triangles\", \"subdivision\": 2, \"radius\": 0.375, "
    "\"center\": [0, 1.75, -0.5]",
};
#define KINDS (sizeof kinds / sizeof kinds[0])

// The last object is nearest to the camera and has a corner at (x, 0, 0), so that coordinates far
// from the origin begin there.
static void write_objects(FILE *file, double x, size_t count)
{
    for (size_t i = 0; i < count; i++)
        fprintf(file,
                "{%s, \"material\": \"grey\", \"transform\": {\"translate\": [%.3f, -1, -4]}},\n",
                kinds[i], x);
    fprintf(file,
            "{\"type\": \"box\", \"min\": [2.25, 1.5, 0], \"max\": [2.5, 1.75, 0.25], "
            "\"material\": \"lamp\", \"transform\": {\"translate\": [%.3f, -1, -4]}},\n"
            "{\"type\": \"box\", \"min\": [0, -0.125, -0.125], \"max\": [0.125, 0, 0], "
            "\"material\": \"grey\", \"transform\": {\"translate\": [%.3f, 0, 0]}}\n",
            x, x);
}

// The camera is at `near`, and `count` kinds of objects are at `far`.
static bool write_apart(double near, double far, size_t count)
{
    FILE *file = fopen("far.json", "wb");
    if (!file)
        return false;
    fprintf(
        file,
        "{\"lampyris\": 1, \"film\": {\"width\": 32, \"height\": 24}, \"camera\": "
        "{\"position\": [%.3f, 0.25, 1], \"direction\": [0, 0, -1], \"fov_degrees\": 40}, "
        "\"environment\": {\"radiance\": [0.5, 0.5, 0.5]}, \"materials\": {\"grey\": "
        "{\"base_color\": [0.5, 0.6, 0.7]}, \"lamp\": {\"emission\": [9, 8, 7]}}, \"shapes\": [",
        near);
    write_objects(file, near, count);
    fputc(',', file);
    write_objects(file, far, count);
    fputs("]}", file);
    return fclose(file) == 0;
}

TEST(apart)
{
    static const double distances[] = {1e7, 1e12};
    char folder[256];
    struct arena arena = {0};
    struct film_image about_origin, far_from_it;
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    REQUIRE(temporary_enter(folder, sizeof folder), "no folder");
    for (int i = 0; i < 4; i++) {
        double distance = distances[i % 2];
        enum instancing instancing = i < 2 ? INSTANCING_OFF : INSTANCING_ON;
        // Vertices of the mesh of a sphere are not multiples of the resolution of doubles at 1e12.
        size_t count = distance < 1e9 ? KINDS : KINDS - 1;
        REQUIRE(write_apart(0, -distance, count), "far.json");
        render_file(&gpu, instancing, &arena, &about_origin);
        REQUIRE(write_apart(distance, 0, count), "far.json");
        render_file(&gpu, instancing, &arena, &far_from_it);
        CHECK(same_means(&about_origin, &far_from_it), "%g m apart, instancing %d: another picture",
              distance, (int)instancing);
    }
    temporary_leave(folder);
    gpu_close(&gpu);
    arena_finish(&arena);
}

// --- a small lamp within a large mesh ------------------------------------------------------------

// Two cubes of one mesh: one with side `size` at (2, 1, 0), and one below the floor.
static bool write_baked_lamp(double size)
{
    static const int sides[6][4] = {{1, 4, 3, 2}, {5, 6, 7, 8}, {1, 2, 6, 5},
                                    {3, 4, 8, 7}, {2, 3, 7, 6}, {4, 1, 5, 8}};
    const double places[2][4] = {{2, 1, 0, size}, {-4, -3, 0, 0.1}};
    char text[1024];
    FILE *file = fopen("baked.obj", "wb");
    if (!file)
        return false;
    for (int cube = 0; cube < 2; cube++)
        for (int v = 0; v < 8; v++) {
            const double *place = places[cube];
            fprintf(file, "v %.17g %.17g %.17g\n", place[0] + place[3] * (v % 4 == 1 || v % 4 == 2),
                    place[1] + place[3] * (v % 4 >= 2), place[2] + place[3] * (v >= 4));
        }
    for (int side = 0; side < 12; side++) {
        const int *f = sides[side % 6], first = side / 6 * 8;
        fprintf(file, "f %d %d %d %d\n", f[0] + first, f[1] + first, f[2] + first, f[3] + first);
    }
    snprintf(
        text, sizeof text,
        "{\"lampyris\": 1, \"film\": {\"width\": 16, \"height\": 16}, \"camera\": {\"position\": "
        "[0, 0.5, 0], \"target\": [0, 0, 0], \"up\": [0, 0, 1], \"fov_degrees\": 1e-4}, "
        "\"settings\": {\"max_bounces\": 1}, \"materials\": {\"floor\": {\"base_color\": [0.5, "
        "0.5, 0.5]}, \"lamp\": {\"base_color\": [0, 0, 0], \"emission\": [%g, %g, %g]}}, "
        "\"shapes\": [{\"type\": \"quad\", \"material\": \"floor\", \"corner\": [-5, 0, 5], \"u\": "
        "[10, 0, 0], \"v\": [0, 0, -10]}, {\"type\": \"mesh\", \"file\": \"baked.obj\", "
        "\"material\": \"lamp\"}]}",
        1 / (size * size), 1 / (size * size), 1 / (size * size));
    return fclose(file) == 0 && temporary_write("far.json", text);
}

// The middle of the floor sees three sides: (albedo / pi) cos (projected area / size^2) / d^2.
TEST(baked_lamps)
{
    static const double sizes[] = {1e-5, 1e-6, 1e-7};
    const double expected = 0.5 / M_PI * 1.0 * 3.0 / 25.0;
    char folder[256];
    struct arena arena = {0};
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    REQUIRE(temporary_enter(folder, sizeof folder), "no folder");
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct film_image film;
        double sum = 0;
        REQUIRE(write_baked_lamp(sizes[i]), "far.json");
        render_samples(&gpu, INSTANCING_AUTO, 256, &arena, &film);
        for (size_t k = 0; k < 256; k++)
            sum += (double)film.mean[k][0];
        CHECK(fabs(sum / 256 / expected - 1) < 0.008, "%g m: %g of its light", sizes[i],
              sum / 256 / expected);
    }
    temporary_leave(folder);
    gpu_close(&gpu);
    arena_finish(&arena);
}

// --- what is reported ----------------------------------------------------------------------------

static char warning[1024];

static void keep_warning(void *context, enum log_level level, const char *message)
{
    (void)context;
    if (level == LOG_WARN && strstr(message, "too small for their distance"))
        snprintf(warning, sizeof warning, "%s", message);
}

static void flatten_file(enum instancing instancing)
{
    const struct scene_load_params load = {.path = "far.json"};
    struct arena arena = {0};
    struct flat_scene flat;
    struct scene scene;
    struct err err = {0};
    warning[0] = '\0';
    REQUIRE_OK(scene_load(&load, &scene, &err));
    const struct flatten_params params = {
        .scene = &scene, .instancing = instancing, .camera = &scene.cameras[0]};
    REQUIRE_OK(scene_flatten(&params, &arena, &flat, &err));
    arena_finish(&arena);
    scene_finish(&scene);
}

// Writes an object of a kind at (x, 0, 0), and a sphere at the origin, which the camera sees.
static void write_kind(size_t kind, double x)
{
    FILE *file = fopen("far.json", "wb");
    REQUIRE(file, "far.json");
    fprintf(file,
            "{\"lampyris\": 1, \"camera\": {\"position\": [0, 1, 5], \"direction\": [0, 0, -1], "
            "\"fov_degrees\": 40}, "
            "\"materials\": {\"grey\": {}}, \"shapes\": [{\"type\": \"sphere\", \"radius\": 1, "
            "\"material\": \"grey\"}, {%s, \"material\": \"grey\", \"transform\": {\"translate\": "
            "[%.3f, 0, 0]}}]}",
            kinds[kind], x);
    REQUIRE(fclose(file) == 0, "far.json");
}

// Warnings name each kind of object with its size, its distance and its coarseness there; objects
// that are resolved are not mentioned.
TEST(warnings)
{
    static const struct {
        const char *name;
        double size;
    } expected[KINDS] = {
        {"shape 1, a sphere, is 1 m", 1},
        {"shape 1, a disc, is 1 m", 1},
        {"shape 1, a quad, is 6 m", 6},
        {"instance 0, of mesh \"quad\", is 6 m", 6},
        {"shape 1, a box, is 0.5 m", 0.5},
        {"instance 0, of mesh \"box\", is 0.5 m", 0.5},
        {"shape 1, a cylinder, is 1 m", 1},
        {"shape 1, an open cylinder, is 1 m", 1},
        {"shape 1, a distance field, is 0.", 1},
        {"instance 0, of mesh \"icosphere\", is 0.7", 0.75},
    };
    char folder[256];
    REQUIRE(temporary_enter(folder, sizeof folder), "no folder");
    log_configure(LOG_WARN, keep_warning, NULL);
    for (size_t i = 0; i < KINDS; i++) {
        write_kind(i, 1e7);
        flatten_file(INSTANCING_OFF);
        CHECK(strstr(warning, expected[i].name) && strstr(warning, "in steps of 1.2 m"),
              "kind %zu: '%s'", i, warning);
        write_kind(i, 1e7);
        flatten_file(INSTANCING_ON);
        CHECK(strstr(warning, expected[i].name) && strstr(warning, "1e+07 m from"),
              "kind %zu, instanced: '%s'", i, warning);
        write_kind(i, expected[i].size * 0x1p17);
        flatten_file(INSTANCING_OFF);
        CHECK(warning[0] == '\0', "kind %zu: '%s'", i, warning);
    }
    log_configure(LOG_WARN, NULL, NULL);
    temporary_leave(folder);
}

TEST_MAIN(TEST_CASE(files), TEST_CASE(apart), TEST_CASE(baked_lamps), TEST_CASE(warnings))
