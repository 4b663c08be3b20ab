// The data that the searches of a scene share: its geometry as rendered, the camera's view, and the
// list of findings. Internal to src/check/scene/.
#ifndef LAMPYRIS_CHECK_SCENE_SURVEY_H
#define LAMPYRIS_CHECK_SCENE_SURVEY_H

#include "check/check_scene.h"
#include "flatten/geometry.h"
#include "job/job.h"
#include "render/probe/ray_probe.h"

// The greatest number of surfaces along a sight line.
#define SIGHTING_STEPS 12

// A surface that a ray hits. Positions are in the flat scene's space.
struct sighting {
    struct probe_hit hit;
    uint32_t object;   // instances of the scene, then shapes
    uint32_t material; // index in the scene
    double point[3];
    double normal[3]; // unit, outward: the side from which the corners are counter-clockwise
    bool is_front;    // the ray comes from outside
};

// A straight line through the scene: through all surfaces that transmit light, up to one that does
// not.
struct sightline {
    double origin[3], direction[3];
    const struct sighting *from; // the surface at which it starts, in place of `origin`; or NULL
    double length;               // nothing beyond it counts; INFINITY: no limit
    uint32_t media;              // the media stack at its start, as in lib/media.glsl
    struct sighting steps[SIGHTING_STEPS];
    uint32_t count;
    bool is_open; // nothing is behind the last step
};

struct survey {
    const struct check_scene_params *params;
    struct scene *scene;
    struct arena *arena; // holds the findings
    struct arena scratch;
    struct geometry geometry;
    const struct flat_scene *flat;
    const struct camera *camera;
    struct settings settings; // the scene's own settings, with its own image size
    const char *refusal;      // why no render of that size can be planned; or NULL
    uint64_t least_bytes;     // device memory that such a render needs, without its waves
    uint64_t small_bytes;     // device memory of the render of the small image
    struct job_params small;  // a render of a small image
    struct job job;           // that render, until the last two searches start others
    struct sightline *lines;  // one for each pixel of it
    uint32_t line_count;
    uint32_t *places; // by find_twice(): a number for each object, the same for those at one place
    struct twin_list *twins;      // by the same: the objects at one place, for name_twice()
    const uint8_t *through_faces; // by find_coincident(): flags of the lines; see there
    bool names_faces;             // faces that lie upon each other are among the findings
    const char *unscaled;         // by find_biases(): what it is to report, if anything
    // By find_hidden_lights(): flags of sources that lines from what is seen have found, through
    // glass or not. NULL: it has sent none.
    bool *is_reached;
    double sky_floor; // set there, too: the luminance of the environment that shadow rays omit
    struct scene_findings *out;
    bool lacks_memory; // memory for flags ran out
};

// --- survey.c ------------------------------------------------------------------------------------

// Adds a finding whose strings are in survey->arena; a NULL string means that memory ran out.
bool survey_add(struct survey *survey, const struct scene_finding *finding, struct err *err);
// Return names for messages, in survey->arena: "instance 3 of mesh \"leaf\"", "shape 2, a sphere",
// "material \"glass\"".
const char *survey_object_name(const struct survey *survey, uint32_t object);
const char *survey_material_name(const struct survey *survey, uint32_t material);
// Returns whether surfaces of the material may have gaps, by a mask or by blending.
bool survey_has_gaps(const struct survey *survey, uint32_t material);
// Returns whether two surfaces of the material at the same place both count; lamps do if shadow
// rays are sent to both.
bool survey_counts_twice(const struct survey *survey, uint32_t material);
// Returns whether two surfaces at the same place may look different from one.
bool survey_differs_doubled(const struct survey *survey, uint32_t material_a, uint32_t material_b);
// Returns the materials as they are uploaded, with the numbers of their media.
const struct gpu_material *survey_gpu_materials(const struct survey *survey);
// Returns the address of an object's `hidden` flag.
bool *survey_hidden(const struct survey *survey, uint32_t object);
static inline uint32_t survey_object_count(const struct survey *survey)
{
    return survey->scene->instance_count + survey->scene->shape_count;
}

// Light sources are numbered: the scene's lights, then its materials, then its environment.
static inline uint32_t survey_lamp_source(const struct survey *survey, uint32_t material)
{
    return survey->scene->light_count + material;
}

static inline uint32_t survey_sky_source(const struct survey *survey)
{
    return survey->scene->light_count + survey->scene->material_count;
}

static inline uint32_t survey_source_count(const struct survey *survey)
{
    return survey_sky_source(survey) + 1;
}

// Returns the mean luminance of pixels of the small picture.
double survey_mean_light(const struct survey *survey, float (*pixels)[3]);

static inline bool survey_is_instance(const struct survey *survey, uint32_t object)
{
    return object < survey->scene->instance_count;
}

// --- sightlines.c --------------------------------------------------------------------------------

// Traces lines whose origin, direction, length and media are set.
bool sightlines_trace(struct survey *survey, struct sightline *lines, uint32_t count,
                      struct err *err);
// Traces the camera's lines, one for each pixel of the small image, into survey->lines.
bool sightlines_take_view(struct survey *survey, struct err *err);
// Computes the surface that a ray hit; hit->primitive is not NO_PRIMITIVE.
void sighting_find(const struct survey *survey, const struct probe_hit *hit, const double origin[3],
                   const double direction[3], struct sighting *out);
// Computes the outward normal of a shape at the point of its surface that is nearest; it is not
// normalized.
void sighting_shape_normal(const struct survey *survey, const struct flat_shape *shape,
                           const double point[3], double normal[3]);
// Returns the kernels' bound of the rounding error of a point on a triangle: gamma(7) of its
// largest coordinate (Pharr, Jakob, Humphreys 2023, section 6.8.5), rounded up.
double sighting_rounding(const double point[3]);
// Returns a ray that continues from a surface to the side to which the direction points.
struct probe_ray sighting_leave(const struct sighting *at, const double direction[3]);
// Computes direction `number` of a sequence distributed by the cosine over the hemisphere about a
// unit normal: points of Roberts's sequence (2018) on a sphere that touches the surface. None is so
// close to the surface that rounding decides its side.
void sighting_scatter(const double normal[3], uint32_t number, double out[3]);
// Returns the surface at which a line of the camera ends, or NULL if lights cannot light it.
const struct sighting *sightline_lit_place(const struct survey *survey,
                                           const struct sightline *seen);
// The height above a surface, in units of its rounding error, at which a point is certainly on that
// side: rounding leaves six binary digits of it.
#define SIGHTING_HEIGHT 64.0
// Lines to a point end just in front of it.
#define SIGHTLINE_SHORT_OF (1.0 - 0x1p-12)
// Returns whether its surfaces transmit light, refracted or not.
bool material_lets_through(const struct material *material);

// Allocates one flag for each of the camera's lines, that is for each pixel of the image, in
// survey->arena; all are 0. Returns NULL when out of memory, which check_scene() reports.
uint8_t *survey_flags(struct survey *survey);
// Returns the fraction of flags that are set; 0 for NULL.
double survey_share(const struct survey *survey, const uint8_t *flags);
// Flags the lines that hit a surface for which `meets` returns true, in front of or behind surfaces
// that transmit light.
typedef bool (*sighting_fn)(const struct survey *survey, const struct sighting *at,
                            const void *context);
const uint8_t *survey_touched(struct survey *survey, sighting_fn meets, const void *context);
const uint8_t *survey_touched_by_object(struct survey *survey, uint32_t object);
const uint8_t *survey_touched_by_objects(struct survey *survey, const bool *marked); // one for each
const uint8_t *survey_touched_by_material(struct survey *survey, uint32_t material);

// --- find_coincident.c ---------------------------------------------------------------------------

// Lines that hit coincident surfaces, or surfaces so close that a line from far away cannot
// distinguish them.
struct coincidences {
    uint8_t *through;        // flags of lines: one of the two surfaces transmits light, so that
                             // rounding decides whether the line enters or leaves there
    uint8_t *touched;        // flags of lines: the two surfaces look different from one
    uint32_t count;          // number of touched lines
    struct sighting pair[2]; // the first two surfaces
    double apart;            // distance along the line if the line's length hides it; or 0
};

bool coincidences_find(struct survey *survey, const struct sightline *lines, uint32_t count,
                       struct coincidences *out, struct err *err);
// Adds the finding, unless there are too few lines or it exists already. `pixels` are flags of the
// camera's lines.
bool coincidences_add(struct survey *survey, const struct coincidences *coincidences,
                      const uint8_t *pixels, struct err *err);
// Moves a point to the nearest point of a shape's surface; not for distance fields.
void shape_put_on(const struct survey *survey, const struct flat_shape *shape, double point[3]);

// --- lamp_places.c, light_reach.c ----------------------------------------------------------------

// Chooses up to `most` points on the emissive surfaces of a material, or of all materials
// (SCENE_NONE), in proportion to their power. lines[].steps[0] are the points. Returns their
// number.
uint32_t lamp_places_take(const struct survey *survey, uint32_t material, uint32_t most,
                          struct sightline *lines);
// Flags the pixels that light from some of these points, which have the normals of their surfaces,
// reaches after at most three reflections, as far as a few lines from each pixel show.
bool survey_lit_from(struct survey *survey, const struct sighting *places, uint32_t count,
                     uint8_t **flags, struct err *err);

// --- measure_outlook.c ---------------------------------------------------------------------------

#define OUTLOOK_SAMPLES 64u // per pixel
// Renders OUTLOOK_SAMPLES samples with a started job of the small image, and estimates their error.
// Finish out->arena in any case. *seconds: rendering time.
bool outlook_render(struct survey *survey, struct job *job, struct job_estimate *out,
                    double *seconds, struct err *err);
// Returns how many samples per pixel the desired error takes, or takes at most, extrapolated from
// OUTLOOK_SAMPLES; NAN if not known.
double outlook_samples(const struct survey *survey, const struct half_error *error);
// Reports the cost of a render to the desired error. *in_view: for each pixel, whether an emitter
// may be visible there; NULL: nowhere.
bool measure_outlook(struct survey *survey, const uint8_t **in_view, struct err *err);

// --- render_again.c ------------------------------------------------------------------------------

// Samples per pixel of each of these renders, which all use the same random numbers.
#define AGAIN_SAMPLES 16u
// Renders the small image with the current settings of survey->scene, when survey->job has ended.
// *luminances: of the pixels' means, in survey->scratch.
bool survey_render_again(struct survey *survey, double **luminances, struct err *err);
// Does the same without the objects that are marked; one flag for each object.
bool survey_render_without(struct survey *survey, const bool *marked, double **luminances,
                           struct err *err);
// Returns the sum of the differences between pixels, relative to the light of the brighter ones.
// *touched: flags of the pixels that differ by more than 1 %.
double survey_difference(struct survey *survey, const double *a, const double *b,
                         const uint8_t **touched);
// Below this difference the images count as equal: rounding changes a few paths.
#define DIFFERENCE_MIN 1e-3

// --- light_sent.c --------------------------------------------------------------------------------

// Returns the luminance of a light at a place of the world, in W/m^2 on a surface that faces it,
// without occlusion: it depends on distance, range, cone and profile. If it is not 0, `towards` is
// the unit direction to the light's centre.
double light_sent(const struct light *light, const double place[3], double towards[3]);

// --- searches: each adds what it finds -----------------------------------------------------------

bool find_coarse(struct survey *survey, struct err *err);     // objects, meshes, cameras
bool find_thin(struct survey *survey, struct err *err);       // slivers, zero areas, no volume
bool find_twice(struct survey *survey, struct err *err);      // objects at one place, which
bool name_twice(struct survey *survey, struct err *err);      // this one names
bool find_coincident(struct survey *survey, struct err *err); // faces upon each other
bool find_normals(struct survey *survey, struct err *err);    // those that contradict the surface
bool find_media(struct survey *survey, struct err *err);      // open, inside-out, overlapping
bool find_albedos(struct survey *survey, struct err *err);    // 1 and above
bool find_texels(struct survey *survey, struct err *err);     // missing, unusable, one-texel suns
bool find_hidden_lights(struct survey *survey, struct err *err);   // behind glass, and by chance
bool find_mirrored_lights(struct survey *survey, struct err *err); // lights that only mirrors show
bool find_narrow_spots(struct survey *survey, struct err *err);    // they light less than a pixel
bool find_lights_on_faces(struct survey *survey, struct err *err); // delta lights
bool find_biases(struct survey *survey, struct err *err);          // settings that bias
bool find_unscaled(struct survey *survey, struct err *err);        // radiance, by refraction
bool find_memory(struct survey *survey, struct err *err);          // too little for the picture
bool find_idle_lights(struct survey *survey, struct err *err);     // they take others' shadow rays
// Those that measure: each renders into the job's film.
bool measure_noise(struct survey *survey,
                   struct err *err); // the tail of the samples, and the outlook
bool measure_depth(struct survey *survey, struct err *err);

#endif
