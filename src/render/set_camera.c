// Changes the camera and the size of the picture of a renderer that is otherwise unchanged.
#include "flatten/large_spheres.h"
#include "render/far_camera.h"
#include "render/film.h"
#include "render/frame.h"

// Returns whether the compiled kernels and the film's size suffice for the new image. Lens code and
// far-camera code in the kernels do no harm to cameras that do not need it.
static bool does_fit(const struct renderer *r, const struct camera *camera, uint32_t width,
                     uint32_t height)
{
    const struct specialization *s = &r->specialization;
    bool is_far_ready = s->features & FEATURE_FAR_CAMERA;
    bool has_lens = s->features & FEATURE_LENS, has_tiles = s->features & FEATURE_TILES;
    bool large_spheres = r->large_spheres_anyway || is_close_to_large_sphere(&r->flat, camera);
    return !has_tiles && (uint64_t)width * height <= r->pixels && camera->kind == s->camera &&
           (is_far_ready || !camera_is_far(&r->flat, camera)) &&
           (has_lens || !(camera->lens_radius > 0.0)) &&
           large_spheres == ((s->geometry & GEOMETRY_LARGE_SPHERES) != 0);
}

// The header of the materials' buffer lists the media in which camera rays begin.
static bool place_camera(struct renderer *r, struct err *err)
{
    struct gpu_buffer *materials = &r->buffers[BINDING_MATERIALS];
    const struct shading_tables_params params = {
        .scene = r->scene,
        .flat = &r->flat,
        .bvh = &r->bvh,
        .camera = &r->camera,
    };
    return !materials->handle || !shading_tables_place_camera(&params, &r->tables) ||
           gpu_upload(r->gpu, materials, 0, r->tables.materials, sizeof(struct gpu_material_header),
                      err);
}

bool renderer_set_camera(struct renderer *r, const struct camera *camera, uint32_t width,
                         uint32_t height, bool *fits, struct err *err)
{
    *fits = does_fit(r, camera, width, height);
    if (!*fits)
        return true;
    r->camera = *camera;
    frame_look(r, width, height);
    return place_camera(r, err) && renderer_restart(r, r->frame.seed, err);
}
