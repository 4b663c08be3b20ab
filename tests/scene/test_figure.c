// Tests generated figures: they have the requested size, are closed, face outwards, are the same
// each time, and have detail if there are enough triangles.
#include "base/maths.h"
#include "scene/generate/figure_field.h"
#include "test.h"

#include <stdlib.h>

static const struct mesh *make(struct scene *scene, enum figure figure, uint32_t triangles)
{
    struct err err = {0};
    uint32_t index = 0;
    *scene = (struct scene){0};
    bool made = scene_add_material(scene, NULL) &&
                generate_figure(scene, figure, triangles, 0, &index, &err);
    CHECK(made, "%s", err.msg);
    return made ? &scene->meshes[index] : NULL;
}

static int compare_edges(const void *a, const void *b)
{
    const uint64_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

// Returns whether each directed edge occurs as often as its opposite.
static bool is_closed(const struct mesh *mesh)
{
    size_t count = 3 * (size_t)mesh->triangle_count;
    uint64_t *edges[2] = {malloc(count * sizeof(uint64_t)), malloc(count * sizeof(uint64_t))};
    bool closed = edges[0] && edges[1];
    for (size_t i = 0; closed && i < count; i++) {
        const uint32_t *corners = mesh->indices[i / 3];
        uint64_t a = corners[i % 3], b = corners[(i + 1) % 3];
        edges[0][i] = a << 32 | b;
        edges[1][i] = b << 32 | a;
    }
    for (int k = 0; closed && k < 2; k++)
        qsort(edges[k], count, sizeof(uint64_t), compare_edges);
    closed = closed && memcmp(edges[0], edges[1], count * sizeof(uint64_t)) == 0;
    free(edges[0]);
    free(edges[1]);
    return closed;
}

struct shape_of {
    double low[3], high[3], volume, area;
    double turned; // area of triangles on whose back the vertex normals are
};

static struct shape_of measure(const struct mesh *mesh)
{
    struct shape_of s = {.low = {INFINITY, INFINITY, INFINITY},
                         .high = {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            s.low[i] = fmin(s.low[i], (double)mesh->positions[v][i]);
            s.high[i] = fmax(s.high[i], (double)mesh->positions[v][i]);
        }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3], e[2][3], n[3], normal[3] = {0, 0, 0};
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < 3; i++) {
                p[c][i] = (double)mesh->positions[mesh->indices[t][c]][i];
                normal[i] += (double)mesh->normals[mesh->indices[t][c]][i];
            }
        vec3_subtract(p[1], p[0], e[0]);
        vec3_subtract(p[2], p[0], e[1]);
        vec3_cross(e[0], e[1], n);
        double area = 0.5 * vec3_norm(n);
        s.area += area;
        s.turned += vec3_dot(n, normal) < 0 ? area : 0;
        s.volume += vec3_dot(p[0], n) / 6;
    }
    return s;
}

// Each figure has its size, and fills this fraction of its box.
TEST(figures)
{
    static const struct {
        uint32_t triangles;
        double size[3], volume;
    } wanted[FIGURE_COUNT] = {[FIGURE_SKULL] = {10000, {1.25, 1.9, 1.75}, 1.56},
                              [FIGURE_DRAGON] = {60000, {4.1, 2.4, 4.2}, 2.05},
                              [FIGURE_MONKEY] = {500, {2.4, 1.7, 1.6}, 1.6}};
    for (uint32_t f = 0; f < FIGURE_COUNT; f++) {
        struct scene scene;
        const struct mesh *mesh = make(&scene, (enum figure)f, wanted[f].triangles);
        const char *name = figure_names[f];
        REQUIRE(mesh, "%s", name);
        double ratio = (double)mesh->triangle_count / wanted[f].triangles;
        CHECK(ratio > 0.9 && ratio < 1.1, "%s: %u triangles", name, mesh->triangle_count);
        CHECK(is_closed(mesh), "%s is open", name);
        struct shape_of s = measure(mesh);
        for (int i = 0; i < 3; i++)
            CHECK(fabs(s.high[i] - s.low[i] - wanted[f].size[i]) < 0.1 * wanted[f].size[i],
                  "%s: %g along axis %d", name, s.high[i] - s.low[i], i);
        CHECK(fabs(s.volume - wanted[f].volume) < 0.1 * wanted[f].volume, "%s: volume %g", name,
              s.volume);
        CHECK(s.turned < 0.02 * s.area, "%s: %g of %g", name, s.turned, s.area);
        for (uint32_t v = 0; v < mesh->vertex_count; v++) {
            const float *n = mesh->normals[v];
            CHECK(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f, "%s, vertex %u", name,
                  v);
        }
        scene_finish(&scene);
    }
}

TEST(the_same_each_time)
{
    struct scene scenes[2];
    const struct mesh *a = make(&scenes[0], FIGURE_SKULL, 52000);
    const struct mesh *b = make(&scenes[1], FIGURE_SKULL, 52000);
    REQUIRE(a && b, "out of memory");
    CHECK(a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
          memcmp(a->positions, b->positions, a->vertex_count * sizeof *a->positions) == 0 &&
          memcmp(a->indices, b->indices, a->triangle_count * sizeof *a->indices) == 0);
    scene_finish(&scenes[0]);
    scene_finish(&scenes[1]);
}

// Detail is relative to the figure's size, and there is none that the mesh cannot represent.
TEST(detail_is_as_fine_as_the_mesh)
{
    for (int skin = SKIN_BONE; skin < SKIN_PLAIN; skin++) {
        double fine = 0, coarse = 0, none = 0;
        const int count = 4000;
        for (int i = 0; i < count; i++) {
            const double p[3] = {0.317 * (i % 20), 0.291 * (i / 20 % 20), 0.271 * (i / 400)};
            fine += pow(figure_detail((enum part_skin)skin, p, 1e-3), 2) / count;
            coarse += pow(figure_detail((enum part_skin)skin, p, 0.03), 2) / count;
            none += fabs(figure_detail((enum part_skin)skin, p, 1));
        }
        CHECK(sqrt(fine) > 5e-4 && sqrt(fine) < 0.03, "skin %d: %g", skin, sqrt(fine));
        CHECK(coarse < fine, "skin %d: %g, %g", skin, sqrt(coarse), sqrt(fine));
        CHECK(none == 0, "skin %d: %g", skin, none);
    }
}

TEST_MAIN(TEST_CASE(figures), TEST_CASE(the_same_each_time),
          TEST_CASE(detail_is_as_fine_as_the_mesh))
