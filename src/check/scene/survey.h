// Declares the data that the searches of a scene share: its geometry as rendered, the camera's
// view, and the list of findings. Internal to src/check/scene/.
#ifndef LAMPYRIS_CHECK_SCENE_SURVEY_H
#define LAMPYRIS_CHECK_SCENE_SURVEY_H

#include "check/check_scene.h"
#include "flatten/geometry.h"
#include "job/job.h"
#include "render/probe/ray_probe.h"

// The greatest number of surfaces along a line.
#define SIGHTING_STEPS 12

// A surface that a ray hits. Positions are in the flat scene's space.
struct sighting {
    struct probe_hit hit;
    uint32_t object;   // index of the object: all instances of the scene, then all shapes
    uint32_t material; // index in the scene
    double point[3];
    double normal[3]; // unit vector to the outside, from which the corners are counter-clockwise
    bool is_front;    // the ray comes from outside
};

// A straight line through the scene. It passes all surfaces that transmit light and ends at the
// first one that does not.
struct sightline {
    double origin[3], direction[3];
    // The surface at which the line starts instead of `origin`; or NULL.
    const struct sighting *from;
    double length;  // surfaces beyond this length are ignored; INFINITY: no limit
    uint32_t media; // the media stack at the start, as in lib/media.glsl
    struct sighting steps[SIGHTING_STEPS];
    uint32_t count;
    bool is_open; // there is no surface beyond the last step
};

struct survey {
    const struct check_scene_params *params;
    struct scene *scene;
    struct arena *arena; // owns the findings
    struct arena scratch;
    struct geometry geometry;
    const struct flat_scene *flat;
    const struct camera *camera;
    struct settings settings; // the scene's own settings, with the size of the full image
    const char *refusal;      // why a render of the full image cannot be planned; NULL if it can
    uint64_t least_bytes;     // device memory that a render of the full image needs without its
                              // waves
    uint64_t small_bytes;     // device memory that the render of the small image takes
    struct job_params small;  // parameters of the job that renders the small image
    struct job job;           // the job of the small image; end_job() finishes it, and later
                              // searches start others
    struct sightline *lines;  // one line for each pixel of the small image
    uint32_t line_count;
    // Set by find_twice(): a number for each object, equal for objects at the same place.
    uint32_t *places;
    struct twin_list *twins; // set by find_twice(): the objects at the same place, for name_twice()
    // Set by find_coincident(): flags of lines through coincident surfaces; see struct
    // coincidences.
    const uint8_t *through_faces;
    bool names_faces;     // a finding about coincident faces exists
    const char *unscaled; // set by find_biases(): the text that find_unscaled() reports, or NULL
    // Set by find_hidden_lights(): flags of the sources of light that lines from visible surfaces
    // have reached, through glass or not. NULL: no lines were traced.
    bool *is_reached;
    // Set by find_hidden_lights(): luminance of the environment below which shadow rays omit it.
    double sky_floor;
    struct scene_findings *out;
    bool lacks_memory; // there was no memory for flags
};

// --- survey.c ------------------------------------------------------------------------------------

// Adds a finding whose strings are owned by survey->arena. Fails if a string is NULL, which means
// that memory ran out.
bool survey_add(struct survey *survey, const struct scene_finding *finding, struct err *err);
// Return names for messages, owned by survey->arena: "instance 3 of mesh \"leaf\"", "shape 2, a
// sphere", "material \"glass\"".
const char *survey_object_name(const struct survey *survey, uint32_t object);
const char *survey_material_name(const struct survey *survey, uint32_t material);
// Returns whether surfaces of the material may have gaps, by an alpha mask or by blending.
bool survey_has_gaps(const struct survey *survey, uint32_t material);
// Returns whether two surfaces of the material at the same place both contribute; lamps do if both
// get shadow rays.
bool survey_counts_twice(const struct survey *survey, uint32_t material);
// Returns whether two surfaces at the same place may look different from a single one.
bool survey_differs_doubled(const struct survey *survey, uint32_t material_a, uint32_t material_b);
// Returns the materials in the form in which they are uploaded, with the numbers of their media.
const struct gpu_material *survey_gpu_materials(const struct survey *survey);
// Returns a pointer to the `hidden` flag of an object.
bool *survey_hidden(const struct survey *survey, uint32_t object);
static inline uint32_t survey_object_count(const struct survey *survey)
{
    return survey->scene->instance_count + survey->scene->shape_count;
}

// Sources of light are numbered: first the scene's lights, then its materials, then its
// environment.
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

// Returns the mean luminance of the pixels of the small image.
double survey_mean_light(const struct survey *survey, float (*pixels)[3]);

static inline bool survey_is_instance(const struct survey *survey, uint32_t object)
{
    return object < survey->scene->instance_count;
}

// --- sightlines.c --------------------------------------------------------------------------------

// Traces lines whose origin, direction, length and media are set; fills in the surfaces that they
// hit.
bool sightlines_trace(struct survey *survey, struct sightline *lines, uint32_t count,
                      struct err *err);
// Traces a line of the camera for each pixel of the small image into survey->lines.
bool sightlines_take_view(struct survey *survey, struct err *err);
// Computes the surface that a ray hit. hit->primitive must not be NO_PRIMITIVE.
void sighting_find(const struct survey *survey, const struct probe_hit *hit, const double origin[3],
                   const double direction[3], struct sighting *out);
// Computes the outward normal, not normalised, of a shape at the point of its surface that is
// nearest to `point`.
void sighting_shape_normal(const struct survey *survey, const struct flat_shape *shape,
                           const double point[3], double normal[3]);
// Returns the bound that kernels use for the rounding error of a point on a triangle: gamma(7)
// times its largest coordinate (Pharr, Jakob, Humphreys 2023, section 6.8.5), rounded up.
double sighting_rounding(const double point[3]);
// Returns a ray that leaves a surface on the side to which the direction points.
struct probe_ray sighting_leave(const struct sighting *at, const double direction[3]);
// Computes the direction with this number in a sequence that is distributed by the cosine over the
// hemisphere about a unit normal: points of Roberts's sequence (2018) on a sphere that touches the
// surface. No direction is so close to the surface that rounding decides on which side it is.
void sighting_scatter(const double normal[3], uint32_t number, double out[3]);
// Returns the surface at which a line of the camera ends, or NULL if lights cannot illuminate it.
const struct sighting *sightline_lit_place(const struct survey *survey,
                                           const struct sightline *seen);
// The height above a surface, in units of the rounding error of its points, at which a point is
// certainly above the surface: rounding leaves six binary digits of the height.
#define SIGHTING_HEIGHT 64.0
// Lines to a point end just before it, at this fraction of their length.
#define SIGHTLINE_SHORT_OF (1.0 - 0x1p-12)
// Returns whether surfaces of the material transmit light, refracted or not.
bool material_lets_through(const struct material *material);

// Allocates a flag, initially 0, for each line of the camera, in survey->arena. Returns NULL when
// out of memory, which check_scene() reports.
uint8_t *survey_flags(struct survey *survey);
// Returns the fraction of flags that are set; 0 for NULL.
double survey_share(const struct survey *survey, const uint8_t *flags);
// Flags the lines that hit a surface for which `meets` returns true, possibly behind surfaces that
// transmit light.
typedef bool (*sighting_fn)(const struct survey *survey, const struct sighting *at,
                            const void *context);
const uint8_t *survey_touched(struct survey *survey, sighting_fn meets, const void *context);
const uint8_t *survey_touched_by_object(struct survey *survey, uint32_t object);
// `marked` has one flag for each object.
const uint8_t *survey_touched_by_objects(struct survey *survey, const bool *marked);
const uint8_t *survey_touched_by_material(struct survey *survey, uint32_t material);

// --- find_coincident.c ---------------------------------------------------------------------------

// The lines that hit surfaces which coincide, or which are so close together that a line from far
// away cannot distinguish them.
struct coincidences {
    // Flags of lines at which one of the two surfaces transmits light, so that rounding decides
    // whether the line enters or leaves it.
    uint8_t *through;
    uint8_t *touched; // flags of lines at which the two surfaces look different from a single one
    uint32_t count;   // number of lines flagged in `touched`
    struct sighting pair[2]; // the first two surfaces
    // Distance between the two surfaces along the line, in metres, if only the line's length makes
    // them indistinguishable; otherwise 0.
    double apart;
};

bool coincidences_find(struct survey *survey, const struct sightline *lines, uint32_t count,
                       struct coincidences *out, struct err *err);
// Adds the finding unless there are too few lines or the finding exists already. `pixels` are the
// affected pixels of the small image.
bool coincidences_add(struct survey *survey, const struct coincidences *coincidences,
                      const uint8_t *pixels, struct err *err);
// Moves a point to the nearest point of a shape's surface. Distance fields are not supported.
void shape_put_on(const struct survey *survey, const struct flat_shape *shape, double point[3]);

// --- lamp_places.c, light_reach.c ----------------------------------------------------------------

// Selects up to `most` points on the emissive surfaces of a material (SCENE_NONE: of all
// materials), in proportion to their power. The points are returned in lines[].steps[0]. Returns
// their number.
uint32_t lamp_places_take(const struct survey *survey, uint32_t material, uint32_t most,
                          struct sightline *lines);
// Flags the pixels that light from some of these points reaches directly or after at most three
// reflections, as far as a few lines per pixel show. The points must have the normals of their
// surfaces.
bool survey_lit_from(struct survey *survey, const struct sighting *places, uint32_t count,
                     uint8_t **flags, struct err *err);

// --- measure_outlook.c ---------------------------------------------------------------------------

#define OUTLOOK_SAMPLES 64u // per pixel
// Renders OUTLOOK_SAMPLES samples per pixel with a started job of the small image, and estimates
// their error. *seconds receives the rendering time. The caller finishes out->arena in any case.
bool outlook_render(struct survey *survey, struct job *job, struct job_estimate *out,
                    double *seconds, struct err *err);
// Returns the number of samples per pixel, or an upper bound of it, that the desired error takes,
// extrapolated from OUTLOOK_SAMPLES; NAN if not known.
double outlook_samples(const struct survey *survey, const struct half_error *error);
// Computes the outlook. *in_view receives a flag for each pixel in which an emitter may be visible;
// NULL: there is none.
bool measure_outlook(struct survey *survey, const uint8_t **in_view, struct err *err);

// --- render_again.c ------------------------------------------------------------------------------

// Samples per pixel of each of these renders. All of them use the same random numbers.
#define AGAIN_SAMPLES 16u
// Renders the small image with the current settings of survey->scene, after survey->job has ended.
// *luminances receives the mean luminance of each pixel, in survey->scratch.
bool survey_render_again(struct survey *survey, double **luminances, struct err *err);
// Does the same without the marked objects. `marked` has a flag for each object.
bool survey_render_without(struct survey *survey, const bool *marked, double **luminances,
                           struct err *err);
// Returns the sum of the absolute differences between pixels, relative to the total light of the
// brighter image. *touched receives flags of the pixels that differ by more than 1 %.
double survey_difference(struct survey *survey, const double *a, const double *b,
                         const uint8_t **touched);
// If images differ by less than this, they count as equal: rounding changes a few paths.
#define DIFFERENCE_MIN 1e-3

// --- light_sent.c --------------------------------------------------------------------------------

// Returns the luminance of a light's irradiance, in W/m^2, at a place in world space on a surface
// that faces the light, without occlusion. It depends on distance, range, cone and profile. If the
// result is not 0, `towards` is the unit direction to the light's centre.
double light_sent(const struct light *light, const double place[3], double towards[3]);

// --- searches: each adds findings ---------------------------------------------------------------

// Objects, meshes or views that single precision does not resolve.
bool find_coarse(struct survey *survey, struct err *err);
// Triangles with little or no area, instances without volume.
bool find_thin(struct survey *survey, struct err *err);
bool find_twice(struct survey *survey, struct err *err); // objects at the same place
bool name_twice(struct survey *survey, struct err *err); // adds the finding about these objects
bool find_coincident(struct survey *survey, struct err *err); // faces that coincide
bool find_normals(struct survey *survey, struct err *err);    // normals that contradict the surface
// Media with open, inside-out or overlapping surfaces.
bool find_media(struct survey *survey, struct err *err);
// Materials that reflect all light or more.
bool find_albedos(struct survey *survey, struct err *err);
// Missing images, invalid texels, suns of one texel.
bool find_texels(struct survey *survey, struct err *err);
// Lights behind glass or without shadow rays.
bool find_hidden_lights(struct survey *survey, struct err *err);
// Delta lights whose light mirrors reflect.
bool find_mirrored_lights(struct survey *survey, struct err *err);
// Spots that light less than a pixel.
bool find_narrow_spots(struct survey *survey, struct err *err);
bool find_lights_on_faces(struct survey *survey, struct err *err); // delta lights on a surface
bool find_biases(struct survey *survey, struct err *err);          // settings that omit light
bool find_unscaled(struct survey *survey, struct err *err);        // radiance_scaling
bool find_memory(struct survey *survey, struct err *err); // too little device memory for the image
// Lights that get shadow rays but contribute nothing.
bool find_idle_lights(struct survey *survey, struct err *err);
// These searches measure: they render the small image.
bool measure_noise(struct survey *survey,
                   struct err *err); // the tail of the samples, and the outlook
bool measure_depth(struct survey *survey, struct err *err);

#endif
