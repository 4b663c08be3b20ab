// Tests STL: what is read, what is refused, and that nothing crashes.
#include "mesh_files.h"

#include <math.h>

static bool load(struct scene *scene, const char *path, struct err *err)
{
    uint32_t mesh;
    return load_stl(scene, path, SCENE_NONE, &mesh, err);
}

// Loads bytes as mesh.stl; the caller finishes the scene. Returns a zero mesh on failure.
static struct mesh load_bytes(struct scene *scene, const void *data, size_t size)
{
    return load_checked(load, write_bytes("mesh.stl", data, size), scene);
}

static struct mesh load_text(struct scene *scene, const char *text)
{
    return load_bytes(scene, text, strlen(text));
}

#define FACET(a, b, c)                                                                             \
    "facet normal 0 0 nan\n outer loop\n  vertex " a "\n vertex " b "\nvertex " c                  \
    "\nendloop\nendfacet\n"
#define SQUARE                                                                                     \
    "solid a square\n" FACET("0 0 0", "1 0 0", "1 1 0")                                            \
        FACET("0 0 -0", "1 1 0", "0 1e0 0") "endsolid a square\n"
#define BINARY_BYTES (84 + 2 * 50)

// Makes the same square in binary form, with a comment that begins like an ASCII file.
static void make_binary(unsigned char bytes[BINARY_BYTES])
{
    static const float corners[2][3][3] = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}},
                                           {{0, 0, -0.0f}, {1, 1, 0}, {0, 1, 0}}};
    memset(bytes, 0, BINARY_BYTES);
    memcpy(bytes, "solid but binary", 16);
    bytes[80] = 2;
    for (int i = 0; i < 2; i++)
        memcpy(bytes + 84 + 50 * i + 12, corners[i], sizeof corners[i]);
}

static void check_square(const struct mesh *mesh)
{
    REQUIRE(mesh->vertex_count == 4 && mesh->triangle_count == 2 && !mesh->normals);
    check_triangle(mesh, 0, 0, 1, 2);
    check_triangle(mesh, 1, 0, 2, 3);
    CHECK(mesh->positions[3][0] == 0 && mesh->positions[3][1] == 1 && mesh->positions[3][2] == 0);
    CHECK(!signbit(mesh->positions[0][2]) && strcmp(mesh->name, "mesh.stl") == 0);
}

TEST(both_kinds)
{
    struct scene scene;
    struct mesh mesh = load_text(&scene, SQUARE);
    CHECK(scene.material_count == 1 && warnings == 0);
    check_square(&mesh);
    scene_finish(&scene);
    unsigned char bytes[BINARY_BYTES];
    make_binary(bytes);
    mesh = load_bytes(&scene, bytes, sizeof bytes);
    check_square(&mesh);
    scene_finish(&scene);
}

TEST(several_solids_and_none)
{
    struct scene scene;
    CHECK(load_text(&scene, SQUARE "\n\n" SQUARE).triangle_count == 4);
    scene_finish(&scene);
    struct mesh mesh = load_text(&scene, "solid\nendsolid");
    CHECK(mesh.triangle_count == 0 && warnings == 1 && strstr(warning, "has no triangles"));
    scene_finish(&scene);
}

TEST(refused)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "0 bytes are too few for a binary file; expected at least 84"},
        {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex",
         ":5: expected a coordinate"},
        {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1e99\n", ":4: the corner is"},
        {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nendloop", ":5: expected vertex"},
        {"solid a\nfact", ":2: expected facet or endsolid, found 'fact'"},
        {"solid a\n", "expected facet or endsolid"},
        {"solid a\nendsolid a\nfacet", ":3: expected solid, found 'facet'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_mesh_refused(load, write_text("mesh.stl", cases[i].text), cases[i].message);
    unsigned char bytes[BINARY_BYTES];
    make_binary(bytes);
    bytes[0] = 'S';
    check_mesh_refused(load, write_bytes("mesh.stl", bytes, BINARY_BYTES - 1),
                       "of 2 triangles has 184 bytes, not 183");
    make_binary(bytes);
    memcpy(bytes + 84 + 12 + 12, &(float){INFINITY}, 4);
    check_mesh_refused(load, write_bytes("mesh.stl", bytes, BINARY_BYTES),
                       "triangle 0: corner 1 is (inf, 0, 0); expected finite");
}

TEST(by_extension)
{
    struct scene scene = {0};
    struct err err = {0};
    const char *path = write_bytes("MESH.STL", SQUARE, strlen(SQUARE));
    const struct scene_load_params params = {.path = path};
    CHECK(scene_load(&params, &scene, &err), "%s", err.msg);
    CHECK(scene.mesh_count == 1 && scene.instance_count == 1 && scene.is_model);
    scene_finish(&scene);
}

TEST(far_positions_of_ascii_files_stay_exact)
{
    char text[600];
    int length = snprintf(text, sizeof text, "solid\nfacet normal 0 0 1\nouter loop\n");
    for (int v = 0; v < 3; v++)
        length +=
            snprintf(text + length, sizeof text - (size_t)length, "vertex %.17g %.17g %.17g\n",
                     far_corners[v][0], far_corners[v][1], far_corners[v][2]);
    snprintf(text + length, sizeof text - (size_t)length, "endloop\nendfacet\nendsolid\n");
    struct scene scene;
    struct mesh mesh = load_text(&scene, text);
    check_far_corners(&mesh);
    scene_finish(&scene);
}

TEST(cut_and_damaged_files_never_crash)
{
    unsigned char bytes[BINARY_BYTES];
    make_binary(bytes);
    cut_everywhere(load, "mesh.stl", bytes, sizeof bytes);
    flip_bytes(load, "mesh.stl", bytes, sizeof bytes, 4000);
    cut_everywhere(load, "mesh.stl", SQUARE, strlen(SQUARE));
    flip_bytes(load, "mesh.stl", SQUARE, strlen(SQUARE), 4000);
}

TEST(memory_limits_are_errors)
{
    check_memory_limits(load, write_text("mesh.stl", SQUARE));
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(both_kinds),
        TEST_CASE(several_solids_and_none),
        TEST_CASE(refused),
        TEST_CASE(by_extension),
        TEST_CASE(far_positions_of_ascii_files_stay_exact),
        TEST_CASE(cut_and_damaged_files_never_crash),
        TEST_CASE(memory_limits_are_errors),
    };
    if (!begin_mesh_tests())
        return 1;
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
