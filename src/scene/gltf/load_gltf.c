// glTF 2.0 and GLB files: opens the document and converts its default scene to meshes, instances,
// materials and cameras.
#include "scene/gltf/gltf_load.h"

#include "base/hash.h"
#include "scene/core/affine.h"
#include "scene/gltf/gltf_buffer.h"
#include "scene/gltf/gltf_node.h"
#include "scene/gltf/gltf_pose.h"
#include "scene/mesh/mesh_loader.h"
#include <math.h>
#include <string.h>

// --- cameras -------------------------------------------------------------------------------------

// Places a camera, which looks along the -Z axis of its node with +Y up (section 3.10.2). Returns
// false when the node's transform is degenerate in these directions.
static bool place_camera(const double world[3][4], struct camera *camera)
{
    double side[3];
    for (int i = 0; i < 3; i++) {
        camera->position[i] = world[i][3];
        camera->direction[i] = -world[i][2];
        camera->up[i] = world[i][1];
    }
    if (!vec3_normalize(camera->direction) || !vec3_normalize(camera->up))
        return false;
    vec3_cross(camera->direction, camera->up, side);
    return vec3_normalize(side);
}

static bool read_perspective(const struct json_node *node, double *fov_y, struct err *err)
{
    static const double pi = 3.14159265358979323846;
    struct json_node perspective;
    return gltf_require(node, "perspective", err) &&
           gltf_read_object(node, "perspective", &perspective, err) &&
           gltf_require(&perspective, "yfov", err) &&
           node_read_number(&perspective, "yfov", (struct range){0, pi, true}, fov_y, err);
}

// Reads the height of an orthographic camera. The file gives half of it; the width follows from the
// image. Rays begin in the camera's plane, whatever znear is, and have no end.
static bool read_orthographic(const struct json_node *node, double *height, struct err *err)
{
    static const struct range coordinates = {-SCENE_COORDINATE_MAX, SCENE_COORDINATE_MAX, false};
    struct json_node orthographic;
    double half = 0;
    if (!gltf_require(node, "orthographic", err) ||
        !gltf_read_object(node, "orthographic", &orthographic, err) ||
        !gltf_require(&orthographic, "ymag", err) ||
        !node_read_number(&orthographic, "ymag", coordinates, &half, err))
        return false;
    const struct json_node ymag = node_member(&orthographic, "ymag");
    *height = 2 * fabs(half);
    return *height >= SCENE_LENGTH_MIN ||
           node_fail(&ymag, err, "%g; expected a height that is not 0", half);
}

// Loads a camera. `holder` is its node, whose name is used if the camera has none.
static bool load_camera(struct gltf_load *load, uint32_t index, const struct json_node *holder,
                        const double world[3][4], struct err *err)
{
    static const char *const types[] = {
        [CAMERA_PERSPECTIVE] = "perspective", [CAMERA_ORTHOGRAPHIC] = "orthographic", NULL};
    const struct json_node node = gltf_item(&load->document, GLTF_CAMERAS, index);
    struct camera camera = {0};
    if (!gltf_require(&node, "type", err) ||
        !node_read_choice(&node, "type", types, &camera.kind, err))
        return false;
    if (!(camera.kind == CAMERA_ORTHOGRAPHIC ? read_orthographic(&node, &camera.height, err)
                                             : read_perspective(&node, &camera.fov_y, err)) ||
        !gltf_read_name(&node, &load->scene->arena, &camera.name, err) ||
        (!*camera.name && !gltf_read_name(holder, &load->scene->arena, &camera.name, err)))
        return false;
    for (int i = 0; i < 3; i++)
        if (fabs(world[i][3]) > SCENE_COORDINATE_MAX)
            return node_fail(holder, err,
                             "the camera's coordinate is %g; expected at most %g metres",
                             world[i][3], SCENE_COORDINATE_MAX);
    if (!place_camera(world, &camera)) {
        load->tally.singular_cameras++;
        return true;
    }
    struct camera *added = scene_add_camera(load->scene, NULL);
    if (!added)
        return gltf_no_memory(&load->document, "cameras", sizeof *added, err);
    *added = camera;
    load->tally.orthographic_cameras += camera.kind == CAMERA_ORTHOGRAPHIC;
    return true;
}

// --- nodes ---------------------------------------------------------------------------------------

// Loads a skinned mesh, which is already in world space.
static bool load_skinned_mesh(struct gltf_load *load, const struct gltf_nodes *nodes, uint32_t skin,
                              uint32_t mesh, const struct gltf_weights *weights, struct err *err)
{
    struct gltf_mesh_range meshes;
    const struct gltf_skin *opened = gltf_skin_open(load, nodes, skin, err);
    return opened && gltf_mesh_load(load, mesh, weights, opened, &meshes, err) &&
           gltf_instance_add(load, AFFINE_IDENTITY, meshes, err);
}

static bool load_node_mesh(struct gltf_load *load, const struct gltf_nodes *nodes, uint32_t index,
                           uint32_t mesh, struct err *err)
{
    const struct gltf_document *document = &load->document;
    const struct json_node node = gltf_item(document, GLTF_NODES, index);
    const double(*world)[4] = (const double(*)[4])nodes->world[index];
    struct gltf_mesh_range meshes;
    struct gltf_weights weights;
    uint32_t skin;
    bool is_instanced;
    if (!gltf_read_index(&node, "skin", document->counts[GLTF_SKINS], &skin, err) ||
        !gltf_morph_weights(load, index, mesh, load->poses ? &load->poses[index] : NULL, &weights,
                            err))
        return false;
    if (skin != GLTF_NONE) {
        struct json_node extensions, instancing;
        if (!gltf_read_extension(&node, "EXT_mesh_gpu_instancing", &extensions, &instancing, err))
            return false;
        load->tally.instanced_skins += instancing.value != NULL;
        return load_skinned_mesh(load, nodes, skin, mesh, &weights, err);
    }
    return gltf_mesh_load(load, mesh, &weights, NULL, &meshes, err) &&
           gltf_instancing_load(load, &node, world, meshes, &is_instanced, err) &&
           (is_instanced || gltf_instance_add(load, world, meshes, err));
}

static bool load_node(struct gltf_load *load, const struct gltf_nodes *nodes, uint32_t index,
                      bool with_cameras, struct err *err)
{
    const struct gltf_document *document = &load->document;
    const struct json_node node = gltf_item(document, GLTF_NODES, index);
    const double(*world)[4] = (const double(*)[4])nodes->world[index];
    uint32_t mesh, camera;
    if (!gltf_read_index(&node, "mesh", document->counts[GLTF_MESHES], &mesh, err) ||
        !gltf_read_index(&node, "camera", document->counts[GLTF_CAMERAS], &camera, err))
        return false;
    if (mesh != GLTF_NONE && !load_node_mesh(load, nodes, index, mesh, err))
        return false;
    if (!gltf_light_load(load, &node, world, err))
        return false;
    return camera == GLTF_NONE || !with_cameras || load_camera(load, camera, &node, world, err);
}

// --- notes ---------------------------------------------------------------------------------------

struct note {
    uint32_t count;
    const char *text;
};

// Adds a note "NAME: N TEXT" for every count that is not zero.
static bool add_notes(struct gltf_load *load, const struct note *notes, size_t count)
{
    const char *name = path_name(load->document.source->path);
    for (size_t i = 0; i < count; i++)
        if (notes[i].count > 0 &&
            !scene_note(load->scene, "%s: %u %s", name, notes[i].count, notes[i].text))
            return false;
    return true;
}

static bool note_what_is_missing(struct gltf_load *load, struct err *err)
{
    const struct gltf_document *document = &load->document;
    const struct gltf_tally *t = &load->tally;
    const struct note notes[] = {
        {t->specular_glossy, "specular-glossiness materials are shown as dielectrics with their "
                             "specular reflectance"},
        {t->coat_normals,
         "materials: the normals of the clear coat are approximated by the base's"},
        {t->anisotropic, "materials: anisotropy is approximated"},
        {t->translucent, "materials: light that is transmitted diffusely has the base colour"},
        {t->translucent_volumes, "materials: diffuse transmission into volumes is ignored"},
        {t->textures_without_image, "textures are ignored: they name no image"},
        {t->meshes_without_texcoords, "meshes lack the texture coordinates of their textures"},
        {t->mislabelled_images, "images are not of the type that their mimeType states"},
        {t->primitives_without_material, "primitives without a material are grey"},
        {t->point_and_line_primitives, "primitives of points or lines are skipped"},
        {t->primitives_without_positions, "primitives without positions are skipped"},
        {t->clamped_colors, "vertex colours outside [0, 1] are clamped"},
        {t->infinite_texcoords, "texture coordinates that are not finite become 0"},
        {t->empty_primitives,
         "primitives are skipped: all of their triangles have a repeated vertex"},
        {load->poses ? 0 : document->counts[GLTF_ANIMATIONS],
         "animations are not used: the nodes are shown without them"},
        {t->ignored_channels, "channels of the animation are ignored: their target is not a "
                              "node's translation, rotation, scale or weights"},
        {t->projective_joints, "inverse bind matrices have a last row other than (0, 0, 0, 1), "
                               "which is ignored"},
        {t->vertices_without_joints, "vertices without weights follow their skin's first joint"},
        {t->instanced_skins, "skinned nodes are shown once, without their instances"},
        {t->singular_lights, "lights are skipped: their node has a singular transform"},
        {t->orthographic_cameras,
         "orthographic cameras take their height from ymag; xmag, znear and zfar are "
         "ignored"},
        {t->singular_cameras, "cameras are skipped: their node has a singular transform"},
    };
    bool noted = add_notes(load, notes, sizeof notes / sizeof notes[0]);
    if (noted && document->ignored_extensions)
        noted = scene_note(load->scene, "%s: unsupported extensions are ignored: %s",
                           path_name(document->source->path), document->ignored_extensions);
    return noted || gltf_no_memory(document, "notes", sizeof(char *), err);
}

// --- loading -------------------------------------------------------------------------------------

static void hash_files(struct gltf_load *load)
{
    const struct gltf_document *document = &load->document;
    uint64_t *hash = &load->scene->hash;
    *hash = hash_bytes(*hash, document->source->bytes.data, document->source->bytes.size);
    for (uint32_t i = 0; i < document->counts[GLTF_BUFFERS]; i++)
        if (document->buffers[i].is_external)
            *hash = hash_bytes(*hash, document->buffers[i].data, document->buffers[i].size);
}

// Hashes the caller's choices in addition to the files, because they determine what is loaded.
static void hash_wishes(struct scene *scene, const struct gltf_load_params *params)
{
    const char *const names[] = {params->animation, params->scene_name, params->variant};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (names[i]) {
            scene->hash = hash_bytes(scene->hash, &i, sizeof i);
            scene->hash = hash_bytes(scene->hash, names[i], strlen(names[i]) + 1);
        }
    if (params->at_seconds)
        scene->hash = hash_bytes(scene->hash, params->at_seconds, sizeof *params->at_seconds);
}

static bool allocate_tables(struct gltf_load *load, struct err *err)
{
    const uint32_t *counts = load->document.counts;
    struct arena *arena = &load->document.arena;
    load->meshes = ARENA_NEW(arena, struct gltf_mesh_range, counts[GLTF_MESHES]);
    load->vectors = ARENA_NEW(arena, struct gltf_vectors, counts[GLTF_ACCESSORS]);
    load->skins = ARENA_NEW(arena, struct gltf_skin, counts[GLTF_SKINS]);
    return (load->meshes && load->vectors && load->skins) ||
           gltf_no_memory(&load->document, "tables",
                          counts[GLTF_MESHES] * sizeof *load->meshes +
                              counts[GLTF_ACCESSORS] * sizeof *load->vectors,
                          err);
}

// Finds the duration of the first animation if none is selected, so that it can be played. Errors
// in the animation do not make loading fail, because the animation is not shown; the duration then
// stays 0.
static void find_length(struct gltf_load *load)
{
    const struct gltf_tally tally = load->tally;
    struct gltf_node_pose *unused;
    struct err err = {0};
    if (!gltf_animation_pose(load, NULL, 0, &unused, &err))
        load->scene->animation_seconds = 0;
    load->tally = tally;
}

// Poses the nodes. If neither an animation nor a time is selected, they are not animated, as in
// viewers that do not play animations.
static bool pose_nodes(struct gltf_load *load, const struct gltf_load_params *params,
                       struct err *err)
{
    load->scene->animation_count += load->document.counts[GLTF_ANIMATIONS];
    if (!params->at_seconds && !params->animation) {
        find_length(load);
        return true;
    }
    double seconds = params->at_seconds ? *params->at_seconds : 0;
    if (!gltf_animation_pose(load, params->animation, seconds, &load->poses, err))
        return false;
    return load->poses ||
           scene_note(load->scene, "%s: the file has no animation; the time %g is ignored",
                      path_name(load->document.source->path), seconds) ||
           gltf_no_memory(&load->document, "notes", sizeof(char *), err);
}

// Adds cameras and instances in the order of the file's nodes.
static bool convert(struct gltf_load *load, const struct gltf_load_params *params, struct err *err)
{
    struct gltf_nodes nodes;
    if (!allocate_tables(load, err) || !pose_nodes(load, params, err))
        return false;
    const struct gltf_nodes_params nodes_params = {
        .place = params->place,
        .scene = params->scene_name,
        .poses = load->poses,
    };
    if (!gltf_nodes_open(&nodes, &load->document, &nodes_params, &load->document.arena, err))
        return false;
    if (!gltf_variant_find(load, params->variant, err) || !gltf_check_memory(load, &nodes, err) ||
        !gltf_materials_load(load, err))
        return false;
    for (uint32_t i = 0; i < nodes.count; i++)
        if (nodes.is_in_scene[i] && (!scene_goes_on(load->scene, 0, err) ||
                                     !load_node(load, &nodes, i, params->with_cameras, err)))
            return false;
    if (!gltf_textures_load(load, err) || !gltf_materials_finish(load, err))
        return false;
    hash_files(load);
    hash_wishes(load->scene, params);
    return note_what_is_missing(load, err);
}

// Decodes compressed meshes. A build without libdraco has refused files that require this.
static bool decode_meshes(struct gltf_document *document, struct err *err)
{
#ifdef HAS_DRACO
    return gltf_draco_decode(document, err);
#else
    (void)document, (void)err;
    return true;
#endif
}

bool gltf_load_bytes(struct scene *scene, const struct gltf_load_params *params, struct err *err)
{
    struct gltf_load load = {
        .scene = scene,
        .progress = params->progress,
        .default_material = SCENE_NONE,
    };
    bool ok = gltf_document_open(&load.document, &params->source, err) &&
              decode_meshes(&load.document, err) && convert(&load, params, err);
    gltf_document_close(&load.document);
    return ok;
}

// Reads a file into params->source.bytes and loads it.
static bool load_file(struct scene *scene, struct gltf_load_params *params, struct err *err)
{
    struct arena arena = {0};
    bool ok = file_read(&arena, params->source.path, 0, &params->source.bytes, err) &&
              gltf_load_bytes(scene, params, err);
    arena_finish(&arena);
    return ok;
}

bool load_gltf(struct scene *scene, const struct scene_load_params *params, struct err *err)
{
    struct gltf_load_params load = {
        .source = {.path = params->path, .allow_outside_paths = params->allow_outside_paths},
        .place = AFFINE_IDENTITY,
        .with_cameras = true,
        .variant = params->variant,
        .at_seconds = params->at_seconds,
        .animation = params->animation,
        .scene_name = params->scene_name,
        .progress = params->progress,
    };
    return load_file(scene, &load, err);
}

bool load_gltf_into(struct scene *scene, const char *path, const double place[3][4],
                    bool allow_outside_paths, struct err *err)
{
    struct gltf_load_params load = {
        .source = {.path = path, .allow_outside_paths = allow_outside_paths},
        .place = place,
    };
    return load_file(scene, &load, err);
}
