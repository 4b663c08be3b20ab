// Samples the first vertex of light paths: a point on an emitter, which is selected by power, and a
// direction. Also computes the densities of both.
#ifndef EMIT_GLSL
#define EMIT_GLSL

#include "lib/bidir.glsl"
#include "lib/light.glsl"
#include "lib/ray_offset.glsl"
#include "lib/vertex.glsl"

// Returns E of lib/bidir.glsl for a point of a surface: the density per unit of area of selecting
// it, times the density per unit of projected solid angle of the direction, which is a cosine lobe
// on either side. It is 0 if no light path begins there.
float emission_density(uint primitive, uint word, material m)
{
    if (IS_SHAPE(primitive)) {
        uint index = primitive & ~PRIMITIVE_SHAPE;
        uint kind = load_shapes(index * SHAPE_WORDS + 1u).w >> SHAPE_KIND_SHIFT;
        // Shadow rays do not sample all points of a shape with opacity below 1: see
        // is_found_by_chance().
        bool may_be_absent = HAS(FEATURE_ALPHA) && (word & MATERIAL_WORD_ALPHA) != 0u;
        if (may_be_absent || IS_KIND(kind, SHAPE_KIND_PLANE) || IS_KIND(kind, SHAPE_KIND_SDF))
            return 0.0;
    }
    return material_pick_density(m) * 0.5 * INV_PI;
}

// Returns the versine (1 - cos) of the cone into which a delta light emits. Point lights emit into
// all directions, whose versine is 2.
float emission_versine(uint light)
{
    uint at = lights_begin() + light * LIGHT_WORDS;
    vec4 w3 = load_materials_float(at + 3u);
    bool is_spot = load_materials(at).w == LIGHT_SPOT;
    return is_spot ? min(w3.y / w3.x, 2.0) : 2.0;
}

// Returns E / p of lib/bidir.glsl for a point that a shadow ray in the unit direction `wi` samples.
float emission_over_pdf(vertex v, vec3 wi, light_sample l)
{
    bool is_far = HAS_EMITTER(EMITTERS_LIGHTS | EMITTER_ENVIRONMENT) && l.infinite;
    if (is_far)
        return reach_of_far(v.s.position, wi);
    if (HAS_EMITTER(EMITTER_LIGHTS) && l.delta)
        return pdf_sun(emission_versine(l.primitive & ~PRIMITIVE_LIGHT)) /
               dot(l.to_light, l.to_light);
    return emission_density(l.primitive, l.material, load_material(l.material)) / l.pdf;
}

struct light_start {
    vec3 origin;
    vec3 direction;
    vec3 power;     // radiance / E, or the corresponding quantity of other emitters
    uint primitive; // primitive on which the path starts, or NO_PRIMITIVE
    // Arguments of light_ratios(). On a surface: the cosine, and E. At a point: 0, and the density
    // of the direction. Infinitely far away: -A, and A / p, where A is the area of the disc; for a
    // delta light, 0 in place of A / p.
    float first, second;
    bool valid;
};

// Returns a uniformly distributed point on a shape. sample_shape() samples the part of a shape that
// a point sees; from its own centre that is the whole shape.
vec3 sample_whole_shape(shape_record shape, vec2 u, out vec2 at)
{
    at = vec2(0.0);
    if (HAS_EMITTER(EMITTER_SPHERES) && shape.kind == SHAPE_KIND_SPHERE)
        return shape.center + shape.radius * sample_sphere(u);
    if (HAS_EMITTER(EMITTER_DISCS) && shape.kind == SHAPE_KIND_DISC) {
        vec2 d = shape.radius * sample_disc(u);
        mat3 basis = basis_around(shape.axis);
        return shape.center + basis[0] * d.x + basis[1] * d.y;
    }
    if (HAS_EMITTER(EMITTER_QUADS) && shape.kind == SHAPE_KIND_QUAD) {
        at = 2.0 * u - 1.0;
        return shape.center + at.x * shape.axis + at.y * shape.other;
    }
    float solid_angle;
    shape_point p = sample_shape(shape, shape.center, u, solid_angle);
    at = p.at;
    return shape.center + p.from_center;
}

// Starts a light path on a triangle or a shape. u: selects the point; u_direction: direction x, y,
// and side.
void start_on_surface(vec2 u, vec4 u_direction, inout light_start l)
{
    bool is_shape = HAS_EMITTER(EMITTERS_SHAPES) && IS_SHAPE(l.primitive);
    surface s;
    vec2 at;
    if (HAS_EMITTER(EMITTER_TRIANGLES) && !is_shape) {
        at = sample_triangle(u);
        s = load_triangle_surface(l.primitive, at, NO_INSTANCE);
    }
    if (is_shape) {
        uint index = l.primitive & ~PRIMITIVE_SHAPE;
        vec3 point = sample_whole_shape(load_shape(index), u, at);
        s = load_shape_surface(index, point, at);
    }
    material m = load_material(s.material);
    vec3 local = sample_cosine_hemisphere(u_direction.xy);
    vec3 normal = u_direction.z < 0.5 ? s.normal_geometric : -s.normal_geometric;
    l.direction = normalize(basis_around(normal) * local);
    l.origin = offset_origin(s.position, s.error, s.normal_geometric, l.direction);
    l.first = local.z;
    l.second = emission_density(l.primitive, s.material, m);
    l.valid = l.first > 0.0 && l.second > 0.0;
    vec3 radiance = HAS(FEATURE_TEXTURES) ? textured_emission(m, s) : material_emission(m);
    if (HAS(FEATURE_ALPHA) && (s.material & MATERIAL_WORD_ALPHA) != 0u)
        radiance *= alpha_probability(l.primitive, at, s.position, s.material);
    l.power = radiance / l.second;
}

// Starts a light path on the disc in front of the scene. pdf: the probability of selecting the
// emitter times, if it is not a delta light, the density per solid angle of the direction. density:
// the disc's area / pdf; 0 for a delta light, which camera paths cannot hit.
void start_far(vec3 towards, vec3 radiance, float pdf, float density, vec2 u, inout light_start l)
{
    float area = PI * frame.scene_radius * frame.scene_radius;
    vec3 local = frame.scene_radius * vec3(sample_disc(u), 1.0);
    l.origin = frame.scene_center + basis_around(towards) * local;
    l.direction = -towards;
    l.power = radiance * (area / pdf);
    l.primitive = NO_PRIMITIVE;
    l.first = -area;
    l.second = density;
    l.valid = pdf > 0.0;
}

// Starts a light path at a delta light or a sun.
void start_at_light(vec2 u, vec2 u_direction, inout light_start l)
{
    uint light = l.primitive & ~PRIMITIVE_LIGHT;
    uint at = lights_begin() + light * LIGHT_WORDS;
    uvec4 w0 = load_materials(at);
    vec4 w1 = load_materials_float(at + 1u);
    vec3 radiant = load_materials_float(at + 2u).rgb;
    vec4 w3 = load_materials_float(at + 3u);
    if (w0.w == LIGHT_DIRECTIONAL) {
        vec3 towards = -w1.xyz;
        float pdf = w1.w;
        bool is_sun = HAS_EMITTER(EMITTER_SUNS) && w3.w > 0.0;
        if (is_sun) {
            pdf *= sample_sun(-w1.xyz, w3.w, u, towards);
            radiant = sun_radiance(radiant, w3.w);
        }
        float area = PI * frame.scene_radius * frame.scene_radius;
        start_far(towards, radiant, pdf, is_sun ? area / pdf : 0.0, u_direction, l);
        return;
    }
    bool is_spot = w0.w == LIGHT_SPOT;
    vec3 axis = is_spot ? w1.xyz : vec3(0.0, 0.0, 1.0);
    l.second = sample_sun(axis, emission_versine(light), u_direction, l.direction);
    if (is_spot)
        radiant *= spot_falloff(w1.xyz, l.direction, w3.x, w3.y);
    if (HAS_EMITTER(EMITTER_PROFILES)) {
        uvec4 w4 = load_materials(at + 4u);
        if (w4.w != 0u)
            radiant *= profile_intensity(w4.w, w1.xyz, uintBitsToFloat(w4.xyz), l.direction);
    }
    l.origin = uintBitsToFloat(w0.xyz);
    l.power = radiant / (w1.w * l.second);
    l.primitive = NO_PRIMITIVE;
    l.first = 0.0;
    l.valid = w1.w > 0.0;
}

// Starts a light path. u: selects the emitter; the point on it, x, y; more bits for the emitter.
// u_direction: the direction x, y (or the point on the disc); the side of the surface.
light_start start_light_path(vec4 u, vec4 u_direction)
{
    light_start l;
    l.primitive = choose_light(receiver(vec3(0.0), vec3(0.0), false), u.xw).primitive;
    l.valid = false;
    bool is_light = HAS_EMITTER(EMITTERS_LIGHTS) && (l.primitive & PRIMITIVE_LIGHT) != 0u;
    bool is_environment = HAS_EMITTER(EMITTER_ENVIRONMENT) && l.primitive == PRIMITIVE_ENVIRONMENT;
    if (HAS_EMITTER(EMITTER_TRIANGLES | EMITTERS_SHAPES) && !is_light && !is_environment)
        start_on_surface(u.yz, u_direction, l);
    if (is_light)
        start_at_light(u.yz, u_direction.xy, l);
    if (is_environment) {
        light_sample far;
        sample_environment_light(frame.environment_pick, u.yz, far);
        float area = PI * frame.scene_radius * frame.scene_radius;
        start_far(normalize(far.to_light), far.radiance, far.pdf, area / far.pdf, u_direction.xy,
                  l);
    }
    return l;
}

// Returns, at the first vertex of a light path after the emitter, the densities with which a shadow
// ray from there would sample the emitter, and with which a camera path that continues from there
// with density 1 would hit it, both divided by E.
vec2 light_ratios(vertex v, uint from, float distance, float first, float second)
{
    if (first < 0.0)
        return vec2(-first, second);
    if (first == 0.0)
        return vec2(distance * distance / second, 0.0);
    vec3 here = offset_origin(v.s.position, v.s.error, v.s.normal_geometric, v.view);
    bool is_shape = HAS_EMITTER(EMITTERS_SHAPES) && IS_SHAPE(from);
    float radius = 0.0;
    vec3 center = vec3(0.0);
    uint word = 0u;
    if (HAS_EMITTER(EMITTER_TRIANGLES) && !is_shape)
        word = load_triangle(from).word;
    if (is_shape) {
        shape_record shape = load_shape(from & ~PRIMITIVE_SHAPE);
        word = shape.word;
        center = shape.center;
        radius = IS_KIND(shape.kind, SHAPE_KIND_SPHERE) ? shape.radius : 0.0;
    }
    float pick_density = pick_density_at(load_material(word), from, here, v.view, v.primitive,
                                         v.instance);
    float pdf = pdf_light_at(here, distance, first, radius, center, from, pick_density);
    return vec2(pdf, 1.0) / second;
}

#endif
