// Signed distance fields of a scene file: the tree of shapes and operations.
#include "scene/json/load_json.h"

#include "scene/core/affine.h"
#include "scene/sdf/sdf.h"
#include "scene/sdf/sdf_evaluate.h"
#include <math.h>
#include <string.h>

#define DEPTH_MOST 64 // maximum depth of the tree
#define LIST_MOST SDF_CODE_MAX
#define BALLS_MOST (4 * (SDF_CODE_MAX - 1))
#define COUNTS_MOST 1000000001 // maximum number of cells that single precision distinguishes

struct reader {
    struct scene *scene;
    struct arena scratch; // memory of the tree and of its places in the document
    uint32_t depth;
};

static const struct range LENGTH_OR_NONE = {0, SCENE_COORDINATE_MAX, false};

// Copies the node's place in the document to memory that lives as long as the tree, because
// children point to it.
static struct json_node *keep_place(struct reader *reader, struct json_node place)
{
    struct json_node *kept = ARENA_NEW(&reader->scratch, struct json_node, 1);
    if (kept)
        *kept = place;
    return kept;
}

// --- shapes --------------------------------------------------------------------------------------

static bool read_length(const struct json_node *node, const char *key, double factor, double *out,
                        struct err *err)
{
    if (!node_read_number(node, key, RANGE_RADIUS, out, err))
        return false;
    *out *= factor;
    return true;
}

// Reads the lengths of whole edges and halves them.
static bool read_size(const struct json_node *node, double half[3], struct err *err)
{
    if (!node_read_vector(node, "size", RANGE_RADIUS, half, err))
        return false;
    for (int i = 0; i < 3; i++)
        half[i] /= 2;
    return true;
}

static bool check_at_most(const struct json_node *node, const char *key, double value, double most,
                          const char *what, struct err *err)
{
    const struct json_node member = node_member(node, key);
    return value <= most || node_fail(member.value ? &member : node, err,
                                      "%.9g is more than %s, %.9g", value, what, most);
}

static bool read_sphere(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    return read_length(node, "radius", 1, &n->a[0], err);
}

static bool read_box(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    if (!read_size(node, n->a, err) ||
        !node_read_number(node, "round", LENGTH_OR_NONE, &n->b[0], err))
        return false;
    return check_at_most(node, "round", n->b[0], fmin(n->a[0], fmin(n->a[1], n->a[2])),
                         "half of the shortest edge", err);
}

static bool read_frame(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    if (!read_size(node, n->a, err) || !read_length(node, "bar", 0.5, &n->b[0], err))
        return false;
    return check_at_most(node, "bar", 2 * n->b[0], 2 * fmin(n->a[0], fmin(n->a[1], n->a[2])),
                         "the shortest edge", err);
}

static bool read_torus(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    return read_length(node, "radius", 1, &n->a[0], err) &&
           read_length(node, "tube", 1, &n->a[1], err);
}

static bool read_capsule(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    return node_read_vector(node, "from", RANGE_COORDINATE, n->a, err) &&
           node_read_vector(node, "to", RANGE_COORDINATE, n->b, err) &&
           read_length(node, "radius", 1, &n->b[3], err);
}

static bool read_cone(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    return node_read_number(node, "radius", LENGTH_OR_NONE, &n->a[0], err) &&
           node_read_number(node, "top", LENGTH_OR_NONE, &n->a[1], err) &&
           read_length(node, "height", 0.5, &n->a[2], err);
}

static bool read_cylinder(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    if (!read_length(node, "radius", 1, &n->a[0], err) ||
        !read_length(node, "height", 0.5, &n->a[1], err) ||
        !node_read_number(node, "round", LENGTH_OR_NONE, &n->a[2], err))
        return false;
    return check_at_most(node, "round", n->a[2], fmin(n->a[0], n->a[1]),
                         "the radius or half of the height", err);
}

static bool read_solid_angle(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    const struct range angles = {0.01, 180, false};
    double degrees = 0;
    if (!read_length(node, "radius", 1, &n->a[0], err) ||
        !node_read_number(node, "degrees", angles, &degrees, err))
        return false;
    if (degrees == 180) // the solid angle has no side surface
        n->op = SDF_SPHERE;
    n->b[0] = sin(degrees * DEGREE);
    n->b[1] = cos(degrees * DEGREE);
    return true;
}

static bool read_plane(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    const struct json_node normal = node_member(node, "normal");
    return node_read_vector(node, "normal", RANGE_COORDINATE, n->a, err) &&
           (vec3_normalize(n->a) || node_fail(&normal, err, "is zero; expected a direction")) &&
           node_read_number(node, "height", RANGE_COORDINATE, &n->b[0], err);
}

// An upper bound of |gradient| / k for the field sin x cos y + sin y cos z + sin z cos x; see
// docs/distance-fields.md.
#define GYROID_GRADIENT 1.7320508075688774

static bool read_gyroid(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    double period = 0;
    if (!read_length(node, "period", 1, &period, err) ||
        !read_length(node, "thickness", 0.5, &n->a[1], err))
        return false;
    n->a[0] = 2 * M_PI / period;
    n->b[0] = GYROID_GRADIENT * (1 + 1e-6); // still a bound after rounding
    return true;
}

static bool read_metaballs(struct reader *reader, const struct json_node *node, struct sdf_node *n,
                           struct err *err)
{
    const struct range thresholds = {0.001, 100, false};
    const struct json_node list = node_member(node, "balls");
    n->a[0] = 0.2;
    if (!node_read_number(node, "threshold", thresholds, &n->a[0], err) ||
        !node_check_array(&list, 1, BALLS_MOST, err))
        return false;
    n->count = (uint32_t)json_array_size(list.value);
    n->balls = arena_alloc(&reader->scratch, n->count, sizeof *n->balls);
    if (!n->balls)
        return err_memory(err, "metaballs", n->count * sizeof *n->balls);
    for (uint32_t k = 0; k < n->count; k++) {
        const struct json_node ball = node_element(&list, k);
        if (!node_numbers(&ball, 4, RANGE_COORDINATE, n->balls[k], err))
            return false;
        if (!(n->balls[k][3] >= RANGE_RADIUS.min))
            return node_fail(&ball, err, "reaches %.9g; expected at least %g", n->balls[k][3],
                             RANGE_RADIUS.min);
    }
    // Reducing the factor by the rounding error of single precision keeps the field a lower bound.
    n->a[1] = (1 - 1e-6) / sdf_metaballs_gradient((const double(*)[4])n->balls, n->count);
    return true;
}

static bool read_iterations(const struct json_node *node, struct sdf_node *n, uint64_t most,
                            struct err *err)
{
    uint64_t iterations = (uint64_t)n->a[1];
    bool ok = node_read_integer(node, "iterations", 0, most, &iterations, err);
    n->a[1] = (double)iterations;
    return ok;
}

static bool read_mandelbulb(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    const struct range powers = {2, 16, false};
    n->a[0] = 8;
    n->a[1] = 8;
    n->a[2] = 4;
    return node_read_number(node, "power", powers, &n->a[0], err) &&
           read_iterations(node, n, 32, err) && ((n->b[0] = sdf_fractal_factor(n)), true);
}

static bool read_sponge(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    n->a[1] = n->op == SDF_MENGER ? 4 : 8;
    return read_length(node, "size", 0.5, &n->a[0], err) &&
           read_iterations(node, n, n->op == SDF_MENGER ? 12 : 20, err);
}

static bool read_apollonian(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    const struct range scales = {1, 1.5, false};
    n->a[0] = 1.2;
    n->a[1] = 8;
    return node_read_number(node, "scale", scales, &n->a[0], err) &&
           read_iterations(node, n, 16, err) && ((n->b[0] = sdf_fractal_factor(n)), true);
}

// --- operations ----------------------------------------------------------------------------------

static bool read_node(struct reader *reader, const struct json_node *place, struct sdf_node *out,
                      struct err *err);

// Reads the child or the children at "of".
static bool read_children(struct reader *reader, struct sdf_node *n, bool is_list, struct err *err)
{
    const struct json_node *of = keep_place(reader, node_member(n->place, "of"));
    if (!of)
        return err_memory(err, "a field's tree", sizeof *of);
    if (is_list && !node_check_array(of, 1, LIST_MOST, err))
        return false;
    n->count = is_list ? (uint32_t)json_array_size(of->value) : 1;
    n->children = ARENA_NEW(&reader->scratch, struct sdf_node, n->count);
    if (!n->children)
        return err_memory(err, "a field's tree", n->count * sizeof *n->children);
    for (uint32_t k = 0; k < n->count; k++) {
        const struct json_node *child = is_list ? keep_place(reader, node_element(of, k)) : of;
        if (!child)
            return err_memory(err, "a field's tree", sizeof *child);
        if (!read_node(reader, child, &n->children[k], err))
            return false;
    }
    return true;
}

// Reads "counts", the number of cells along each axis, which is odd, because the middle cell is at
// the child's position.
static bool read_repeat(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    const struct json_node list = node_member(node, "counts");
    double counts[3];
    if (!node_read_vector(node, "spacing", LENGTH_OR_NONE, n->a, err))
        return false;
    for (int i = 0; i < 3; i++)
        n->b[i] = n->a[i] > 0 ? SDF_ENDLESS : 0;
    if (!list.value)
        return true;
    const struct range range = {1, COUNTS_MOST, false};
    if (!node_numbers(&list, 3, range, counts, err))
        return false;
    for (int i = 0; i < 3; i++) {
        const struct json_node count = node_element(&list, (size_t)i);
        if (fmod(counts[i], 2) != 1)
            return node_unexpected(&count, "an odd number", err);
        n->b[i] = n->a[i] > 0 ? (counts[i] - 1) / 2 : 0;
    }
    return true;
}

static bool read_axes(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    const char *axes = NULL;
    const struct json_node member = node_member(node, "axes");
    if (!node_read_string(node, "axes", &axes, err))
        return false;
    for (const char *axis = axes; axis && *axis; axis++) {
        if (*axis < 'x' || *axis > 'z' || n->a[*axis - 'x'] != 0)
            return node_unexpected(&member, "some of the letters x, y and z", err);
        n->a[*axis - 'x'] = 1;
    }
    return (axes && *axes) || node_unexpected(&member, "some of the letters x, y and z", err);
}

static bool read_operation(struct reader *reader, const struct json_node *node, struct sdf_node *n,
                           struct err *err)
{
    bool is_list = n->op <= SDF_DIFFERENCE, ok = true;
    switch (n->op) {
    case SDF_UNION:
    case SDF_INTERSECTION:
    case SDF_DIFFERENCE:
        ok = node_read_number(node, "smooth", LENGTH_OR_NONE, &n->a[0], err);
        break;
    case SDF_ROUND:
        ok = read_length(node, "radius", 1, &n->a[0], err);
        break;
    case SDF_SHELL:
        ok = read_length(node, "thickness", 0.5, &n->a[0], err);
        break;
    case SDF_REPEAT:
        ok = read_repeat(node, n, err);
        break;
    case SDF_TWIST:
        n->a[1] = 1;
        ok = node_read_number(node, "degrees", RANGE_COORDINATE, &n->a[0], err);
        n->a[0] *= M_PI / 180;
        break;
    default:
        ok = read_axes(node, n, err);
        break;
    }
    return ok && read_children(reader, n, is_list, err);
}

// --- nodes ---------------------------------------------------------------------------------------

static const struct {
    const char *name;
    const char *required[5], *optional[4];
    uint32_t op;
    bool (*read)(const struct json_node *node, struct sdf_node *n, struct err *err);
} types[] = {
    {"sphere", {"type", "radius"}, {"transform"}, SDF_SPHERE, read_sphere},
    {"box", {"type", "size"}, {"transform", "round"}, SDF_BOX, read_box},
    {"frame", {"type", "size", "bar"}, {"transform"}, SDF_FRAME, read_frame},
    {"torus", {"type", "radius", "tube"}, {"transform"}, SDF_TORUS, read_torus},
    {"capsule", {"type", "from", "to", "radius"}, {"transform"}, SDF_CAPSULE, read_capsule},
    {"cone", {"type", "radius", "height"}, {"transform", "top"}, SDF_CONE, read_cone},
    {"cylinder", {"type", "radius", "height"}, {"transform", "round"}, SDF_CYLINDER, read_cylinder},
    {"solid_angle",
     {"type", "radius", "degrees"},
     {"transform"},
     SDF_SOLID_ANGLE,
     read_solid_angle},
    {"plane", {"type", "normal"}, {"transform", "height"}, SDF_PLANE, read_plane},
    {"gyroid", {"type", "period", "thickness"}, {"transform"}, SDF_GYROID, read_gyroid},
    {"metaballs", {"type", "balls"}, {"transform", "threshold"}, SDF_METABALLS, NULL},
    {"mandelbulb", {"type"}, {"transform", "power", "iterations"}, SDF_MANDELBULB, read_mandelbulb},
    {"menger", {"type", "size"}, {"transform", "iterations"}, SDF_MENGER, read_sponge},
    {"pyramid", {"type", "size"}, {"transform", "iterations"}, SDF_PYRAMID, read_sponge},
    {"apollonian",
     {"type", "thickness"},
     {"transform", "scale", "iterations"},
     SDF_APOLLONIAN,
     read_apollonian},
    {"union", {"type", "of"}, {"transform", "smooth"}, SDF_UNION, NULL},
    {"intersection", {"type", "of"}, {"transform", "smooth"}, SDF_INTERSECTION, NULL},
    {"difference", {"type", "of"}, {"transform", "smooth"}, SDF_DIFFERENCE, NULL},
    {"round", {"type", "of", "radius"}, {"transform"}, SDF_ROUND, NULL},
    {"shell", {"type", "of", "thickness"}, {"transform"}, SDF_SHELL, NULL},
    {"repeat", {"type", "of", "spacing"}, {"transform", "counts"}, SDF_REPEAT, NULL},
    {"twist", {"type", "of", "degrees"}, {"transform"}, SDF_TWIST, NULL},
    {"mirror", {"type", "of", "axes"}, {"transform"}, SDF_MIRROR, NULL},
};
#define TYPES (sizeof types / sizeof *types)

static bool read_type(const struct json_node *node, uint32_t *type, struct err *err)
{
    const char *names[TYPES + 1];
    if (!json_is_object(node->value))
        return node_unexpected(node, "an object", err);
    if (!node_member(node, "type").value)
        return node_fail(node, err, "\"type\" is missing");
    for (uint32_t i = 0; i < TYPES; i++)
        names[i] = types[i].name;
    names[TYPES] = NULL;
    return node_read_choice(node, "type", names, type, err) &&
           node_check_object(node, types[*type].required, types[*type].optional, err);
}

static bool read_placement(const struct json_node *node, struct sdf_node *n, struct err *err)
{
    const struct json_node transform = node_member(node, "transform");
    if (!transform.value)
        return true;
    n->is_placed = true;
    return load_json_transform(&transform, n->to_parent, err) &&
           ((affine_uniform_scale(n->to_parent, &n->scale) && n->scale >= RANGE_RADIUS.min) ||
            node_fail(&transform, err,
                      "is not a rotation, translation and uniform scale above %g, the only "
                      "transforms that a distance field can have",
                      RANGE_RADIUS.min));
}

// Thickens an Apollonian packing, which is a surface without thickness, by an offset.
static bool thicken(struct reader *reader, const struct json_node *node, struct sdf_node *n,
                    struct err *err)
{
    struct sdf_node *sheet = ARENA_NEW(&reader->scratch, struct sdf_node, 1);
    if (!sheet)
        return err_memory(err, "a field's tree", sizeof *sheet);
    *sheet = *n;
    *n = (struct sdf_node){.place = n->place, .op = SDF_ROUND, .children = sheet, .count = 1};
    return read_length(node, "thickness", 0.5, &n->a[0], err);
}

static bool read_node(struct reader *reader, const struct json_node *place, struct sdf_node *out,
                      struct err *err)
{
    uint32_t type = 0;
    if (reader->depth >= DEPTH_MOST)
        return node_fail(place, err, "is inside of more than %d operations", DEPTH_MOST);
    if (!read_type(place, &type, err))
        return false;
    *out = (struct sdf_node){.place = place, .op = types[type].op};
    reader->depth++;
    bool ok = types[type].read           ? types[type].read(place, out, err)
              : out->op == SDF_METABALLS ? read_metaballs(reader, place, out, err)
                                         : read_operation(reader, place, out, err);
    reader->depth--;
    return ok && (out->op != SDF_APOLLONIAN || thicken(reader, place, out, err)) &&
           read_placement(place, out, err);
}

// --- the shape -----------------------------------------------------------------------------------

static bool read_clip(const struct json_node *bounds, struct bounds *clip, struct err *err)
{
    static const char *const required[] = {"min", "max", NULL};
    static const char *const optional[] = {NULL};
    if (!node_check_object(bounds, required, optional, err) ||
        !node_read_vector(bounds, "min", RANGE_COORDINATE, clip->min, err) ||
        !node_read_vector(bounds, "max", RANGE_COORDINATE, clip->max, err))
        return false;
    for (int i = 0; i < 3; i++)
        if (!(clip->min[i] < clip->max[i]))
            return node_fail(bounds, err, "max[%d] %.9g is not above min[%d] %.9g", i, clip->max[i],
                             i, clip->min[i]);
    return true;
}

#define CUT_SAMPLES 24 // samples along each edge of the bounding box

// Returns whether the field is negative at a sampled point on the faces of its bounding box. The
// box then cuts the solid, so that the surface has an opening there.
static bool is_cut(const struct sdf *sdf)
{
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 2 * CUT_SAMPLES * CUT_SAMPLES; k++) {
            const int u = k / 2 % CUT_SAMPLES, v = k / 2 / CUT_SAMPLES;
            const int steps[3] = {k % 2 * CUT_SAMPLES, u, v};
            double p[3];
            for (int i = 0; i < 3; i++) {
                int c = (axis + i) % 3;
                double part = (i == 0 ? steps[0] : steps[i] + 0.5) / CUT_SAMPLES;
                p[c] = sdf->min[c] + part * (sdf->max[c] - sdf->min[c]);
            }
            if (sdf_evaluate(sdf, p) < -1e-6 * sdf->magnitude)
                return true;
        }
    return false;
}

static bool note_cut(struct reader *reader, const struct json_node *bounds, const struct sdf *sdf,
                     struct err *err)
{
    if (!bounds->value || !is_cut(sdf))
        return true;
    struct err text = {0};
    node_fail(bounds, &text,
              "cuts the field open, so that there is no surface at the cut; an intersection with a "
              "box would close it");
    return scene_note(reader->scene, "%s", text.msg) || err_memory(err, "a note", sizeof text.msg);
}

static bool add_field(struct reader *reader, const struct json_node *node, uint32_t material,
                      struct err *err)
{
    const struct json_node field = node_member(node, "field"),
                           clip_node = node_member(node, "bounds");
    struct bounds clip;
    struct sdf_node root;
    struct scene *scene = reader->scene;
    if ((clip_node.value && !read_clip(&clip_node, &clip, err)) ||
        !read_node(reader, &field, &root, err))
        return false;
    struct sdf *sdf = scene_add_sdf(scene, NULL);
    struct shape *shape = scene_add_shape(scene, NULL);
    if (!sdf || !shape)
        return err_memory(err, "a distance field", sizeof *sdf);
    *shape = (struct shape){.kind = SHAPE_SDF, .material = material, .sdf = scene->sdf_count - 1};
    if (!sdf_compile(&root, clip_node.value ? &clip : NULL, &scene->arena, sdf, err))
        return false;
    sdf_place(sdf, shape);
    return note_cut(reader, &clip_node, sdf, err);
}

bool load_json_sdf(struct scene *scene, const struct json_node *node, uint32_t material,
                   struct err *err)
{
    struct reader reader = {.scene = scene};
    bool ok = add_field(&reader, node, material, err);
    arena_finish(&reader.scratch);
    return ok;
}
