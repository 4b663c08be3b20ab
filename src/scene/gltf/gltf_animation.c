// Evaluates animations (glTF 2.0, section 3.11 and appendix C): the values of all channels at one
// time.
#include "scene/gltf/gltf_pose.h"

#include "scene/core/affine.h"
#include "scene/gltf/gltf_accessor.h"
#include "scene/mesh/mesh_loader.h"
#include <math.h>
#include <string.h>

enum path { PATH_TRANSLATION, PATH_ROTATION, PATH_SCALE, PATH_WEIGHTS, PATH_POINTER };
enum interpolation { LINEAR, STEP, CUBICSPLINE };

#define SMALL                                                                                      \
    (COMPONENT_BIT(COMPONENT_I8) | COMPONENT_BIT(COMPONENT_U8) | COMPONENT_BIT(COMPONENT_I16) |    \
     COMPONENT_BIT(COMPONENT_U16))

static const struct accessor_rule time_rule = {
    .use = "an animation's input", .components = 1, .types = COMPONENTS_FLOAT};
static const struct accessor_rule value_rules[] = {
    [PATH_TRANSLATION] = {.use = "a translation", .components = 3, .types = COMPONENTS_FLOAT},
    [PATH_ROTATION] = {.use = "a rotation",
                       .components = 4,
                       .types = COMPONENTS_FLOAT,
                       .normalized_types = SMALL},
    [PATH_SCALE] = {.use = "a scale", .components = 3, .types = COMPONENTS_FLOAT},
    [PATH_WEIGHTS] = {.use = "weights",
                      .components = 1,
                      .types = COMPONENTS_FLOAT,
                      .normalized_types = SMALL},
};

// A channel with its sampler, and the position of the time among its keys.
struct channel {
    struct arena arena;
    enum path path;
    uint32_t node;
    uint32_t width; // numbers per key
    enum interpolation interpolation;
    uint32_t key_count;
    const float *times; // owned by the player
    float *values;
    struct json_node output; // accessor of the values, for messages
    // The time is a fraction `part` (0 to 1) of the `interval`, in seconds, from key `before` to
    // the next one. Before the first key and after the last, `part` is 0.
    uint32_t before;
    double part, interval;
};

// State that the channels of an animation share.
struct player {
    struct gltf_load *load;
    struct arena arena;
    struct json_node samplers;
    double seconds;
    struct gltf_node_pose *poses;
    // Input accessors are read and checked once, because channels share them.
    struct key_times {
        float *values; // NULL: not yet read
        uint32_t count;
    } * times;
};

// --- reading -------------------------------------------------------------------------------------

static bool read_numbers(struct gltf_load *load, struct arena *arena, uint32_t accessor,
                         const struct accessor_rule *rule, float **out, struct accessor_view *view,
                         struct err *err)
{
    const struct gltf_document *document = &load->document;
    if (!accessor_view(document, accessor, rule, view, err))
        return false;
    float *values = arena_alloc(arena, view->count, rule->components * sizeof *values);
    if (!values)
        return gltf_no_memory(document, "an animation",
                              (uint64_t)view->count * rule->components * sizeof *values, err);
    if (!accessor_read_floats(view, values, err))
        return false;
    *out = values;
    return true;
}

static bool check_times(const struct accessor_view *view, const float *times, struct err *err)
{
    double last = -INFINITY;
    for (uint32_t i = 0; i < view->count; i++) {
        double time = (double)times[i];
        if (time < 0 || time <= last)
            return node_fail(&view->node, err,
                             "element %u is %g; expected times from 0 on that increase strictly", i,
                             time);
        last = time;
    }
    return true;
}

static bool read_times(struct player *player, struct channel *channel, uint32_t accessor,
                       struct err *err)
{
    struct key_times *times = &player->times[accessor];
    struct accessor_view view;
    if (!times->values) {
        if (!read_numbers(player->load, &player->arena, accessor, &time_rule, &times->values, &view,
                          err) ||
            !check_times(&view, times->values, err))
            return false;
        times->count = view.count;
    }
    channel->times = times->values;
    channel->key_count = times->count;
    return true;
}

static bool read_values(struct gltf_load *load, struct channel *channel, uint32_t accessor,
                        struct err *err)
{
    struct accessor_view view;
    const struct accessor_rule *rule = &value_rules[channel->path];
    if (!read_numbers(load, &channel->arena, accessor, rule, &channel->values, &view, err))
        return false;
    channel->output = view.node;
    uint64_t expected = (uint64_t)channel->key_count * (channel->width / rule->components) *
                        (channel->interpolation == CUBICSPLINE ? 3 : 1);
    if (view.count != expected)
        return node_fail(&view.node, err, "%u elements; expected %llu for %u keys of %s%s",
                         view.count, (unsigned long long)expected, channel->key_count, rule->use,
                         channel->interpolation == CUBICSPLINE ? " with tangents" : "");
    return true;
}

static bool read_sampler(struct player *player, const struct json_node *sampler,
                         struct channel *channel, struct err *err)
{
    struct gltf_load *load = player->load;
    static const char *const names[] = {"LINEAR", "STEP", "CUBICSPLINE", NULL};
    uint32_t accessors = load->document.counts[GLTF_ACCESSORS], input, output, choice = LINEAR;
    if (!json_is_object(sampler->value))
        return node_unexpected(sampler, "an object", err);
    if (!gltf_require(sampler, "input", err) || !gltf_require(sampler, "output", err) ||
        !gltf_read_index(sampler, "input", accessors, &input, err) ||
        !gltf_read_index(sampler, "output", accessors, &output, err) ||
        !node_read_choice(sampler, "interpolation", names, &choice, err))
        return false;
    channel->interpolation = (enum interpolation)choice;
    return read_times(player, channel, input, err) && read_values(load, channel, output, err);
}

// Finds the number of components of the channel's value. Fails if the node lacks the animated
// property.
static bool find_width(struct gltf_load *load, const struct json_node *target,
                       struct channel *channel, struct err *err)
{
    const struct gltf_document *document = &load->document;
    const struct json_node node = gltf_item(document, GLTF_NODES, channel->node);
    uint32_t mesh;
    if (channel->path != PATH_WEIGHTS) {
        channel->width = value_rules[channel->path].components;
        return !json_object_get(node.value, "matrix") ||
               node_fail(target, err, "nodes[%u] has a \"matrix\"; expected a node without",
                         channel->node);
    }
    if (!gltf_read_index(&node, "mesh", document->counts[GLTF_MESHES], &mesh, err) ||
        (mesh != GLTF_NONE && !gltf_morph_count(load, mesh, &channel->width, err)))
        return false;
    return channel->width > 0 ||
           node_fail(target, err, "nodes[%u] has no mesh with morph targets", channel->node);
}

// Reads the target of a channel. *is_ignored becomes true if the target belongs to an extension.
static bool read_target(struct gltf_load *load, const struct json_node *node,
                        struct channel *channel, bool *is_ignored, struct err *err)
{
    static const char *const names[] = {"translation", "rotation", "scale",
                                        "weights",     "pointer",  NULL};
    struct json_node target;
    uint32_t choice = 0;
    if (!gltf_require(node, "target", err) || !gltf_read_object(node, "target", &target, err) ||
        !gltf_require(&target, "path", err) ||
        !node_read_choice(&target, "path", names, &choice, err) ||
        !gltf_read_index(&target, "node", load->document.counts[GLTF_NODES], &channel->node, err))
        return false;
    channel->path = (enum path)choice;
    *is_ignored = channel->path == PATH_POINTER || channel->node == GLTF_NONE;
    return *is_ignored || find_width(load, &target, channel, err);
}

// --- values --------------------------------------------------------------------------------------

static void place_time(struct channel *channel, double seconds)
{
    uint32_t low = 0, high = channel->key_count; // times[low] <= seconds < times[high]
    if (!(seconds > (double)channel->times[0]))
        return;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if ((double)channel->times[middle] <= seconds)
            low = middle;
        else
            high = middle;
    }
    channel->before = low;
    if (high == channel->key_count)
        return;
    channel->interval = (double)channel->times[high] - (double)channel->times[low];
    channel->part = (seconds - (double)channel->times[low]) / channel->interval;
}

// Returns component c of key `key`. `slot` is for splines: 0 in-tangent, 1 value, 2 out-tangent.
static double key_number(const struct channel *channel, uint32_t key, uint32_t slot, uint32_t c)
{
    size_t index = channel->interpolation == CUBICSPLINE ? 3 * (size_t)key + slot : key;
    return (double)channel->values[index * channel->width + c];
}

static bool read_rotation_key(const struct channel *channel, uint32_t key, double out[4],
                              struct err *err)
{
    double square = 0;
    for (uint32_t c = 0; c < 4; c++) {
        out[c] = key_number(channel, key, 1, c);
        square += out[c] * out[c];
    }
    for (int c = 0; c < 4 && square > 0; c++)
        out[c] /= sqrt(square);
    return square > 0 ||
           node_fail(&channel->output, err, "key %u: the zero quaternion is not a rotation", key);
}

// Interpolates rotations spherically along the shorter arc (appendix C.4; Shoemake 1985).
static bool turn(const struct channel *channel, double out[4], struct err *err)
{
    double a[4], b[4], dot = 0;
    if (!read_rotation_key(channel, channel->before, a, err) ||
        !read_rotation_key(channel, channel->before + 1, b, err))
        return false;
    for (int c = 0; c < 4; c++)
        dot += a[c] * b[c];
    double angle = acos(fmin(fabs(dot), 1)), t = channel->part;
    double weight_a = angle > 0 ? sin(angle * (1 - t)) / sin(angle) : 1 - t;
    double weight_b = angle > 0 ? sin(angle * t) / sin(angle) : t;
    for (int c = 0; c < 4; c++)
        out[c] = weight_a * a[c] + copysign(weight_b, dot) * b[c];
    return true;
}

// Evaluates a cubic Hermite spline, whose tangents are per second (appendix C.5).
static double spline(const struct channel *channel, uint32_t c)
{
    double t = channel->part, t2 = t * t, t3 = t2 * t;
    uint32_t k = channel->before;
    return (2 * t3 - 3 * t2 + 1) * key_number(channel, k, 1, c) +
           channel->interval * (t3 - 2 * t2 + t) * key_number(channel, k, 2, c) +
           (3 * t2 - 2 * t3) * key_number(channel, k + 1, 1, c) +
           channel->interval * (t3 - t2) * key_number(channel, k + 1, 0, c);
}

static bool evaluate(const struct channel *channel, double *out, struct err *err)
{
    bool is_at_key = channel->part == 0 || channel->interpolation == STEP;
    if (!is_at_key && channel->interpolation == LINEAR && channel->path == PATH_ROTATION)
        return turn(channel, out, err);
    for (uint32_t c = 0; c < channel->width; c++) {
        double value = key_number(channel, channel->before, 1, c);
        if (!is_at_key && channel->interpolation == CUBICSPLINE)
            value = spline(channel, c);
        else if (!is_at_key)
            value += channel->part * (key_number(channel, channel->before + 1, 1, c) - value);
        out[c] = value;
    }
    if (channel->path == PATH_ROTATION && out[0] == 0 && out[1] == 0 && out[2] == 0 && out[3] == 0)
        return node_fail(&channel->output, err,
                         "the zero quaternion after key %u is not a rotation", channel->before);
    return true;
}

// --- the pose ------------------------------------------------------------------------------------

// Returns where to store the channel's value; NULL with *err set if another channel has already set
// it.
static double *open_value(struct gltf_load *load, const struct json_node *node,
                          const struct channel *channel, struct gltf_node_pose *pose,
                          struct err *err)
{
    bool *const has[] = {&pose->has_translation, &pose->has_rotation, &pose->has_scale};
    double *const values[] = {pose->translation, pose->rotation, pose->scale};
    bool is_taken = channel->path == PATH_WEIGHTS ? pose->weights != NULL : *has[channel->path];
    if (is_taken) {
        node_fail(node, err, "another channel already animates %s of nodes[%u]",
                  value_rules[channel->path].use, channel->node);
        return NULL;
    }
    if (channel->path != PATH_WEIGHTS) {
        *has[channel->path] = true;
        return values[channel->path];
    }
    double *weights = ARENA_NEW(&load->document.arena, double, channel->width);
    if (!weights)
        gltf_no_memory(&load->document, "weights", channel->width * sizeof *weights, err);
    pose->weights = weights;
    pose->weight_count = channel->width;
    return weights;
}

static bool apply_channel(struct player *player, const struct json_node *node,
                          struct channel *channel, struct err *err)
{
    struct gltf_load *load = player->load;
    uint32_t sampler = 0;
    bool is_ignored;
    if (!json_is_object(node->value))
        return node_unexpected(node, "an object", err);
    if (!gltf_require(node, "sampler", err) ||
        !gltf_read_index(node, "sampler", (uint32_t)json_array_size(player->samplers.value),
                         &sampler, err) ||
        !read_target(load, node, channel, &is_ignored, err))
        return false;
    load->tally.ignored_channels += is_ignored;
    if (is_ignored)
        return true;
    const struct json_node sampler_node = node_element(&player->samplers, sampler);
    double *value = open_value(load, node, channel, &player->poses[channel->node], err);
    if (!value || !read_sampler(player, &sampler_node, channel, err))
        return false;
    place_time(channel, player->seconds);
    load->scene->animation_seconds =
        fmax(load->scene->animation_seconds, (double)channel->times[channel->key_count - 1]);
    return evaluate(channel, value, err);
}

static bool play(struct player *player, const struct json_node *channels, struct err *err)
{
    const struct gltf_document *document = &player->load->document;
    uint32_t count = document->counts[GLTF_ACCESSORS];
    player->times = ARENA_NEW(&player->arena, struct key_times, count);
    if (!player->times)
        return gltf_no_memory(document, "an animation", count * sizeof *player->times, err);
    for (size_t i = 0; i < json_array_size(channels->value); i++) {
        const struct json_node node = node_element(channels, i);
        struct channel channel = {0};
        bool ok = apply_channel(player, &node, &channel, err);
        arena_finish(&channel.arena);
        if (!ok)
            return false;
    }
    return true;
}

bool gltf_animation_pose(struct gltf_load *load, const char *name, double seconds,
                         struct gltf_node_pose **poses, struct err *err)
{
    struct gltf_document *document = &load->document;
    struct player player = {.load = load, .seconds = seconds};
    uint32_t index = 0, node_count = document->counts[GLTF_NODES];
    struct json_node channels;
    *poses = NULL;
    if (name && !gltf_find(document, GLTF_ANIMATIONS, "animation", name, &index, err))
        return false;
    if (document->counts[GLTF_ANIMATIONS] == 0)
        return true;
    const struct json_node animation = gltf_item(document, GLTF_ANIMATIONS, index);
    if (!gltf_require(&animation, "channels", err) || !gltf_require(&animation, "samplers", err) ||
        !gltf_read_array(&animation, "channels", &channels, err) ||
        !gltf_read_array(&animation, "samplers", &player.samplers, err))
        return false;
    *poses = ARENA_NEW(&document->arena, struct gltf_node_pose, node_count);
    if (!*poses)
        return gltf_no_memory(document, "poses", node_count * sizeof **poses, err);
    player.poses = *poses;
    bool ok = play(&player, &channels, err);
    arena_finish(&player.arena);
    return ok;
}
