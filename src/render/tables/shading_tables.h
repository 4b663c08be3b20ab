// The data that kernels read of a scene besides its geometry, in the form they read it. It is built
// before memory is planned, since the plan needs its size.
#ifndef LAMPYRIS_RENDER_TABLES_SHADING_TABLES_H
#define LAMPYRIS_RENDER_TABLES_SHADING_TABLES_H

#include "render/tables/emitter_lamps.h"
#include "render/tables/emitters.h"
#include "render/tables/texture_set.h"

struct shading_tables {
    struct emitters emitters;
    struct texture_set textures;
    void *materials; // gpu_material_header and the sections that it refers to
    uint64_t material_bytes;
    uint32_t medium_count; // number of different media inside materials
};

struct shading_tables_params {
    const struct scene *scene;
    const struct flat_scene *flat;
    const struct bvh *bvh;
    const struct camera *camera;       // its rays may start inside a medium
    uint32_t light_choice;             // LIGHT_CHOICE_*, not AUTO
    const struct emitter_lamps *lamps; // if the light choice needs them
    const struct progress *progress;   // asked whether to stop; NULL: no progress is reported
};

// Builds everything in `arena`. ERR_INPUT for more than MEDIA_MAX different media.
bool shading_tables_build(const struct shading_tables_params *params, struct arena *arena,
                          struct shading_tables *out, struct err *err);

// Writes to the header the media that contain params->camera; returns whether that changed
// anything.
bool shading_tables_place_camera(const struct shading_tables_params *params,
                                 struct shading_tables *tables);

#endif
