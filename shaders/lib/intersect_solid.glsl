// Intersects rays with boxes, cylinders and open cylinders. All functions are pure.
//
// A ray that starts on such a shape either leaves it for good or passes through it, and rounding
// must not decide which. The ray starts on each face whose distance is within the error of the
// starting point. A ray that leaves through one of these faces hits nothing; a ray that enters hits
// none of them. When a ray starts, its origin is moved to the side to which it goes
// (lib/ray_offset.glsl); that side decides if the direction is too close to parallel to a face.
#ifndef INTERSECT_SOLID_GLSL
#define INTERSECT_SOLID_GLSL

#include "lib/constants.glsl"

// The crossings of a ray with a shape, in order along the ray: distances, which are negative if
// there is no crossing, and the data that a hit record keeps for load_shape_surface().
struct crossings {
    float first, second;
    vec2 first_at, second_at;
};

const float SMALLEST_NORMAL = 1.17549435e-38;
const float FARTHEST = 3e38;

// Bound, in roundings of a coordinate along a face's normal, on the distance of an origin from the
// face on which it is: twice surface.error, because the origin was moved by that error once.
#define ORIGIN_ROUNDINGS GAMMA(48)
// A bound of the rounding error of the cosine between a direction and a normal, relative to 1.
#define SLOPE_ROUNDINGS GAMMA(16)

// The part of the ray inside all faces tested so far, and the faces at its ends.
struct interval {
    float near, far;
    float near_face, far_face;
    bool empty;
};

interval interval_all()
{
    return interval(-FARTHEST, FARTHEST, 0.0, 0.0, false);
}

void interval_cut(inout interval i, float near, float near_face, float far, float far_face)
{
    bool later = near > i.near;
    i.near_face = later ? near_face : i.near_face;
    i.near = later ? near : i.near;
    bool sooner = far < i.far;
    i.far_face = sooner ? far_face : i.far_face;
    i.far = sooner ? far : i.far;
}

// Returns whether a ray leaves the face on which it starts. `height` is the height of the ray's
// origin above the face; only its sign is used. `rise` is the ray's speed away from the face; a
// speed below slope_error is not significant.
bool leaves_face(float height, float rise, float slope_error)
{
    return rise > (height > 0.0 ? -slope_error : slope_error);
}

// Clips to the slab |x . normal| <= half_width: the ray's position is `along`, its speed `rise`.
// The faces are numbered `face` and -face.
void cut_slab(inout interval i, float along, float rise, float half_width, float bound,
              float slope_error, bool starts_here, float face)
{
    float side = rise < 0.0 ? -1.0 : 1.0;
    float speed = abs(rise);
    float at = along * side; // mirrored so that the ray rises
    float near = (-half_width - at) / speed;
    float far = (half_width - at) / speed;
    if (speed < SMALLEST_NORMAL) {
        near = -FARTHEST;
        far = FARTHEST;
        i.empty = i.empty || (abs(at) > half_width && !starts_here);
    }
    if (starts_here) {
        bool on_far = at > 0.0 && at >= half_width - bound;
        bool on_near = at <= 0.0 && at <= bound - half_width;
        i.empty = i.empty || (on_far && leaves_face(at - half_width, speed, slope_error)) ||
                  (on_near && leaves_face(-half_width - at, -speed, slope_error));
        near = -FARTHEST;
        far = on_far ? FARTHEST : far;
    }
    interval_cut(i, near, -side * face, far, side * face);
}

crossings interval_ends(interval i)
{
    crossings c;
    bool met = !i.empty && i.near <= i.far && i.far > 0.0 && i.far < FARTHEST;
    bool enters = i.near > 0.0;
    c.first = met ? (enters ? i.near : i.far) : -1.0;
    c.first_at = vec2(enters ? i.near_face : i.far_face, 0.0);
    c.second = met && enters ? i.far : -1.0;
    c.second_at = vec2(i.far_face, 0.0);
    return c;
}

// Unit axes of a box, and half of its edges along them. The third axis is perpendicular to both.
struct box_frame {
    vec3 axis[3];
    vec3 half_edges;
};

box_frame box_frame_of(vec3 half_edge, vec3 other, float third)
{
    box_frame b;
    b.half_edges = vec3(length(half_edge), length(other), third);
    b.axis[0] = half_edge / b.half_edges.x;
    b.axis[1] = other / b.half_edges.y;
    b.axis[2] = cross(b.axis[0], b.axis[1]);
    return b;
}

// Faces have the number of their axis, 1 to 3, with the sign of the side.
crossings intersect_box(vec3 origin, vec3 direction, vec3 center, box_frame b, bool starts_here)
{
    vec3 f = origin - center;
    vec3 reach = abs(origin) + abs(center);
    interval i = interval_all();
    for (int k = 0; k < 3; k++) {
        vec3 n = b.axis[k];
        float half_edge = b.half_edges[k];
        float bound = ORIGIN_ROUNDINGS * (dot(abs(n), reach) + half_edge);
        cut_slab(i, dot(f, n), dot(direction, n), half_edge, bound,
                 SLOPE_ROUNDINGS * dot(abs(n), abs(direction)), starts_here, float(k + 1));
    }
    return interval_ends(i);
}

// A ray and an infinite cylinder.
struct round_ray {
    vec3 f;          // from the axis to the origin
    vec3 d;          // the direction, without its component along the axis
    float a, b;      // d.d, -f.d
    vec2 t;          // distances of the crossings, in order
    bool misses;     // the ray misses the cylinder, or leaves it
    bool is_along;   // parallel to the axis: the ray is always inside or always outside
};

round_ray intersect_round(vec3 f, vec3 d, float radius, float bound, vec3 speeds, bool starts_here)
{
    round_ray r;
    r.f = f;
    r.d = d;
    r.a = dot(d, d);
    r.b = -dot(f, d);
    float away2 = dot(f, f);
    float away = sqrt(away2);
    float c = away2 - radius * radius;
    bool on_side = starts_here && abs(away - radius) <= bound;
    r.is_along = r.a < SMALLEST_NORMAL;
    vec3 closest = f + (r.b / r.a) * d;
    float discriminant = radius * radius - dot(closest, closest);
    r.misses = !(discriminant >= 0.0) && !on_side;
    if (on_side) {
        // The uncertainty of the normal is that of the distance, relative to the radius.
        float slope_error = SLOPE_ROUNDINGS * dot(abs(f), speeds) +
                            min(bound / max(away, radius), 1.0) * away * sqrt(r.a);
        // If the radius is hardly greater than the error bound, a ray leaves the cylinder unless it
        // certainly enters it.
        r.misses = leaves_face(8.0 * bound > radius ? bound : away - radius, -r.b, slope_error);
        c = min(c, 0.0);
    }
    float root = sqrt(r.a * max(discriminant, 0.0));
    float q = r.b + (r.b < 0.0 ? -root : root);
    float t0 = c / q;
    float t1 = q / r.a;
    r.misses = r.misses || q == 0.0;
    r.t = vec2(min(t0, t1), max(t0, t1));
    if (r.is_along) {
        r.misses = away > radius && !on_side;
        r.t = vec2(-FARTHEST, FARTHEST);
    }
    if (on_side)
        r.t.x = -FARTHEST;
    return r;
}

// Returns a bound on the error of a point on a cylinder's side; `f` is the vector from the axis to
// the point, at this height along the axis.
float side_bound(vec3 f, vec3 reach, float radius, float height)
{
    float away = max(length(f), SMALLEST_NORMAL);
    return ORIGIN_ROUNDINGS * (dot(abs(f), reach) / away + radius + abs(height));
}

// Face 0 is the side; face 1 is the cap at the end of the half axis, face -1 the opposite one.
crossings intersect_cylinder(vec3 origin, vec3 direction, vec3 center, vec3 half_axis, float radius,
                             bool starts_here)
{
    float half_height = length(half_axis);
    vec3 n = half_axis / half_height;
    vec3 f = origin - center;
    vec3 reach = abs(origin) + abs(center);
    float along = dot(f, n);
    float rise = dot(direction, n);
    vec3 across = f - along * n;
    interval i = interval_all();
    cut_slab(i, along, rise, half_height,
             ORIGIN_ROUNDINGS * (dot(abs(n), reach) + half_height),
             SLOPE_ROUNDINGS * dot(abs(n), abs(direction)), starts_here, 1.0);
    round_ray r = intersect_round(across, direction - rise * n, radius,
                                  side_bound(across, reach, radius, along), abs(direction),
                                  starts_here);
    i.empty = i.empty || r.misses;
    interval_cut(i, r.t.x, 0.0, r.t.y, 0.0);
    if (starts_here)
        i.near = -FARTHEST;
    return interval_ends(i);
}

// Tests an open cylinder, which is a side without caps.
crossings intersect_tube(vec3 origin, vec3 direction, vec3 center, vec3 half_axis, float radius,
                         bool starts_here)
{
    float half_height = length(half_axis);
    vec3 n = half_axis / half_height;
    vec3 f = origin - center;
    float along = dot(f, n);
    float rise = dot(direction, n);
    vec3 across = f - along * n;
    vec3 reach = abs(origin) + abs(center);
    round_ray r = intersect_round(across, direction - rise * n, radius,
                                  side_bound(across, reach, radius, along), abs(direction),
                                  starts_here);
    vec2 heights = abs(along + rise * r.t);
    bool none = r.misses || r.is_along;
    bool near = !none && r.t.x > 0.0 && r.t.x < FARTHEST && heights.x <= half_height;
    bool far = !none && r.t.y > 0.0 && r.t.y < FARTHEST && heights.y <= half_height;
    return crossings(near ? r.t.x : far ? r.t.y : -1.0, near && far ? r.t.y : -1.0, vec2(0.0),
                     vec2(0.0));
}

#endif
