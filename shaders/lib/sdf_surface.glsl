// Reads signed distance fields: the point of one that a hit stands for.
#ifndef SDF_SURFACE_GLSL
#define SDF_SURFACE_GLSL

#include "lib/sdf.glsl"
#include "lib/surface_types.glsl"

// Half the width of the differences that gradients are made of, as a part of the field's magnitude
// m. Values are rounded to about e m, e = 2^-24, which leaves e m / h in the gradient; where the
// surface has the radius R, central differences of half width h are off by (h / R)^2 / 6 besides.
// Both are 1.2e-4 for R = m / 55: surfaces of larger features lose the less to the second part,
// which is smooth, and edges are blurred by h only.
const float SDF_DIFFERENCE_PART = 1.0 / 2048.0;

// Position, its error, and the geometric normal, outwards, of shape `index` near `point`: a step of
// Newton's method from there. How far the result still is from the surface, the field itself says;
// a ray that leaves it begins where the field is certain about the side.
void load_sdf_surface(uint index, vec3 point, inout surface s)
{
    sdf_field f = load_sdf(sdf_number(index));
    vec3 from = point - sdf_origin(f);
    vec3 p = sdf_to_object(f, from);
    float h = SDF_DIFFERENCE_PART * f.magnitude;
    vec3 above = p + h, below = p - h; // the differences of these are exact
    vec3 gradient = vec3(0.0), moved = p;
    float last = 0.0, slope = 1.0;
    // Two a component, then the point itself, then the moved one. One call keeps the code short.
    for (int i = 0; i < 8; i++) {
        int c = i >> 1;
        vec3 end = (i & 1) == 0 ? above : below;
        vec3 at = vec3(c == 0 ? end.x : p.x, c == 1 ? end.y : p.y, c == 2 ? end.z : p.z);
        float d = sdf_value(f.first, f.count, i < 6 ? at : moved);
        float difference = (d - last) / (below - above)[c % 3];
        if (i < 6 && (i & 1) == 1)
            gradient[c] = difference;
        if (i == 6) {
            // Folds and fractals may have any slope; what is not nearly 1 is not trusted.
            slope = max(length(gradient), 0.25);
            moved = p - gradient * (d / (slope * slope));
        }
        last = d;
    }
    vec3 n = dot(gradient, gradient) > 0.0 ? normalize(gradient) : vec3(0.0, 1.0, 0.0);
    // The inverse of a rotation times 1 / scale.
    float scale2 = f.scale * f.scale;
    vec3 step = moved - p;
    s.position = point + scale2 * (f.to_object[0].xyz * step.x + f.to_object[1].xyz * step.y +
                                   f.to_object[2].xyz * step.z);
    s.normal_geometric = normalize(f.to_object[0].xyz * n.x + f.to_object[1].xyz * n.y +
                                   f.to_object[2].xyz * n.z);
    // The field's rounding: once here, once where the next ray begins, once for the threshold
    // there, and again for what creases take. And the rounding of the way from the world and back.
    float off = f.scale * (abs(last) + 4.0 * sdf_error(f)) / slope;
    s.error = off * abs(s.normal_geometric) + GAMMA(16) * (abs(point) + abs(from));
    s.radius = 0.0;
}

#endif
