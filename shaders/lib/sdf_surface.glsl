// Reads signed distance fields: the surface point of a hit.
#ifndef SDF_SURFACE_GLSL
#define SDF_SURFACE_GLSL

#include "lib/sdf.glsl"
#include "lib/surface_types.glsl"

// Half the width of the central differences that approximate gradients, divided by the field's
// magnitude m. Values have rounding errors of about e m, with e = 2^-24, which cause an error of e
// m / h in the gradient. If the surface has a radius of curvature R, central differences of half
// width h have an additional error of (h / R)^2 / 6. Both are 1.2e-4 for R = m / 55. Surfaces with
// larger features have a smaller second error, which is smooth; edges are blurred by h only.
const float SDF_DIFFERENCE_PART = 1.0 / 2048.0;

// Computes position, error and outward geometric normal of shape `index` near `point`, by a step of
// Newton's method. The field itself gives the remaining distance from the surface; a ray that
// leaves the surface begins where the sign of the field is certain.
void load_sdf_surface(uint index, vec3 point, inout surface s)
{
    sdf_field f = load_sdf(sdf_number(index));
    vec3 from = point - sdf_origin(f);
    vec3 p = sdf_to_object(f, from);
    float h = SDF_DIFFERENCE_PART * f.magnitude;
    vec3 above = p + h, below = p - h; // the differences of these are exact
    vec3 gradient = vec3(0.0), moved = p;
    float last = 0.0, slope = 1.0;
    // Two evaluations per component, then the point itself, then the moved point. A single call in
    // the loop keeps the code short.
    for (int i = 0; i < 8; i++) {
        int c = i >> 1;
        vec3 end = (i & 1) == 0 ? above : below;
        vec3 at = vec3(c == 0 ? end.x : p.x, c == 1 ? end.y : p.y, c == 2 ? end.z : p.z);
        float d = sdf_value(f.first, f.count, i < 6 ? at : moved);
        float difference = (d - last) / (below - above)[c % 3];
        if (i < 6 && (i & 1) == 1)
            gradient[c] = difference;
        if (i == 6) {
            // Folds and fractals may have any slope; a slope far from 1 is not reliable.
            slope = max(length(gradient), 0.25);
            moved = p - gradient * (d / (slope * slope));
        }
        last = d;
    }
    vec3 n = dot(gradient, gradient) > 0.0 ? normalize(gradient) : vec3(0.0, 1.0, 0.0);
    // The inverse matrix is the transpose divided by the squared scale.
    float scale2 = f.scale * f.scale;
    vec3 step = moved - p;
    s.position = point + scale2 * (f.to_object[0].xyz * step.x + f.to_object[1].xyz * step.y +
                                   f.to_object[2].xyz * step.z);
    s.normal_geometric = normalize(f.to_object[0].xyz * n.x + f.to_object[1].xyz * n.y +
                                   f.to_object[2].xyz * n.z);
    // The field's rounding error counts four times: here, where the next ray begins, in the
    // threshold there, and once more because of creases. Then the rounding errors of the transforms
    // from and to the world are added.
    float off = f.scale * (abs(last) + 4.0 * sdf_error(f)) / slope;
    s.error = off * abs(s.normal_geometric) + GAMMA(16) * (abs(point) + abs(from));
    s.radius = 0.0;
}

#endif
