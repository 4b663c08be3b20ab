#include "viewer/core/motion.h"

#include "scene/core/affine.h"
#include <stdlib.h>
#include <string.h>

// The denoiser does not follow scenes with more objects, because every renderer would copy as many
// object frames.
#define OBJECTS_MAX 65536u

// A coordinate system that moves, rotates and scales with an object, in world space. Equal frames
// have equal bytes.
struct object_frame {
    double axes[3][4];
};

static void set_column(double m[3][4], int column, const double v[3], double factor)
{
    for (int c = 0; c < 3; c++)
        m[c][column] = factor * v[c];
}

// Computes two unit vectors that are orthogonal to `normal` and to each other; out[2] is `normal`.
static void across(const double normal[3], double out[3][3])
{
    int least = fabs(normal[0]) < fabs(normal[1]) ? 0 : 1;
    if (fabs(normal[2]) < fabs(normal[least]))
        least = 2;
    const double axis[3] = {least == 0, least == 1, least == 2};
    memcpy(out[2], normal, sizeof out[2]);
    vec3_cross(normal, axis, out[0]);
    vec3_normalize(out[0]);
    vec3_cross(normal, out[0], out[1]);
}

// Returns the frame of a shape. Shapes without axes of their own, such as spheres, do not rotate;
// neither does their shading.
static struct object_frame shape_frame(const struct shape *shape)
{
    struct object_frame frame;
    double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double factors[3] = {1, 1, 1};
    if (shape->kind == SHAPE_BOX || shape->kind == SHAPE_SDF || shape->kind == SHAPE_QUAD)
        memcpy(axes, shape->axes, sizeof axes);
    if (shape->kind == SHAPE_QUAD)
        vec3_cross(axes[0], axes[1], axes[2]);
    if (shape->kind == SHAPE_CYLINDER || shape->kind == SHAPE_TUBE) {
        memcpy(axes, shape->axes, 2 * sizeof axes[0]);
        vec3_cross(axes[0], axes[1], axes[2]);
        vec3_normalize(axes[2]);
        factors[1] = factors[2] = shape->radius;
    }
    if (shape->kind == SHAPE_DISC || shape->kind == SHAPE_PLANE)
        across(shape->normal, axes);
    if (shape->kind == SHAPE_DISC || shape->kind == SHAPE_SPHERE)
        factors[0] = factors[1] = factors[2] = shape->radius;
    memset(&frame, 0, sizeof frame);
    for (int i = 0; i < 3; i++)
        set_column(frame.axes, i, axes[i], factors[i]);
    set_column(frame.axes, 3, shape->center, 1);
    return frame;
}

static struct object_frame frame_of(const struct scene *scene, uint32_t object)
{
    struct object_frame frame;
    if (object >= scene->instance_count)
        return shape_frame(&scene->shapes[object - scene->instance_count]);
    memcpy(frame.axes, scene->instances[object].transform, sizeof frame.axes);
    return frame;
}

static void find_frames(struct object_frames *frames, const struct scene *scene)
{
    uint32_t count = scene->instance_count + scene->shape_count;
    free(frames->list);
    frames->list = count <= OBJECTS_MAX ? malloc((count + 1u) * sizeof *frames->list) : NULL;
    frames->count = count;
    for (uint32_t i = 0; frames->list && i < count; i++)
        frames->list[i] = frame_of(scene, i);
}

// Finds the primitives of an object in the flat scene. There are none if the object is hidden.
static void find_primitives(const struct scene *scene, const struct flat_scene *flat,
                            uint32_t object, struct denoise_motion *out)
{
    out->instance = NO_INSTANCE;
    out->primitive_count = 0;
    if (object >= scene->instance_count) {
        for (uint32_t i = 0; i < flat->shape_count; i++)
            if (flat->shapes[i].source == object - scene->instance_count) {
                out->first_primitive = PRIMITIVE_SHAPE | i;
                out->primitive_count = 1;
            }
        return;
    }
    for (uint32_t i = 0; i < flat->placed_count; i++)
        if (flat->instances[i].source == object) {
            const struct flat_mesh *mesh = &flat->meshes[flat->instances[i].mesh];
            out->instance = i;
            out->first_primitive = mesh->first_triangle;
            out->primitive_count = mesh->triangle_count;
            return;
        }
    flat_instance_triangles(flat, object, &out->first_primitive, &out->primitive_count);
}

static bool describe(struct motion *motion, const struct scene *scene,
                     const struct flat_scene *flat, uint32_t object)
{
    const struct object_frame *past = &motion->past.list[object], *now = &motion->now.list[object];
    struct denoise_motion moved;
    double back[3][4];
    if (memcmp(past, now, sizeof *now) == 0)
        return true;
    find_primitives(scene, flat, object, &moved);
    if (moved.primitive_count == 0)
        return true;
    if (motion->count == DENOISE_MOTIONS_MAX || !affine_inverse(now->axes, back))
        return false;
    affine_multiply(past->axes, back, moved.to_past);
    motion->list[motion->count++] = moved;
    return true;
}

bool motion_begin(struct motion *motion, const struct scene *scene, const struct flat_scene *flat,
                  uint32_t deformations)
{
    find_frames(&motion->now, scene);
    motion->now.deformations = deformations;
    motion->has_changed = true;
    motion->count = 0;
    bool follows = motion->now.list && motion->past.list &&
                   motion->now.count == motion->past.count &&
                   motion->now.deformations == motion->past.deformations;
    for (uint32_t i = 0; follows && i < motion->now.count; i++)
        follows = describe(motion, scene, flat, i);
    if (!follows)
        motion->count = 0;
    return follows;
}

void motion_keep(struct motion *motion)
{
    size_t bytes = (motion->now.count + 1u) * sizeof *motion->now.list;
    free(motion->past.list);
    motion->past = motion->now;
    motion->past.list = motion->now.list ? malloc(bytes) : NULL;
    if (motion->past.list)
        memcpy(motion->past.list, motion->now.list, bytes);
    motion->has_changed = false;
    motion->count = 0;
}

void motion_finish(struct motion *motion)
{
    free(motion->now.list);
    free(motion->past.list);
    *motion = (struct motion){0};
}
