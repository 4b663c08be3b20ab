// Interpolates directional albedos from tables in the materials' buffer (shared/albedo.h). For
// their computation and accuracy see render/tables/albedo_generate.c and docs/materials.md.
//
// `tables` is albedos_begin(), the index of the tables' first word. mu is the cosine between wo and
// the normal.
#ifndef ALBEDO_GLSL
#define ALBEDO_GLSL

#include "lib/material.glsl"
#include "lib/microfacet.glsl"
#include "shared/albedo.h"

// The following functions return coordinates in [0, 1] along the tables' axes. Albedos change most
// at cosines of about `scale`; near cosine 0 they change with its square root.
float albedo_axis_mu(float mu, float scale)
{
    return sqrt(mu * (1.0 + scale) / (mu + scale));
}

// alpha is in [SMALLEST_ALPHA, 1].
float albedo_axis_alpha(float alpha)
{
    return clamp((sqrt(sqrt(alpha)) - 0.1) / 0.9, 0.0, 1.0);
}

// Clamps a coordinate of a table to [0, 1]. A NaN, which clamp() may return, becomes 0, so that
// reads stay inside the table.
float albedo_place(float at)
{
    return at > 0.0 ? min(at, 1.0) : 0.0;
}

vec2 albedo_place(vec2 at)
{
    return vec2(albedo_place(at.x), albedo_place(at.y));
}

vec3 albedo_place(vec3 at)
{
    return vec3(albedo_place(at.xy), albedo_place(at.z));
}

// Returns the cell of a table that contains a position with coordinates in [0, 1], and the position
// in the cell.
uvec2 albedo_cell(uvec2 size, vec2 at, out vec2 w)
{
    vec2 cells = vec2(size);
    vec2 position = albedo_place(at) * cells;
    vec2 corner = min(floor(position), cells - 1.0);
    w = position - corner;
    return uvec2(corner);
}

uvec3 albedo_cell(uvec3 size, vec3 at, out vec3 w)
{
    vec3 cells = vec3(size);
    vec3 position = albedo_place(at) * cells;
    vec3 corner = min(floor(position), cells - 1.0);
    w = position - corner;
    return uvec3(corner);
}

float albedo_quad(uint first, uvec2 size, vec2 at)
{
    vec2 w;
    uvec2 cell = albedo_cell(size, at, w);
    vec4 v = load_materials_float(first + cell.y * size.x + cell.x);
    return mix(mix(v.x, v.y, w.x), mix(v.z, v.w, w.x), w.y);
}

// Returns E1, the albedo of GGX with height-correlated masking and reflectance 1.
float albedo_ggx(uint tables, float mu, float alpha)
{
    float albedo = albedo_quad(tables + ALBEDO_GGX, uvec2(ALBEDO_GGX_MU, ALBEDO_GGX_ALPHA),
                               vec2(albedo_axis_mu(mu, alpha), albedo_axis_alpha(alpha)));
    return min(1.0, albedo); // nodes were raised, so values may exceed 1
}

// Returns the mean of Schlick's weight W over the directions that GGX reflects, which is called w
// here: a reflectance f0 + (1 - f0) W has the albedo E1 (f0 + (1 - f0) w).
float albedo_schlick(uint tables, float mu, float alpha)
{
    return albedo_quad(tables + ALBEDO_SCHLICK, uvec2(ALBEDO_SCHLICK_MU, ALBEDO_SCHLICK_ALPHA),
                       vec2(albedo_axis_mu(mu, alpha + 0.2), albedo_axis_alpha(alpha)));
}

// Returns the albedo of the fibres before the division by max(1, albedo); roughness is in [0.1, 1].
float albedo_charlie(uint tables, float mu, float roughness)
{
    return albedo_quad(tables + ALBEDO_CHARLIE, uvec2(ALBEDO_CHARLIE_MU, ALBEDO_CHARLIE_ROUGHNESS),
                       vec2(albedo_axis_mu(mu, roughness), (roughness - 0.1) / 0.9));
}

// Returns the albedo of Burley's coat of weight 1.
float albedo_coat(uint tables, float mu, float gloss)
{
    return albedo_quad(tables + ALBEDO_COAT, uvec2(ALBEDO_COAT_MU, ALBEDO_COAT_GLOSS),
                       vec2(albedo_axis_mu(mu, 0.25), gloss));
}

// Returns the albedo of Burley's coat of weight 1 with the Fresnel reflectance of index 1.5 instead
// of Schlick's.
float albedo_coat_exact(uint tables, float mu, float gloss)
{
    return albedo_quad(tables + ALBEDO_COAT_EXACT, uvec2(ALBEDO_COAT_MU, ALBEDO_COAT_GLOSS),
                       vec2(albedo_axis_mu(mu, 0.25), gloss));
}

// Returns in xyz the coefficients of a polynomial in the roughness, whose value is the albedo of
// Burley's subsurface approximation. w is the albedo of his sheen.
vec4 albedo_diffuse(uint tables, float mu)
{
    float position = albedo_place(albedo_axis_mu(mu, 0.2)) * float(ALBEDO_DIFFUSE_MU);
    float corner = min(floor(position), float(ALBEDO_DIFFUSE_MU) - 1.0);
    uint first = tables + ALBEDO_DIFFUSE + uint(corner);
    return mix(load_materials_float(first), load_materials_float(first + 1u), position - corner);
}

// Interpolates in a table whose cells have eight values of 16 bits.
float albedo_cube(uint first, uvec3 size, vec3 at)
{
    vec3 w;
    uvec3 cell = albedo_cell(size, at, w);
    uvec4 v = load_materials(first + (cell.z * size.y + cell.y) * size.x + cell.x);
    vec4 low = mix(vec4(v & 0xffffu), vec4(v >> 16u), w.x);
    vec2 middle = mix(low.xz, low.yw, w.y);
    return min(1.0, mix(middle.x, middle.y, w.z) * (ALBEDO_HIGHEST / 65535.0));
}

// Returns the mean of fresnel_dielectric() over the directions that GGX reflects. The axis of eta
// is the fourth root of |eta - 1| / (eta + 1). Seen from inside, where reflection is total for
// cosines below c, the axis of mu is bent around c.
float albedo_fresnel(uint tables, float mu, float alpha, float eta)
{
    bool inside = eta < 1.0;
    float root_k = sqrt(abs((eta - 1.0) * (eta + 1.0)));
    float beyond = (mu - root_k) / (inside && mu > root_k ? 1.0 - root_k : root_k);
    float x = inside ? 0.5 + 0.5 * sign(beyond) * sqrt(abs(beyond))
                     : albedo_axis_mu(mu, alpha + 0.6 * root_k / (1.0 + root_k));
    return albedo_cube(tables + ALBEDO_FRESNEL + (inside ? ALBEDO_FRESNEL_SIDE : 0u),
                       uvec3(ALBEDO_FRESNEL_MU, ALBEDO_FRESNEL_ALPHA, ALBEDO_FRESNEL_ETA),
                       vec3(x, albedo_axis_alpha(alpha),
                            sqrt(sqrt(abs(eta - 1.0) / (eta + 1.0)))));
}

// Interpolates between two adjacent values of the eight 16-bit values in a uvec4 word.
float albedo_run(uint word, uint left, float w)
{
    uvec4 v = load_materials(word);
    uint right = left + 1u;
    float low = float(v[left >> 1] >> (16u * (left & 1u)) & 0xffffu);
    float high = float(v[right >> 1] >> (16u * (right & 1u)) & 0xffffu);
    return mix(low, high, w);
}

// Interpolates in a table whose words are read by albedo_run(): each is a run of nodes along the
// first axis. Returns 0 to 65535.
float albedo_runs(uint first, uvec3 size, vec3 at)
{
    vec3 w;
    uvec3 cell = albedo_cell(size, at, w);
    uint row = size.x / ALBEDO_RUN;
    uint slice = row * (size.y + 1u);
    uint left = cell.x % ALBEDO_RUN;
    uint word = first + cell.z * slice + cell.y * row + cell.x / ALBEDO_RUN;
    float near = mix(albedo_run(word, left, w.x), albedo_run(word + row, left, w.x), w.y);
    word += slice;
    float far = mix(albedo_run(word, left, w.x), albedo_run(word + row, left, w.x), w.y);
    return mix(near, far, w.z);
}

// Returns coordinates along the axes of the tables of interfaces that also refract.
vec3 albedo_axes_glass(float mu, float alpha, float eta)
{
    float root_k = sqrt(abs((eta - 1.0) * (eta + 1.0)));
    float scale = eta < 1.0 ? alpha + 0.6 * root_k / (1.0 + root_k) : alpha;
    return vec3(albedo_axis_mu(mu, scale), albedo_axis_alpha(alpha),
                sqrt(sqrt(abs(eta - 1.0) / (eta + 1.0))));
}

// Returns the energy that a rough interface between dielectrics reflects and transmits in all. The
// table stores the square root of this energy.
float albedo_glass(uint tables, float mu, float alpha, float eta)
{
    vec3 axes = albedo_axes_glass(mu, alpha, eta);
    uint first = tables + (eta < 1.0 ? ALBEDO_GLASS_INSIDE : ALBEDO_GLASS);
    uvec3 size = eta < 1.0 ? uvec3(ALBEDO_GLASS_INSIDE_MU, ALBEDO_GLASS_INSIDE_ALPHA,
                                   ALBEDO_GLASS_INSIDE_ETA)
                           : uvec3(ALBEDO_GLASS_MU, ALBEDO_GLASS_ALPHA, ALBEDO_GLASS_ETA);
    float root = min(1.0, albedo_runs(first, size, axes) * (ALBEDO_HIGHEST / 65535.0));
    return root * root;
}

// Returns the energy that a rough interface reflects and transmits in all if it reflects only where
// reflection is total.
float albedo_clear(uint tables, float mu, float alpha, float eta)
{
    float root = albedo_runs(tables + ALBEDO_CLEAR + (eta < 1.0 ? ALBEDO_CLEAR_SIDE : 0u),
                             uvec3(ALBEDO_CLEAR_MU, ALBEDO_CLEAR_ALPHA, ALBEDO_CLEAR_ETA),
                             albedo_axes_glass(mu, alpha, eta));
    root = min(1.0, root * (ALBEDO_HIGHEST / 65535.0));
    return root * root;
}

// Returns the coordinates of wo along the axes of anisotropic tables: roughness, anisotropy and
// azimuth. alpha_o is the standard deviation of slopes along wo, which determines the scale of the
// axis of mu. The coordinate of the azimuth is the angle halfway between the azimuths of wo and of
// wo stretched to an isotropic surface.
vec3 albedo_axes_turned(vec3 wo, float roughness, float anisotropic, vec2 alpha, out float alpha_o)
{
    vec2 azimuth = abs(wo.xy) * sqrt(alpha);
    bool tilted = azimuth.x + azimuth.y > 0.0;
    alpha_o = tilted ? length(alpha * wo.xy) / length(wo.xy) : alpha.x;
    return vec3((roughness - 0.01) / 0.99, log(1.0 - 0.9 * anisotropic) / log(0.1),
                4.0 * atan_turns(azimuth.y, azimuth.x));
}

// Interpolates between two tables of neighbouring azimuths.
float albedo_slices(uint first, uvec4 size, vec4 at)
{
    float position = albedo_place(at.w) * float(size.w);
    float corner = min(floor(position), float(size.w) - 1.0);
    uint slice = size.x * size.y * size.z;
    first += uint(corner) * slice;
    return mix(albedo_cube(first, size.xyz, at.xyz), albedo_cube(first + slice, size.xyz, at.xyz),
               position - corner);
}

// Returns E1 of anisotropic GGX.
float albedo_turned(uint tables, float mu, vec3 axes, float alpha_o)
{
    return albedo_slices(tables + ALBEDO_TURNED,
                         uvec4(ALBEDO_TURNED_MU, ALBEDO_TURNED_ROUGHNESS, ALBEDO_TURNED_ASPECT,
                               ALBEDO_TURNED_AZIMUTH),
                         vec4(albedo_axis_mu(mu, alpha_o), axes));
}

// Returns a cosine x that represents wo.h for all directions that anisotropic GGX reflects:
// (1 - x)^12 is the mean of (1 - wo.h)^12. From the index 1.05 on, the Fresnel reflectance is a
// concave function of (1 - wo.h)^12, so the reflectance at x is at least the mean reflectance.
float albedo_turned_cosine(uint tables, float mu, vec3 axes, float alpha_o)
{
    return 1.0 - albedo_slices(tables + ALBEDO_SINE,
                               uvec4(ALBEDO_SINE_MU, ALBEDO_SINE_ROUGHNESS, ALBEDO_SINE_ASPECT,
                                     ALBEDO_SINE_AZIMUTH),
                               vec4(albedo_axis_mu(mu, alpha_o + 0.2), axes));
}

// Returns the alpha, at most 1, of the isotropic interface that approximates an anisotropic one.
// Along the normal (mu = 1) both axes count equally; at the horizon only the slope along wo counts.
float albedo_turned_stand_in(float mu, vec2 alpha, float alpha_o)
{
    float along = alpha_o * alpha_o;
    float variance = along + 0.5 * mu * mu * (dot(alpha, alpha) - 2.0 * along);
    return sqrt(variance * inversesqrt(1.0 + variance * variance));
}

// Returns the ratio of the energies that leave the anisotropic interface and its isotropic
// approximation.
float albedo_turned_glass(uint tables, float mu, vec3 axes, float roughness, float alpha_o,
                          float eta)
{
    const uvec3 size = uvec3(ALBEDO_TURNED_GLASS_MU, ALBEDO_TURNED_GLASS_ROUGHNESS,
                             ALBEDO_TURNED_GLASS_ASPECT);
    const float least = ALBEDO_TURNED_GLASS_ROUGHNESS_LEAST;
    vec3 glass = albedo_axes_glass(mu, alpha_o, eta);
    vec3 at = vec3(glass.x, (roughness - least) / (1.0 - least), axes.y);
    vec2 w;
    uvec2 cell = albedo_cell(uvec2(ALBEDO_TURNED_GLASS_AZIMUTH, ALBEDO_TURNED_GLASS_ETA),
                             vec2(axes.z, glass.z / ALBEDO_TURNED_GLASS_ETA_LAST), w);
    uint slice = ALBEDO_TURNED_GLASS_SLICE;
    uint row = slice * (ALBEDO_TURNED_GLASS_AZIMUTH + 1u);
    uint first = tables + ALBEDO_TURNED_GLASS + (eta < 1.0 ? ALBEDO_TURNED_GLASS_SIDE : 0u) +
                 cell.y * row + cell.x * slice;
    float near =
        mix(albedo_runs(first, size, at), albedo_runs(first + slice, size, at), w.x);
    first += row;
    float far = mix(albedo_runs(first, size, at), albedo_runs(first + slice, size, at), w.x);
    return exp((mix(near, far, w.y) * (2.0 / 65535.0) - 1.0) * ALBEDO_TURNED_GLASS_LOG);
}

// Returns the albedo of Burley's diffuse reflection with base colour 1, in closed form. With A =
// FD90 - 1 = roughness (1 + wi.wo) - 1/2 and s = W(c_i), it is the integral of (1 + A s) (1 + A
// W(mu)) / pi over the cosine-weighted hemisphere. It uses <wi.wo> = c_i mu, <(wi.wo)^2> = (c_i
// mu)^2 + (1 - c_i^2) (1 - mu^2) / 2 and the moments of c^n (1 - c)^5: 1/42, 1/168, 1/504 for n =
// 1, 2, 3.
float albedo_burley(float mu, float roughness)
{
    const float j1 = 1.0 / 42.0, j2 = 1.0 / 168.0, j3 = 1.0 / 504.0;
    float m = 1.0 - clamp(mu, 0.0, 1.0);
    float s = m * m * m * m * m;
    float r = roughness;
    float a_s = (r - 0.5) * j1 + r * mu * j2;
    float a = 0.5 * (r - 0.5) + r * mu / 3.0;
    float a2_s = r * r * (j1 + 2.0 * mu * j2 + mu * mu * j3 + 0.5 * (1.0 - mu * mu) * (j1 - j3)) -
                 r * (j1 + mu * j2) + 0.25 * j1;
    return 2.0 * (0.5 + a_s + s * (a + a2_s));
}

#endif
