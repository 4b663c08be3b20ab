// Computes the surface point of a hit on a shape.
#ifndef SHAPE_SURFACE_GLSL
#define SHAPE_SURFACE_GLSL

#include "lib/sampling.glsl"
#include "lib/sdf_surface.glsl"
#include "lib/shape_record.glsl"
#include "lib/surface_types.glsl"

// --- parametrisations ----------------------------------------------------------------------------
// The texture's u increases to the right and its v downwards, as seen from outside or from the
// front.

// Returns texture coordinates on a sphere, from the direction `n` from its centre. The image goes
// around the sphere once, and is upright as seen from outside; its middle is at +z of the world,
// its top at +y.
vec2 sphere_uv(vec3 n)
{
    return vec2(0.5 + atan_turns(n.x, n.z), 2.0 * atan_turns(length(n.xz), n.y));
}

// Returns the unit tangent in the direction of increasing u; at the poles, where it is undefined,
// an arbitrary tangent.
vec3 sphere_tangent(vec3 n)
{
    float across = length(n.xz);
    return across > 0.0 ? vec3(n.z, 0.0, -n.x) / across : vec3(1.0, 0.0, 0.0);
}

// Returns texture coordinates on a disc, which shows the inscribed circle of the image. u increases
// along the first axis of basis_around(), v against the second.
vec2 disc_uv(mat3 basis, vec3 from_center, float radius)
{
    return 0.5 + 0.5 / radius * vec2(dot(from_center, basis[0]), -dot(from_center, basis[1]));
}

void place_on_sphere(inout surface s)
{
    if (HAS(FEATURE_TEXTURES))
        s.uv0 = sphere_uv(s.normal_geometric);
    if (HAS_TANGENT)
        s.tangent = vec4(sphere_tangent(s.normal_geometric), 1.0);
}

void place_on_disc(shape_record shape, inout surface s)
{
    mat3 basis = basis_around(s.normal_geometric);
    if (HAS(FEATURE_TEXTURES))
        s.uv0 = disc_uv(basis, s.position - s.center, shape.radius);
    if (HAS_TANGENT)
        s.tangent = vec4(basis[0], 1.0);
}

// A plane shows an image on every square metre. `center` is the lower left corner of one image, and
// the images' lower edges are along `right`.
void place_on_plane(vec3 right, inout surface s)
{
    vec3 f = (s.position - s.center) * frame.metre;
    s.uv0 = vec2(dot(f, right), -dot(f, cross(s.normal_geometric, right)));
    s.tangent = vec4(right, 1.0);
}

// On a quad, u increases along the first edge, and the top of the image is at the end of the second
// edge. at: a and b of intersect_quad().
void place_on_quad(shape_record shape, vec2 at, inout surface s)
{
    s.uv0 = vec2(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y);
    if (HAS_TANGENT)
        s.tangent = vec4(normalize(shape.axis), 1.0);
}

// A box shows an image on each face. If the axes are x, y and z, the sides show it upright, the top
// with its upper edge at -z, the bottom with its upper edge at +z. along: coordinates of the point
// along the axes.
void place_on_box(box_frame b, float face, vec3 along, inout surface s)
{
    int k = int(abs(face)) - 1;
    float side = face < 0.0 ? -1.0 : 1.0;
    int right = k == 0 ? 2 : 0;
    int up = k == 1 ? 2 : 1;
    float right_sign = k == 0 ? -side : k == 1 ? 1.0 : side;
    float up_sign = k == 1 ? -side : 1.0;
    s.uv0 = 0.5 + 0.5 * vec2(right_sign * along[right] / b.half_edges[right],
                             -up_sign * along[up] / b.half_edges[up]);
    s.tangent = vec4(right_sign * b.axis[right], 1.0);
}

// The side of a cylinder shows one image, which begins at `across`, is upright as seen from
// outside, and has its top at the end of the half axis. Each cap shows the inscribed circle of an
// image, the top one with its upper edge towards `across`, the bottom one with its lower edge, as
// if both were folded away from the front.
void place_on_cylinder(shape_record shape, vec3 across, float face, float along, inout surface s)
{
    float half_height = length(shape.axis);
    vec3 n = shape.axis / half_height;
    vec3 f = s.position - s.center;
    vec3 right = cross(across, n);
    if (face == 0.0) {
        float turn = atan_turns(-dot(f, right), dot(f, across));
        s.uv0 = vec2(turn < 0.0 ? turn + 1.0 : turn, 0.5 - 0.5 * along / half_height);
        s.tangent = vec4(cross(n, s.normal_geometric), 1.0);
    } else {
        vec3 up = face > 0.0 ? across : -across;
        s.uv0 = 0.5 + 0.5 / shape.radius * vec2(dot(f, right), -dot(f, up));
        s.tangent = vec4(right, 1.0);
    }
}

// --- points --------------------------------------------------------------------------------------

// Sets a point on a plane through the shape's centre, from a point near that plane.
void surface_of_plane(vec3 point, vec3 normal, inout surface s)
{
    s.normal_geometric = normal;
    vec3 height = dot(point - s.center, normal) * normal;
    s.position = point - height;
    s.error = GAMMA(7) * (abs(point) + abs(s.center) + abs(height));
}

void surface_of_sphere(vec3 point, float radius, inout surface s)
{
    // For the smallest spheres far from the origin, rounding may leave only the centre.
    vec3 f = point - s.center;
    s.normal_geometric = dot(f, f) > 0.0 ? normalize(f) : vec3(0.0, 1.0, 0.0);
    s.radius = radius;
    if (HAS_GEOMETRY(GEOMETRY_LARGE_SPHERES)) {
        // Moves the point onto the sphere. The remaining error is the rounding of the sum and of
        // the height, and that of the double-float arithmetic.
        vec3 height = sphere_height(point, s.center, radius) * s.normal_geometric;
        s.position = point - height;
        s.error = GAMMA(2) * abs(s.position) + GAMMA(12) * abs(height) +
                  2.8421709e-14 * radius * abs(s.normal_geometric);
    } else {
        // Projects the point back onto the sphere. The remaining error is the rounding of normalize
        // (4), scaling and addition.
        s.position = s.center + radius * s.normal_geometric;
        s.error = GAMMA(7) * (abs(s.center) + radius * abs(s.normal_geometric));
    }
}

// Returns a bound on the error of points that were moved by `shift` to a face at `distance` from
// the centre. The distance of the point from the centre along the normal has 10 roundings,
// including those of the normal; the distance of the face has 8.
vec3 error_of_face(vec3 point, vec3 center, vec3 shift, vec3 normal, float distance)
{
    return GAMMA(16) * (abs(point) + abs(center) + abs(shift)) + GAMMA(8) * distance * abs(normal);
}

// Returns the axis of the face on which a point is, if the hit record does not have it.
int box_face_at(vec3 along, vec3 half_edges)
{
    vec3 height = abs(along) - half_edges;
    return height.x >= height.y ? (height.x >= height.z ? 0 : 2) : (height.y >= height.z ? 1 : 2);
}

vec3 along_box(box_frame b, vec3 f)
{
    return vec3(dot(f, b.axis[0]), dot(f, b.axis[1]), dot(f, b.axis[2]));
}

// A point that rounding has moved beyond an edge is moved back.
void surface_of_box(vec3 point, shape_record shape, float face, inout surface s)
{
    box_frame b = box_frame_of(shape.axis, shape.other, shape.radius);
    vec3 along = along_box(b, point - s.center);
    int k = int(abs(face)) - 1;
    float side = face < 0.0 ? -1.0 : 1.0;
    vec3 moved = clamp(along, -b.half_edges, b.half_edges);
    moved[k] = side * b.half_edges[k];
    vec3 change = moved - along;
    vec3 shift = change.x * b.axis[0] + change.y * b.axis[1] + change.z * b.axis[2];
    s.normal_geometric = side * b.axis[k];
    s.position = point + shift;
    s.error = error_of_face(point, s.center, shift, b.axis[k], b.half_edges[k]);
    if (HAS(FEATURE_TEXTURES) || HAS_TANGENT)
        place_on_box(b, face, moved, s);
}

// along: the surface point's position along the axis.
void surface_of_cylinder(vec3 point, shape_record shape, float face, out float along,
                         inout surface s)
{
    float half_height = length(shape.axis);
    vec3 n = shape.axis / half_height;
    vec3 f = point - s.center;
    float height = dot(f, n);
    vec3 across = f - height * n;
    across -= dot(across, n) * n; // corrects the error of the first subtraction, which is large for
                                  // thin cylinders
    float away = length(across);
    vec3 outwards = away > 0.0 ? across / away : basis_around(n)[0];
    along = clamp(height, -half_height, half_height);
    vec3 shift;
    if (face == 0.0) {
        s.normal_geometric = outwards;
        shift = (shape.radius - away) * outwards + (along - height) * n;
        s.error = error_of_face(point, s.center, shift, outwards, shape.radius + abs(height));
    } else {
        s.normal_geometric = face < 0.0 ? -n : n;
        along = face < 0.0 ? -half_height : half_height;
        shift = (along - height) * n + min(shape.radius - away, 0.0) * outwards;
        s.error = error_of_face(point, s.center, shift, n, half_height);
    }
    s.position = point + shift;
}

vec3 quad_normal(shape_record shape)
{
    return normalize(cross(normalize(shape.axis), normalize(shape.other)));
}

void surface_of_quad(shape_record shape, vec2 at, inout surface s)
{
    vec3 u = at.x * shape.axis;
    vec3 v = at.y * shape.other;
    s.normal_geometric = quad_normal(shape);
    s.position = s.center + u + v;
    s.error = GAMMA(7) * (abs(s.center) + abs(u) + abs(v));
}

// Returns the normal, of either sign, at the point where a ray starts on a shape.
vec3 shape_normal_at(shape_record shape, vec3 point)
{
    vec3 normal = shape.axis; // normal of discs and planes
    vec3 f = point - shape.center;
    if (IS_KIND(shape.kind, SHAPE_KIND_SPHERE))
        normal = normalize(f);
    if (IS_KIND(shape.kind, SHAPE_KIND_QUAD))
        normal = quad_normal(shape);
    if (IS_KIND(shape.kind, SHAPE_KIND_BOX)) {
        box_frame b = box_frame_of(shape.axis, shape.other, shape.radius);
        normal = b.axis[box_face_at(along_box(b, f), b.half_edges)];
    }
    if (IS_KIND(shape.kind, SHAPE_KIND_CYLINDER) || IS_KIND(shape.kind, SHAPE_KIND_TUBE)) {
        float half_height = length(shape.axis);
        vec3 n = shape.axis / half_height;
        float along = dot(f, n);
        vec3 across = f - along * n;
        bool on_cap = shape.kind == SHAPE_KIND_CYLINDER &&
                      abs(along) - half_height > length(across) - shape.radius;
        normal = on_cap ? n : normalize(across);
    }
    return normal;
}

// Returns the surface at a point of a shape. at: the data that the hit record has besides the
// distance, see struct crossings. Shapes have one set of texture coordinates, and no vertex
// colours.
surface load_shape_surface(uint index, vec3 point, vec2 at)
{
    shape_record shape = load_shape(index);
    surface s;
    s.material = shape.word;
    s.center = shape.center;
    s.radius = 0.0;
    s.uv0 = vec2(0.0);
    s.color = vec4(1.0);
    s.tangent = vec4(0.0);
    if (IS_KIND(shape.kind, SHAPE_KIND_SPHERE)) {
        surface_of_sphere(point, shape.radius, s);
        place_on_sphere(s);
    }
    if (IS_KIND(shape.kind, SHAPE_KIND_DISC)) {
        surface_of_plane(point, shape.axis, s);
        place_on_disc(shape, s);
    }
    if (IS_KIND(shape.kind, SHAPE_KIND_PLANE)) {
        surface_of_plane(point, shape.axis, s);
        if (HAS(FEATURE_TEXTURES) || HAS_TANGENT)
            place_on_plane(load_shape_across(index), s);
    }
    if (IS_KIND(shape.kind, SHAPE_KIND_QUAD)) {
        surface_of_quad(shape, at, s);
        place_on_quad(shape, at, s);
    }
    if (IS_KIND(shape.kind, SHAPE_KIND_BOX))
        surface_of_box(point, shape, at.x, s);
    if (IS_KIND(shape.kind, SHAPE_KIND_CYLINDER) || IS_KIND(shape.kind, SHAPE_KIND_TUBE)) {
        float along;
        surface_of_cylinder(point, shape, at.x, along, s);
        if (HAS(FEATURE_TEXTURES) || HAS_TANGENT)
            place_on_cylinder(shape, load_shape_across(index), at.x, along, s);
    }
    if (IS_KIND(shape.kind, SHAPE_KIND_SDF))
        load_sdf_surface(index, point, s);
    s.normal_shading = s.normal_geometric;
    s.uv1 = s.uv0;
    return s;
}

#endif
