// Makes tables of scene data other than geometry, in the form that kernels read. The tables are
// built before memory is planned, because the plan depends on their size.
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
    const struct camera *camera;       // the camera, whose rays may begin inside a medium
    uint32_t light_choice;             // LIGHT_CHOICE_*, but never AUTO
    const struct emitter_lamps *lamps; // required by some light sampling strategies
    const struct progress *progress;   // polled for a stop; NULL: never stops
};

// Builds the tables in `arena`. Fails with ERR_INPUT if the scene has more than MEDIA_MAX different
// media.
bool shading_tables_build(const struct shading_tables_params *params, struct arena *arena,
                          struct shading_tables *out, struct err *err);

// Writes the media that contain params->camera to the header. Returns whether that changed the
// header.
bool shading_tables_place_camera(const struct shading_tables_params *params,
                                 struct shading_tables *tables);

#endif
