// Ray tests of boxes, cylinders and tubes. Pure functions.
//
// A ray that starts on one of these leaves it for good or goes through it, and rounding must not
// decide which. Where it starts it is on every face that is as near as that point may be wrong:
// going out of one of them it meets nothing, and none of them is what it meets going in. A ray is
// moved to the side that it goes to when it starts (lib/ray_offset.glsl), which decides where its
// direction is too close to a face's to tell.
#ifndef INTERSECT_SOLID_GLSL
#define INTERSECT_SOLID_GLSL

#include "lib/constants.glsl"

// The crossings of a ray with a shape, in order along it: distances, negative if there is none, and
// the data that a hit record keeps of the place for load_shape_surface().
struct crossings {
    float first, second;
    vec2 first_at, second_at;
};

const float SMALLEST_NORMAL = 1.17549435e-38;
const float FARTHEST = 3e38;

// Roundings of a coordinate along a face's normal, by which an origin on the face may be off: twice
// what surface.error says there, of which the origin was moved by once.
#define ORIGIN_ROUNDINGS GAMMA(48)
// A bound of the rounding error of the cosine between a direction and a normal, relative to 1.
#define SLOPE_ROUNDINGS GAMMA(16)

// The part of a ray that is within the faces tested so far, and the faces that end it.
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

// A ray that starts on a face at a height above it, of which only the sign is used, and rises as
// fast: whether it leaves. `slope_error`: what is too little to tell.
bool leaves_face(float height, float rise, float slope_error)
{
    return rise > (height > 0.0 ? -slope_error : slope_error);
}

// The slab |x . normal| <= half_width: the ray is at `along` and goes on by `rise`. Its faces are
// `face` and -face.
void cut_slab(inout interval i, float along, float rise, float half_width, float bound,
              float slope_error, bool starts_here, float face)
{
    float side = rise < 0.0 ? -1.0 : 1.0;
    float speed = abs(rise);
    float at = along * side; // as if the ray rose
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

// A box's unit axes, and half of its edges along them. The third one is at right angles to both.
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

// Faces are numbered by their axis, 1 to 3, with the sign of the side.
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

// A ray and a cylinder without end.
struct round_ray {
    vec3 f;          // from the axis to the origin
    vec3 d;          // the direction, less what is along the axis
    float a, b;      // d.d, -f.d
    vec2 t;          // distances of the crossings, in order
    bool misses;     // or leaves
    bool is_along;   // the axis: it is inside or outside for good
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
        // The normal is as uncertain as the distance is, of the radius.
        float slope_error = SLOPE_ROUNDINGS * dot(abs(f), speeds) +
                            min(bound / max(away, radius), 1.0) * away * sqrt(r.a);
        // Rays leave a cylinder that is hardly thicker than that unless they are certain not to.
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

// A bound of the error of a point on a cylinder's side, to which `f` leads from the axis, at a
// height along it.
float side_bound(vec3 f, vec3 reach, float radius, float height)
{
    float away = max(length(f), SMALLEST_NORMAL);
    return ORIGIN_ROUNDINGS * (dot(abs(f), reach) / away + radius + abs(height));
}

// Face 0 is the side; 1 and -1 are the caps at the end of the half axis and at the other.
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

// The side alone.
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
