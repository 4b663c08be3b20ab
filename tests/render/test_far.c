// Objects far from the origin of their file or of the scene: the picture is the one of the same
// objects about the origin.
#define _XOPEN_SOURCE 700 // nftw
#define _DEFAULT_SOURCE

#include "../base/temporary_folder.h"
#include "render_fixture.h"

// --- meshes in files -----------------------------------------------------------------------------

// An octahedron, whose middle is the origin and whose coordinates are multiples of 2^-6, moved.
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

static void render_file(struct gpu *gpu, struct arena *arena, struct film_image *film)
{
    const struct scene_load_params load = {.path = "far.json"};
    struct scene scene;
    struct err err = {0};
    REQUIRE_OK(scene_load(&load, &scene, &err));
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, 4, arena, film, NULL, &err));
    scene_finish(&scene);
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
            render_file(&gpu, &arena, &films[place]);
            CHECK(same_means(&films[0], &films[place]), "%s at %g: another picture",
                  formats[i].name, places[place][0]);
        }
    CHECK(films[0].mean[8 * 16 + 8][0] < 0.9f, "the mesh is seen");
    temporary_leave(folder);
    gpu_close(&gpu);
    arena_finish(&arena);
}

TEST_MAIN(TEST_CASE(files))
