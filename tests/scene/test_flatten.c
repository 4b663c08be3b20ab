// Tests flattening against closed forms.
#include "mesh_files.h"

#include "flatten/flatten.h"
#include "scene/core/affine.h"

#include <float.h>

// A scene with one triangle mesh and one material, whose arrays are members.
struct fixture {
    struct scene scene;
    struct mesh mesh;
    struct instance instances[4];
    struct material materials[3];
    float positions[8][3], normals[8][3];
    double exact[8][3];
    uint32_t indices[4][3];
    struct arena arena;
    struct flat_scene flat;
    struct err err;
};

// One triangle (0,0,0) (1,0,0) (0,1,0) and one instance of it.
static void begin(struct fixture *f)
{
    *f = (struct fixture){
        .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        .indices = {{0, 1, 2}},
    };
    f->mesh = (struct mesh){
        .name = "triangle",
        .vertex_count = 3,
        .triangle_count = 1,
        .positions = f->positions,
        .indices = f->indices,
        .material = 1,
    };
    for (int i = 0; i < 4; i++) {
        f->instances[i].material = SCENE_NONE;
        memcpy(f->instances[i].transform, AFFINE_IDENTITY, sizeof AFFINE_IDENTITY);
    }
    f->scene = (struct scene){
        .path = "test",
        .meshes = &f->mesh,
        .mesh_count = 1,
        .instances = f->instances,
        .instance_count = 1,
        .materials = f->materials,
        .material_count = 3,
    };
}

static bool flatten(struct fixture *f)
{
    warnings = 0;
    return scene_flatten(&(struct flatten_params){&f->scene, INSTANCING_OFF}, &f->arena, &f->flat,
                         &f->err);
}

static void end(struct fixture *f)
{
    arena_finish(&f->arena);
}

static void set_matrix(struct instance *instance, const double m[12])
{
    memcpy(instance->transform, m, sizeof instance->transform);
}

static bool is_point(const float p[3], double x, double y, double z)
{
    return p[0] == (float)x && p[1] == (float)y && p[2] == (float)z;
}

TEST(transforms_and_materials)
{
    struct fixture f;
    uint32_t per_triangle[] = {2};
    begin(&f);
    f.scene.instance_count = 3;
    set_matrix(&f.instances[1], (const double[]){0, -2, 0, 5, 3, 0, 0, 6, 0, 0, 1, 7});
    f.instances[2].material = 0;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    REQUIRE(f.flat.triangle_count == 3 && !f.flat.normals && warnings == 0);
    const struct flat_triangle *t = f.flat.triangles;
    CHECK(is_point(t[1].v[0], 5, 6, 7) && is_point(t[1].v[1], 5, 9, 7) &&
          is_point(t[1].v[2], 3, 6, 7));
    CHECK(t[0].material == 1 && t[2].material == 0);
    CHECK(f.flat.bounds_min[0] == 0 && f.flat.bounds_max[0] == 5 && f.flat.bounds_max[1] == 9 &&
          f.flat.bounds_max[2] == 7);
    CHECK(f.flat.origin[0] == 0 && f.flat.dropped_degenerate == 0);
    f.mesh.triangle_material = per_triangle;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.triangles[0].material == 2 && f.flat.triangles[2].material == 0);
    end(&f);
}

TEST(an_empty_scene)
{
    struct fixture f;
    begin(&f);
    f.scene.instance_count = 0;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.triangle_count == 0 && f.flat.shape_count == 0);
    CHECK(f.flat.bounds_min[0] > f.flat.bounds_max[0]);
    end(&f);
}

static double dot(const float a[3], const float b[3])
{
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

TEST(normals_are_transformed_by_the_inverse_transpose)
{
    struct fixture f;
    begin(&f);
    // The plane x + y = 1, its normal, and a scale that tilts it: x' / 4 + y' = 1.
    const float positions[3][3] = {{1, 0, 0}, {0, 1, 0}, {1, 0, -1}};
    memcpy(f.positions, positions, sizeof positions);
    for (int i = 0; i < 3; i++)
        f.normals[i][0] = f.normals[i][1] = (float)sqrt(0.5);
    f.mesh.normals = f.normals;
    set_matrix(&f.instances[0], (const double[]){4, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3});
    REQUIRE(flatten(&f) && f.flat.triangle_count == 1 && f.flat.normals, "%s", f.err.msg);
    const float *n = f.flat.normals[0][0];
    CHECK(fabs((double)n[0] - 1 / sqrt(17)) < 1e-6 && fabs((double)n[1] - 4 / sqrt(17)) < 1e-6,
          "%g %g %g", (double)n[0], (double)n[1], (double)n[2]);
    end(&f);
}

// Through a reflection, normals and winding remain on the outside.
TEST(mirrored_instances_stay_outside_out)
{
    struct fixture f;
    begin(&f);
    for (int i = 0; i < 3; i++)
        f.normals[i][2] = 1;
    f.mesh.normals = f.normals;
    set_matrix(&f.instances[0], (const double[]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0});
    REQUIRE(flatten(&f) && f.flat.triangle_count == 1, "%s", f.err.msg);
    const float(*v)[3] = (const float(*)[3])f.flat.triangles[0].v;
    double cross = (double)(v[1][0] - v[0][0]) * (double)(v[2][1] - v[0][1]) -
                   (double)(v[1][1] - v[0][1]) * (double)(v[2][0] - v[0][0]);
    CHECK(cross < 0, "the mirrored triangle faces +z");
    CHECK(is_point(f.flat.normals[0][0], 0, 0, -1));
    end(&f);
}

TEST(normals_belong_to_their_corners_when_mirrored)
{
    struct fixture f;
    begin(&f);
    const float normals[3][3] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
    memcpy(f.normals, normals, sizeof normals);
    f.mesh.normals = f.normals;
    set_matrix(&f.instances[0], (const double[]){-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    REQUIRE(flatten(&f) && f.flat.triangle_count == 1, "%s", f.err.msg);
    for (int corner = 0; corner < 3; corner++) {
        const float *p = f.flat.triangles[0].v[corner], *n = f.flat.normals[0][corner];
        double expected_z = p[0] == 0 && p[1] == 0;
        CHECK(dot(p, n) == (expected_z > 0 ? 0 : 1) && (double)n[2] == expected_z, "corner %d",
              corner);
    }
    end(&f);
}

TEST(missing_normals_are_geometric)
{
    struct fixture f;
    begin(&f);
    const float normals[3][3] = {{0, 0, 0}, {NAN, 0, 1}, {0, INFINITY, 0}};
    memcpy(f.normals, normals, sizeof normals);
    f.mesh.normals = f.normals;
    REQUIRE(flatten(&f) && f.flat.triangle_count == 1, "%s", f.err.msg);
    for (int corner = 0; corner < 3; corner++)
        CHECK(is_point(f.flat.normals[0][corner], 0, 0, 1), "corner %d", corner);
    end(&f);
}

TEST(degenerate_triangles_are_dropped_and_counted)
{
    struct fixture f;
    begin(&f);
    // A point, a line, a triangle and another line.
    const float positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                   {3, 0, 0}, {0, 0, 1}, {0, 0, 2}};
    const uint32_t indices[4][3] = {{1, 1, 1}, {0, 1, 3}, {0, 1, 2}, {0, 4, 5}};
    memcpy(f.positions, positions, sizeof positions);
    memcpy(f.indices, indices, sizeof indices);
    f.mesh.vertex_count = 6;
    f.mesh.triangle_count = 4;
    for (int i = 0; i < 6; i++)
        f.normals[i][2] = 1;
    f.normals[2][0] = 7;
    f.mesh.normals = f.normals;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.triangle_count == 1 && f.flat.dropped_degenerate == 3, "%u",
          f.flat.triangle_count);
    CHECK(is_point(f.flat.triangles[0].v[2], 0, 1, 0));
    CHECK(f.flat.normals[0][2][0] > 0.9f, "the normals went with the dropped");
    CHECK(f.flat.bounds_max[0] == 1, "a dropped triangle counts in the bounds");

    // Slivers have an area, however small it is.
    f.positions[1][0] = 1e-15f;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.triangle_count == 1);
    end(&f);
}

// Each flat triangle must name its instance and its triangle in the mesh, although others were
// dropped.
TEST(sources_of_triangles)
{
    struct fixture f;
    begin(&f);
    const float positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                   {3, 0, 0}, {0, 0, 1}, {0, 0, 2}};
    const uint32_t indices[4][3] = {{1, 1, 1}, {0, 1, 2}, {0, 4, 5}, {0, 1, 4}};
    memcpy(f.positions, positions, sizeof positions);
    memcpy(f.indices, indices, sizeof indices);
    f.mesh.vertex_count = 6;
    f.mesh.triangle_count = 4;
    f.scene.instance_count = 4;
    memset(f.instances[1].transform, 0, sizeof f.instances[1].transform); // singular
    REQUIRE(flatten(&f), "%s", f.err.msg);
    REQUIRE(f.flat.triangle_count == 6 && f.flat.dropped_degenerate == 6);
    static const uint32_t expected[6][2] = {{0, 1}, {0, 3}, {2, 1}, {2, 3}, {3, 1}, {3, 3}};
    for (uint32_t id = 0; id < 6; id++) {
        uint32_t instance, triangle;
        flat_triangle_source(&f.flat, id, &instance, &triangle);
        CHECK(instance == expected[id][0] && triangle == expected[id][1], "%u: %u, %u", id,
              instance, triangle);
    }
    static const uint32_t runs[4][2] = {{0, 2}, {2, 0}, {2, 2}, {4, 2}};
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t first, count;
        flat_instance_triangles(&f.flat, i, &first, &count);
        CHECK(first == runs[i][0] && count == runs[i][1], "instance %u: %u from %u", i, count,
              first);
    }
    end(&f);
}

TEST(singular_instances_are_skipped_with_a_warning)
{
    struct fixture f;
    begin(&f);
    f.scene.instance_count = 4;
    set_matrix(&f.instances[1], (const double[]){1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0});
    // Two equal columns, rotated, so that the determinant is 0 except for rounding.
    set_matrix(&f.instances[2], (const double[]){.1, .1, .7, 0, .3, .3, .2, 0, .9, .9, .6, 0});
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.triangle_count == 2 && f.flat.skipped_instances == 2);
    CHECK(warnings == 1 &&
              strstr(warning, "2 instances of mesh \"triangle\" are skipped, instance 1"),
          "%s", warning);
    f.scene.instance_count = 2;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(warnings == 1 && strstr(warning, "instance 1 of mesh \"triangle\" is skipped"), "%s",
          warning);
    end(&f);
}

TEST(transforms_that_are_not_finite_are_errors)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    struct fixture f;
    begin(&f);
    f.scene.instance_count = 2;
    for (int i = 0; i < 12; i++) {
        memcpy(f.instances[1].transform, AFFINE_IDENTITY, sizeof AFFINE_IDENTITY);
        f.instances[1].transform[i / 4][i % 4] = bad[i % 3];
        f.err = (struct err){0};
        CHECK(!flatten(&f) && f.err.code == ERR_INPUT && strstr(f.err.msg, "test: instance 1 of"),
              "%d: %s", i, f.err.msg);
    }
    end(&f);
}

TEST(tiny_and_huge_scales_are_not_singular)
{
    struct fixture f;
    begin(&f);
    for (double scale = 1e-12; scale <= 1e12; scale *= 1e12) {
        const double m[12] = {scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0};
        set_matrix(&f.instances[0], m);
        REQUIRE(flatten(&f), "%s", f.err.msg);
        CHECK(f.flat.triangle_count == 1 && f.flat.skipped_instances == 0, "scale %g", scale);
    }
    end(&f);
}

// The unit of length is 1 m for scenes of ordinary size and a power of two for others. Numbers
// beyond all supported sizes are reported as errors.
TEST(sizes_choose_the_unit)
{
    static const struct {
        double size, scale;
    } sizes[] = {
        {0x1p-40, 0x1p40}, {0x1.8p-11, 0x1p11}, {0x1p-10, 1},        {1, 1},
        {0x1.ffp19, 1},    {0x1p20, 0.5},       {0x1.8p40, 0x1p-21},
    };
    struct fixture f;
    begin(&f);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        double size = sizes[i].size;
        set_matrix(&f.instances[0], (const double[]){size, 0, 0, 0, 0, size, 0, 0, 0, 0, size, 0});
        REQUIRE(flatten(&f), "%s", f.err.msg);
        CHECK(f.flat.scale == sizes[i].scale, "%g m: %g", size, f.flat.scale);
        for (int corner = 0; corner < 3; corner++) {
            double point[3], exact[3];
            for (int c = 0; c < 3; c++) {
                point[c] = (double)f.flat.triangles[0].v[corner][c];
                exact[c] = size * (double)f.positions[corner][c];
            }
            flat_to_world(&f.flat, point, point);
            CHECK(memcmp(point, exact, sizeof point) == 0, "%g m, corner %d", size, corner);
        }
    }
    static const double beyond[] = {1e-14, 1e14};
    for (int i = 0; i < 2; i++) {
        double size = beyond[i];
        f.err = (struct err){0};
        set_matrix(&f.instances[0], (const double[]){size, 0, 0, 0, 0, size, 0, 0, 0, 0, size, 0});
        CHECK(!flatten(&f) && f.err.code == ERR_INPUT &&
                  strstr(f.err.msg, i ? "1e+14" : "the scene is 1e-14 m across; expected 1e-13 m"),
              "%s", f.err.msg);
    }
    end(&f);
}

// A lamp of 1e-8 m at a distance of 2 m is a point in single precision. Its edges are stored
// separately, in a box.
TEST(small_emitters_keep_their_edges)
{
    struct fixture f;
    double edges[2][3];
    begin(&f);
    f.scene.instance_count = 2;
    set_matrix(&f.instances[0], (const double[]){1e-8, 0, 0, 2, 0, 1e-8, 0, 1, 0, 0, 1e-8, 3});
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.triangle_count == 1 && f.flat.dropped_degenerate == 1 && f.flat.small_count == 0,
          "what sends no light is dropped");
    for (int c = 0; c < 3; c++)
        f.instances[0].transform[c][c] = 1e-6;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(warnings == 1 && strstr(warning, "instance 0, of mesh \"triangle\", is 1e-06 m"), "%s",
          warning);
    for (int c = 0; c < 3; c++)
        f.instances[0].transform[c][c] = 1e-8;
    f.materials[1].emission[0] = 1;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    REQUIRE(f.flat.triangle_count == 2 && f.flat.small_count == 1 && flat_find_small(&f.flat, 0) &&
            !flat_find_small(&f.flat, 1));
    CHECK(warnings == 0, "%s", warning);
    flat_triangle_edges(&f.flat, 0, edges);
    const struct flat_triangle *triangle = &f.flat.triangles[0];
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++) {
            double exact = 1e-8 * ((double)f.positions[e + 1][i] - (double)f.positions[0][i]);
            double end = (double)triangle->v[0][i] + edges[e][i];
            CHECK(fabs(edges[e][i] - exact) <= 1e-6 * 1e-8, "edge %d, axis %d: %g", e, i,
                  edges[e][i]);
            CHECK(edges[e][i] >= 0 ? (double)triangle->v[e + 1][i] >= end
                                   : (double)triangle->v[e + 1][i] <= end,
                  "edge %d, axis %d leaves the box", e, i);
        }
    end(&f);
}

// Emitters whose positions are a single point have no edges left.
TEST(emitters_without_area_are_warned_of)
{
    struct fixture f;
    begin(&f);
    memcpy(f.positions[2], f.positions[1], sizeof f.positions[2]);
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.dropped_degenerate == 1 && warnings == 0, "%s", warning);
    f.materials[1].emission[0] = 1;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.dropped_degenerate == 1 && warnings == 1 &&
              strstr(warning, "1 emissive triangles are omitted") &&
              strstr(warning, "longest edge is 1 m") && strstr(warning, "mesh \"triangle\""),
          "%s", warning);
    end(&f);
}

TEST(far_scenes_are_rebased_in_double_precision)
{
    struct fixture f;
    begin(&f);
    set_matrix(&f.instances[0], (const double[]){1, 0, 0, 1e5, 0, 1, 0, 1e5 + 1e-3, 0, 0, 1, 0});
    REQUIRE(flatten(&f), "%s", f.err.msg);
    const float(*v)[3] = (const float(*)[3])f.flat.triangles[0].v;
    CHECK(f.flat.origin[0] == 1e5 + 0.5, "%.17g", f.flat.origin[0]);
    for (int corner = 0; corner < 3; corner++)
        for (int i = 0; i < 3; i++) {
            double exact = (double)f.positions[corner][i] + f.instances[0].transform[i][3];
            double got = (double)v[corner][i] + f.flat.origin[i];
            CHECK(fabs(got - exact) < 1e-7, "corner %d axis %d: %.17g", corner, i, got - exact);
        }
    CHECK(warnings == 0, "%s", warning);

    // Up to 16 times its extent away, the scene is not moved.
    set_matrix(&f.instances[0], (const double[]){1, 0, 0, 15, 0, 1, 0, 0, 0, 0, 1, 0});
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(f.flat.origin[0] == 0 && f.flat.triangles[0].v[1][0] == 16);
    end(&f);
}

TEST(exact_positions_come_first)
{
    struct fixture f;
    begin(&f);
    for (int v = 0; v < 3; v++)
        for (int i = 0; i < 3; i++) {
            f.exact[v][i] = 4e6 + 0.1 * (double)f.positions[v][i];
            f.positions[v][i] = (float)f.exact[v][i];
        }
    f.mesh.exact_positions = f.exact;
    REQUIRE(flatten(&f) && f.flat.triangle_count == 1, "%s", f.err.msg);
    const float(*v)[3] = (const float(*)[3])f.flat.triangles[0].v;
    CHECK(fabs((double)(v[1][0] - v[0][0]) - 0.1) < 1e-8, "%.9g", (double)(v[1][0] - v[0][0]));
    CHECK(warnings == 0);
    end(&f);
}

TEST(meshes_beyond_their_precision_are_warned_of)
{
    struct fixture f;
    begin(&f);
    for (int v = 0; v < 3; v++)
        f.positions[v][0] += 4e6f;
    REQUIRE(flatten(&f), "%s", f.err.msg);
    CHECK(warnings == 1 &&
              strstr(warning, "\"triangle\" has size 1 at distance 4e+06 from its origin"),
          "%s", warning);
    end(&f);
}

TEST(vertices_out_of_range_are_errors)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1e38f, 1.1e13f};
    struct fixture f;
    begin(&f);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        f.positions[2][1] = bad[i];
        f.err = (struct err){0};
        CHECK(!flatten(&f) && f.err.code == ERR_INPUT, "%g", (double)bad[i]);
        CHECK(strstr(f.err.msg, "test: instance 0: mesh 0 \"triangle\": vertex 2 lies at ("), "%s",
              f.err.msg);
    }
    // An unused vertex has no effect.
    f.positions[2][1] = 1;
    f.positions[3][0] = NAN;
    f.mesh.vertex_count = 4;
    CHECK(flatten(&f), "%s", f.err.msg);
    end(&f);
}

TEST(shapes)
{
    struct fixture f;
    struct shape list[2] = {
        {.kind = SHAPE_SPHERE, .material = 2, .center = {1e5, 0, 0}, .radius = 2},
        {.kind = SHAPE_DISC, .center = {1e5, 3, 0}, .normal = {0, 1, 0}, .radius = 1},
    };
    begin(&f);
    f.scene.instance_count = 0;
    f.scene.shapes = list;
    f.scene.shape_count = 2;
    REQUIRE(flatten(&f) && f.flat.shape_count == 2, "%s", f.err.msg);
    CHECK(f.flat.origin[0] == 1e5 && f.flat.origin[1] == 0.5 && f.flat.origin[2] == 0);
    CHECK(is_point(f.flat.shapes[0].center, 0, -0.5, 0) && f.flat.shapes[0].material == 2);
    CHECK(is_point(f.flat.shapes[1].center, 0, 2.5, 0) &&
          is_point(f.flat.shapes[1].normal, 0, 1, 0));
    CHECK(f.flat.shapes[0].kind == SHAPE_SPHERE && f.flat.shapes[0].radius == 2);
    // The disc is flat, so nothing is above y = 2.5 except for outward rounding.
    CHECK(f.flat.bounds_max[1] >= 2.5f && f.flat.bounds_max[1] < 2.5f + 1e-6f);
    CHECK(f.flat.bounds_min[0] <= -2 && f.flat.bounds_min[0] > -2.00001f);

    list[1].center[2] = INFINITY;
    f.err = (struct err){0};
    CHECK(!flatten(&f) && f.err.code == ERR_INPUT && strstr(f.err.msg, "shape 1 at"), "%s",
          f.err.msg);
    end(&f);
}

// --- sharing -------------------------------------------------------------------------------------

static bool share(struct fixture *f, enum instancing instancing)
{
    warnings = 0;
    return scene_flatten(&(struct flatten_params){&f->scene, instancing}, &f->arena, &f->flat,
                         &f->err);
}

// Returns the difference between the place of flat triangle `id` of instance `i` in world space and
// its correct place.
static double placing_error(const struct fixture *f, uint32_t i, uint32_t id, int corner)
{
    const struct flat_instance *placed = &f->flat.instances[i];
    const struct instance *source = &f->scene.instances[placed->source];
    uint32_t instance, triangle;
    flat_triangle_source(&f->flat, id, &instance, &triangle);
    uint32_t vertex = f->indices[triangle][corner];
    double given[3], want[3], worst = instance == SCENE_NONE ? 0 : INFINITY;
    for (int c = 0; c < 3; c++)
        given[c] = f->mesh.exact_positions ? f->exact[vertex][c] : (double)f->positions[vertex][c];
    affine_point(source->transform, given, want);
    for (int c = 0; c < 3; c++) {
        const float *m = placed->to_world[c], *v = f->flat.triangles[id].v[corner];
        double got = (double)m[0] * (double)v[0] + (double)m[1] * (double)v[1] +
                     (double)m[2] * (double)v[2] + (double)m[3] + f->flat.origin[c];
        worst = fmax(worst, fabs(got - want[c]));
        CHECK(got - f->flat.origin[c] >= (double)f->flat.bounds_min[c] &&
              got - f->flat.origin[c] <= (double)f->flat.bounds_max[c]);
    }
    return worst;
}

TEST(shared_meshes_stay_in_their_own_space)
{
    struct fixture f;
    begin(&f);
    // A line, which is dropped, and two triangles.
    const uint32_t indices[3][3] = {{0, 1, 1}, {0, 1, 2}, {2, 1, 3}};
    memcpy(f.indices, indices, sizeof indices);
    f.positions[3][2] = 1;
    f.mesh.vertex_count = 4;
    f.mesh.triangle_count = 3;
    f.scene.instance_count = 4;
    set_matrix(&f.instances[0], (const double[]){0, -2, 0, 5, 3, 0, 0, 6, 0, 0, 1, 7});
    set_matrix(&f.instances[1], (const double[]){0, 0, 0, 5, 3, 0, 0, 6, 0, 0, 1, 7});
    set_matrix(&f.instances[2], (const double[]){-1, .5, 0, 1, 0, 1, .25, 2, 0, 0, 1, 3});
    f.instances[2].material = 2;
    REQUIRE(share(&f, INSTANCING_ON), "%s", f.err.msg);
    REQUIRE(f.flat.mesh_count == 1 && f.flat.placed_count == 3 && f.flat.triangle_count == 2 &&
            f.flat.world_triangle_count == 0 && f.flat.skipped_instances == 1);
    for (uint32_t i = 0; i < 3; i++)
        for (uint32_t id = 0; id < 2; id++)
            for (int corner = 0; corner < 3; corner++)
                CHECK(placing_error(&f, i, id, corner) < 1e-6);
    const struct flat_instance *placed = f.flat.instances;
    CHECK(placed[0].source == 0 && placed[1].source == 2 && placed[2].source == 3);
    CHECK(!placed[0].is_mirrored && placed[1].is_mirrored && !placed[2].is_mirrored);
    CHECK(placed[0].material == SCENE_NONE && placed[1].material == 2);
    CHECK(!f.flat.material_used[0] && f.flat.material_used[1] && f.flat.material_used[2]);
    for (uint32_t i = 0; i < 4; i++)
        f.instances[i].material = 2;
    REQUIRE(share(&f, INSTANCING_ON), "%s", f.err.msg);
    CHECK(!f.flat.material_used[1] && f.flat.material_used[2], "nobody shows the mesh's own");
    end(&f);
}

TEST(far_instances_and_far_meshes_are_rebased)
{
    struct fixture f;
    begin(&f);
    f.scene.instance_count = 2;
    for (int v = 0; v < 3; v++)
        for (int i = 0; i < 3; i++) {
            f.exact[v][i] = 4e6 + 0.1 * (double)f.positions[v][i];
            f.positions[v][i] = (float)f.exact[v][i];
        }
    f.mesh.exact_positions = f.exact;
    set_matrix(&f.instances[1], (const double[]){2, 0, 0, -4e6, 0, 0, -1, 8e6, 0, 1, 0, 0.25});
    REQUIRE(share(&f, INSTANCING_ON) && f.flat.placed_count == 2, "%s", f.err.msg);
    for (uint32_t i = 0; i < 2; i++)
        for (int corner = 0; corner < 3; corner++) {
            double error = placing_error(&f, i, 0, corner);
            CHECK(error < 1e-7, "instance %u corner %d: %g", i, corner, error);
        }
    end(&f);
}

TEST(what_cannot_be_shared_is_in_the_world)
{
    struct fixture f;
    begin(&f);
    f.scene.instance_count = 4;
    f.instances[1].material = 2; // this material emits
    f.materials[2].emission[1] = 1;
    set_matrix(&f.instances[2], (const double[]){1, 0, 0, 0, 0, 1e-5, 0, 0, 0, 0, 1, 0});
    REQUIRE(share(&f, INSTANCING_ON), "%s", f.err.msg);
    CHECK(f.flat.placed_count == 2 && f.flat.world_triangle_count == 2 &&
          f.flat.triangle_count == 3);
    CHECK(f.flat.triangles[0].material == 2 && f.flat.triangles[1].material == 1);
    uint32_t instance, triangle;
    flat_triangle_source(&f.flat, 1, &instance, &triangle);
    CHECK(instance == 2 && triangle == 0);
    f.materials[1].emission[1] = 1; // the mesh's own material emits
    REQUIRE(share(&f, INSTANCING_ON), "%s", f.err.msg);
    CHECK(f.flat.placed_count == 0 && f.flat.mesh_count == 0 && f.flat.triangle_count == 4);
    f.materials[1].emission[1] = 0;
    for (int v = 0; v < 3; v++)
        f.positions[v][0] *= 1e-10f, f.positions[v][1] *= 1e-10f;
    REQUIRE(share(&f, INSTANCING_ON), "%s", f.err.msg);
    CHECK(f.flat.placed_count == 2 && f.flat.triangles[2].v[1][0] >= 0.5f,
          "a small mesh has a unit of its own");
    end(&f);
}

// By default a mesh is shared if that saves memory, and never if it is used only once.
TEST(sharing_has_to_pay)
{
    enum { TRIANGLES = 65536 };
    static uint32_t indices[TRIANGLES][3];
    struct fixture f;
    begin(&f);
    for (uint32_t t = 0; t < TRIANGLES; t++)
        for (uint32_t corner = 0; corner < 3; corner++)
            indices[t][corner] = corner;
    struct instance *many = calloc(20, sizeof *many);
    REQUIRE(many);
    for (int i = 0; i < 20; i++)
        many[i] = f.instances[0];
    f.mesh.indices = indices;
    f.mesh.triangle_count = TRIANGLES;
    f.scene.instances = many;
    for (uint32_t count = 1; count <= 18; count += count == 2 ? 14 : 1) {
        f.scene.instance_count = count;
        REQUIRE(share(&f, INSTANCING_AUTO), "%s", f.err.msg);
        bool want = (count - 1) * TRIANGLES >= 1048576;
        CHECK(f.flat.placed_count == (want ? count : 0), "%u instances", count);
        CHECK(f.flat.triangle_count == (want ? 1 : count) * TRIANGLES);
        end(&f);
    }
    free(many);
}

static bool stop(void *context)
{
    return --*(int *)context < 0;
}

TEST(flattening_stops_when_asked)
{
    struct fixture f;
    begin(&f);
    f.scene.instance_count = 4;
    bool ok = false;
    int most = 0;
    for (; !ok && most < 100; most++) {
        int left = most;
        const struct progress progress = {.should_stop = stop, .context = &left};
        const struct flatten_params params = {&f.scene, INSTANCING_OFF, &progress};
        f.err = (struct err){0};
        ok = scene_flatten(&params, &f.arena, &f.flat, &f.err);
        CHECK(ok || f.err.code == ERR_STOPPED, "%s", f.err.msg);
        end(&f);
    }
    CHECK(ok && most > 2, "%d looks", most);
}

TEST(memory_limits_are_errors)
{
    struct fixture f;
    begin(&f);
    f.mesh.normals = f.normals;
    bool ok = false;
    for (size_t limit = 1; limit < 100000 && !ok; limit *= 2) {
        memory_set_budget(memory_used() + limit);
        f.err = (struct err){0};
        ok = flatten(&f);
        CHECK(ok || f.err.code == ERR_BUDGET, "%zu bytes: %s", limit, f.err.msg);
        memory_set_budget(0);
        end(&f);
    }
    CHECK(ok);
}

TEST(uniform_scales_are_recognised)
{
    double scale, turned[3][4];
    const double axis[3] = {1, 2, 3};
    CHECK(affine_rotation(axis, 1.0, turned));
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            turned[i][j] *= -0.25;
    CHECK(affine_uniform_scale(turned, &scale) && fabs(scale - 0.25) < 1e-15, "%g", scale);
    turned[0][0] *= 1.001;
    CHECK(!affine_uniform_scale(turned, &scale));
    const double zero[3] = {0, 0, 0};
    CHECK(!affine_rotation(zero, 1.0, turned));
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(transforms_and_materials),
        TEST_CASE(an_empty_scene),
        TEST_CASE(normals_are_transformed_by_the_inverse_transpose),
        TEST_CASE(mirrored_instances_stay_outside_out),
        TEST_CASE(normals_belong_to_their_corners_when_mirrored),
        TEST_CASE(missing_normals_are_geometric),
        TEST_CASE(degenerate_triangles_are_dropped_and_counted),
        TEST_CASE(sources_of_triangles),
        TEST_CASE(singular_instances_are_skipped_with_a_warning),
        TEST_CASE(tiny_and_huge_scales_are_not_singular),
        TEST_CASE(sizes_choose_the_unit),
        TEST_CASE(small_emitters_keep_their_edges),
        TEST_CASE(emitters_without_area_are_warned_of),
        TEST_CASE(far_scenes_are_rebased_in_double_precision),
        TEST_CASE(exact_positions_come_first),
        TEST_CASE(meshes_beyond_their_precision_are_warned_of),
        TEST_CASE(vertices_out_of_range_are_errors),
        TEST_CASE(shapes),
        TEST_CASE(transforms_that_are_not_finite_are_errors),
        TEST_CASE(shared_meshes_stay_in_their_own_space),
        TEST_CASE(far_instances_and_far_meshes_are_rebased),
        TEST_CASE(what_cannot_be_shared_is_in_the_world),
        TEST_CASE(sharing_has_to_pay),
        TEST_CASE(flattening_stops_when_asked),
        TEST_CASE(memory_limits_are_errors),
        TEST_CASE(uniform_scales_are_recognised),
    };
    if (!begin_mesh_tests())
        return 1;
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
