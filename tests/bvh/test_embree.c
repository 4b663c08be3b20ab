// Compares the tree and the reference traversal with Embree's robust mode, on procedural and
// scanned meshes. Embree computes in single precision, so results may differ if a ray grazes an
// edge; such rays are counted.
#include "bvh_trace.h"
#include "meshes.h"
#include "test.h"

#include <embree3/rtcore.h>

struct embree {
    RTCDevice device;
    RTCScene scene;
};

static struct embree embree_open(const struct mesh *mesh)
{
    struct embree embree = {.device = rtcNewDevice("threads=2")};
    embree.scene = rtcNewScene(embree.device);
    rtcSetSceneFlags(embree.scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(embree.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    size_t vertices = (size_t)mesh->count * 3;
    float *points = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            sizeof(float[3]), vertices);
    unsigned *indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                RTC_FORMAT_UINT3, sizeof(unsigned[3]), mesh->count);
    memcpy(points, mesh->vertices, vertices * sizeof(float[3]));
    for (size_t i = 0; i < vertices; i++)
        indices[i] = (unsigned)i;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(embree.scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(embree.scene);
    return embree;
}

static void embree_close(struct embree *embree)
{
    rtcReleaseScene(embree->scene);
    rtcReleaseDevice(embree->device);
}

// Returns the hit primitive, or UINT32_MAX.
static uint32_t embree_trace(const struct embree *embree, const struct bvh_ray *ray, double *t)
{
    struct RTCRayHit query = {
        .ray = {.org_x = (float)ray->origin[0],
                .org_y = (float)ray->origin[1],
                .org_z = (float)ray->origin[2],
                .dir_x = (float)ray->direction[0],
                .dir_y = (float)ray->direction[1],
                .dir_z = (float)ray->direction[2],
                .tfar = INFINITY,
                .mask = UINT32_MAX},
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .primID = RTC_INVALID_GEOMETRY_ID},
    };
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(embree->scene, &context, &query);
    *t = query.ray.tfar;
    return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? UINT32_MAX : query.hit.primID;
}

static void mesh_centre(const struct mesh *mesh, double centre[3], double *radius)
{
    double min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < mesh->count; i++)
        for (int v = 0; v < 3; v++)
            for (int axis = 0; axis < 3; axis++) {
                min[axis] = fmin(min[axis], mesh->vertices[i][v][axis]);
                max[axis] = fmax(max[axis], mesh->vertices[i][v][axis]);
            }
    *radius = 0;
    for (int axis = 0; axis < 3; axis++) {
        centre[axis] = (min[axis] + max[axis]) / 2;
        *radius += (max[axis] - centre[axis]) * (max[axis] - centre[axis]);
    }
    *radius = sqrt(*radius);
}

// Makes a ray from the sphere around the mesh to a point inside it, with coordinates that floats
// represent.
static struct bvh_ray random_ray(struct random *random, const double centre[3], double radius)
{
    struct bvh_ray ray = {.t_max = INFINITY, .ignore = {UINT32_MAX, UINT32_MAX}};
    double from[3], to[3], length = 0;
    random_direction(random, from);
    random_direction(random, to);
    double inside = 0.6 * radius * random_unit(random);
    for (int axis = 0; axis < 3; axis++) {
        ray.origin[axis] = (float)(centre[axis] + 1.5 * radius * from[axis]);
        to[axis] = centre[axis] + inside * to[axis] - ray.origin[axis];
        length += to[axis] * to[axis];
    }
    for (int axis = 0; axis < 3; axis++)
        ray.direction[axis] = (float)(to[axis] / sqrt(length));
    return ray;
}

static void compare(const char *name, const struct mesh *mesh, struct bvh_method method,
                    uint32_t rays)
{
    struct arena arena = {0};
    struct bvh bvh;
    struct err err = {0};
    struct bvh_params params = mesh_params(mesh);
    params.method = method;
    REQUIRE(bvh_build(&params, &arena, &bvh, &err), "%s", err.msg);
    CHECK(bvh_validate(&bvh, &params, &err), "%s", err.msg);
    struct bvh_trace_scene scene = {.bvh = &bvh, .geometry = &params};
    struct embree embree = embree_open(mesh);
    double centre[3], radius;
    mesh_centre(mesh, centre, &radius);
    struct random random = {1};
    uint32_t hits = 0, disagreements = 0, other_ids = 0;
    uint64_t nodes = 0, tests = 0;
    for (uint32_t i = 0; i < rays; i++) {
        struct bvh_ray ray = random_ray(&random, centre, radius);
        struct bvh_hit hit;
        bvh_trace_closest(&scene, &ray, &hit);
        double t;
        uint32_t primitive = embree_trace(&embree, &ray, &t);
        bool same = (primitive == UINT32_MAX) == (hit.primitive == UINT32_MAX) &&
                    (primitive == UINT32_MAX || fabs(t - hit.t) <= 1e-5 * hit.t);
        disagreements += !same;
        other_ids += same && primitive != hit.primitive; // on an edge, or at equal distance
        hits += hit.primitive != UINT32_MAX;
        nodes += hit.nodes_visited;
        tests += hit.primitives_tested;
    }
    printf("%s, split %d, format %d: %u rays, %u hits, %u disagreements, %u other ids; %.2f nodes "
           "and %.2f tests a ray\n",
           name, method.split, method.format, rays, hits, disagreements, other_ids,
           (double)nodes / rays, (double)tests / rays);
    CHECK(disagreements < 1e-5 * rays, "%u", disagreements);
    CHECK(other_ids < 1e-4 * rays, "%u", other_ids);
    CHECK(hits > rays / 4, "%u", hits);
    embree_close(&embree);
    arena_finish(&arena);
}

TEST(every_way_to_build)
{
    struct arena arena = {0};
    struct mesh sphere = mesh_sphere(&arena, 100, 200), soup = mesh_soup(&arena, 30000, 0.05, 1);
    for (uint32_t split = BVH_SPLIT_SAH; split <= BVH_SPLIT_MEAN; split++) {
        for (uint32_t format = BVH_QUANTISED; format <= BVH_FLOAT; format++) {
            compare("sphere", &sphere, (struct bvh_method){split, format}, 50001);
            compare("soup", &soup, (struct bvh_method){split, format}, 50001);
        }
    }
    arena_finish(&arena);
}

static void compare_file(const char *name)
{
    struct arena arena = {0};
    struct mesh mesh;
    if (!mesh_load(&arena, name, &mesh))
        SKIP("%s is not there (LAMPYRIS_DATA)", name);
    compare(name, &mesh, (struct bvh_method){0}, 500000);
    arena_finish(&arena);
}

TEST(nefertiti)
{
    compare_file("nefertiti.obj");
}

TEST(stanford_bunny)
{
    compare_file("stanford-bunny.obj");
}

TEST_MAIN(TEST_CASE(every_way_to_build), TEST_CASE(nefertiti), TEST_CASE(stanford_bunny))
