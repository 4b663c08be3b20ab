#include "render/show/denoise_view.h"

#include "base/maths.h"

// Sets `out` to `axis` scaled by a length, and `inverse` to the parallel vector whose dot product
// with `out` is 1.
static void set_axis(const double axis[3], double length, float out[3], float inverse[3])
{
    double norm = vec3_norm(axis);
    for (int i = 0; i < 3; i++) {
        out[i] = (float)(axis[i] / norm * length);
        inverse[i] = (float)(axis[i] / norm / length);
    }
}

void denoise_view_fill(const struct camera *camera, uint32_t width, uint32_t height,
                       const double origin[3], struct gpu_denoise_view *out)
{
    bool is_panoramic = camera->kind == CAMERA_PANORAMIC;
    double right[3], up[3];
    double half_height =
        camera->kind == CAMERA_ORTHOGRAPHIC ? 0.5 * camera->height : tan(0.5 * camera->fov_y);
    *out = (struct gpu_denoise_view){.kind = camera->kind, .width = width, .height = height};
    vec3_cross(camera->direction, camera->up, right);
    vec3_cross(right, camera->direction, up);
    set_axis(right, is_panoramic ? 1.0 : half_height * width / height, out->right, out->to_right);
    set_axis(up, is_panoramic ? 1.0 : half_height, out->up, out->to_up);
    for (int i = 0; i < 3; i++) {
        out->position[i] = (float)(camera->position[i] - origin[i]);
        out->forward[i] = (float)camera->direction[i];
    }
}
