// Samples points on emissive shapes, and returns the density of the samples.
#ifndef SHAPE_LIGHT_GLSL
#define SHAPE_LIGHT_GLSL

#include "lib/light_types.glsl"
#include "lib/material.glsl"
#include "lib/primitive.glsl"
#include "lib/sampling.glsl"
#include "lib/shape_record.glsl"
#include "lib/solid_angle.glsl"
#include "lib/surface.glsl"

// Returns 1 - cos of the half-angle at which a sphere is seen, from sin^2 of that angle, without
// cancellation.
float sphere_cone(float sin2_max)
{
    return sin2_max / (1.0 + sqrt(max(0.0, 1.0 - sin2_max)));
}

// Returns the density per solid angle of a direction to a sphere from outside it: uniform in the
// cone that it fills.
float pdf_sphere_cone(float radius, float sin2_max, float pick_density)
{
    float pick = pick_density * 4.0 * PI * radius * radius;
    return pick / (2.0 * PI * sphere_cone(sin2_max));
}

// Returns sin^2 of the half-angle at which a sphere is seen; below 1 for points outside. If it is
// closer to 1 than a float can represent, the sphere's equation decides.
float sphere_sin2(vec3 point, vec3 center, float radius)
{
    vec3 to_center = center - point;
    float sin2_max = radius * radius / dot(to_center, to_center);
    if (HAS_GEOMETRY(GEOMETRY_LARGE_SPHERES))
        sin2_max = sphere_height(point, center, radius) > 0.0 ? min(sin2_max, 1.0 - ROUNDING)
                                                               : max(sin2_max, 1.0);
    return sin2_max;
}

float shape_area(shape_record shape)
{
    float area = PI * shape.radius * shape.radius;
    if (HAS_EMITTER(EMITTER_SPHERES) && shape.kind == SHAPE_KIND_SPHERE)
        area *= 4.0;
    if (HAS_EMITTER(EMITTER_QUADS) && shape.kind == SHAPE_KIND_QUAD)
        area = 4.0 * length(cross(shape.axis, shape.other));
    if (HAS_EMITTER(EMITTER_BOXES) && shape.kind == SHAPE_KIND_BOX) {
        vec3 h = vec3(length(shape.axis), length(shape.other), shape.radius);
        area = 8.0 * dot(h, h.yzx);
    }
    float side = 4.0 * PI * shape.radius * length(shape.axis);
    if (HAS_EMITTER(EMITTER_CYLINDERS) && shape.kind == SHAPE_KIND_CYLINDER)
        area = side + 2.0 * area;
    if (HAS_EMITTER(EMITTER_TUBES) && shape.kind == SHAPE_KIND_TUBE)
        area = side;
    return area;
}

// Returns the area of a shape's outline, seen along a unit direction from far away.
float shape_area_seen(shape_record shape, vec3 direction)
{
    float area = PI * shape.radius * shape.radius;
    if (HAS_EMITTER(EMITTER_DISCS) && shape.kind == SHAPE_KIND_DISC)
        area *= abs(dot(direction, shape.axis));
    if (HAS_EMITTER(EMITTER_QUADS) && shape.kind == SHAPE_KIND_QUAD)
        area = 4.0 * abs(dot(direction, cross(shape.axis, shape.other)));
    if (HAS_EMITTER(EMITTER_BOXES) && shape.kind == SHAPE_KIND_BOX) {
        box_frame b = box_frame_of(shape.axis, shape.other, shape.radius);
        area = 4.0 * dot(abs(along_box(b, direction)), b.half_edges.yzx * b.half_edges.zxy);
    }
    if (HAS_EMITTER(EMITTER_CYLINDERS | EMITTER_TUBES) &&
        (shape.kind == SHAPE_KIND_CYLINDER || shape.kind == SHAPE_KIND_TUBE)) {
        float rise = abs(dot(direction, normalize(shape.axis)));
        float side = 4.0 * shape.radius * length(shape.axis) * sqrt(max(0.0, 1.0 - rise * rise));
        area = side + (shape.kind == SHAPE_KIND_CYLINDER ? area * rise : 0.0);
    }
    return area;
}

#define EMITTERS_CONVEX (EMITTER_BOXES | EMITTER_CYLINDERS)

// Returns whether the shape is a box or a closed cylinder that may emit.
bool is_convex_light(uint kind)
{
    return (HAS_EMITTER(EMITTER_BOXES) && kind == SHAPE_KIND_BOX) ||
           (HAS_EMITTER(EMITTER_CYLINDERS) && kind == SHAPE_KIND_CYLINDER);
}

// The visible part of a box or a closed cylinder. Seen from outside, sides that face away are
// hidden; seen from inside, no side is hidden.
struct shape_sight {
    bool is_outside;
    vec3 areas;  // visible areas: of a box's faces across each axis; of a cylinder's side and caps
    vec3 place;  // position of the point relative to the centre: along a box's axes; from a
                 // cylinder's axis, unit
    float along; // position along a cylinder's axis
    float arc;   // half of the visible angle around the axis of a cylinder's side, in turns, for
                 // points outside
};

shape_sight box_sight(shape_record shape, vec3 origin)
{
    box_frame b = box_frame_of(shape.axis, shape.other, shape.radius);
    shape_sight sight;
    sight.areas = 4.0 * b.half_edges.yzx * b.half_edges.zxy;
    sight.place = along_box(b, origin - shape.center);
    bvec3 sees = greaterThan(abs(sight.place), b.half_edges);
    sight.is_outside = any(sees);
    sight.areas *= sight.is_outside ? vec3(sees) : vec3(2.0);
    return sight;
}

shape_sight cylinder_sight(shape_record shape, vec3 origin)
{
    float half_height = length(shape.axis);
    float radius = shape.radius;
    vec3 n = shape.axis / half_height;
    vec3 f = origin - shape.center;
    shape_sight sight;
    sight.along = dot(f, n);
    vec3 across = f - sight.along * n;
    across -= dot(across, n) * n;
    float away = length(across);
    bool sees_side = away > radius;
    bool sees_cap = abs(sight.along) > half_height;
    sight.is_outside = sees_side || sees_cap;
    sight.place = sees_side ? across / away : vec3(0.0);
    // acos(radius / away), without cancellation near the side.
    sight.arc = sees_side ? atan_turns(sqrt((away - radius) * (away + radius)), radius) : 0.0;
    float cap = PI * radius * radius;
    sight.areas = vec3(8.0 * PI * half_height * radius * sight.arc, sees_cap ? cap : 0.0, 0.0);
    if (!sight.is_outside)
        sight.areas = vec3(4.0 * half_height * radius * PI, 2.0 * cap, 0.0);
    return sight;
}

// Returns the part of a shape of any kind that is visible from a point; only boxes and cylinders
// hide sides of their own.
shape_sight sight_of_shape(shape_record shape, vec3 origin)
{
    shape_sight sight;
    sight.is_outside = false;
    sight.areas = vec3(0.0);
    if (HAS_EMITTER(EMITTER_BOXES) && shape.kind == SHAPE_KIND_BOX)
        sight = box_sight(shape, origin);
    if (HAS_EMITTER(EMITTER_CYLINDERS) && shape.kind == SHAPE_KIND_CYLINDER)
        sight = cylinder_sight(shape, origin);
    return sight;
}

// Returns the area of a shape at which shadow rays from `origin` are aimed.
float shape_area_visible(shape_record shape, vec3 origin)
{
    if (HAS_EMITTER(EMITTERS_CONVEX) && is_convex_light(shape.kind))
        return dot(sight_of_shape(shape, origin).areas, vec3(1.0));
    return shape_area(shape);
}

// Returns the density, per unit of visible area, of selecting a point of a shape: from the
// selection probability `pick`, or, if emitters are selected by power, from its material.
float shape_density(shape_record shape, material m, float pick, vec3 origin)
{
    if (LIGHT_CHOICE != LIGHT_CHOICE_POWER)
        return pick / shape_area_visible(shape, origin);
    float density = material_pick_density(m);
    if (HAS_EMITTER(EMITTERS_CONVEX) && is_convex_light(shape.kind))
        density *= shape_area(shape) / shape_area_visible(shape, origin);
    return density;
}

// A point sampled uniformly on the visible part of a shape: relative to the centre, with the
// outward normal, and the data that a hit record would have (struct crossings).
struct shape_point {
    vec3 from_center;
    vec3 normal;
    vec2 at;
};

// Samples a quad uniformly by solid angle, or by area if the solid angle is 0.
shape_point sample_quad(shape_record shape, vec3 origin, vec2 u, out float solid_angle)
{
    float first;
    vec3 center = shape.center - origin;
    solid_angle = solid_angle_of_quad(center, shape.axis, shape.other, first);
    vec2 at = solid_angle > 0.0 ? sample_seen_quad(center, shape.axis, shape.other, first, u)
                                : 2.0 * u - 1.0;
    return shape_point(at.x * shape.axis + at.y * shape.other, quad_normal(shape), at);
}

// The first uniform selects the axis. Its remainder gives a coordinate on the face and, for points
// inside, the sign of the face as well.
shape_point sample_box(shape_record shape, vec3 origin, vec2 u)
{
    box_frame b = box_frame_of(shape.axis, shape.other, shape.radius);
    shape_sight sight = box_sight(shape, origin);
    vec3 areas = sight.areas;
    float pick = u.x * (areas.x + areas.y + areas.z);
    int k = pick < areas.x ? 0 : pick < areas.x + areas.y ? 1 : 2;
    pick -= k == 0 ? 0.0 : k == 1 ? areas.x : areas.x + areas.y;
    float within = clamp(2.0 * pick / areas[k] - 1.0, -1.0, 1.0);
    bool is_negative = (sight.is_outside ? sight.place[k] : within) < 0.0;
    float side = is_negative ? -1.0 : 1.0;
    within = sight.is_outside ? within : 2.0 * abs(within) - 1.0;
    int first = k == 2 ? 0 : k + 1;
    int second = 3 - k - first;
    vec3 along;
    along[k] = side * b.half_edges[k];
    along[first] = within * b.half_edges[first];
    along[second] = (2.0 * u.y - 1.0) * b.half_edges[second];
    vec3 point = along.x * b.axis[0] + along.y * b.axis[1] + along.z * b.axis[2];
    return shape_point(point, side * b.axis[k], vec2(side * float(k + 1), 0.0));
}

vec3 around(vec3 x, vec3 y, float turns)
{
    vec2 v = cos_sin_turns(turns);
    return v.x * x + v.y * y;
}

// Returns the point of a cylinder's side below which the area `pick` of the visible area `side`
// lies.
shape_point side_point(shape_record shape, vec3 outwards, float pick, float side)
{
    float along = min(2.0 * pick / side - 1.0, 1.0);
    return shape_point(shape.radius * outwards + along * shape.axis, outwards, vec2(0.0));
}

shape_point sample_tube(shape_record shape, vec2 u)
{
    float side = 2.0 * length(shape.axis); // in units of 2 pi r
    mat3 basis = basis_around(2.0 * shape.axis / side);
    return side_point(shape, around(basis[0], basis[1], u.y), u.x * side, side);
}

// The first uniform selects the side or one of the caps.
shape_point sample_cylinder(shape_record shape, vec3 origin, vec2 u)
{
    shape_sight sight = cylinder_sight(shape, origin);
    vec3 n = normalize(shape.axis);
    mat3 basis = basis_around(n);
    float side = sight.areas.x;
    float pick = u.x * (side + sight.areas.y);
    if (pick < side) {
        vec3 outwards =
            sight.is_outside
                ? around(sight.place, cross(n, sight.place), (2.0 * u.y - 1.0) * sight.arc)
                : around(basis[0], basis[1], u.y);
        return side_point(shape, outwards, pick, side);
    }
    float within = clamp((pick - side) / sight.areas.y, 0.0, 1.0);
    float end = sight.along < 0.0 ? -1.0 : 1.0;
    if (!sight.is_outside) {
        within = 2.0 * within - 1.0;
        end = within < 0.0 ? -1.0 : 1.0;
    }
    vec3 outwards = sqrt(abs(within)) * around(basis[0], basis[1], u.y);
    return shape_point(shape.radius * outwards + end * shape.axis, end * n, vec2(end, 0.0));
}

shape_point sample_shape(shape_record shape, vec3 origin, vec2 u, out float solid_angle)
{
    solid_angle = 0.0;
    shape_point p = shape_point(vec3(0.0), vec3(0.0, 0.0, 1.0), vec2(0.0));
    if (HAS_EMITTER(EMITTER_QUADS) && shape.kind == SHAPE_KIND_QUAD)
        p = sample_quad(shape, origin, u, solid_angle);
    if (HAS_EMITTER(EMITTER_BOXES) && shape.kind == SHAPE_KIND_BOX)
        p = sample_box(shape, origin, u);
    if (HAS_EMITTER(EMITTER_CYLINDERS) && shape.kind == SHAPE_KIND_CYLINDER)
        p = sample_cylinder(shape, origin, u);
    if (HAS_EMITTER(EMITTER_TUBES) && shape.kind == SHAPE_KIND_TUBE)
        p = sample_tube(shape, u);
    return p;
}

#define EMITTERS_SOLID (EMITTERS_CONVEX | EMITTER_TUBES)

// Returns whether an open cylinder hides a point on it from another point. Shadow rays do not test
// this, because they ignore the shape at their end.
bool hides_itself(shape_record tube, vec3 point, vec3 towards)
{
    float t = intersect_tube(point, towards, tube.center, tube.axis, tube.radius, true).first;
    return t > 0.0 && t < 1.0;
}

// Samples a sphere: seen from outside, uniformly in the cone that it fills, on its near side; from
// inside, by area.
void sample_sphere_light(vec3 origin, vec3 center, float radius, material m, float density, vec2 u,
                         inout light_sample l)
{
    vec3 to_center = center - origin;
    float distance2 = dot(to_center, to_center);
    float sin2_max = sphere_sin2(origin, center, radius);
    if (sin2_max < 1.0) {
        float distance = sqrt(distance2);
        float one_minus_cos = u.x * sphere_cone(sin2_max);
        float cos_theta = 1.0 - one_minus_cos;
        float sin2_theta = one_minus_cos * (2.0 - one_minus_cos);
        vec3 local = vec3(sqrt(sin2_theta) * cos_sin_turns(u.y), cos_theta);
        float half_chord = sqrt(max(0.0, radius * radius - distance2 * sin2_theta));
        float reach = distance * cos_theta - half_chord;
        vec3 direction = basis_around(to_center / distance) * local;
        if (HAS_GEOMETRY(GEOMETRY_LARGE_SPHERES)) {
            vec2 t;
            bool met = intersect_large_sphere(origin, direction, center, radius, false, t);
            reach = met ? t.x : distance * cos_theta;
        }
        l.to_light = direction * reach;
        l.pdf = pdf_sphere_cone(radius, sin2_max, density);
        l.radiance = material_emission(m);
    } else {
        vec3 normal = sample_sphere(u);
        finish_area_sample(l, to_center + radius * normal, normal, m, density);
    }
}

void sample_shape_light(vec3 origin, uint index, float pick, vec2 u, inout light_sample l)
{
    shape_record shape = load_shape(index);
    material m = load_material(shape.word);
    float density = shape_density(shape, m, pick, origin);
    l.material = shape.word;
    if (HAS_EMITTER(EMITTER_SPHERES) && shape.kind == SHAPE_KIND_SPHERE)
        sample_sphere_light(origin, shape.center, shape.radius, m, density, u, l);
    if (HAS_EMITTER(EMITTER_DISCS) && shape.kind == SHAPE_KIND_DISC) {
        vec2 d = shape.radius * sample_disc(u);
        mat3 basis = basis_around(shape.axis);
        finish_area_sample(l, shape.center + basis[0] * d.x + basis[1] * d.y - origin, shape.axis,
                           m, density);
    }
    bool is_solid = HAS_EMITTER(EMITTERS_SOLID) && shape.kind >= SHAPE_KIND_BOX;
    if (is_solid || (HAS_EMITTER(EMITTER_QUADS) && shape.kind == SHAPE_KIND_QUAD)) {
        float solid_angle;
        shape_point p = sample_shape(shape, origin, u, solid_angle);
        l.barycentrics = p.at;
        finish_area_sample(l, shape.center - origin + p.from_center, p.normal, m, density);
        if (HAS_EMITTER(EMITTER_QUADS) && solid_angle > 0.0)
            l.pdf = density * shape_area(shape) / solid_angle;
        bool is_tube = HAS_EMITTER(EMITTER_TUBES) && shape.kind == SHAPE_KIND_TUBE;
        if (is_tube && hides_itself(shape, shape.center + p.from_center, -l.to_light))
            l.pdf = 0.0;
    }
}

// Returns whether a point of an emissive shape is never sampled by shadow rays from `origin`, so
// that a scattered ray that hits it has an MIS weight of 1: on shapes that cannot be sampled, and
// behind the near side of those with opacity below 1.
bool is_found_by_chance(vec3 origin, uint primitive, surface s)
{
    bool by_chance = false;
    bool asks = HAS(FEATURE_ALPHA) || HAS_GEOMETRY(GEOMETRY_PLANES | GEOMETRY_SDFS);
    if (asks && IS_SHAPE(primitive)) {
        uint index = primitive & ~PRIMITIVE_SHAPE;
        uint kind = load_shapes(index * SHAPE_WORDS + 1u).w >> SHAPE_KIND_SHIFT;
        by_chance = IS_KIND(kind, SHAPE_KIND_PLANE) || IS_KIND(kind, SHAPE_KIND_SDF);
        if (HAS(FEATURE_ALPHA) && (s.material & MATERIAL_WORD_ALPHA) != 0u) {
            if (HAS_EMITTER(EMITTER_SPHERES) && kind == SHAPE_KIND_SPHERE)
                by_chance = !s.front && sphere_sin2(origin, s.center, s.radius) < 1.0;
            if (HAS_EMITTER(EMITTERS_CONVEX) && is_convex_light(kind))
                by_chance = !s.front && sight_of_shape(load_shape(index), origin).is_outside;
            if (HAS_EMITTER(EMITTER_TUBES) && kind == SHAPE_KIND_TUBE)
                by_chance = hides_itself(load_shape(index), s.position, origin - s.position);
        }
    }
    return by_chance;
}

#endif
