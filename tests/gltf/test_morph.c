// Tests morph targets against sums computed by hand.
#include "gltf_builder.h"
#include "test.h"

static bool near(float a, double b)
{
    return fabs((double)a - b) < 1e-6;
}

static void check_numbers(const float *values, uint32_t count, const double *expected,
                          const char *what)
{
    CHECK(values, "%s is not there", what);
    for (uint32_t i = 0; values && i < count; i++)
        CHECK(near(values[i], expected[i]), "%s, number %u: %.9g, expected %.9g", what, i,
              (double)values[i], expected[i]);
}

// Makes a triangle with every attribute (accessors 0 to 5) and two targets (6 to 11, and 12).
static struct gltf_builder with_targets(void)
{
    struct gltf_builder b = {0};
    BUILDER_FLOATS(&b, "VEC3", 3, 0, 0, 0, 1, 0, 0, 0, 1, 0);
    BUILDER_FLOATS(&b, "VEC3", 3, 0, 0, 1, 0, 0, 1, 0, 0, 1);
    BUILDER_FLOATS(&b, "VEC4", 3, 1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1);
    BUILDER_FLOATS(&b, "VEC2", 3, 0, 0, 1, 0, 0, 1);
    BUILDER_FLOATS(&b, "VEC2", 3, 5, 5, 5, 5, 5, 5);
    BUILDER_FLOATS(&b, "VEC4", 3, .5f, .5f, .5f, .5f, .5f, .5f, .5f, .5f, 1, 0, 0, .5f);
    BUILDER_FLOATS(&b, "VEC3", 3, 0, 0, 2, 0, 0, 4, 0, 0, 0);
    BUILDER_FLOATS(&b, "VEC3", 3, 2, 0, 0, 0, 0, 0, 0, 0, -4);
    BUILDER_FLOATS(&b, "VEC3", 3, 0, 2, 0, 0, 0, 0, -4, 0, 0);
    BUILDER_FLOATS(&b, "VEC2", 3, .5f, 1, 0, 0, 0, 0);
    BUILDER_FLOATS(&b, "VEC2", 3, 0, 0, 0, -2, 0, 0);
    BUILDER_FLOATS(&b, "VEC3", 3, .5f, 0, -2, 0, 0, 0, 4, 4, 4);
    BUILDER_FLOATS(&b, "VEC3", 3, 8, 0, 0, 0, 0, 0, 0, 16, 0);
    return b;
}

#define ATTRIBUTES                                                                                 \
    "'attributes':{'POSITION':0,'NORMAL':1,'TANGENT':2,'TEXCOORD_0':3,'TEXCOORD_1':4,'COLOR_0':5}"
#define TARGETS                                                                                    \
    "'targets':[{'POSITION':6,'NORMAL':7,'TANGENT':8,'TEXCOORD_0':9,'TEXCOORD_1':10,"              \
    "'COLOR_0':11},{'POSITION':12}]"
#define PRIMITIVE "{" ATTRIBUTES "," TARGETS "}"

TEST(sums)
{
    const struct gltf_builder builder = with_targets();
    struct scene scene;
    struct err err;
    bool ok = builder_load(
        &builder,
        "'nodes':[{'mesh':0}],'meshes':[{'weights':[0.5,0.25],'primitives':[" PRIMITIVE "]}]", NULL,
        &scene, &err);
    CHECK(ok && scene.mesh_count == 1, "%s", err.msg);
    if (ok && scene.mesh_count == 1) {
        const struct mesh *mesh = &scene.meshes[0];
        const double root = sqrt(0.5);
        check_numbers(mesh->positions[0], 9, (const double[]){2, 0, 1, 1, 0, 2, 0, 5, 0},
                      "positions");
        // These are (1, 0, 1), (0, 0, 1) and (0, 0, -1), normalised.
        check_numbers(mesh->normals[0], 9, (const double[]){root, 0, root, 0, 0, 1, 0, 0, -1},
                      "normals");
        check_numbers(mesh->tangents[0], 12,
                      (const double[]){root, root, 0, -1, 1, 0, 0, -1, -1, 0, 0, -1}, "tangents");
        check_numbers(mesh->uvs[0][0], 6, (const double[]){.25, .5, 1, 0, 0, 1}, "TEXCOORD_0");
        check_numbers(mesh->uvs[1][0], 6, (const double[]){5, 5, 5, 4, 5, 5}, "TEXCOORD_1");
        // Colours are clamped to [0, 1]. No target displaces alpha.
        check_numbers(mesh->colors[0], 12,
                      (const double[]){.75, .5, 0, .5, .5, .5, .5, .5, 1, 1, 1, .5}, "colors");
    }
    scene_finish(&scene);
}

// The weights of a node have precedence over the mesh's. Meshes with equal weights are shared.
TEST(weights_of_nodes)
{
    const struct gltf_builder builder = with_targets();
    struct scene scene;
    struct err err;
    bool ok = builder_load(&builder,
                           "'nodes':[{'mesh':0},{'mesh':0,'weights':[0,1]},{'mesh':0,"
                           "'weights':[0,1]},{'mesh':0,'weights':[0,0]}],"
                           "'meshes':[{'weights':[1,0],'primitives':[" PRIMITIVE "]}]",
                           NULL, &scene, &err);
    CHECK(ok && scene.instance_count == 4 && scene.mesh_count == 3, "%u meshes: %s",
          scene.mesh_count, err.msg);
    if (ok && scene.instance_count == 4 && scene.mesh_count == 3) {
        const struct instance *i = scene.instances;
        CHECK(i[1].mesh == i[2].mesh && i[0].mesh != i[1].mesh && i[3].mesh != i[1].mesh);
        CHECK(scene.meshes[i[0].mesh].positions[0][2] == 2 &&
              scene.meshes[i[1].mesh].positions[0][0] == 8 &&
              scene.meshes[i[3].mesh].positions[0][0] == 0);
        // Arrays that no weight changes are shared.
        CHECK(scene.meshes[i[1].mesh].normals == scene.meshes[i[3].mesh].normals);
    }
    scene_finish(&scene);
}

TEST(animated_weights)
{
    struct gltf_builder builder = with_targets();
    BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 2);
    BUILDER_FLOATS(&builder, "SCALAR", 4, 1, 0, 0, 0.5f);
    // In-tangent, value and out-tangent of two keyframes, each for both targets.
    BUILDER_FLOATS(&builder, "SCALAR", 12, 0, 0, 0, 0, 1, 2, 0, 0, 0, 1, 0, 0);
    const uint8_t bytes[4] = {255, 0, 0, 51};
    builder_accessor(&builder, UNSIGNED_BYTE_CODE, "SCALAR,'normalized':true", 4, bytes, 4);
    static const struct {
        const char *sampler;
        // The first vertex has x = 8 * second weight, z = 2 * first weight.
        double seconds, x, z;
    } cases[] = {
        {"'output':14", 0, 0, 2},
        {"'output':14", 0.5, 1, 1.5},
        {"'output':14", 2, 4, 0},
        {"'output':14,'interpolation':'STEP'", 1.9, 0, 2},
        // At t = 1/2 the value is 2 * 1/8 of the slopes at the first keyframe, and half of the
        // second value.
        {"'output':15,'interpolation':'CUBICSPLINE'", 1, 8 * (2 / 8.0 * 2 + 0.5), 2 * (2 / 8.0)},
        {"'output':16", 1, 8 * 0.1, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char lists[1024];
        snprintf(lists, sizeof lists,
                 "'nodes':[{'mesh':0,'weights':[9,9]}],'meshes':[{'primitives':[" PRIMITIVE "]}],"
                 "'animations':[{'samplers':[{'input':13,%s}],'channels':[{'sampler':0,"
                 "'target':{'node':0,'path':'weights'}}]}]",
                 cases[i].sampler);
        struct scene scene;
        struct err err;
        bool ok =
            builder_load(&builder, lists,
                         &(struct gltf_load_params){.at_seconds = &cases[i].seconds}, &scene, &err);
        CHECK(ok && scene.mesh_count == 1, "%s", err.msg);
        if (ok && scene.mesh_count == 1) {
            const float *p = scene.meshes[0].positions[0];
            CHECK(near(p[0], cases[i].x) && near(p[2], cases[i].z),
                  "%s at %g: %g %g, expected %g %g", cases[i].sampler, cases[i].seconds,
                  (double)p[0], (double)p[2], cases[i].x, cases[i].z);
        }
        scene_finish(&scene);
    }
}

TEST(sparse_and_quantized_displacements)
{
    struct gltf_builder builder = {0};
    const int16_t quantized[3][4] = {{32767, 0, 0}, {0, -32768, 0}, {0, 0, 16384}};
    BUILDER_FLOATS(&builder, "VEC3", 3, 0, 0, 0, 1, 0, 0, 0, 1, 0);
    uint32_t view = builder_view(&builder, quantized, sizeof quantized, "'byteStride':8");
    const uint8_t index[1] = {1};
    const float value[3] = {0, 0, 3};
    uint32_t indices = builder_view(&builder, index, 1, "");
    uint32_t values = builder_view(&builder, value, sizeof value, "");
    snprintf(builder.accessors + strlen(builder.accessors),
             sizeof builder.accessors - strlen(builder.accessors),
             ",{'bufferView':%u,'componentType':5122,'normalized':true,'count':3,'type':'VEC3'},"
             "{'componentType':5126,'count':3,'type':'VEC3','sparse':{'count':1,"
             "'indices':{'bufferView':%u,'componentType':5121},'values':{'bufferView':%u}}}",
             view, indices, values);
    struct scene scene;
    struct err err;
    bool ok = builder_load(&builder,
                           "'extensionsUsed':['KHR_mesh_quantization'],'nodes':[{'mesh':0}],"
                           "'meshes':[{'weights':[2,1],'primitives':[{'attributes':{'POSITION':0},"
                           "'targets':[{'POSITION':1},{'POSITION':2}]}]}]",
                           NULL, &scene, &err);
    CHECK(ok, "%s", err.msg);
    if (ok)
        check_numbers(scene.meshes[0].positions[0], 9,
                      (const double[]){2, 0, 0, 1, -2, 3, 0, 1, 2 * 16384 / 32767.0}, "positions");
    scene_finish(&scene);
}

static void check_rejected(const char *lists, const char *message)
{
    struct gltf_builder builder = with_targets();
    BUILDER_FLOATS(&builder, "VEC3", 2, 0, 0, 0, 0, 0, 0);                 // accessor 13
    BUILDER_FLOATS(&builder, "VEC3", 3, 3e38f, 0, 0, 0, 0, 0, 0, 0, 0);    // accessor 14
    BUILDER_FLOATS(&builder, "VEC3", 3, 0, 0, 0, 0, INFINITY, 0, 0, 0, 0); // accessor 15
    struct scene scene;
    struct err err;
    bool ok = builder_load(&builder, lists, NULL, &scene, &err);
    CHECK(!ok && err.code == ERR_INPUT && strstr(err.msg, message), "%s: %s", lists,
          ok ? "loaded" : err.msg);
    scene_finish(&scene);
}

#define WITH_TARGETS(targets)                                                                      \
    "'nodes':[{'mesh':0}],'meshes':[{'weights':[1],'primitives':[{'attributes':{'POSITION':0},"    \
    "'targets':" targets "}]}]"

TEST(bad_targets)
{
    check_rejected(WITH_TARGETS("7"), "meshes[0].primitives[0].targets: expected an array");
    check_rejected(WITH_TARGETS("[7]"), "meshes[0].primitives[0].targets[0]: expected an object");
    check_rejected(WITH_TARGETS("[{'POSITION':99}]"), "targets[0].POSITION: 99; expected an index");
    check_rejected(WITH_TARGETS("[{'POSITION':13}]"),
                   "accessors[13]: 2 displacements of POSITION for 3 vertices");
    check_rejected(WITH_TARGETS("[{'POSITION':2}]"),
                   "accessors[2].type: \"VEC4\"; expected \"VEC3\" for displacements of POSITION");
    check_rejected(WITH_TARGETS("[{'POSITION':14}]"),
                   "meshes[0].primitives[0]: vertex 0: POSITION is 3e+38 with its morph targets");
    check_rejected(WITH_TARGETS("[{'POSITION':15}]"),
                   "accessors[15]: element 1, component 1 is inf");
    check_rejected(WITH_TARGETS("[{},{}]"), "meshes[0].weights: 1 elements; expected 2");
    check_rejected("'nodes':[{'mesh':0,'weights':['a']}],'meshes':[{'primitives':[{'attributes':{"
                   "'POSITION':0},'targets':[{}]}]}]",
                   "nodes[0].weights[0]: ");
    check_rejected(
        "'nodes':[{'mesh':0}],'meshes':[{'primitives':[" PRIMITIVE ",{'attributes':{"
        "'POSITION':0},'targets':[{}]}]}]",
        "meshes[0].primitives[1]: has 1 morph targets, but the primitives before have 2");
}

TEST_MAIN(TEST_CASE(sums), TEST_CASE(weights_of_nodes), TEST_CASE(animated_weights),
          TEST_CASE(sparse_and_quantized_displacements), TEST_CASE(bad_targets))
