#include "viewer/core/pose.h"

#include "base/clock.h"
#include "scene/core/environment.h"
#include "scene/core/placement.h"
#include "scene/json/scene_edits.h"
#include "scene/json/scene_fields.h"
#include "viewer/core/changes.h"
#include "viewer/core/messages.h"
#include "viewer/core/viewer.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define NAME "pose"

struct pose_job {
    struct scene_load_params params;
    struct progress progress;
    struct scene_pose pose;
    struct scene scene;
    atomic_bool is_cancelled;
    bool is_done, is_ok;
};

static bool same_pose(const struct scene_pose *a, const struct scene_pose *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

// Returns the parameters with which the scene is loaded at another time. If the file has a base,
// these are the base's, because the file's edits are already applied.
static const struct scene_load_params *animated(const struct document *document)
{
    return document->pristine.base ? &document->pristine.base->load : &document->load_params;
}

void pose_init(struct viewer *viewer)
{
    struct pose *pose = &viewer->document.pose;
    const struct scene_load_params *load = animated(&viewer->document);
    memset(pose, 0, sizeof *pose); // clears padding, too, because poses are compared byte by byte
    pose->speed = 1;
    pose->shown.is_posed = load->at_seconds != NULL;
    pose->shown.seconds = load->at_seconds ? *load->at_seconds : 0;
    pose->wanted = pose->shown;
}

bool pose_has_animation(const struct viewer *viewer)
{
    return viewer->document.has_scene && viewer->document.scene.animation_count > 0;
}

bool pose_is_pending(const struct viewer *viewer)
{
    const struct pose *pose = &viewer->document.pose;
    return viewer->document.has_scene && (pose->job || !same_pose(&pose->shown, &pose->wanted));
}

// --- on the worker's thread ----------------------------------------------------------------------

static bool is_cancelled(void *context)
{
    struct pose_job *job = context;
    return atomic_load(&job->is_cancelled);
}

static bool run(void *context, struct err *err)
{
    struct pose_job *job = context;
    return scene_load(&job->params, &job->scene, err);
}

// --- finding what has moved ----------------------------------------------------------------------

static bool same_array(const void *a, const void *b, size_t bytes)
{
    return (!a && !b) || (a && b && memcmp(a, b, bytes) == 0);
}

static bool same_vertices(const struct mesh *a, const struct mesh *b)
{
    uint32_t n = a->vertex_count;
    return n == b->vertex_count && a->triangle_count == b->triangle_count &&
           same_array(a->positions, b->positions, n * sizeof *a->positions) &&
           same_array(a->exact_positions, b->exact_positions, n * sizeof *a->exact_positions) &&
           same_array(a->normals, b->normals, n * sizeof *a->normals) &&
           same_array(a->tangents, b->tangents, n * sizeof *a->tangents);
}

// The arrays of the base scene that the document has copied.
struct base_lists {
    struct instance *instances;
    struct shape *shapes;
    struct light *lights;
    uint32_t shape_count, light_count;
};

// Returns the document's own copies of the lists, which only this file changes.
static struct base_lists base_of(struct document *document)
{
    struct scene *pristine = &document->pristine;
    const struct scene_base *base = pristine->base;
    struct base_lists lists = {pristine->instances, pristine->shapes, pristine->lights,
                               pristine->shape_count, pristine->light_count};
    if (base && base->instances) {
        lists.instances = base->instances;
        lists.shapes = base->shapes;
        lists.shape_count = base->shape_count;
    }
    if (base) {
        lists.lights = base->lights;
        lists.light_count = base->light_count;
    }
    return lists;
}

static bool fits(struct document *document, const struct scene *posed, struct err *err)
{
    const struct base_lists base = base_of(document);
    return (posed->instance_count == document->scene.instance_count &&
            posed->mesh_count == document->scene.mesh_count &&
            posed->shape_count == base.shape_count) ||
           err_set(err, ERR_INPUT,
                   "the file has other objects at that time: %u instances of %u meshes; expected "
                   "%u instances of %u meshes",
                   posed->instance_count, posed->mesh_count, document->scene.instance_count,
                   document->scene.mesh_count);
}

static bool has_moved(struct document *document, const struct scene *posed)
{
    const struct base_lists base = base_of(document);
    bool same = true;
    for (uint32_t i = 0; i < posed->instance_count && same; i++)
        same = memcmp(posed->instances[i].transform, base.instances[i].transform,
                      sizeof posed->instances[i].transform) == 0;
    for (uint32_t i = 0; i < posed->shape_count && same; i++)
        same =
            memcmp(posed->shapes[i].center, base.shapes[i].center,
                   sizeof posed->shapes[i].center) == 0 &&
            memcmp(posed->shapes[i].axes, base.shapes[i].axes, sizeof posed->shapes[i].axes) == 0;
    for (uint32_t i = 0; i < posed->light_count && i < base.light_count && same; i++)
        same =
            memcmp(posed->lights[i].position, base.lights[i].position, 3 * sizeof(double)) == 0 &&
            memcmp(posed->lights[i].direction, base.lights[i].direction, 3 * sizeof(double)) == 0;
    for (uint32_t i = 0; i < posed->mesh_count && same; i++)
        same = same_vertices(&posed->meshes[i], &document->scene.meshes[i]);
    return !same;
}

// --- adopting the pose ---------------------------------------------------------------------------

// Adopts the transforms of objects. The placement of an object is relative to its transform in the
// current pose.
static bool take_objects(struct document *document, const struct scene *posed, struct err *err)
{
    const struct base_lists base = base_of(document);
    struct scene *scene = &document->scene, *pristine = &document->pristine;
    uint32_t count = posed->instance_count + posed->shape_count;
    for (uint32_t i = 0; i < count; i++) {
        const struct placement placement = scene_placement(scene, i);
        const struct placement none = placement_none(placement.about);
        bool is_placed = !placement_is_none(&placement);
        if (is_placed && !scene_place(scene, i, &none, err))
            return false;
        if (i < posed->instance_count) {
            const double(*transform)[4] = (const double(*)[4])posed->instances[i].transform;
            memcpy(scene->instances[i].transform, transform, sizeof(double[3][4]));
            memcpy(pristine->instances[i].transform, transform, sizeof(double[3][4]));
            memcpy(base.instances[i].transform, transform, sizeof(double[3][4]));
        } else {
            uint32_t s = i - posed->instance_count;
            shape_take_place(&scene->shapes[s], &posed->shapes[s]);
            shape_take_place(&pristine->shapes[s], &posed->shapes[s]);
            shape_take_place(&base.shapes[s], &posed->shapes[s]);
        }
        if (is_placed && !scene_place(scene, i, &placement, err))
            return false;
    }
    return true;
}

// Adopts the lights of the new pose, except for members that the user has edited. The sun of a sky
// does not move.
static void take_lights(struct document *document, const struct scene *posed)
{
    const struct base_lists base = base_of(document);
    uint32_t sun = scene_sun_light(&document->scene);
    for (uint32_t i = 0; i < posed->light_count && i < base.light_count && i != sun &&
                         i < document->scene.light_count && i < document->pristine.light_count;
         i++) {
        struct light *now = &document->scene.lights[i];
        struct scene_fields fields;
        scene_light_fields(posed->lights[i].kind, &fields);
        for (size_t f = 0; f < fields.count; f++)
            if (field_same(&fields.list[f], now, &base.lights[i]))
                field_copy(&fields.list[f], now, &posed->lights[i]);
        base.lights[i] = posed->lights[i];
        document->pristine.lights[i] = posed->lights[i];
    }
}

static bool same_camera(const struct camera *a, const struct camera *b)
{
    return memcmp(a->position, b->position, sizeof a->position) == 0 &&
           memcmp(a->direction, b->direction, sizeof a->direction) == 0 &&
           memcmp(a->up, b->up, sizeof a->up) == 0;
}

// Adopts the cameras. A camera of the file that is in use moves with the pose, unless the user has
// moved it.
static void take_cameras(struct viewer *viewer, const struct scene *posed)
{
    struct scene *scene = &viewer->document.scene;
    uint32_t index = viewer->view.camera_index;
    if (scene->camera_is_framed || posed->camera_count != scene->camera_count)
        return;
    bool follows = same_camera(&viewer->view.camera, &scene->cameras[index]);
    for (uint32_t i = 0; i < posed->camera_count; i++) {
        const struct camera *to = &posed->cameras[i];
        memcpy(scene->cameras[i].position, to->position, sizeof to->position);
        memcpy(scene->cameras[i].direction, to->direction, sizeof to->direction);
        memcpy(scene->cameras[i].up, to->up, sizeof to->up);
    }
    if (!follows || same_camera(&viewer->view.camera, &scene->cameras[index]))
        return;
    memcpy(viewer->view.camera.position, scene->cameras[index].position, 3 * sizeof(double));
    memcpy(viewer->view.camera.direction, scene->cameras[index].direction, 3 * sizeof(double));
    memcpy(viewer->view.camera.up, scene->cameras[index].up, 3 * sizeof(double));
    viewer_changed(viewer, CHANGE_CAMERA);
}

// Adopts the vertices of the meshes, which the scene of the new pose owns. Materials are kept.
static bool take_meshes(struct document *document, const struct scene *posed, struct err *err)
{
    bool same = true;
    struct scene *scene = &document->scene;
    struct mesh *meshes = arena_copy(&document->pose.loaded.arena, scene->meshes, scene->mesh_count,
                                     sizeof *scene->meshes);
    if (!meshes)
        return err_memory(err, "meshes", scene->mesh_count * sizeof *meshes);
    for (uint32_t i = 0; i < scene->mesh_count; i++) {
        const struct mesh *from = &posed->meshes[i];
        same = same && same_vertices(from, &meshes[i]);
        meshes[i].positions = from->positions;
        meshes[i].exact_positions = from->exact_positions;
        meshes[i].normals = from->normals;
        meshes[i].tangents = from->tangents;
    }
    scene->meshes = document->pristine.meshes = meshes;
    document->pose.deformations += !same;
    // The ground of a studio fades out around the objects, so its texture changes with them.
    if (posed->has_ground && posed->image_count == scene->image_count &&
        posed->texture_count == scene->texture_count) {
        scene->images = document->pristine.images = posed->images;
        scene->textures = document->pristine.textures = posed->textures;
    }
    return true;
}

static bool take(struct viewer *viewer, struct pose_job *job, struct err *err)
{
    struct document *document = &viewer->document;
    struct pose *pose = &document->pose;
    if (!fits(document, &job->scene, err))
        return false;
    document->scene.animation_seconds = job->scene.animation_seconds;
    if (!has_moved(document, &job->scene)) {
        take_cameras(viewer, &job->scene);
        return true;
    }
    // Sides and geometry still use the previous scene, which is freed when the next pose is
    // adopted.
    scene_finish(&pose->older);
    pose->older = pose->loaded;
    pose->loaded = job->scene;
    pose->loaded.progress = NULL;
    job->scene = (struct scene){0};
    viewer_changed(viewer, CHANGE_GEOMETRY);
    take_lights(document, &pose->loaded);
    take_cameras(viewer, &pose->loaded);
    return take_meshes(document, &pose->loaded, err) && take_objects(document, &pose->loaded, err);
}

// --- loading poses -------------------------------------------------------------------------------

static void done(void *context, void *viewer, bool ok, const struct err *err)
{
    struct pose_job *job = context;
    struct pose *pose = &((struct viewer *)viewer)->document.pose;
    job->is_done = true;
    job->is_ok = ok;
    if (ok || err->code == ERR_STOPPED)
        return;
    viewer_message(viewer, MESSAGE_ERROR, "%s", err->msg);
    pose->wanted = pose->shown;
    pose->plays = false;
}

static void free_job(struct pose_job *job)
{
    scene_finish(&job->scene);
    free(job);
}

static void start(struct viewer *viewer)
{
    struct pose *pose = &viewer->document.pose;
    struct pose_job *job = calloc(1, sizeof *job);
    if (!job)
        return;
    job->pose = pose->wanted;
    job->progress = (struct progress){.should_stop = is_cancelled, .context = job};
    job->params = *animated(&viewer->document);
    job->params.at_seconds = job->pose.is_posed ? &job->pose.seconds : NULL;
    job->params.progress = &job->progress;
    const struct worker_task task = {.name = NAME, .run = run, .done = done, .context = job};
    if (worker_add(viewer->shell.worker, &task))
        pose->job = job;
    else
        free_job(job); // the next frame tries again
}

void pose_update(struct viewer *viewer)
{
    struct pose *pose = &viewer->document.pose;
    struct err err = {0};
    if (pose->job && pose->job->is_done && !rebuild_is_pending(viewer)) {
        struct pose_job *job = pose->job;
        pose->job = NULL;
        if (job->is_ok && take(viewer, job, &err))
            pose->shown = job->pose;
        else
            pose->wanted = pose->shown;
        if (err.code != ERR_NONE) {
            viewer_message(viewer, MESSAGE_ERROR, "%s", err.msg);
            pose->plays = false;
        }
        free_job(job);
    }
    if (!pose->job && pose_is_pending(viewer))
        start(viewer);
}

bool pose_is_played(const struct viewer *viewer)
{
    return viewer->document.pose.plays && pose_has_animation(viewer) && !viewer->stage.is_paused;
}

// Returns the time in [0, length) of an animation that repeats.
static double wrapped(double seconds, double length)
{
    return length > 0 ? fmod(fmod(seconds, length) + length, length) : 0;
}

// Advances a playing animation. This is no edit: it cannot be undone, and undone steps can still be
// redone.
void pose_play(struct viewer *viewer, double seconds)
{
    struct scene_pose *wanted = &viewer->document.pose.wanted;
    if (!pose_is_played(viewer))
        return;
    wanted->is_posed = 1;
    wanted->seconds = wrapped(wanted->seconds + viewer->document.pose.speed * seconds,
                              viewer->document.scene.animation_seconds);
    viewer->stage.is_resting = false;
}

void pose_finish(struct viewer *viewer)
{
    struct pose *pose = &viewer->document.pose;
    if (pose->job) {
        atomic_store(&pose->job->is_cancelled, true);
        while (!pose->job->is_done) {
            clock_sleep(1e-3);
            worker_poll(viewer->shell.worker, viewer);
        }
        free_job(pose->job);
        pose->job = NULL;
    }
    scene_finish(&pose->loaded);
    scene_finish(&pose->older);
}
