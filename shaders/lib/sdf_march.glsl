// Traces rays through the box of a signed distance field, by sphere tracing (Hart 1996).
#ifndef SDF_MARCH_GLSL
#define SDF_MARCH_GLSL

#include "lib/sdf.glsl"
#include "lib/trace_types.glsl"

// A ray in a field's own space. Distances along it are metres of the field from where the ray
// enters the box, so that their rounding errors are relative to the box, not to the distance of the
// ray's origin.
struct sdf_ray {
    vec3 entry, direction; // direction: unit
    float begin, end;      // distances from the origin to where the ray enters and leaves the box
    float per_metre;       // units of t per metre
};

// The box is enlarged by the rounding errors of the origin and of the distances.
sdf_ray sdf_ray_create(trace_ray ray, sdf_field f, float t_max)
{
    sdf_ray r;
    vec3 from = ray.origin - sdf_origin(f);
    vec3 origin = sdf_to_object(f, from);
    vec3 along = sdf_to_object(f, ray.direction);
    float metres = length(along);
    r.direction = along / metres;
    r.per_metre = 1.0 / metres;
    // A direction component of 0 is replaced by 1e-30.
    vec3 steep = mix(r.direction, vec3(1e-30), lessThan(abs(r.direction), vec3(1e-30)));
    float margin = GAMMA(16) * (max3(abs(origin)) + f.magnitude);
    vec3 low = (f.low - origin - margin) / steep;
    vec3 high = (f.high - origin + margin) / steep;
    vec3 near = min(low, high), far = max(low, high);
    r.begin = max(max3(near), 0.0);
    r.end = min(min(far.x, min(far.y, far.z)), t_max * metres);
    r.entry = origin + r.begin * r.direction;
    return r;
}

// Up to this distance, in multiples of the field's error, a ray that has just left a surface is
// inside its own rounding error.
const float SDF_NEAR = 64.0;

// Marches from `march` to the nearest crossing of the surface of shape `index` before t_max; stores
// its distance, or a negative number, in `t`. Returns false if the iteration budget is used up
// before; `march` is then the position reached: metres from where the ray entered the box, with the
// sign of the field there. It is 0 at the beginning, and when the march is complete.
//
// The surface is reached when the distance, on the ray's side, is below its rounding error. So
// every step is longer than that, and all marches end. Rays that start on this shape start at a
// greater distance (load_sdf_surface). At creases and on fractals this may fail; near their origin,
// such rays therefore reach the surface only where the sign of the distance certainly differs.
bool march_sdf(trace_ray ray, uint index, float t_max, inout float march, inout uint iterations,
               out float t)
{
    sdf_field f = load_sdf(sdf_number(index));
    sdf_ray r = sdf_ray_create(ray, f, t_max);
    float error = sdf_error(f);
    bool begins_here = (PRIMITIVE_SHAPE | index) == ray.ignore_a;
    float x = abs(march);
    float side = march < 0.0 ? -1.0 : 1.0;
    bool begun = march != 0.0;
    bool hit = false, more = x <= r.end - r.begin;
    sdf_rounds = 0u;
    uint budget = ITERATION_BUDGET - min(iterations, ITERATION_BUDGET - 1u);
    while (more && sdf_rounds < budget) {
        sdf_rounds++;
        float d = sdf_value(f.first, f.count, r.entry + x * r.direction);
        if (!begun)
            side = d < 0.0 ? -1.0 : 1.0;
        begun = true;
        bool near = begins_here && r.begin + x <= SDF_NEAR * error;
        hit = side * d <= (near ? -error : error);
        x += hit ? 0.0 : max(abs(d), error);
        more = !hit && x <= r.end - r.begin && abs(d) < 3e38;
    }
    iterations += sdf_rounds;
    t = hit ? (r.begin + x) * r.per_metre : -1.0;
    march = more ? side * x : 0.0;
    return !more;
}

#endif
