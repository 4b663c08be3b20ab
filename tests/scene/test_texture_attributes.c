// Tests the texture attributes of flattened corners against closed forms.
#include "base/memory.h"
#include "flatten/flatten.h"
#include "scene/core/affine.h"
#include "test.h"

#include <float.h>

// A triangle (0,0,0) (2,0,0) (0,1,0), whose u increases along x and v along -y (up in the image is
// +y), and one instance of it.
struct fixture {
    struct scene scene;
    struct mesh mesh;
    struct instance instance;
    struct material materials[2];
    struct texture textures[2];
    float positions[3][3], normals[3][3], tangents[3][4], uvs[2][3][2], colors[3][4];
    uint32_t indices[1][3];
    struct arena arena;
    struct flat_scene flat;
    struct err err;
};

static void begin(struct fixture *f)
{
    *f = (struct fixture){
        .positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}},
        .uvs = {{{0, 1}, {1, 1}, {0, 0}}, {{5, 1}, {5, 2}, {7, 0}}},
        .colors = {{1, 0.5f, 0.25f, 1}, {0, 0, 0, 0.5f}, {0, 1, 0, 1}},
        .indices = {{0, 1, 2}},
    };
    f->mesh = (struct mesh){
        .name = "triangle",
        .vertex_count = 3,
        .triangle_count = 1,
        .positions = f->positions,
        .uvs = {f->uvs[0], f->uvs[1]},
        .indices = f->indices,
    };
    f->instance = (struct instance){.material = SCENE_NONE};
    memcpy(f->instance.transform, AFFINE_IDENTITY, sizeof AFFINE_IDENTITY);
    for (int i = 0; i < 2; i++)
        material_init(&f->materials[i]);
    f->scene = (struct scene){
        .path = "test",
        .meshes = &f->mesh,
        .mesh_count = 1,
        .instances = &f->instance,
        .instance_count = 1,
        .materials = f->materials,
        .material_count = 2,
        .textures = f->textures,
        .texture_count = 2,
    };
}

static bool flatten(struct fixture *f)
{
    return scene_flatten(&(struct flatten_params){&f->scene, INSTANCING_OFF}, &f->arena, &f->flat,
                         &f->err) &&
           f->flat.triangle_count == 1;
}

static void end(struct fixture *f)
{
    arena_finish(&f->arena);
}

static void use_texture(struct fixture *f, uint32_t flags)
{
    f->materials[0].texture_count = 1;
    f->textures[0].flags = flags;
}

#define NORMAL_MAP (TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT)

static void check_tangent(const struct fixture *f, int corner, double x, double y, double z,
                          double sign)
{
    const float *t = f->flat.tangents[0][corner];
    CHECK(fabs((double)t[0] - x) < 1e-6 && fabs((double)t[1] - y) < 1e-6 &&
              fabs((double)t[2] - z) < 1e-6 && (double)t[3] == sign,
          "corner %d: (%g, %g, %g) %g, expected (%g, %g, %g) %g", corner, (double)t[0],
          (double)t[1], (double)t[2], (double)t[3], x, y, z, sign);
}

TEST(only_what_materials_need)
{
    struct fixture f;
    begin(&f);
    f.mesh.tangents = f.tangents;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(!f.flat.uvs[0] && !f.flat.uvs[1] && !f.flat.tangents && !f.flat.colors);

    use_texture(&f, 0);
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.uvs[0] && !f.flat.uvs[1] && !f.flat.tangents);
    CHECK(f.flat.uvs[0][0][1][0] == 1 && f.flat.uvs[0][0][2][1] == 0);

    use_texture(&f, TEXTURE_UV1);
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(!f.flat.uvs[0] && f.flat.uvs[1] && f.flat.uvs[1][0][2][0] == 7);

    use_texture(&f, NORMAL_MAP);
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.uvs[0] && f.flat.tangents);

    // A material without triangles needs no attributes. An instance's material replaces the mesh's.
    f.mesh.material = 1;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(!f.flat.uvs[0] && !f.flat.tangents);
    f.instance.material = 0;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.uvs[0] && f.flat.tangents);

    // Anisotropy needs tangents, and coordinates only for meshes without tangents.
    f.instance.material = SCENE_NONE;
    f.materials[1].anisotropic = 0.5f;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(!f.flat.uvs[0] && f.flat.tangents);

    f.mesh.colors = f.colors;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.colors && f.flat.colors[0][1][3] == 0.5f);
    end(&f);
}

TEST(missing_attributes)
{
    struct fixture f;
    struct mesh meshes[2];
    struct instance instances[2];
    begin(&f);
    use_texture(&f, NORMAL_MAP);
    f.mesh.colors = f.colors;
    meshes[0] = meshes[1] = f.mesh;
    instances[0] = instances[1] = f.instance;
    meshes[1].uvs[0] = NULL;
    meshes[1].colors = NULL;
    instances[1].mesh = 1;
    f.scene.meshes = meshes;
    f.scene.instances = instances;
    f.scene.mesh_count = f.scene.instance_count = 2;
    REQUIRE(scene_flatten(&(struct flatten_params){&f.scene, INSTANCING_OFF}, &f.arena, &f.flat,
                          &f.err),
            "%s", f.err.msg);
    REQUIRE(f.flat.triangle_count == 2 && f.flat.uvs[0] && f.flat.colors && f.flat.tangents);
    for (int corner = 0; corner < 3; corner++) {
        const float *t = f.flat.tangents[1][corner];
        CHECK(f.flat.uvs[0][1][corner][0] == 0 && f.flat.uvs[0][1][corner][1] == 0);
        for (int c = 0; c < 4; c++)
            CHECK(f.flat.colors[1][corner][c] == 1);
        // Any direction in the triangle's plane is correct.
        CHECK(fabsf(t[0] * t[0] + t[1] * t[1] - 1) < 1e-6f && t[2] == 0);
    }
    end(&f);
}

// See docs/verification.md, C32.
TEST(coordinates_that_are_not_finite_are_zero)
{
    struct fixture f;
    begin(&f);
    use_texture(&f, 0);
    f.uvs[0][0][0] = NAN;
    f.uvs[0][1][1] = INFINITY;
    f.uvs[0][2][0] = -INFINITY;
    f.uvs[0][2][1] = -1e6f;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    const float(*uv)[2] = (const float(*)[2])f.flat.uvs[0][0];
    CHECK(uv[0][0] == 0 && uv[0][1] == 1 && uv[1][0] == 1 && uv[1][1] == 0 && uv[2][0] == 0 &&
          uv[2][1] == -1e6f);
    end(&f);
}

// The tangent is along increasing u, and the bitangent upwards in the image: cross(z, x) = +y.
TEST(tangents_follow_coordinates)
{
    struct fixture f;
    begin(&f);
    use_texture(&f, NORMAL_MAP);
    REQUIRE(flatten(&f), "%s", f.err.msg);
    for (int corner = 0; corner < 3; corner++)
        check_tangent(&f, corner, 1, 0, 0, 1);

    // If the coordinates are mirrored in u, the tangent is reversed and the bitangent unchanged.
    f.uvs[0][0][0] = 1;
    f.uvs[0][1][0] = 0;
    f.uvs[0][2][0] = 1;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    check_tangent(&f, 0, -1, 0, 0, -1);

    // If they are rotated, u increases along +y and v along +x, so upwards is -x.
    const float turned[3][2] = {{0, 0}, {0, 2}, {1, 0}};
    memcpy(f.uvs[0], turned, sizeof turned);
    REQUIRE(flatten(&f), "%s", f.err.msg);
    check_tangent(&f, 0, 0, 1, 0, 1);

    // The second set is used if the normal map uses it.
    use_texture(&f, NORMAL_MAP | TEXTURE_UV1);
    const float second[3][2] = {{0, 0}, {0, 1}, {-1, 0}}; // u along -y, v along +x
    memcpy(f.uvs[1], second, sizeof second);
    REQUIRE(flatten(&f), "%s", f.err.msg);
    check_tangent(&f, 0, 0, -1, 0, -1);
    end(&f);
}

TEST(coordinates_without_extent_still_give_a_tangent)
{
    static const float bad[][3][2] = {
        {{0, 0}, {0, 0}, {0, 0}},
        {{0, 0}, {1, 1}, {2, 2}},
        {{FLT_MAX, 0}, {-FLT_MAX, 0}, {FLT_MAX, FLT_MAX}},
        {{1e-40f, 0}, {0, 1e-40f}, {0, 0}},
    };
    struct fixture f;
    begin(&f);
    use_texture(&f, NORMAL_MAP);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        memcpy(f.uvs[0], bad[i], sizeof bad[i]);
        REQUIRE(flatten(&f), "%s", f.err.msg);
        for (int corner = 0; corner < 3; corner++) {
            const float *t = f.flat.tangents[0][corner];
            double length = sqrt((double)(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
            CHECK(fabs(length - 1) < 1e-6 && t[2] == 0 && fabsf(t[3]) == 1, "%zu: %g", i, length);
        }
    }
    end(&f);
}

// Tangents are transformed by the matrix, normals by its inverse transpose.
TEST(tangents_are_transformed)
{
    struct fixture f;
    begin(&f);
    use_texture(&f, NORMAL_MAP);
    const float slanted[4] = {(float)sqrt(0.5), (float)sqrt(0.5), 0, -1};
    for (int i = 0; i < 3; i++)
        memcpy(f.tangents[i], slanted, sizeof slanted);
    f.mesh.tangents = f.tangents;
    const double scale[12] = {3, 0, 0, 7, 0, 1, 0, 8, 0, 0, 1, 9};
    memcpy(f.instance.transform, scale, sizeof scale);
    REQUIRE(flatten(&f), "%s", f.err.msg);
    check_tangent(&f, 0, 3 / sqrt(10), 1 / sqrt(10), 0, -1);
    end(&f);
}

// A mirrored instance shows the mirrored image: its tangent and bitangent are those of the mesh,
// mirrored. The bitangent is sign * cross(normal, tangent) with the flattened normals.
TEST(mirrored_instances_keep_their_bitangents)
{
    struct fixture f;
    begin(&f);
    use_texture(&f, NORMAL_MAP);
    const double mirror[3][12] = {
        {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
        {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0},
        {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0},
    };
    for (int given = 0; given < 2; given++)
        for (int axis = 0; axis < 3; axis++) {
            for (int i = 0; i < 3; i++) {
                const float normal[3] = {0, 0, 1}, tangent[4] = {1, 0, 0, 1};
                memcpy(f.normals[i], normal, sizeof normal);
                memcpy(f.tangents[i], tangent, sizeof tangent);
            }
            f.mesh.normals = f.normals;
            f.mesh.tangents = given ? f.tangents : NULL;
            memcpy(f.instance.transform, mirror[axis], sizeof mirror[axis]);
            REQUIRE(flatten(&f), "%s", f.err.msg);
            for (int corner = 0; corner < 3; corner++) {
                const float *n = f.flat.normals[0][corner], *t = f.flat.tangents[0][corner];
                // The mesh has the tangent +x and the bitangent +y.
                float x = axis == 0 ? -1 : 1, y = axis == 1 ? -1 : 1;
                float up = t[3] * (n[2] * t[0] - n[0] * t[2]);
                CHECK(t[0] == x && up == y && n[2] == (axis == 2 ? -1 : 1),
                      "given %d, axis %d: tangent %g, bitangent %g, normal %g", given, axis,
                      (double)t[0], (double)up, (double)n[2]);
            }
            // The corners keep their coordinates.
            for (int corner = 0; corner < 3; corner++) {
                const float *p = f.flat.triangles[0].v[corner];
                const float *uv = f.flat.uvs[0][0][corner];
                CHECK(uv[0] == (p[0] != 0) && uv[1] == (p[1] == 0));
            }
        }
    end(&f);
}

TEST(tangents_that_are_none_are_derived)
{
    struct fixture f;
    begin(&f);
    use_texture(&f, NORMAL_MAP);
    f.mesh.tangents = f.tangents; // all zero
    f.tangents[1][0] = NAN;
    f.tangents[2][1] = 1;
    f.tangents[2][3] = 1;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    check_tangent(&f, 0, 1, 0, 0, 1);
    check_tangent(&f, 1, 1, 0, 0, 1);
    check_tangent(&f, 2, 0, 1, 0, 1);
    end(&f);
}

TEST(memory_limits_are_errors)
{
    struct fixture f;
    begin(&f);
    use_texture(&f, NORMAL_MAP);
    f.mesh.normals = f.normals;
    f.mesh.colors = f.colors;
    bool ok = false;
    unsigned refused = 0;
    for (size_t limit = 16; limit < 100000 && !ok; limit += 16) {
        memory_set_budget(memory_used() + limit);
        f.err = (struct err){0};
        ok = flatten(&f);
        CHECK(ok || f.err.code == ERR_BUDGET, "%zu bytes: %s", limit, f.err.msg);
        memory_set_budget(0);
        refused += !ok;
        end(&f);
    }
    CHECK(ok && refused > 5, "%u refused", refused);
}

TEST_MAIN(TEST_CASE(only_what_materials_need), TEST_CASE(missing_attributes),
          TEST_CASE(coordinates_that_are_not_finite_are_zero),
          TEST_CASE(tangents_follow_coordinates),
          TEST_CASE(coordinates_without_extent_still_give_a_tangent),
          TEST_CASE(tangents_are_transformed), TEST_CASE(mirrored_instances_keep_their_bitangents),
          TEST_CASE(tangents_that_are_none_are_derived), TEST_CASE(memory_limits_are_errors))
