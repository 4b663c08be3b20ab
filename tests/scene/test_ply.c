// Tests PLY: what is read, what is refused, and that nothing crashes.
#include "mesh_files.h"

#include <float.h>
#include <math.h>

static bool load(struct scene *scene, const char *path, struct err *err)
{
    uint32_t mesh;
    return load_ply(scene, path, SCENE_NONE, &mesh, err);
}

// Loads bytes as mesh.ply; the caller finishes the scene. Returns a zero mesh on failure.
static struct mesh load_bytes(struct scene *scene, const void *data, size_t size)
{
    return load_checked(load, write_bytes("mesh.ply", data, size), scene);
}

static struct mesh load_text(struct scene *scene, const char *text)
{
    return load_bytes(scene, text, strlen(text));
}

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define HEADER_4 "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ
#define SQUARE "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
#define FACES "property list uchar int vertex_indices\n"

TEST(ascii)
{
    struct scene scene;
    struct mesh mesh = load_text(
        &scene, "ply\nformat ascii 1.0\ncomment made in C:\\\nobj_info x\nelement vertex 5\n" XYZ
                "element face 2\n" FACES "end_header\n" SQUARE "-1 .5 1e-3\n5 0 1 2 3 4\n3 2 1 0");
    CHECK(mesh.vertex_count == 5 && mesh.triangle_count == 4 && !mesh.normals);
    CHECK(strcmp(mesh.name, "mesh.ply") == 0 && scene.material_count == 1 && warnings == 0);
    check_triangle(&mesh, 0, 0, 1, 2);
    check_triangle(&mesh, 1, 0, 2, 3);
    check_triangle(&mesh, 2, 0, 3, 4);
    check_triangle(&mesh, 3, 2, 1, 0);
    if (mesh.vertex_count == 5)
        CHECK(mesh.positions[4][0] == -1.0f && mesh.positions[4][2] == 1e-3f);
    scene_finish(&scene);
}

TEST(line_ends)
{
    static const char text[] = HEADER_4 "element face 1\n" FACES "end_header\n" SQUARE "3 0 1 2\n";
    char with_cr_lf[2 * sizeof text], with_cr[sizeof text];
    size_t length = 0;
    for (const char *c = text; *c; c++) {
        if (*c == '\n')
            with_cr_lf[length++] = '\r';
        with_cr_lf[length++] = *c;
        with_cr[c - text] = *c == '\n' ? '\r' : *c;
    }
    struct scene scene;
    CHECK(load_bytes(&scene, with_cr_lf, length).triangle_count == 1);
    scene_finish(&scene);
    CHECK(load_bytes(&scene, with_cr, sizeof text - 1).triangle_count == 1);
    scene_finish(&scene);
}

TEST(unknown_elements_and_properties_are_skipped)
{
    struct scene scene;
    struct mesh mesh = load_text(
        &scene, "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar float texcoord\n"
                "property list int uint32 vertex_index\nproperty uchar red\n"
                "element camera 2\nproperty double angle\nproperty list uchar short ids\n"
                "element nothing 1000000000000\nelement vertex 3\nproperty uchar red\n"
                "property double y\nproperty short x\nproperty list uchar char more\n"
                "property int8 z\nend_header\n"
                "2 .5 .5 3 0 1 2 255\n1.5 0\n2.5 3 1 2 3\n255 1.5 -300 0 -1\n0 0 0 2 7 8 0\n1 1 1 "
                "0 1\n");
    CHECK(mesh.vertex_count == 3 && mesh.triangle_count == 1);
    if (mesh.vertex_count == 3)
        CHECK(mesh.positions[0][0] == -300.0f && mesh.positions[0][1] == 1.5f &&
              mesh.positions[0][2] == -1.0f);
    scene_finish(&scene);
}

TEST(normals)
{
    struct scene scene;
    struct mesh mesh = load_text(
        &scene, "ply\nformat ascii 1.0\nelement vertex 3\n" XYZ
                "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n" FACES
                "end_header\n0 0 0 0 0 2\n1 0 0 nan 0 0\n1 1 0 0 0 0\n3 0 1 2\n");
    REQUIRE(mesh.normals, "no normals");
    CHECK(mesh.normals[0][2] == 1.0f && mesh.normals[1][0] == 0.0f && mesh.normals[2][2] == 0.0f);
    CHECK(warnings == 1 && strstr(warning, "2 normals"), "%s", warning);
    scene_finish(&scene);
    mesh = load_text(&scene, "ply\nformat ascii 1.0\nelement vertex 1\n" XYZ
                             "property float nx\nproperty float ny\nend_header\n0 0 0 1 0\n");
    CHECK(mesh.vertex_count == 1 && !mesh.normals && warnings == 1, "no faces: a warning");
    scene_finish(&scene);
}

TEST(colours_and_texture_coordinates)
{
    struct scene scene;
    struct mesh mesh = load_text(
        &scene, "ply\nformat ascii 1.0\nelement vertex 3\n" XYZ
                "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                "property uchar alpha\nproperty float s\nproperty float t\n"
                "element face 1\n" FACES "end_header\n"
                "0 0 0 255 0 128 51 .25 .5\n1 0 0 0 0 0 255 0 0\n0 1 0 1 2 3 0 1 1\n3 0 1 2\n");
    REQUIRE(mesh.colors && mesh.uvs[0], "not read");
    CHECK(mesh.colors[0][0] == 1.0f && mesh.colors[0][1] == 0.0f);
    CHECK(fabs((double)mesh.colors[0][2] - 0.21586050) < 1e-6, "sRGB: %.8g",
          (double)mesh.colors[0][2]);
    CHECK(fabs((double)mesh.colors[0][3] - 0.2) < 1e-6, "alpha is linear");
    CHECK(mesh.uvs[0][0][0] == 0.25f && mesh.uvs[0][0][1] == 0.5f && mesh.uvs[0][2][1] == 0.0f);
    CHECK(scene.materials[mesh.material].base_color[0] == 1.0f, "colours scale white");
    scene_finish(&scene);
    mesh = load_text(&scene, "ply\nformat ascii 1.0\nelement vertex 1\n" XYZ
                             "property float red\nproperty float green\nproperty float blue\n"
                             "end_header\n0 0 0 .5 nan 7\n");
    REQUIRE(mesh.colors, "not read");
    CHECK(mesh.colors[0][0] == 0.5f && mesh.colors[0][1] == 0.0f && mesh.colors[0][2] == 1.0f &&
              mesh.colors[0][3] == 1.0f,
          "floats are linear");
    scene_finish(&scene);
}

TEST(strips_alternate_their_winding)
{
    // The first list has three runs, separated by -1. A triangle with a repeated corner is left
    // out, but the winding still alternates past it.
    struct scene scene;
    struct mesh mesh =
        load_text(&scene, "ply\nformat ascii 1.0\nelement vertex 6\n" XYZ
                          "element tristrips 2\nproperty list int int vertex_indices\nend_header\n"
                          "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n"
                          "14 0 1 2 3 4 -1 1 2 3 -1 0 1 1 2\n4 5 4 3 2\n");
    CHECK(mesh.triangle_count == 6, "%u", mesh.triangle_count);
    check_triangle(&mesh, 0, 0, 1, 2);
    check_triangle(&mesh, 1, 2, 1, 3);
    check_triangle(&mesh, 2, 2, 3, 4);
    check_triangle(&mesh, 3, 1, 2, 3);
    check_triangle(&mesh, 4, 5, 4, 3);
    check_triangle(&mesh, 5, 3, 4, 2);
    scene_finish(&scene);
}

TEST(stitched_strips_keep_their_winding)
{
    struct scene scene;
    struct mesh mesh = load_text(
        &scene, "ply\nformat ascii 1.0\nelement vertex 6\n" XYZ
                "element tristrips 1\nproperty list int uint vertex_indices\nend_header\n"
                "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n12 0 1 2 2 3 3 4 5 4294967295 0 1 2\n");
    CHECK(mesh.triangle_count == 3, "%u", mesh.triangle_count);
    check_triangle(&mesh, 0, 0, 1, 2);
    check_triangle(&mesh, 1, 4, 3, 5);
    check_triangle(&mesh, 2, 0, 1, 2);
    scene_finish(&scene);
}

// --- binary files --------------------------------------------------------------------------------

// A file that is being assembled.
struct builder {
    unsigned char bytes[4096];
    size_t size;
    bool is_big_endian;
};

static void put_text(struct builder *builder, const char *text)
{
    memcpy(builder->bytes + builder->size, text, strlen(text));
    builder->size += strlen(text);
}

static void put(struct builder *builder, const void *value, size_t size)
{
    const uint16_t probe = 1;
    bool host_is_big_endian = *(const unsigned char *)&probe == 0;
    for (size_t i = 0; i < size; i++) {
        size_t from = builder->is_big_endian == host_is_big_endian ? i : size - 1 - i;
        builder->bytes[builder->size++] = ((const unsigned char *)value)[from];
    }
}

#define PUT(builder, type, ...)                                                                    \
    do {                                                                                           \
        const type values_[] = {__VA_ARGS__};                                                      \
        for (size_t i_ = 0; i_ < sizeof values_ / sizeof *values_; i_++)                           \
            put((builder), &values_[i_], sizeof *values_);                                         \
    } while (0)

// Makes a file with every type of property, including lists to skip, two vertices, and one face of
// each kind.
static struct builder build_binary(bool is_big_endian)
{
    struct builder file = {.is_big_endian = is_big_endian};
    put_text(&file, "ply\nformat ");
    put_text(&file, is_big_endian ? "binary_big_endian" : "binary_little_endian");
    put_text(&file, " 1.0\nelement vertex 4\nproperty float32 x\nproperty double y\n"
                    "property ushort z\nproperty char a\nproperty list uint16 float64 b\n"
                    "element face 2\nproperty list uchar uint vertex_indices\nproperty short c\n"
                    "element tristrips 1\nproperty list int int16 vertex_indices\n"
                    "element end 1\nproperty list char uint8 d\nend_header\n");
    static const uint16_t heights[4] = {0, 1, 300, 65535};
    for (int v = 0; v < 4; v++) {
        PUT(&file, float, (float)v);
        PUT(&file, double, -0.5 * v);
        PUT(&file, uint16_t, heights[v]);
        PUT(&file, int8_t, -1);
        PUT(&file, uint16_t, (uint16_t)v);
        for (int i = 0; i < v; i++)
            PUT(&file, double, 1.0);
    }
    PUT(&file, uint8_t, 3);
    PUT(&file, uint32_t, 0, 1, 2);
    PUT(&file, int16_t, -1);
    PUT(&file, uint8_t, 4);
    PUT(&file, uint32_t, 3, 2, 1, 0);
    PUT(&file, int16_t, 5);
    PUT(&file, int32_t, 5);
    PUT(&file, int16_t, 0, 1, 2, -1, 3);
    PUT(&file, int8_t, 2);
    PUT(&file, uint8_t, 8, 9);
    return file;
}

TEST(binary_of_both_byte_orders)
{
    for (int order = 0; order < 2; order++) {
        struct builder file = build_binary(order == 1);
        struct scene scene;
        struct mesh mesh = load_bytes(&scene, file.bytes, file.size);
        CHECK(mesh.vertex_count == 4 && mesh.triangle_count == 4, "%u", mesh.triangle_count);
        check_triangle(&mesh, 0, 0, 1, 2);
        check_triangle(&mesh, 1, 3, 2, 1);
        check_triangle(&mesh, 2, 3, 1, 0);
        check_triangle(&mesh, 3, 0, 1, 2);
        if (mesh.vertex_count == 4) {
            const float *p = mesh.positions[3];
            CHECK(p[0] == 3.0f && p[1] == -1.5f && p[2] == 65535.0f, "%g %g %g", (double)p[0],
                  (double)p[1], (double)p[2]);
        }
        scene_finish(&scene);
    }
}

// Data that begin with LF must be complete, after "end_header" CR LF as well as after CR alone.
static struct builder far_triangle(const char *format, const char *type, bool is_big_endian)
{
    struct builder file = {.is_big_endian = is_big_endian};
    put_text(&file, "ply\nformat ");
    put_text(&file, format);
    put_text(&file, " 1.0\nelement face 1\n" FACES "element vertex 3\nproperty uchar red\n");
    for (int c = 0; c < 3; c++) {
        const char name[] = {' ', (char)('x' + c), '\n', '\0'};
        put_text(&file, "property ");
        put_text(&file, type);
        put_text(&file, name);
    }
    put_text(&file, "end_header\n");
    return file;
}

TEST(double_positions_stay_exact)
{
    struct scene scene;
    for (int is_big_endian = 0; is_big_endian < 2; is_big_endian++) {
        struct builder file = far_triangle(
            is_big_endian ? "binary_big_endian" : "binary_little_endian", "double", is_big_endian);
        PUT(&file, uint8_t, 3);
        for (int i = 0; i < 3; i++)
            PUT(&file, int32_t, i);
        for (int v = 0; v < 3; v++) {
            PUT(&file, uint8_t, 0);
            for (int c = 0; c < 3; c++)
                PUT(&file, double, far_corners[v][c]);
        }
        struct mesh mesh = load_bytes(&scene, file.bytes, file.size);
        CHECK(mesh.triangle_count == 1, "%u", mesh.triangle_count);
        check_far_corners(&mesh);
        scene_finish(&scene);
    }
}

// All digits count, whatever type is declared; but floats in binary files do not have more.
TEST(far_positions_of_ascii_files_stay_exact)
{
    static const char rows[] = "3 0 1 2\n0 500000.0625 5400000.123 100.1\n"
                               "0 500001.0625 5400000.123 100.1\n0 500000.0625 5400001 100\n";
    static const char *const types[] = {"double", "float"};
    struct scene scene;
    for (int i = 0; i < 2; i++) {
        struct builder file = far_triangle("ascii", types[i], false);
        put_text(&file, rows);
        struct mesh mesh = load_bytes(&scene, file.bytes, file.size);
        check_far_corners(&mesh);
        scene_finish(&scene);
    }
    struct mesh mesh = load_text(&scene, HEADER_4 "element face 1\n" FACES
                                                  "end_header\n0 0 0\n1.1 0 0\n1 1 0\n0 1 0\n"
                                                  "3 0 1 2\n");
    CHECK(mesh.vertex_count == 4 && !mesh.exact_positions);
    scene_finish(&scene);
}

TEST(data_may_begin_with_a_line_end)
{
    static const char *const headers[] = {
        "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 1\r\nproperty uchar x\r\n"
        "property uchar y\r\nproperty uchar z\r\nend_header\r\n",
        "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty uchar x\r"
        "property uchar y\rproperty uchar z\rend_header\r",
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\n"
        "property uchar y\nproperty uchar z\nend_header\n",
    };
    for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++) {
        struct builder file = {0};
        put_text(&file, headers[i]);
        PUT(&file, uint8_t, '\n', '\r', '\n');
        struct scene scene;
        struct mesh mesh = load_bytes(&scene, file.bytes, file.size);
        if (mesh.vertex_count == 1)
            CHECK(mesh.positions[0][0] == 10.0f && mesh.positions[0][1] == 13.0f, "header %zu", i);
        scene_finish(&scene);
    }
}

// --- errors --------------------------------------------------------------------------------------

#define ASCII "ply\nformat ascii 1.0\n"
#define BINARY "ply\nformat binary_little_endian 1.0\n"

TEST(errors_in_the_header)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "mesh.ply:1: expected 'ply', the first line of a PLY file, found the end of the file"},
        {"plx\n", "found 'plx'"},
        {"ply\n", "mesh.ply:2: the file ends inside the header"},
        {"ply\nformat", "expected the format ascii"},
        {"ply\nformat text 1.0\n",
         "mesh.ply:2: expected the format ascii, binary_little_endian or"},
        {"ply\nformat ascii 2.0\n", "mesh.ply:2: expected format version 1.0, found '2.0'"},
        {"ply\nelement vertex 1\n" XYZ "end_header\n0 0 0\n", "the header has no format line"},
        {ASCII "end_header\n", "mesh.ply: the header has no element vertex"},
        {ASCII "vertex 3\n", "mesh.ply:3: expected a line of a PLY header, found 'vertex'"},
        {ASCII "element vertex\n", "mesh.ply:3: expected an element's name and count, found the"},
        {ASCII "element vertex -1\n", "mesh.ply:3: element vertex: a count of -1"},
        {ASCII "element vertex 1\nelement vertex 1\n",
         "mesh.ply:4: element vertex is declared twice"},
        {ASCII "property float x\n", "mesh.ply:3: a property before the first element"},
        {ASCII "element vertex 1\nproperty real x\n", "mesh.ply:4: expected a type such as float"},
        {ASCII "element vertex 1\nproperty float x\nproperty float x\n",
         "mesh.ply:5: x is declared twice in element vertex"},
        {ASCII "element vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
         "mesh.ply: element vertex: expected properties x, y and z"},
        {ASCII "element face 1\nproperty list float int vertex_index\n",
         "mesh.ply:4: expected an integer type for a list's count, found 'float'"},
        {ASCII "element face 1\nproperty list int float vertex_index\n",
         "mesh.ply:4: vertex_index: expected an integer type"},
        {ASCII "element vertex 5000000000\n" XYZ "end_header\n",
         "mesh.ply: 5000000000 vertices; expected at most 4294967295"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_mesh_refused(load, write_text("mesh.ply", cases[i].text), cases[i].message);
}

TEST(errors_in_the_data)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {ASCII "element vertex 1000000000\n" XYZ "end_header\n0 0 0\n",
         "vertex 0: 1000000000 entries of 6 bytes or more, but only 6 bytes remain"},
        {BINARY "element vertex 1000000000\n" XYZ "end_header\n0 0 0\n",
         "mesh.ply: vertex 0: 1000000000 entries of 12 bytes or more, but only 6 bytes remain"},
        {BINARY "element vertex 0\n" XYZ "element x 9223372036854775807\nproperty double y\n"
                "property double z\nend_header\n",
         "x 0: 9223372036854775807 entries of 16 bytes"},
        {HEADER_4 "end_header\n0 0 0\n1 nan 0\n1 1 0\n0 1 0\n",
         "mesh.ply:9: vertex 1: y is nan; expected a finite number"},
        {HEADER_4 "end_header\n0 0 0\n1 0 0\n1 1 1e40\n0 1 0\n", "vertex 2: z is inf"},
        {HEADER_4 "end_header\n0 0 0\n1 0 0\n1 x 0\n0 1 0\n",
         "mesh.ply:10: vertex 2: expected a number, found 'x'"},
        {HEADER_4 "element face 1\n" FACES "end_header\n" SQUARE "3 0 1 4\n",
         "mesh.ply:14: face 0: vertex index 4; expected 0 or more and below 4"},
        {HEADER_4 "element face 1\n" FACES "end_header\n" SQUARE "3 0 1 -1\n",
         "face 0: vertex index -1; expected 0 or more"},
        {HEADER_4 "element face 1\n" FACES "end_header\n" SQUARE "3 0 1 1.5\n",
         "face 0: expected an integer, found '1.5'"},
        {HEADER_4 "element face 2\n" FACES "end_header\n" SQUARE "3 0 1 2\n2 0 1\n",
         "mesh.ply:15: face 1: a face of 2 corners; expected at least 3"},
        {HEADER_4 "element face 1\n" FACES "end_header\n" SQUARE "-3 0 1 2\n",
         "face 0: a list of -3 entries"},
        {HEADER_4 "element face 1\n" FACES "end_header\n" SQUARE "200 0 1 2\n",
         "face 0: 200 entries of 2 bytes or more"},
        {HEADER_4 "element face 1\n" FACES "end_header\n" SQUARE "5 0 1\n",
         "face 0: 5 entries of 2 bytes or more, but only 5 bytes remain"},
        {HEADER_4 "element face 1\n" FACES "end_header\n" SQUARE "3 0   1\n\n",
         "face 0: the file ends here"},
        {HEADER_4 "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" SQUARE
                  "4 0 1 -2 2\n",
         "tristrips 0: vertex index -2"},
        {BINARY "element vertex 0\n" XYZ "element f 1\nproperty list uint int i\nend_header\n"
                "\xff\xff\xff\xff....",
         "mesh.ply: f 0: 4294967295 entries of 4 bytes or more, but only 4 bytes remain"},
        {BINARY "element vertex 0\n" XYZ "element face 1\nproperty list uchar int vertex_index\n"
                "property double d\nend_header\n\x03............1234",
         "mesh.ply: face 0: "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_mesh_refused(load, write_text("mesh.ply", cases[i].text), cases[i].message);
}

TEST(binary_values_that_are_not_finite)
{
    static const double bad[] = {NAN, INFINITY, 1e300};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct builder file = {0};
        put_text(&file, BINARY "element vertex 2\nproperty double x\nproperty double y\n"
                               "property double z\nend_header\n");
        PUT(&file, double, 0.0, 0.0, 0.0, 0.0, 0.0, bad[i]);
        check_mesh_refused(load, write_bytes("mesh.ply", file.bytes, file.size),
                           "mesh.ply: vertex 1: z is ");
    }
}

TEST(files_that_cannot_be_read)
{
    check_mesh_refused(load, in_folder("nothing.ply"), "nothing.ply");
}

TEST(memory_limits_are_errors)
{
    struct builder file = build_binary(false);
    check_memory_limits(load, write_bytes("mesh.ply", file.bytes, file.size));
}

// --- damage --------------------------------------------------------------------------------------

TEST(cut_and_damaged_files_never_crash)
{
    static const char ascii[] =
        "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ
        "property float nx\nproperty float ny\nproperty float nz\nelement face 2\n" FACES
        "property list uchar float uv\nelement tristrips 1\nproperty list int int vertex_indices\n"
        "end_header\n0 0 0 0 0 1\n1 0 0 0 1 0\n1 1 0 1 0 0\n0 1 0 0 0 0\n4 0 1 2 3 2 .5 .5\n"
        "3 2 1 0 0\n5 0 1 2 -1 3\n";
    cut_everywhere(load, "cut.ply", ascii, sizeof ascii - 1);
    flip_bytes(load, "cut.ply", ascii, sizeof ascii - 1, 10000);
    for (int order = 0; order < 2; order++) {
        struct builder file = build_binary(order == 1);
        cut_everywhere(load, "cut.ply", file.bytes, file.size);
        flip_bytes(load, "cut.ply", file.bytes, file.size, 10000);
    }
}

// --- a real mesh ---------------------------------------------------------------------------------

TEST(igea)
{
    const char *path = data_file("mesh/igea.ply");
    if (!path)
        SKIP("no mesh/igea.ply");
    struct scene scene = {0};
    struct err err = {0};
    bool is_loaded = load(&scene, path, &err);
    REQUIRE(is_loaded, "%s", err.msg);
    const struct mesh *mesh = &scene.meshes[0];
    // A closed surface without handles has 2 (V - 2) triangles (Euler).
    CHECK(mesh->vertex_count == 134345 && mesh->triangle_count == 2 * (134345 - 2), "%u",
          mesh->triangle_count);
    check_mesh(&scene, mesh);
    // All triangles face outwards, so the volume by the divergence theorem is that of the head:
    // positive, and a large fraction of its bounding box.
    double volume = 0.0, low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3];
    for (int c = 0; c < 3; c++)
        high[c] = -DBL_MAX;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const float *a = mesh->positions[mesh->indices[t][0]];
        const float *b = mesh->positions[mesh->indices[t][1]];
        const float *c = mesh->positions[mesh->indices[t][2]];
        volume += ((double)a[0] * ((double)b[1] * c[2] - (double)b[2] * c[1]) +
                   (double)a[1] * ((double)b[2] * c[0] - (double)b[0] * c[2]) +
                   (double)a[2] * ((double)b[0] * c[1] - (double)b[1] * c[0])) /
                  6.0;
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fmin(low[axis], (double)a[axis]);
            high[axis] = fmax(high[axis], (double)a[axis]);
        }
    }
    double box = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
    CHECK(volume > 0.2 * box && volume < 0.8 * box, "%g of %g", volume, box);
    scene_finish(&scene);
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(ascii),
        TEST_CASE(line_ends),
        TEST_CASE(unknown_elements_and_properties_are_skipped),
        TEST_CASE(normals),
        TEST_CASE(colours_and_texture_coordinates),
        TEST_CASE(strips_alternate_their_winding),
        TEST_CASE(stitched_strips_keep_their_winding),
        TEST_CASE(binary_of_both_byte_orders),
        TEST_CASE(double_positions_stay_exact),
        TEST_CASE(far_positions_of_ascii_files_stay_exact),
        TEST_CASE(data_may_begin_with_a_line_end),
        TEST_CASE(errors_in_the_header),
        TEST_CASE(errors_in_the_data),
        TEST_CASE(binary_values_that_are_not_finite),
        TEST_CASE(files_that_cannot_be_read),
        TEST_CASE(memory_limits_are_errors),
        TEST_CASE(cut_and_damaged_files_never_crash),
        TEST_CASE(igea),
    };
    if (!begin_mesh_tests())
        return 1;
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
