// Tests KHR_lights_punctual and KHR_materials_variants.
#include "gltf_fixture.h"
#include "scene/gltf/gltf_load.h"
#include "test.h"

// A file of nodes with lights. The %s are replaced by the nodes and the lights.
#define LIGHT_FILE                                                                                 \
    "{'asset':{'version':'2.0'},'nodes':[%s],"                                                     \
    "'extensions':{'KHR_lights_punctual':{'lights':[%s]}}}"
#define HOLDS(index) "'extensions':{'KHR_lights_punctual':{'light':" #index "}}"

static bool load_lights(struct scene *scene, const char *nodes, const char *lights, struct err *err)
{
    char json[4096];
    snprintf(json, sizeof json, LIGHT_FILE, nodes, lights);
    return load_glb(scene, json, NULL, 0, err);
}

static bool near3(const double *a, double x, double y, double z)
{
    return fabs(a[0] - x) < 1e-12 && fabs(a[1] - y) < 1e-12 && fabs(a[2] - z) < 1e-12;
}

TEST(kinds)
{
    struct scene scene;
    struct err err;
    // The first node has the light twice. The last one rotates -Z to -Y; its scale must not change
    // any number of the light.
    bool ok = load_lights(
        &scene,
        "{'translation':[1,2,3]," HOLDS(0) "},{'name':'lamp'," HOLDS(
            1) "},"
               "{'rotation':[-0.7071067811865476,0,0,0.7071067811865476],'scale':[2,3,4]," HOLDS(
                   2) "},"
                      "{" HOLDS(0) "},{'rotation':[0,0.7071067811865476,0,0.7071067811865476]"
                                   "," HOLDS(3) "},"
                                                "{" HOLDS(4) "}",
        "{'type':'point','name':'bulb','color':[1,0.5,0.25],'intensity':8,'range':20},"
        "{'type':'spot'},"
        "{'type':'directional','intensity':3},"
        "{'type':'spot','spot':{'innerConeAngle':0.25,'outerConeAngle':1.5},'intensity':2},"
        "{'type':'spot','spot':{'innerConeAngle':0.5,'outerConeAngle':0.5}}",
        &err);
    REQUIRE(ok, "%s", err.msg);
    const struct light *l = scene.lights;
    CHECK(scene.light_count == 6, "%u", scene.light_count);
    if (scene.light_count == 6) {
        CHECK(l[0].kind == LIGHT_POINT && strcmp(l[0].name, "bulb") == 0);
        CHECK(near3(l[0].position, 1, 2, 3) && l[0].range == 20);
        CHECK(l[0].radiant[0] == 8 && l[0].radiant[1] == 4 && l[0].radiant[2] == 2);
        CHECK(l[1].kind == LIGHT_SPOT && strcmp(l[1].name, "lamp") == 0);
        CHECK(l[1].inner_angle == 0 && fabsf(l[1].outer_angle - 0.78539816f) < 1e-7f);
        CHECK(near3(l[1].direction, 0, 0, -1) && l[1].radiant[1] == 1 && isinf(l[1].range));
        CHECK(l[2].kind == LIGHT_DIRECTIONAL && near3(l[2].direction, 0, -1, 0));
        CHECK(l[2].radiant[0] == 3);
        CHECK(near3(l[3].position, 0, 0, 0) && l[3].kind == LIGHT_POINT);
        CHECK(l[4].inner_angle == 0.25f && l[4].outer_angle == 1.5f);
        CHECK(near3(l[4].direction, -1, 0, 0));
        // The light has a sharp edge.
        CHECK(l[5].inner_angle < 0.5f && l[5].inner_angle > 0.4999999f && l[5].outer_angle == 0.5f);
    }
    CHECK(scene.note_count == 0);
    scene_finish(&scene);
}

TEST(singular_nodes)
{
    struct scene scene;
    struct err err;
    bool ok = load_lights(&scene, "{'scale':[1,1,0]," HOLDS(0) "},{'scale':[0,0,0]," HOLDS(1) "}",
                          "{'type':'directional'},{'type':'point'}", &err);
    CHECK(ok, "%s", err.msg);
    CHECK(scene.light_count == 1 && has_note(&scene, "1 lights are skipped"));
    scene_finish(&scene);
}

// Tests the environment that scene_load adds to a file with a light, and to one with only unlit
// materials.
TEST(even_environment)
{
    static const char *const files[] = {
        "{'asset':{'version':'2.0'},'nodes':[{'extensions':{'KHR_lights_punctual':{'light':0}}}],"
        "'extensions':{'KHR_lights_punctual':{'lights':[{'type':'point'}]}}}",
        "{'asset':{'version':'2.0'},'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':"
        "{'POSITION':0},'material':0}]}],'accessors':[{'componentType':5126,'count':3,"
        "'type':'VEC3'}],'materials':[{'extensions':{'KHR_materials_unlit':{}}}]}",
    };
    for (int i = 0; i < 2; i++) {
        struct bytes json = json_bytes(files[i]);
        FILE *file = fopen("test_lights.gltf", "wb");
        REQUIRE(file);
        fwrite(json.data, 1, json.size, file);
        fclose(file);
        free(json.data);
        struct scene scene;
        struct err err = {0};
        bool ok = scene_load(&(struct scene_load_params){.path = "test_lights.gltf"}, &scene, &err);
        CHECK(ok, "%s", err.msg);
        CHECK(scene.environment.present == (i == 1), "file %d", i);
        scene_finish(&scene);
    }
    remove("test_lights.gltf");
}

static const struct {
    const char *node, *light, *message;
} bad_lights[] = {
    {HOLDS(1), "{'type':'point'}",
     "test.glb: nodes[0].extensions.KHR_lights_punctual.light: 1; expected an index below 1"},
    {"'extensions':{'KHR_lights_punctual':{}}", "{'type':'point'}", "\"light\" is missing"},
    {"'extensions':{'KHR_lights_punctual':7}", "{'type':'point'}", "expected an object, not 7"},
    {"'translation':[1e30,0,0]," HOLDS(0), "{'type':'point'}", "the light's coordinate is 1e+30"},
    {HOLDS(0), "7", "extensions.KHR_lights_punctual.lights[0]: expected an object, not 7"},
    {HOLDS(0), "{}", "lights[0]: \"type\" is missing"},
    {HOLDS(0), "{'type':'area'}", "lights[0].type: "},
    {HOLDS(0), "{'type':'point','intensity':-1}", "lights[0].intensity: -1 is outside"},
    {HOLDS(0), "{'type':'point','intensity':1e31}", "lights[0].intensity: 1e+31 is outside"},
    {HOLDS(0), "{'type':'point','color':[1,2,1]}", "lights[0].color[1]: 2 is outside [0, 1]"},
    {HOLDS(0), "{'type':'point','color':[1,1]}", "lights[0].color: "},
    {HOLDS(0), "{'type':'point','range':0}", "lights[0].range: 0 is outside"},
    {HOLDS(0), "{'type':'point','name':3}", "lights[0].name: "},
    {HOLDS(0), "{'type':'spot','spot':[]}", "lights[0].spot: expected an object"},
    {HOLDS(0), "{'type':'spot','spot':{'innerConeAngle':1}}", "innerConeAngle 1 is not below"},
    {HOLDS(0), "{'type':'spot','spot':{'outerConeAngle':1.6}}", "outerConeAngle: 1.6 is outside"},
    {HOLDS(0), "{'type':'spot','spot':{'outerConeAngle':0}}", "innerConeAngle 0 is not below"},
};

TEST(bad_input)
{
    for (size_t i = 0; i < sizeof bad_lights / sizeof *bad_lights; i++) {
        struct scene scene;
        struct err err;
        char node[256];
        snprintf(node, sizeof node, "{%s}", bad_lights[i].node);
        bool ok = load_lights(&scene, node, bad_lights[i].light, &err);
        CHECK(!ok && err.code == ERR_INPUT, "%s", bad_lights[i].message);
        CHECK(ok || strstr(err.msg, bad_lights[i].message), "%s\n  expected: %s", err.msg,
              bad_lights[i].message);
        scene_finish(&scene);
    }
}

// --- variants ------------------------------------------------------------------------------------

#define VARIANT_FILE                                                                               \
    "{'asset':{'version':'2.0'},'extensionsRequired':['KHR_materials_variants'],"                  \
    "'extensions':{'KHR_materials_variants':{'variants':[{'name':'red'},{'name':'blue'},"          \
    "{'name':'none'}]}},'nodes':[{'mesh':0}],"                                                     \
    "'accessors':[{'componentType':5126,'count':3,'type':'VEC3'}],"                                \
    "'materials':[{'name':'a'},{'name':'b'},{'name':'c'}],"                                        \
    "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'material':0,'extensions':"             \
    "{'KHR_materials_variants':{'mappings':[{'material':1,'variants':[0]},"                        \
    "{'material':2,'variants':[1]}]}}},"                                                           \
    "{'attributes':{'POSITION':0},'extensions':"                                                   \
    "{'KHR_materials_variants':{'mappings':[{'material':2,'variants':[0,1]}]}}}]}]}"

static bool load_variant(struct scene *scene, const char *json, const char *variant,
                         struct err *err)
{
    static const double identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    struct bytes bytes = json_bytes(json);
    const struct gltf_load_params params = {
        .source = {.path = "test.gltf", .bytes = {bytes.data, bytes.size}},
        .place = identity,
        .variant = variant,
    };
    *scene = empty_scene("test.gltf");
    *err = (struct err){0};
    bool ok = gltf_load_bytes(scene, &params, err);
    free(bytes.data);
    return ok;
}

TEST(variants)
{
    static const struct {
        const char *variant, *materials[2];
    } rows[] = {{NULL, {"a", ""}}, {"red", {"b", "c"}}, {"blue", {"c", "c"}}, {"none", {"a", ""}}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct scene scene;
        struct err err;
        bool ok = load_variant(&scene, VARIANT_FILE, rows[i].variant, &err);
        CHECK(ok && scene.mesh_count == 2, "%s", err.msg);
        for (uint32_t j = 0; ok && j < 2; j++) {
            const char *name = scene.materials[scene.meshes[j].material].name;
            bool is_default = scene.meshes[j].material >= 3;
            CHECK(is_default ? *rows[i].materials[j] == '\0'
                             : strcmp(name, rows[i].materials[j]) == 0,
                  "%zu: %s", i, name);
        }
        scene_finish(&scene);
    }
}

TEST(bad_variants)
{
    static const struct {
        const char *find, *replacement, *variant, *message;
        enum err_code code;
    } rows[] = {
        {"red", "red", "green", "test.gltf: has no variant \"green\", but \"red\", \"blue\"",
         ERR_USAGE},
        {"'extensions':{'KHR_materials_variants':{'variants'", "'extras':{'x':{'variants'", "red",
         "test.gltf: has no variant \"red\" and no others", ERR_USAGE},
        {"{'name':'red'}", "{}", "blue", "variants[0]: \"name\" is missing", ERR_INPUT},
        {"{'name':'red'}", "7", "blue", "variants[0]: expected an object, not 7", ERR_INPUT},
        {"'material':1,'variants'", "'variants'", "red", "\"material\" is missing", ERR_INPUT},
        {"'material':1,'variants'", "'material':3,'variants'", "red",
         "mappings[0].material: 3; expected an index below 3", ERR_INPUT},
        {"'variants':[0]", "'variants':[3]", "red",
         "mappings[0].variants[0]: expected the index of one of 3 variants", ERR_INPUT},
        {",'variants':[0]}", "}", "red", "mappings[0]: \"variants\" is missing", ERR_INPUT},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct scene scene;
        struct err err;
        char *json = replace_text(VARIANT_FILE, rows[i].find, rows[i].replacement);
        REQUIRE(json, "%s", rows[i].find);
        bool ok = load_variant(&scene, json, rows[i].variant, &err);
        CHECK(!ok && err.code == rows[i].code, "row %zu", i);
        CHECK(ok || strstr(err.msg, rows[i].message), "%s\n  expected: %s", err.msg,
              rows[i].message);
        scene_finish(&scene);
        free(json);
    }
}

TEST_MAIN(TEST_CASE(kinds), TEST_CASE(singular_nodes), TEST_CASE(even_environment),
          TEST_CASE(bad_input), TEST_CASE(variants), TEST_CASE(bad_variants))
