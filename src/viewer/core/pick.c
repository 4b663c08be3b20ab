#include "viewer/core/pick.h"

#include "base/maths.h"
#include "render/probe/replay.h"
#include "shared/types.h"
#include "viewer/core/frame.h"
#include "viewer/core/viewer.h"
#include <math.h>
#include <string.h>

uint32_t viewer_object(const struct renderer *renderer, bool is_shape, uint32_t primitive,
                       uint32_t flat_instance)
{
    const struct flat_scene *flat = &renderer->flat;
    uint32_t instance, triangle;
    if (is_shape)
        return flat->instance_count + flat->shapes[primitive].source;
    flat_triangle_source(flat, primitive, &instance, &triangle);
    return flat_instance == NO_INSTANCE ? instance : flat->instances[flat_instance].source;
}

// Returns whether the surface that a side shows is still in the scene. It may have been removed
// while the BVH is being rebuilt.
static bool is_there(const struct scene *scene, const struct picked *picked)
{
    return picked->object < scene->instance_count + scene->shape_count &&
           picked->material < scene->material_count;
}

static void take_hit(const struct scene *scene, const struct view *view,
                     const struct replay_vertex *hit, struct picked *out)
{
    double away[3];
    out->object = viewer_object(&view->job.renderer, hit->is_shape, hit->primitive, hit->instance);
    out->material = (uint32_t)(hit->material - view->scene.materials);
    out->primitive = hit->primitive;
    memcpy(out->position, hit->position, sizeof out->position);
    vec3_subtract(hit->position, view->job.renderer.camera.position, away);
    out->distance = vec3_length(away);
    if (!is_there(scene, out))
        out->object = out->material = VIEWER_NO_OBJECT;
}

static uint32_t pixel_at(double position, uint32_t size, uint32_t pixels)
{
    double at = floor(position / size * pixels);
    return (uint32_t)fmax(0.0, fmin(at, (double)pixels - 1.0));
}

bool viewer_pick(struct viewer *viewer, double x, double y, struct picked *out, struct err *err)
{
    uint32_t place[4];
    viewer_picture_place(viewer, place);
    bool is_right = viewer->stage.side_count > 1 && x >= viewer_split_x(viewer);
    struct view *view = &viewer->stage.sides[is_right];
    *out = (struct picked){.object = VIEWER_NO_OBJECT, .material = VIEWER_NO_OBJECT};
    x -= place[0];
    y -= place[1];
    bool is_inside = x >= 0.0 && y >= 0.0 && x < place[2] && y < place[3];
    if (!viewer->document.has_scene || !view->is_ready || !is_inside)
        return true;
    const struct gpu_frame *frame = &view->job.renderer.frame;
    struct replay replay;
    // Follows one of the samples of the image itself.
    if (!job_replay(&view->job, pixel_at(x, place[2], frame->width),
                    pixel_at(y, place[3], frame->height), 0, &viewer->shell.frame_arena, &replay,
                    err))
        return false;
    out->is_some = true;
    if (replay.vertex_count > 0 && strcmp(replay.vertices[0].queue, "surface") == 0)
        take_hit(&viewer->document.scene, view, &replay.vertices[0], out);
    return true;
}
