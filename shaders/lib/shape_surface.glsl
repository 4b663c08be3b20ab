// The point of a shape that a hit record stands for.
#ifndef SHAPE_SURFACE_GLSL
#define SHAPE_SURFACE_GLSL

#include "lib/sampling.glsl"
#include "lib/sdf_surface.glsl"
#include "lib/shape_record.glsl"
#include "lib/surface_types.glsl"

// --- parametrisations ----------------------------------------------------------------------------
// A picture has u to its right and v downwards, and reads from outside or from the front.

// Texture coordinates of a sphere, of the direction from its centre: the picture goes round it once
// and reads from outside; its middle faces +z of the world, its top +y.
vec2 sphere_uv(vec3 n)
{
    return vec2(0.5 + atan_turns(n.x, n.z), 2.0 * atan_turns(length(n.xz), n.y));
}

// The unit tangent along which u grows; at the poles, where there is none, any direction.
vec3 sphere_tangent(vec3 n)
{
    float across = length(n.xz);
    return across > 0.0 ? vec3(n.z, 0.0, -n.x) / across : vec3(1.0, 0.0, 0.0);
}

// Texture coordinates of a disc. It shows the image's inscribed circle; u grows along the first
// axis of basis_around(), v against the second.
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

// A plane has a picture for every square metre; `center` is a lower left corner of one, its lower
// edge along `right`.
void place_on_plane(vec3 right, inout surface s)
{
    vec3 f = (s.position - s.center) * frame.metre;
    s.uv0 = vec2(dot(f, right), -dot(f, cross(s.normal_geometric, right)));
    s.tangent = vec4(right, 1.0);
}

// A quad: u along its first edge, the top of the picture at the end of the second. a and b as of
// intersect_quad().
void place_on_quad(shape_record shape, vec2 at, inout surface s)
{
    s.uv0 = vec2(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y);
    if (HAS_TANGENT)
        s.tangent = vec4(normalize(shape.axis), 1.0);
}

// A box: a picture for each face. With axes along x, y and z the sides show it upright, the top with
// its upper edge at -z, the bottom at +z. `along`: the point's place along the box's axes.
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

// A cylinder: the side has one picture, which begins at `across`, reads from outside and has its top
// at the end of the half axis. Each cap shows a picture's largest circle, the top one with its upper
// edge towards `across`, the bottom one with its lower edge, as if they were folded away from the
// front.
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

// A point of a plane through the shape's centre, from one near it.
void surface_of_plane(vec3 point, vec3 normal, inout surface s)
{
    s.normal_geometric = normal;
    vec3 height = dot(point - s.center, normal) * normal;
    s.position = point - height;
    s.error = GAMMA(7) * (abs(point) + abs(s.center) + abs(height));
}

void surface_of_sphere(vec3 point, float radius, inout surface s)
{
    // Rounding leaves nothing but the centre of the smallest spheres, far from the origin.
    vec3 f = point - s.center;
    s.normal_geometric = dot(f, f) > 0.0 ? normalize(f) : vec3(0.0, 1.0, 0.0);
    s.radius = radius;
    if (HAS_GEOMETRY(GEOMETRY_LARGE_SPHERES)) {
        // Moved onto the sphere: what is left is the rounding of the sum, of the height, and what
        // double precision of sorts rounds.
        vec3 height = sphere_height(point, s.center, radius) * s.normal_geometric;
        s.position = point - height;
        s.error = GAMMA(2) * abs(s.position) + GAMMA(12) * abs(height) +
                  2.8421709e-14 * radius * abs(s.normal_geometric);
    } else {
        // Projected back onto the sphere: what is left is the rounding of normalize (4), scaling
        // and addition.
        s.position = s.center + radius * s.normal_geometric;
        s.error = GAMMA(7) * (abs(s.center) + radius * abs(s.normal_geometric));
    }
}

// A bound of the error of points that were moved by `shift` to a face at `distance` from the
// centre: the distance of the point from the centre along the normal has 10 roundings, among them
// those of the normal, and that of the face 8.
vec3 error_of_face(vec3 point, vec3 center, vec3 shift, vec3 normal, float distance)
{
    return GAMMA(16) * (abs(point) + abs(center) + abs(shift)) + GAMMA(8) * distance * abs(normal);
}

// The axis of the face that a point is on, where nobody kept it.
int box_face_at(vec3 along, vec3 half_edges)
{
    vec3 height = abs(along) - half_edges;
    return height.x >= height.y ? (height.x >= height.z ? 0 : 2) : (height.y >= height.z ? 1 : 2);
}

vec3 along_box(box_frame b, vec3 f)
{
    return vec3(dot(f, b.axis[0]), dot(f, b.axis[1]), dot(f, b.axis[2]));
}

// A point that rounding put beyond an edge is moved back to it.
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

// `along`: of the point that was moved to the surface, on the axis.
void surface_of_cylinder(vec3 point, shape_record shape, float face, out float along,
                         inout surface s)
{
    float half_height = length(shape.axis);
    vec3 n = shape.axis / half_height;
    vec3 f = point - s.center;
    float height = dot(f, n);
    vec3 across = f - height * n;
    across -= dot(across, n) * n; // of needles the first one's rounding is not little
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

// The normal outwards where a ray that starts on a shape does so.
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

// `at`: what the hit record keeps besides the distance, see struct crossings. Shapes have one set of
// texture coordinates, and no colours.
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
