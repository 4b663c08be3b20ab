// Clips triangles at planes. Everything is computed in double precision from single-precision
// corners, so that rounding errors are negligible relative to the padding.
#include "bvh/bvh_clip.h"

#include "bvh/bvh_box.h"
#include <string.h>

// The padding relative to the triangle's size and to its coordinates. The second is at least four
// units in the last place of a coordinate.
#define PAD_OF_SIZE 0x1p-16
#define PAD_OF_COORDINATE 0x1p-21
#define PAD_MIN 0x1p-147

enum { CORNERS_MAX = 9 }; // maximum number of corners of a triangle cut by the six planes of a box

struct bvh_clip bvh_clip_for(const float vertices[3][3])
{
    struct bvh_clip clip;
    double size = 0, reach = 0;
    for (int axis = 0; axis < 3; axis++) {
        double min = INFINITY, max = -INFINITY;
        for (int corner = 0; corner < 3; corner++) {
            double x = vertices[corner][axis];
            clip.vertices[corner][axis] = x;
            min = x < min ? x : min;
            max = x > max ? x : max;
        }
        size = max - min > size ? max - min : size;
        reach = fmax(reach, fmax(fabs(min), fabs(max)));
    }
    clip.pad = fmax(fmax(PAD_OF_SIZE * size, PAD_OF_COORDINATE * reach), PAD_MIN);
    return clip;
}

struct extent {
    double min[3], max[3];
};

static struct extent extent_empty(void)
{
    return (struct extent){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void extent_add(struct extent *extent, const double point[3])
{
    for (int axis = 0; axis < 3; axis++) {
        extent->min[axis] = point[axis] < extent->min[axis] ? point[axis] : extent->min[axis];
        extent->max[axis] = point[axis] > extent->max[axis] ? point[axis] : extent->max[axis];
    }
}

// Returns the padded extent, clipped to `box`. Rounding to the nearest float takes at most an
// eighth of the padding, and the box's own planes are exact. Adding 0 turns -0 into +0.
static struct bvh_box padded(const struct extent *extent, double pad, const struct bvh_box *box)
{
    struct bvh_box part;
    for (int axis = 0; axis < 3; axis++) {
        double lowest = box->min[axis], highest = box->max[axis];
        double min = extent->min[axis] - pad, max = extent->max[axis] + pad;
        min = min > lowest ? min : lowest;
        max = max < highest ? max : highest;
        part.min[axis] = (float)(min < highest ? min : highest) + 0.0f;
        part.max[axis] = (float)(max > lowest ? max : lowest) + 0.0f;
    }
    return part;
}

// Computes the intersection of the edge from a to b with the plane. Its coordinate on the axis is
// exactly that of the plane.
static void meet(const double a[3], const double b[3], int axis, double plane, double point[3])
{
    double t = (plane - a[axis]) / (b[axis] - a[axis]);
    for (int i = 0; i < 3; i++)
        point[i] = a[i] + t * (b[i] - a[i]);
    point[axis] = plane;
}

void bvh_clip_quickly(const struct bvh_clip *clip, const struct bvh_box *box, int axis,
                      double plane, struct bvh_box parts[2])
{
    struct extent extents[2] = {extent_empty(), extent_empty()};
    for (int i = 0; i < 3; i++) {
        const double *a = clip->vertices[i], *b = clip->vertices[(i + 1) % 3];
        if (a[axis] <= plane)
            extent_add(&extents[0], a);
        if (a[axis] >= plane)
            extent_add(&extents[1], a);
        if ((a[axis] < plane && b[axis] > plane) || (a[axis] > plane && b[axis] < plane)) {
            double point[3];
            meet(a, b, axis, plane, point);
            extent_add(&extents[0], point);
            extent_add(&extents[1], point);
        }
    }
    parts[0] = padded(&extents[0], clip->pad, box);
    parts[1] = padded(&extents[1], clip->pad, box);
}

struct polygon {
    double corners[CORNERS_MAX][3];
    int count;
};

// Keeps the part of the polygon below a plane, or the part above it (Sutherland and Hodgman 1974,
// "Reentrant polygon clipping").
static void halve(struct polygon *polygon, int axis, double plane, bool below)
{
    struct polygon in = *polygon;
    polygon->count = 0;
    for (int i = 0; i < in.count; i++) {
        const double *a = in.corners[i], *b = in.corners[(i + 1) % in.count];
        bool a_stays = below ? a[axis] <= plane : a[axis] >= plane;
        bool b_stays = below ? b[axis] <= plane : b[axis] >= plane;
        if (a_stays && polygon->count < CORNERS_MAX)
            memcpy(polygon->corners[polygon->count++], a, sizeof(double[3]));
        if (a_stays != b_stays && polygon->count < CORNERS_MAX)
            meet(a, b, axis, plane, polygon->corners[polygon->count++]);
    }
}

void bvh_clip_exactly(const struct bvh_clip *clip, const struct bvh_box *box, int axis,
                      double plane, struct bvh_box parts[2])
{
    bvh_clip_quickly(clip, box, axis, plane, parts);
    struct polygon whole = {.count = 3};
    memcpy(whole.corners, clip->vertices, sizeof clip->vertices);
    for (int i = 0; i < 3; i++) {
        halve(&whole, i, box->min[i], false);
        halve(&whole, i, box->max[i], true);
    }
    for (int side = 0; side < 2; side++) {
        struct polygon part = whole;
        struct extent extent = extent_empty();
        halve(&part, axis, plane, side == 0);
        for (int i = 0; i < part.count; i++)
            extent_add(&extent, part.corners[i]);
        if (part.count > 0) // empty if the triangle touches the box only within rounding errors
            parts[side] = padded(&extent, clip->pad, &parts[side]);
    }
}
