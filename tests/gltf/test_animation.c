// Tests nodes at times of an animation against values computed by hand.
#include "gltf_builder.h"
#include "test.h"

#define TRIANGLE_LISTS "'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]"

static struct gltf_builder with_triangle(void)
{
    struct gltf_builder builder = {0};
    BUILDER_FLOATS(&builder, "VEC3", 3, 0, 0, 0, 1, 0, 0, 0, 1, 0);
    return builder;
}

// Loads a node with the mesh at `seconds`. It has one channel, with accessors 1 (times) and 2
// (values).
static bool load_channel(const struct gltf_builder *builder, const char *path,
                         const char *interpolation, double seconds, struct scene *scene,
                         struct err *err)
{
    char lists[512];
    snprintf(lists, sizeof lists,
             TRIANGLE_LISTS ",'nodes':[{'mesh':0}],'animations':[{'samplers':[{'input':1,"
                            "'output':2,'interpolation':'%s'}],"
                            "'channels':[{'sampler':0,'target':{'node':0,'path':'%s'}}]}]",
             interpolation, path);
    return builder_load(builder, lists, &(struct gltf_load_params){.at_seconds = &seconds}, scene,
                        err);
}

// Checks the node's matrix at `seconds` against `expected`, 12 numbers by rows.
static void check_channel(const struct gltf_builder *builder, const char *path,
                          const char *interpolation, double seconds, const double *expected)
{
    struct scene scene;
    struct err err;
    bool ok = load_channel(builder, path, interpolation, seconds, &scene, &err);
    CHECK(ok && scene.instance_count == 1, "%s", err.msg);
    for (int i = 0; ok && i < 12; i++)
        CHECK(fabs(scene.instances[0].transform[i / 4][i % 4] - expected[i]) < 1e-7,
              "%s %s at %g: [%d][%d] is %.9g, expected %.9g", path, interpolation, seconds, i / 4,
              i % 4, scene.instances[0].transform[i / 4][i % 4], expected[i]);
    scene_finish(&scene);
}

static void check_translation(const struct gltf_builder *builder, const char *interpolation,
                              double seconds, double x, double y, double z)
{
    check_channel(builder, "translation", interpolation, seconds,
                  (const double[]){1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z});
}

TEST(linear_and_step)
{
    struct gltf_builder builder = with_triangle();
    BUILDER_FLOATS(&builder, "SCALAR", 3, 1, 2, 4);
    BUILDER_FLOATS(&builder, "VEC3", 3, 0, 0, 0, 2, 4, 6, 0, 0, 8);
    static const struct {
        double seconds, linear[3], step[3];
    } cases[] = {
        {0, {0, 0, 0}, {0, 0, 0}}, // before the first keyframe
        {1, {0, 0, 0}, {0, 0, 0}},  {1.5, {1, 2, 3}, {0, 0, 0}},
        {2, {2, 4, 6}, {2, 4, 6}},  {2.5, {1.5, 3, 6.5}, {2, 4, 6}},
        {4, {0, 0, 8}, {0, 0, 8}},  {1e9, {0, 0, 8}, {0, 0, 8}}, // after the last keyframe
        {-5, {0, 0, 0}, {0, 0, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const double *linear = cases[i].linear, *step = cases[i].step;
        check_translation(&builder, "LINEAR", cases[i].seconds, linear[0], linear[1], linear[2]);
        check_translation(&builder, "STEP", cases[i].seconds, step[0], step[1], step[2]);
    }
}

TEST(one_key)
{
    struct gltf_builder builder = with_triangle();
    BUILDER_FLOATS(&builder, "SCALAR", 1, 3);
    BUILDER_FLOATS(&builder, "VEC3", 1, 1, 2, 3);
    check_translation(&builder, "LINEAR", 0, 1, 2, 3);
    check_translation(&builder, "LINEAR", 3, 1, 2, 3);
    check_translation(&builder, "STEP", 7, 1, 2, 3);
}

// The spline goes from 0 with slope 4 per second to 8 with slope -2, in two seconds. At t = 1/4
// (half a second) the four weights are 54/64, 2 * 9/64, 10/64 and 2 * -3/64.
TEST(cubic_spline)
{
    struct gltf_builder builder = with_triangle();
    BUILDER_FLOATS(&builder, "SCALAR", 2, 1, 3);
    BUILDER_FLOATS(&builder, "VEC3", 6, 9, 9, 9, 0, 1, 0, 4, 0, 0, // in-tangent, value, out-tangent
                   -2, 0, 1, 8, 3, 0, 9, 9, 9);
    const double x = 18.0 / 64 * 4 + 10.0 / 64 * 8 - 6.0 / 64 * -2;
    const double y = 54.0 / 64 * 1 + 10.0 / 64 * 3, z = -6.0 / 64 * 1;
    check_translation(&builder, "CUBICSPLINE", 1.5, x, y, z);
    check_translation(&builder, "CUBICSPLINE", 0, 0, 1, 0);
    check_translation(&builder, "CUBICSPLINE", 1, 0, 1, 0);
    check_translation(&builder, "CUBICSPLINE", 3, 8, 3, 0);
    check_translation(&builder, "CUBICSPLINE", 9, 8, 3, 0);
}

TEST(scale)
{
    struct gltf_builder builder = with_triangle();
    BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 1);
    BUILDER_FLOATS(&builder, "VEC3", 2, 1, 1, 1, 3, 1, -1);
    check_channel(&builder, "scale", "LINEAR", 0.25,
                  (const double[]){1.5, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0.5, 0});
}

static void check_turn(const struct gltf_builder *builder, const char *interpolation,
                       double seconds, double degrees)
{
    double c = cos(degrees / 180 * 3.14159265358979323846);
    double s = sin(degrees / 180 * 3.14159265358979323846);
    check_channel(builder, "rotation", interpolation, seconds,
                  (const double[]){c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0});
}

// A quarter turn about Z with constant angular velocity. Its quaternions may have either sign.
TEST(spherical_interpolation)
{
    const float h = 0.70710678f;
    for (int sign = -1; sign <= 1; sign += 2) {
        struct gltf_builder builder = with_triangle();
        BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 3);
        BUILDER_FLOATS(&builder, "VEC4", 2, 0, 0, 0, 1, 0, 0, (float)sign * h, (float)sign * h);
        check_turn(&builder, "LINEAR", 0, 0);
        check_turn(&builder, "LINEAR", 1, 30);
        check_turn(&builder, "LINEAR", 2, 60);
        check_turn(&builder, "LINEAR", 2.9, 87);
        check_turn(&builder, "LINEAR", 3, 90);
        check_turn(&builder, "STEP", 2.9, 0);
    }
}

TEST(equal_rotations)
{
    struct gltf_builder builder = with_triangle();
    BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 1);
    BUILDER_FLOATS(&builder, "VEC4", 2, 0, 0, 0.6f, 0.8f, 0, 0, 0.6f, 0.8f);
    check_turn(&builder, "LINEAR", 0.5, 2 * asin(0.6) * 180 / 3.14159265358979323846);
}

TEST(quantized_rotations)
{
    const int8_t i8[2][4] = {{0, 0, 0, 127}, {0, 0, 90, 90}};
    const uint8_t u8[2][4] = {{0, 0, 0, 255}, {0, 0, 90, 90}};
    const int16_t i16[2][4] = {{0, 0, 0, 32767}, {0, 0, 90, 90}};
    const uint16_t u16[2][4] = {{0, 0, 0, 65535}, {0, 0, 90, 90}};
    const struct {
        int code;
        const void *data;
        size_t size;
    } cases[] = {{BYTE_CODE, i8, sizeof i8},
                 {UNSIGNED_BYTE_CODE, u8, sizeof u8},
                 {SHORT_CODE, i16, sizeof i16},
                 {UNSIGNED_SHORT_CODE, u16, sizeof u16}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct gltf_builder builder = with_triangle();
        BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 1);
        builder_accessor(&builder, cases[i].code, "VEC4,'normalized':true", 2, cases[i].data,
                         cases[i].size);
        check_turn(&builder, "LINEAR", 1.0 / 3, 30);
    }
}

// Half way from no rotation to a quarter turn, with slopes of 0, the spline is (0, 0, h/2, (1 +
// h)/2). Normalised, this is again the rotation by 45 degrees.
TEST(spline_of_rotations)
{
    const float h = 0.70710678f;
    struct gltf_builder builder = with_triangle();
    BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 1);
    BUILDER_FLOATS(&builder, "VEC4", 6, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, //
                   0, 0, 0, 0, 0, 0, h, h, 0, 0, 0, 0);
    check_turn(&builder, "CUBICSPLINE", 0.5, 45);
    check_turn(&builder, "CUBICSPLINE", 1, 90);
}

// --- which animation, which scene ----------------------------------------------------------------

static double translation_of(const struct gltf_builder *builder, const char *name,
                             const double *seconds, struct err *err)
{
    static const char lists[] =
        TRIANGLE_LISTS ",'nodes':[{'mesh':0,'translation':[7,0,0]}],'animations':["
                       "{'name':'walk','samplers':[{'input':1,'output':2}],"
                       "'channels':[{'sampler':0,'target':{'node':0,'path':'translation'}}]},"
                       "{'name':'0','samplers':[{'input':1,'output':3}],"
                       "'channels':[{'sampler':0,'target':{'node':0,'path':'translation'}}]}]";
    struct scene scene;
    bool ok = builder_load(builder, lists,
                           &(struct gltf_load_params){.at_seconds = seconds, .animation = name},
                           &scene, err);
    double x = ok && scene.instance_count == 1 ? scene.instances[0].transform[0][3] : NAN;
    bool is_noted = has_note(&scene, "2 animations are not used");
    CHECK(!ok || is_noted == (!name && !seconds));
    scene_finish(&scene);
    return x;
}

TEST(choice_of_the_animation)
{
    struct gltf_builder builder = with_triangle();
    struct err err;
    double one = 1;
    BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 1);
    BUILDER_FLOATS(&builder, "VEC3", 2, 1, 0, 0, 2, 0, 0);
    BUILDER_FLOATS(&builder, "VEC3", 2, 3, 0, 0, 4, 0, 0);
    CHECK(translation_of(&builder, NULL, NULL, &err) == 7);
    CHECK(translation_of(&builder, NULL, &one, &err) == 2);
    CHECK(translation_of(&builder, "walk", &one, &err) == 2);
    CHECK(translation_of(&builder, "walk", NULL, &err) == 1); // at the beginning of the animation
    CHECK(translation_of(&builder, "0", &one, &err) == 4);    // names have precedence over indices
    CHECK(translation_of(&builder, "1", &one, &err) == 4);
    CHECK(isnan(translation_of(&builder, "run", &one, &err)) && err.code == ERR_USAGE &&
              strstr(err.msg,
                     "test.glb: has no animation \"run\"; expected a name or an index below 2"),
          "%s", err.msg);
    CHECK(isnan(translation_of(&builder, "2", &one, &err)) && err.code == ERR_USAGE);
    CHECK(isnan(translation_of(&builder, "-1", &one, &err)) && err.code == ERR_USAGE);
    CHECK(isnan(translation_of(&builder, "", &one, &err)) && err.code == ERR_USAGE);
}

static uint64_t hash_of(const char *animation, const char *scene_name, const double *seconds)
{
    struct gltf_builder builder = with_triangle();
    struct scene scene;
    struct err err;
    BUILDER_FLOATS(&builder, "SCALAR", 1, 0);
    BUILDER_FLOATS(&builder, "VEC3", 1, 1, 0, 0);
    CHECK(builder_load(&builder,
                       TRIANGLE_LISTS ",'nodes':[{'mesh':0}],'scenes':[{'nodes':[0]}],"
                                      "'animations':[{'samplers':[{'input':1,'output':2}],"
                                      "'channels':[]}]",
                       &(struct gltf_load_params){
                           .animation = animation, .scene_name = scene_name, .at_seconds = seconds},
                       &scene, &err),
          "%s", err.msg);
    uint64_t hash = scene.hash;
    scene_finish(&scene);
    return hash;
}

// The hash includes what was selected, because a resumed render must not mix two poses.
TEST(hash_covers_the_choice)
{
    const double zero = 0, one = 1;
    const uint64_t hashes[] = {hash_of(NULL, NULL, NULL), hash_of("0", NULL, NULL),
                               hash_of(NULL, "0", NULL), hash_of(NULL, NULL, &zero),
                               hash_of(NULL, NULL, &one)};
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < i; j++)
            CHECK(hashes[i] != hashes[j], "%d and %d", i, j);
    CHECK(hashes[0] == hash_of(NULL, NULL, NULL));
}

// The length is known before an animation is played; the first animation is the default.
TEST(length_of_what_can_be_played)
{
    struct gltf_builder builder = with_triangle();
    static const char channel[] = "'channels':[{'sampler':0,'target':{'node':0,'path':'%s'}}]";
    char lists[512], path[256];
    BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 2.5);
    BUILDER_FLOATS(&builder, "VEC3", 2, 1, 0, 0, 2, 0, 0);
    for (int is_good = 0; is_good < 2; is_good++) {
        struct scene scene;
        struct err err;
        snprintf(path, sizeof path, channel, is_good ? "translation" : "weights");
        snprintf(lists, sizeof lists,
                 TRIANGLE_LISTS ",'nodes':[{'mesh':0}],'animations':[{'samplers':[{'input':1,"
                                "'output':2}],%s}]",
                 path);
        CHECK(builder_load(&builder, lists, &(struct gltf_load_params){0}, &scene, &err), "%s",
              err.msg);
        CHECK(scene.animation_seconds == (is_good ? 2.5 : 0), "%g", scene.animation_seconds);
        CHECK(scene.instances[0].transform[0][3] == 0, "posed though nobody asked for it");
        scene_finish(&scene);
    }
}

TEST(no_animation)
{
    struct gltf_builder builder = with_triangle();
    double seconds = 2;
    struct scene scene;
    struct err err;
    CHECK(builder_load(&builder, TRIANGLE_LISTS ",'nodes':[{'mesh':0}]",
                       &(struct gltf_load_params){.at_seconds = &seconds}, &scene, &err),
          "%s", err.msg);
    CHECK(has_note(&scene, "the file has no animation; the time 2 is ignored"));
    scene_finish(&scene);
}

TEST(choice_of_the_scene)
{
    static const struct {
        const char *wanted;
        double x; // NAN: loading must fail
    } cases[] = {{NULL, 2}, {"a", 1}, {"b", 2}, {"0", 1}, {"1", 2}, {"2", NAN}, {"c", NAN}};
    struct gltf_builder builder = with_triangle();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct scene scene;
        struct err err;
        bool ok =
            builder_load(&builder,
                         TRIANGLE_LISTS ",'nodes':[{'mesh':0,'translation':[1,0,0]},"
                                        "{'mesh':0,'translation':[2,0,0]}],'scene':1,"
                                        "'scenes':[{'name':'a','nodes':[0]},"
                                        "{'name':'b','nodes':[1]}]",
                         &(struct gltf_load_params){.scene_name = cases[i].wanted}, &scene, &err);
        CHECK(ok == !isnan(cases[i].x), "%s", err.msg);
        CHECK(ok ? scene.instance_count == 1 && scene.instances[0].transform[0][3] == cases[i].x
                 : err.code == ERR_USAGE && strstr(err.msg, "no scene"),
              "%s", err.msg);
        scene_finish(&scene);
    }
}

TEST(children_follow)
{
    struct gltf_builder builder = with_triangle();
    double half = 0.5;
    struct scene scene;
    struct err err;
    BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 1);
    BUILDER_FLOATS(&builder, "VEC3", 2, 0, 0, 0, 2, 0, 0);
    bool ok = builder_load(&builder,
                           TRIANGLE_LISTS
                           ",'nodes':[{'children':[1],'scale':[2,2,2]},{'mesh':0,"
                           "'translation':[0,5,0]}],'animations':[{'samplers':[{'input':1,"
                           "'output':2}],'channels':[{'sampler':0,'target':{'node':0,"
                           "'path':'translation'}},{'sampler':0,'target':{'path':'translation'}},"
                           "{'sampler':0,'target':{'path':'pointer','extensions':{}}}]}]",
                           &(struct gltf_load_params){.at_seconds = &half}, &scene, &err);
    CHECK(ok, "%s", err.msg);
    CHECK(ok && scene.instances[0].transform[0][3] == 1 &&
          scene.instances[0].transform[1][3] == 10 && scene.instances[0].transform[2][2] == 2);
    CHECK(has_note(&scene, "2 channels of the animation are ignored"));
    scene_finish(&scene);
}

// --- bad files -----------------------------------------------------------------------------------

static void check_rejected(const struct gltf_builder *builder, const char *nodes,
                           const char *animation, const char *message)
{
    char lists[1024];
    double seconds = 1;
    struct scene scene;
    struct err err;
    snprintf(lists, sizeof lists, TRIANGLE_LISTS ",'nodes':[%s],'animations':[%s]", nodes,
             animation);
    bool ok = builder_load(builder, lists, &(struct gltf_load_params){.at_seconds = &seconds},
                           &scene, &err);
    CHECK(!ok && err.code == ERR_INPUT && strstr(err.msg, message), "%s: %s", animation,
          ok ? "loaded" : err.msg);
    scene_finish(&scene);
}

#define CHANNEL(target) "'channels':[{'sampler':0,'target':{" target "}}]"
#define SAMPLER(members) "'samplers':[{" members "}]"
#define TO_TRANSLATION CHANNEL("'node':0,'path':'translation'")

TEST(bad_animations)
{
    struct gltf_builder builder = with_triangle();
    static const char node[] = "{'mesh':0}", good[] = SAMPLER("'input':1,'output':2");
    char both[512];
    BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 1);                 // accessor 1
    BUILDER_FLOATS(&builder, "VEC3", 2, 0, 0, 0, 2, 0, 0);       // accessor 2
    BUILDER_FLOATS(&builder, "SCALAR", 3, 0, 1, 1);              // accessor 3
    BUILDER_FLOATS(&builder, "SCALAR", 2, -1, 1);                // accessor 4
    BUILDER_FLOATS(&builder, "SCALAR", 2, 0, NAN);               // accessor 5
    BUILDER_FLOATS(&builder, "VEC4", 2, 0, 0, 0, 0, 0, 0, 0, 0); // accessor 6
    BUILDER_FLOATS(&builder, "SCALAR", 2, 2, 1);                 // accessor 7
    check_rejected(&builder, node, "{}", "animations[0]: \"channels\" is missing");
    check_rejected(&builder, node, "{'channels':[]}", "animations[0]: \"samplers\" is missing");
    check_rejected(&builder, node, "{'channels':[7],'samplers':[]}",
                   "animations[0].channels[0]: expected an object");
    check_rejected(&builder, node, "{'channels':[{}],'samplers':[]}", "\"sampler\" is missing");
    check_rejected(&builder, node, "{" TO_TRANSLATION ",'samplers':[]}",
                   "animations[0].channels[0].sampler: 0; expected an index below 0");
    check_rejected(&builder, node, "{" TO_TRANSLATION ",'samplers':[1]}",
                   "animations[0].samplers[0]: expected an object");
    check_rejected(&builder, node, "{" TO_TRANSLATION ",'samplers':[{'input':1}]}",
                   "\"output\" is missing");
    check_rejected(&builder, node, "{" TO_TRANSLATION "," SAMPLER("'input':1,'output':99") "}",
                   "animations[0].samplers[0].output: 99; expected an index below 8");
    check_rejected(&builder, node,
                   "{" TO_TRANSLATION
                   "," SAMPLER("'input':1,'output':2,'interpolation':'CUBIC'") "}",
                   "animations[0].samplers[0].interpolation");
    check_rejected(&builder, node, "{" TO_TRANSLATION "," SAMPLER("'input':2,'output':2") "}",
                   "accessors[2].type: \"VEC3\"; expected \"SCALAR\" for an animation's input");
    check_rejected(&builder, node, "{" TO_TRANSLATION "," SAMPLER("'input':3,'output':2") "}",
                   "accessors[3]: element 2 is 1; expected times from 0 on that increase strictly");
    check_rejected(&builder, node, "{" TO_TRANSLATION "," SAMPLER("'input':7,'output':2") "}",
                   "accessors[7]: element 1 is 1; expected times");
    check_rejected(&builder, node, "{" TO_TRANSLATION "," SAMPLER("'input':4,'output':2") "}",
                   "accessors[4]: element 0 is -1; expected times");
    check_rejected(&builder, node, "{" TO_TRANSLATION "," SAMPLER("'input':5,'output':2") "}",
                   "accessors[5]: element 1, component 0 is nan");
    check_rejected(
        &builder, node,
        "{" TO_TRANSLATION "," SAMPLER("'input':1,'output':2,'interpolation':'CUBICSPLINE'") "}",
        "accessors[2]: 2 elements; expected 6 for 2 keys of a translation with tangents");
    check_rejected(&builder, node, "{" TO_TRANSLATION "," SAMPLER("'input':1,'output':6") "}",
                   "accessors[6].type: \"VEC4\"; expected \"VEC3\" for a translation");
    check_rejected(
        &builder, node,
        "{" CHANNEL("'node':0,'path':'rotation'") "," SAMPLER("'input':1,'output':6") "}",
        "accessors[6]: the zero quaternion after key 1 is not a rotation");
    snprintf(both, sizeof both, "{%s,%s}", CHANNEL("'node':1,'path':'translation'"), good);
    check_rejected(&builder, node, both, "target.node: 1; expected an index below 1");
    snprintf(both, sizeof both, "{%s,%s}", CHANNEL("'node':0,'path':'color'"), good);
    check_rejected(&builder, node, both, "animations[0].channels[0].target.path");
    snprintf(both, sizeof both, "{%s,%s}", CHANNEL("'node':0"), good);
    check_rejected(&builder, node, both, "target: \"path\" is missing");
    snprintf(both, sizeof both, "{%s,%s}", TO_TRANSLATION, good);
    check_rejected(&builder, "{'mesh':0,'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}", both,
                   "animations[0].channels[0].target: nodes[0] has a \"matrix\"");
    snprintf(both, sizeof both, "{%s,%s}", CHANNEL("'node':0,'path':'weights'"), good);
    check_rejected(&builder, node, both, "nodes[0] has no mesh with morph targets");
    check_rejected(&builder, "{}", both, "nodes[0] has no mesh with morph targets");
    snprintf(both, sizeof both,
             "{'channels':[{'sampler':0,'target':{'node':0,'path':'scale'}},"
             "{'sampler':0,'target':{'node':0,'path':'scale'}}],%s}",
             good);
    check_rejected(
        &builder, node, both,
        "animations[0].channels[1]: another channel already animates a scale of nodes[0]");
}

TEST_MAIN(TEST_CASE(linear_and_step), TEST_CASE(one_key), TEST_CASE(cubic_spline), TEST_CASE(scale),
          TEST_CASE(spherical_interpolation), TEST_CASE(equal_rotations),
          TEST_CASE(quantized_rotations), TEST_CASE(spline_of_rotations),
          TEST_CASE(choice_of_the_animation), TEST_CASE(hash_covers_the_choice),
          TEST_CASE(length_of_what_can_be_played), TEST_CASE(no_animation),
          TEST_CASE(choice_of_the_scene), TEST_CASE(children_follow), TEST_CASE(bad_animations))
