#include "scene/core/placement.h"

#include "scene/core/affine.h"
#include "scene/core/bounds.h"
#include <math.h>
#include <string.h>

struct placement placement_none(const double about[3])
{
    struct placement none;
    memset(&none, 0, sizeof none); // clears padding: placements are compared byte by byte
    memcpy(none.about, about, sizeof none.about);
    for (int c = 0; c < 3; c++)
        none.scale[c] = 1;
    return none;
}

bool placement_is_none(const struct placement *p)
{
    bool is_none = true;
    for (int c = 0; c < 3; c++)
        is_none = is_none && p->move[c] == 0 && p->turn_degrees[c] == 0 && p->scale[c] == 1;
    return is_none;
}

// --- transforms ----------------------------------------------------------------------------------

// Computes the rotation about x, then y, then z; exactly the identity if all angles are 0.
static void rotation_of(const struct placement *p, double out[3][4])
{
    memcpy(out, AFFINE_IDENTITY, sizeof AFFINE_IDENTITY);
    for (int c = 0; c < 3; c++) {
        const double axis[3] = {c == 0, c == 1, c == 2};
        double step[3][4], degrees = fmod(p->turn_degrees[c], 360);
        if (degrees != 0 && affine_rotation(axis, degrees * DEGREE, step))
            affine_multiply(step, out, out);
    }
}

// Applies a placement to the transform M: the linear part becomes R M S, with rotation R and scale
// S, and the point that M maps to `about` is still mapped there before the translation.
static bool place_transform(const struct placement *p, const double from[3][4], double to[3][4],
                            struct err *err)
{
    double turn[3][4], scale[3][4], inverse[3][4], fixed[3], moved[3];
    memcpy(scale, AFFINE_IDENTITY, sizeof scale);
    for (int c = 0; c < 3; c++)
        scale[c][c] = p->scale[c];
    if (!affine_inverse(from, inverse))
        return err_set(err, ERR_INPUT,
                       "its transform is singular, so it cannot be placed; expected an invertible "
                       "one");
    rotation_of(p, turn);
    affine_point(inverse, p->about, fixed); // in the mesh's space
    affine_multiply(from, scale, to);
    affine_multiply(turn, to, to);
    affine_vector(to, fixed, moved);
    for (int c = 0; c < 3; c++)
        to[c][3] = p->about[c] + p->move[c] - moved[c];
    return true;
}

// Returns how many of a shape's axes are edges with a length. The other axes are unit vectors or 0.
static int edge_count(enum shape_kind kind)
{
    switch (kind) {
    case SHAPE_QUAD:
        return 2;
    case SHAPE_BOX:
    case SHAPE_SDF:
        return 3;
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        return 1;
    case SHAPE_SPHERE:
    case SHAPE_DISC:
    case SHAPE_PLANE:
    case SHAPE_KIND_COUNT:
        break;
    }
    return 0;
}

static bool has_size(double length)
{
    return length >= SCENE_LENGTH_MIN && length <= SCENE_COORDINATE_MAX;
}

static bool check_shape(const struct shape *shape, struct err *err)
{
    bool ok = shape->radius == 0 || has_size(shape->radius);
    for (int i = 0; i < edge_count(shape->kind); i++)
        ok = ok && has_size(vec3_length(shape->axes[i]));
    for (int c = 0; c < 3; c++)
        ok = ok && fabs(shape->center[c]) <= SCENE_COORDINATE_MAX;
    return ok || err_set(err, ERR_INPUT,
                         "the shape at (%g, %g, %g) would be outside the range of scenes; expected "
                         "coordinates of at most %g m and lengths of at least %g m",
                         shape->center[0], shape->center[1], shape->center[2], SCENE_COORDINATE_MAX,
                         SCENE_LENGTH_MIN);
}

static bool has_free_axes(enum shape_kind kind)
{
    return kind == SHAPE_QUAD || kind == SHAPE_BOX;
}

static bool is_round_about_axis(enum shape_kind kind)
{
    return kind == SHAPE_CYLINDER || kind == SHAPE_TUBE;
}

static bool check_scales(const struct placement *p, enum shape_kind kind, struct err *err)
{
    const double *s = p->scale;
    bool is_even = s[1] == s[2] && (s[0] == s[1] || is_round_about_axis(kind));
    return is_even || has_free_axes(kind) ||
           err_set(err, ERR_INPUT, "scales of %g, %g and %g; expected %s for this shape", s[0],
                   s[1], s[2],
                   is_round_about_axis(kind) ? "equal second and third scales (across the axis)"
                                             : "the same scale along all axes");
}

static bool place_shape(const struct placement *p, const struct shape *from, struct shape *to,
                        struct err *err)
{
    double turn[3][4], offset[3];
    if (!check_scales(p, from->kind, err))
        return false;
    rotation_of(p, turn);
    vec3_subtract(from->center, p->about, offset);
    affine_vector(turn, offset, offset);
    affine_vector(turn, from->normal, to->normal);
    for (int c = 0; c < 3; c++)
        to->center[c] = p->about[c] + p->move[c] + offset[c];
    for (int i = 0; i < 3; i++) {
        affine_vector(turn, from->axes[i], to->axes[i]);
        for (int c = 0; c < 3 && i < edge_count(from->kind); c++)
            to->axes[i][c] *= p->scale[i];
    }
    to->radius = from->radius * p->scale[1];
    return check_shape(to, err);
}

// --- the placed objects of a scene ---------------------------------------------------------------

// Returns the object's index in the list of placed objects, or the index at which to insert it. The
// list is in ascending order.
static uint32_t place_in_list(const struct scene *scene, uint32_t object)
{
    uint32_t low = 0, high = scene->placed_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (scene->placed[middle].object < object)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

const struct placed_object *scene_find_placed(const struct scene *scene, uint32_t object)
{
    uint32_t i = place_in_list(scene, object);
    return i < scene->placed_count && scene->placed[i].object == object ? &scene->placed[i] : NULL;
}

bool place_axes_are_free(const struct scene *scene, uint32_t object)
{
    return object < scene->instance_count ||
           has_free_axes(scene->shapes[object - scene->instance_count].kind);
}

struct placement scene_placement(const struct scene *scene, uint32_t object)
{
    const struct placed_object *placed = scene_find_placed(scene, object);
    return placed ? placed->placement : placement_none((const double[3]){0, 0, 0});
}

void shape_take_place(struct shape *to, const struct shape *from)
{
    struct shape placed = *from;
    placed.material = to->material;
    placed.hidden = to->hidden;
    *to = placed;
}

static void put_back(struct scene *scene, const struct placed_object *placed)
{
    if (placed->object < scene->instance_count)
        memcpy(scene->instances[placed->object].transform, placed->transform,
               sizeof placed->transform);
    else
        shape_take_place(&scene->shapes[placed->object - scene->instance_count], &placed->shape);
}

static struct placed_object *find_or_add(struct scene *scene, uint32_t object)
{
    uint32_t i = place_in_list(scene, object);
    if (i < scene->placed_count && scene->placed[i].object == object)
        return &scene->placed[i];
    if (!scene_add_placed(scene))
        return NULL;
    struct placed_object *placed = &scene->placed[i];
    memmove(placed + 1, placed, (scene->placed_count - 1 - i) * sizeof *placed);
    *placed = (struct placed_object){
        .object = object,
        .placement = placement_none((const double[3]){0, 0, 0}),
    };
    if (object < scene->instance_count)
        memcpy(placed->transform, scene->instances[object].transform, sizeof placed->transform);
    else
        placed->shape = scene->shapes[object - scene->instance_count];
    return placed;
}

static void remove_placed(struct scene *scene, struct placed_object *placed)
{
    uint32_t after = scene->placed_count - (uint32_t)(placed - scene->placed) - 1;
    memmove(placed, placed + 1, after * sizeof *placed);
    scene->placed_count--;
}

static bool place(struct scene *scene, struct placed_object *placed, const struct placement *to,
                  struct err *err)
{
    if (placed->object < scene->instance_count) {
        double transform[3][4];
        if (!place_transform(to, (const double(*)[4])placed->transform, transform, err))
            return false;
        memcpy(scene->instances[placed->object].transform, transform, sizeof transform);
    } else {
        struct shape shape = placed->shape;
        if (!place_shape(to, &placed->shape, &shape, err))
            return false;
        shape_take_place(&scene->shapes[placed->object - scene->instance_count], &shape);
    }
    placed->placement = *to;
    return true;
}

bool scene_place(struct scene *scene, uint32_t object, const struct placement *to, struct err *err)
{
    struct placed_object *placed = find_or_add(scene, object);
    if (!placed)
        return err_memory(err, "a placement", sizeof *placed);
    bool is_back = placement_is_none(to), ok = is_back || place(scene, placed, to, err);
    if (is_back)
        put_back(scene, placed);
    // An entry that was added for a failed placement is removed again.
    if (is_back || placement_is_none(&placed->placement))
        remove_placed(scene, placed);
    return ok;
}

void scene_object_middle(const struct scene *scene, uint32_t object, double out[3])
{
    if (object >= scene->instance_count) {
        memcpy(out, scene->shapes[object - scene->instance_count].center, 3 * sizeof *out);
        return;
    }
    const struct instance *instance = &scene->instances[object];
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    struct bounds bounds = BOUNDS_EMPTY;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        double point[3];
        mesh_vertex(mesh, v, point);
        bounds_add_point(&bounds, point);
    }
    double middle[3] = {0, 0, 0};
    for (int c = 0; c < 3 && !bounds_is_empty(&bounds); c++)
        middle[c] = 0.5 * bounds.min[c] + 0.5 * bounds.max[c];
    affine_point(instance->transform, middle, out);
}
