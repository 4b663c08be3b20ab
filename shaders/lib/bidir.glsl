// Weights between the three ways in which INTEGRATOR_BIDIR finds a path: camera paths that hit an
// emitter, shadow rays from camera paths to an emitter, and light paths that are connected to the
// camera. Reads the uniform block.
//
// A path x_0 ... x_k begins on an emitter and ends at the camera. Let B_j be the density per solid
// angle with which a camera path continues from x_j to x_(j-1); F_j the density with which a light
// path continues from x_j to x_(j+1); p the density with which shadow rays from x_1 sample x_0; and
// E the result of emission_density(). The density with which light paths find this path, divided by
// that of shadow rays, is
//
//   E Q / p,   Q = I d^2 (F_1 ... F_(k-2)) / (B_2 ... B_(k-1)),
//
// and divided by that of camera paths that hit x_0, it is E Q / B_1. Cosines cancel, and the only
// distance that remains is d, from x_(k-1) to the camera. I is the number of pixels times the solid
// angle of the pixel in the path's direction (image_extent()), because one light path is traced per
// pixel and sample. Q is multiplied by F_j / B_j at each vertex, so no vertices need to be stored
// (after Georgiev 2012, "Implementing Vertex Connection and Merging", section 4).
//
// At a delta vertex F_j / B_j counts as 1: both are the same Dirac delta, up to the ratio of two
// cosines, and the weights need only sum to 1. If the vertex next to the camera is a delta, light
// paths are not connected there, and Q is 0.
#ifndef BIDIR_GLSL
#define BIDIR_GLSL

#include "lib/buffers.glsl"

#define IS_BIDIR (INTEGRATOR == INTEGRATOR_BIDIR)

// Applies the chosen MIS heuristic to a ratio of two densities, as mis_weight() does.
float heuristic(float ratio)
{
    if (MIS == MIS_POWER_ANY)
        return pow(ratio, frame.mis_exponent);
    return MIS == MIS_BALANCE ? ratio : ratio * ratio;
}

// Returns the weight of a contribution of a camera path. The arguments are the densities of the
// other strategy of camera paths (shadow rays, or hitting the emitter) and of light paths, both
// divided by the density of this path.
float weight_of_camera_path(float other, float of_light_paths)
{
#ifdef LIGHT_PATHS_ALONE // for tests: only light paths contribute, wherever they can
    if (of_light_paths > 0.0)
        return 0.0;
#endif
    return 1.0 / (1.0 + heuristic(other) + heuristic(of_light_paths));
}

// Returns the weight of a contribution of a light path. The arguments are the densities of shadow
// rays and of camera paths that hit the emitter, both divided by the density of this path.
float weight_of_light_path(float by_shadow_ray, float by_hit)
{
#ifdef LIGHT_PATHS_ALONE
    return 1.0;
#endif
    return 1.0 / (1.0 + heuristic(by_shadow_ray) + heuristic(by_hit));
}

// Returns the number of pixels times the solid angle of the pixel in a unit direction from the
// camera. For an orthographic camera, the pixel's area replaces its solid angle. The camera's
// vectors are orthogonal.
float image_extent(vec3 direction)
{
    if (CAMERA == CAMERA_PANORAMIC) {
        float height = dot(direction, frame.camera_up);
        return 2.0 * PI * PI * sqrt(max(0.0, 1.0 - height * height));
    }
    float area = 4.0 * length(frame.camera_right) * length(frame.camera_up);
    float along = dot(direction, frame.camera_forward);
    return CAMERA == CAMERA_ORTHOGRAPHIC ? area : area * along * along * along;
}

// Returns Q of a camera path at its first vertex, at `distance` from the camera. Its inverse is the
// density with which a light path's last vertex is connected to the camera.
float first_ratio(vec3 direction, float distance)
{
    float extent = image_extent(direction);
    return CAMERA == CAMERA_ORTHOGRAPHIC ? extent : extent * distance * distance;
}

// Returns E / p of an emitter that is infinitely far away in the unit direction `towards`. Its
// light paths begin uniformly on a disc in front of the scene, as wide as the scene's bounding
// sphere. So E is p divided by the disc's area; it is 0 at points that no ray from the disc
// reaches.
float reach_of_far(vec3 point, vec3 towards)
{
    vec3 from_center = point - frame.scene_center;
    float along = dot(from_center, towards);
    vec3 beside = from_center - along * towards;
    float square = frame.scene_radius * frame.scene_radius;
    bool reached = along < frame.scene_radius && dot(beside, beside) < square;
    return reached ? 1.0 / (PI * square) : 0.0;
}

// Returns Q at a vertex of a path, which was stored at the vertex before.
float load_ratio(uint slot)
{
    return uintBitsToFloat(load_path(slot, PATH_WEIGHTS).x);
}

void store_ratio(uint slot, float ratio)
{
    store_path(slot, PATH_WEIGHTS, uvec4(floatBitsToUint(ratio), 0u, 0u, 0u));
}

#endif
