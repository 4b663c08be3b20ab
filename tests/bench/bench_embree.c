#include "bench.h"

#include "base/clock.h"
#include "base/parallel.h"
#include <math.h>
#include <stdlib.h>

#ifdef HAVE_EMBREE
#include <embree3/rtcore.h>

struct yardstick {
    RTCDevice device;
    RTCScene scene;
    unsigned threads;
    // The following members belong to the current call.
    bool shadow;
    const struct probe_ray *rays;
    struct probe_hit *hits;
};

struct yardstick *yardstick_create(const struct flat_scene *flat, unsigned threads)
{
    struct yardstick *y = calloc(1, sizeof *y);
    if (!y)
        return NULL;
    y->threads = threads;
    y->device = rtcNewDevice(NULL);
    y->scene = rtcNewScene(y->device);
    rtcSetSceneBuildQuality(y->scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(y->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    size_t corners = (size_t)flat->triangle_count * 3;
    float *vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                              RTC_FORMAT_FLOAT3, 12, corners);
    unsigned *indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                RTC_FORMAT_UINT3, 12, flat->triangle_count);
    for (size_t i = 0; i < corners; i++) {
        for (int c = 0; c < 3; c++)
            vertices[3 * i + c] = flat->triangles[i / 3].v[i % 3][c];
        indices[i] = (unsigned)i;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(y->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(y->scene);
    return y;
}

void yardstick_destroy(struct yardstick *y)
{
    if (!y)
        return;
    rtcReleaseScene(y->scene);
    rtcReleaseDevice(y->device);
    free(y);
}

static struct RTCRay embree_ray(const struct probe_ray *ray, float t_far)
{
    return (struct RTCRay){
        .org_x = ray->origin[0],
        .org_y = ray->origin[1],
        .org_z = ray->origin[2],
        .dir_x = ray->direction[0],
        .dir_y = ray->direction[1],
        .dir_z = ray->direction[2],
        .tfar = t_far,
        .mask = ~0u,
    };
}

static void trace_range(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct yardstick *y = context;
    struct RTCIntersectContext rtc;
    rtcInitIntersectContext(&rtc);
    for (size_t i = begin; i < end; i++) {
        if (y->shadow) {
            struct RTCRay ray = embree_ray(&y->rays[i], 1.0f);
            rtcOccluded1(y->scene, &rtc, &ray);
            y->hits[i].primitive = ray.tfar < 0.0f ? 0 : NO_PRIMITIVE;
        } else {
            struct RTCRayHit hit = {.ray = embree_ray(&y->rays[i], INFINITY),
                                    .hit.geomID = RTC_INVALID_GEOMETRY_ID};
            rtcIntersect1(y->scene, &rtc, &hit);
            bool found = hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
            y->hits[i] = (struct probe_hit){hit.ray.tfar, hit.hit.u, hit.hit.v,
                                            found ? hit.hit.primID : NO_PRIMITIVE};
        }
    }
}

double yardstick_trace(struct yardstick *y, bool shadow, const struct probe_ray *rays,
                       uint32_t count, struct probe_hit *hits)
{
    y->shadow = shadow;
    y->rays = rays;
    y->hits = hits;
    uint64_t start = clock_ns();
    parallel_for(count, 4096, y->threads, trace_range, y);
    return clock_seconds_since(start);
}

#else

struct yardstick *yardstick_create(const struct flat_scene *flat, unsigned threads)
{
    (void)flat, (void)threads;
    return NULL;
}

void yardstick_destroy(struct yardstick *y)
{
    (void)y;
}

double yardstick_trace(struct yardstick *y, bool shadow, const struct probe_ray *rays,
                       uint32_t count, struct probe_hit *hits)
{
    (void)y, (void)shadow, (void)rays, (void)count, (void)hits;
    return NAN;
}

#endif
