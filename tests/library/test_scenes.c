// Tests scenes of the library: changes of documents, places in error messages, and meshes from
// arrays.
#include "library_fixture.h"

// --- documents -----------------------------------------------------------------------------------

static void check_get(struct lampyris_context *context, struct lampyris_scene *scene,
                      const char *pointer, const char *expected)
{
    char *json;
    OK(context, lampyris_scene_get(scene, pointer, &json));
    CHECK(strcmp(json, expected) == 0, "%s: %s", pointer, json);
    lampyris_text_release(json);
}

TEST(values_are_read_and_set_by_pointers)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    OK(context, lampyris_scene_parse(context,
                                     "{\"lampyris\": 1, \"materials\": {\"a/b~c\": {}, \"red\": "
                                     "{\"base_color\": [0.1, 0.25, 0.5]}}}",
                                     NULL, NULL, &scene));
    check_get(context, scene, "/materials/red/base_color/1", "0.25");
    check_get(context, scene, "/materials/a~1b~0c", "{}");
    OK(context, lampyris_scene_set(scene, "/materials/red/base_color/1", "1"));
    OK(context, lampyris_scene_set(scene, "/film/width", "16"));
    OK(context, lampyris_scene_set(scene, "/shapes", "[]"));
    OK(context, lampyris_scene_set(scene, "/shapes/-", "{\"type\": \"torus\"}"));
    check_get(context, scene, "/film", "{\"width\": 16}");
    check_get(context, scene, "/shapes/0/type", "\"torus\"");
    OK(context, lampyris_scene_remove(scene, "/shapes/0"));
    check_get(context, scene, "/shapes", "[]");
    check_get(context, scene, "/materials/red/base_color", "[0.10000000000000001, 1, 0.5]");
    static const char *const bad[][2] = {
        {"/materials/rod",
         "/materials/rod: there is no \"rod\" in the document; did you mean red?"},
        {"materials", "does not begin with \"/\""},
        {"/shapes/1", "there is no element \"1\" in an array of 0"},
        {"/film/width/x", "there is no \"x\" inside 16"},
        {"/film~2", "expected \"~0\""},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char *json;
        CHECK(lampyris_scene_get(scene, bad[i][0], &json) == LAMPYRIS_INPUT && !json);
        CHECK(strstr(error_of(context).message, bad[i][1]), "%s", error_of(context).message);
        CHECK(strcmp(error_of(context).place, bad[i][0]) == 0, "%s", error_of(context).place);
    }
    CHECK(lampyris_scene_set(scene, "/film/width", "{") == LAMPYRIS_INPUT);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

TEST(edits_change_the_next_render)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    struct lampyris_render *render;
    char *json;
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    uint64_t first = render_hash(context, scene);
    OK(context, lampyris_render_begin(scene, SMALL, NULL, &render));
    OK(context, lampyris_scene_get(scene, "/materials/red", &json));
    OK(context, lampyris_scene_set(scene, "/materials/red/base_color", "[0.1, 0.2, 0.9]"));
    uint64_t blue = render_hash(context, scene);
    char arguments[1200];
    snprintf(arguments, sizeof arguments,
             "%s -D 'materials.red.base_color=[0.1, 0.2, 0.9]' --size 32x24 --spp 8",
             path_of("scenes/cornell.json"));
    CHECK(blue != first && blue == hash_of_program(arguments));
    OK(context, lampyris_render_step(render, NULL, NULL));
    CHECK(state_of(render).hash == first, "a render keeps the scene that it began with");
    OK(context, lampyris_scene_set(scene, "/materials/red", json));
    CHECK(render_hash(context, scene) == first);
    lampyris_text_release(json);
    lampyris_render_release(render);
    lampyris_scene_release(scene);
    // A document given as text, and a model that becomes the base of a document.
    OK(context, lampyris_scene_load(context, path_of("scenes/models/vase.glb"), NULL, &scene));
    first = render_hash(context, scene);
    OK(context, lampyris_scene_set(scene, "/settings/max_bounces", "0"));
    CHECK(render_hash(context, scene) != first);
    OK(context, lampyris_scene_remove(scene, "/settings"));
    CHECK(render_hash(context, scene) == first);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

TEST(errors_have_status_file_place_and_what_was_expected)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    struct lampyris_render *render;
    CHECK(lampyris_scene_load(context, "none.json", NULL, &scene) == LAMPYRIS_INPUT && !scene);
    CHECK(strcmp(error_of(context).file, "none.json") == 0, "%s", error_of(context).file);
    CHECK(lampyris_scene_load(context, "none.glb", NULL, &scene) == LAMPYRIS_INPUT);
    CHECK(lampyris_scene_load(context, "none.stl", NULL, &scene) == LAMPYRIS_INPUT);
    CHECK(strstr(error_of(context).message, "no such file"), "%s", error_of(context).message);
    CHECK(lampyris_scene_load(context, "none.xyz", NULL, &scene) == LAMPYRIS_INPUT);
    CHECK(strcmp(error_of(context).expected, "json, gltf, glb, obj, ply or stl") == 0, "%s",
          error_of(context).expected);
    CHECK(lampyris_scene_parse(context, "{", "a", NULL, &scene) == LAMPYRIS_INPUT);
    CHECK(strstr(error_of(context).message, "a/document.json: line 1"), "%s",
          error_of(context).message);
    OK(context, lampyris_scene_parse(context,
                                     "{\"lampyris\": 1, \"materials\": {\"red\": {\"type\": "
                                     "\"principled\", \"roughness\": 1.7}}}",
                                     NULL, NULL, &scene));
    CHECK(lampyris_scene_check(scene, NULL) == LAMPYRIS_INPUT);
    const struct lampyris_error error = error_of(context);
    CHECK(error.status == LAMPYRIS_INPUT);
    CHECK(strcmp(error.file, "document.json") == 0, "%s", error.file);
    CHECK(strcmp(error.place, "/materials/red/roughness") == 0, "%s", error.place);
    CHECK(strcmp(error.expected, "[0, 1]") == 0, "%s", error.expected);
    CHECK(strstr(error.message, "materials.red.roughness: 1.7"), "%s", error.message);
    OK(context, lampyris_scene_set(scene, "/materials/red/roughness", "0.5"));
    CHECK(error_of(context).status == LAMPYRIS_OK && !*error_of(context).message);
    CHECK(lampyris_scene_check(scene, NULL) == LAMPYRIS_INPUT, "an empty scene");
    lampyris_scene_release(scene);

    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    static const char *const settings[][3] = {
        {"{\"spq\": 1}", "settings: spq: unknown key; did you mean spp?", "/spq"},
        {"{\"spp\": 0}", "settings: spp: 0 is outside", "/spp"},
        {"{\"aov\": [\"depths\"]}", "settings: aov[0]:", "/aov/0"},
        {"{\"camera\": \"back\"}", "there is no camera \"back\"", "/camera"},
        {"{\"error\": 0}", "settings: error: 0 is outside", "/error"},
        {"{\"resume\": \"none.ck\"}", "none.ck: there is no such checkpoint", ""},
        {"[]", "settings: expected an object", ""},
        {"{\"sampler\": \"grid\", \"error\": 1e-3}", "cannot be combined with --error", ""},
    };
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        enum lampyris_status status = lampyris_render_begin(scene, settings[i][0], NULL, &render);
        CHECK(status == LAMPYRIS_INPUT && !render, "%s: %d", settings[i][0], status);
        CHECK(strstr(error_of(context).message, settings[i][1]), "%s", error_of(context).message);
        CHECK(strcmp(error_of(context).place, settings[i][2]) == 0, "%s", error_of(context).place);
    }
    OK(context, lampyris_render_begin(scene, SMALL, NULL, &render));
    CHECK(lampyris_render_save(render, "nowhere/x.exr", NULL) == LAMPYRIS_OUTPUT);
    CHECK(strcmp(error_of(context).file, "nowhere/x.exr") == 0, "%s", error_of(context).file);
    CHECK(lampyris_render_save(render, "x.tiff", NULL) == LAMPYRIS_INPUT);
    CHECK(lampyris_render_checkpoint(render, "nowhere/x.ck") == LAMPYRIS_OUTPUT);
    lampyris_render_release(render);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
    const struct lampyris_context_params none = {.size = sizeof none, .device = "no such device"};
    REQUIRE(lampyris_context_create(&none, &context) == LAMPYRIS_OK);
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    CHECK(lampyris_render_begin(scene, SMALL, NULL, &render) == LAMPYRIS_INPUT && !render);
    CHECK(strstr(error_of(context).message, "no such device"), "%s", error_of(context).message);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

// --- meshes --------------------------------------------------------------------------------------

#define ROOM                                                                                       \
    "{\"lampyris\": 1, \"environment\": {\"radiance\": [1, 1, 1]}, \"camera\": {\"position\": "    \
    "[0.3, 0.3, 3], \"target\": [0.3, 0.3, 0], \"fov_degrees\": 40}, "                             \
    "\"materials\": {\"red\": {\"base_color\": [0.8, 0.1, 0.1]}}"

TEST(meshes_from_arrays_are_those_of_files)
{
    // Two triangles, in records that also contain other data.
    static const struct record {
        float weight, position[3], normal[3];
    } vertices[] = {
        {9, {0, 0, 0}, {0, 0, 1}},
        {9, {1, 0, 0}, {0, 0.6f, 0.8f}},
        {9, {0, 1, 0}, {0, 0, 1}},
        {9, {1, 1, 0.5f}, {0.6f, 0, 0.8f}},
    };
    static const uint32_t indices[] = {0, 1, 2, 2, 1, 3};
    FILE *file = fopen("library_mesh.ply", "w");
    REQUIRE(file);
    fprintf(file, "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                  "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                  "element face 2\nproperty list uchar int vertex_indices\nend_header\n");
    for (int i = 0; i < 4; i++) {
        const struct record *v = &vertices[i];
        fprintf(file, "%.9g %.9g %.9g %.9g %.9g %.9g\n", (double)v->position[0],
                (double)v->position[1], (double)v->position[2], (double)v->normal[0],
                (double)v->normal[1], (double)v->normal[2]);
    }
    fprintf(file, "3 0 1 2\n3 2 1 3\n");
    fclose(file);

    struct lampyris_context *context = open_context();
    struct lampyris_scene *from_file, *from_arrays;
    OK(context, lampyris_scene_parse(context,
                                     ROOM ", \"shapes\": [{\"type\": \"mesh\", \"file\": "
                                          "\"library_mesh.ply\", \"material\": \"red\"}]}",
                                     ".", NULL, &from_file));
    OK(context, lampyris_scene_parse(context, ROOM "}", NULL, NULL, &from_arrays));
    struct lampyris_mesh mesh = {
        .size = sizeof mesh,
        .vertex_count = 4,
        .triangle_count = 2,
        .positions = vertices[0].position,
        .position_stride = sizeof *vertices,
        .normals = vertices[0].normal,
        .normal_stride = sizeof *vertices,
        .indices = indices,
        .material = "red",
    };
    uint64_t expected = render_hash(context, from_file);
    for (int is_borrowed = 0; is_borrowed < 2; is_borrowed++) {
        mesh.is_borrowed = is_borrowed;
        OK(context, lampyris_scene_add_mesh(from_arrays, "pair", &mesh));
        CHECK(render_hash(context, from_arrays) == expected && expected != 0);
    }
    check_get(context, from_arrays, "/shapes",
              "[{\"type\": \"mesh\", \"array\": \"pair\", \"name\": \"pair\", \"material\": "
              "\"red\"}]");
    OK(context, lampyris_scene_set(from_arrays, "/shapes/0/transform", "{\"scale\": 0.5}"));
    CHECK(render_hash(context, from_arrays) != expected);
    static const uint32_t beyond[] = {0, 1, 2, 2, 1, 4};
    mesh.indices = beyond;
    OK(context, lampyris_scene_add_mesh(from_arrays, "pair", &mesh));
    CHECK(lampyris_scene_check(from_arrays, NULL) == LAMPYRIS_INPUT);
    CHECK(strstr(error_of(context).message, "indices[1][2]: 4; expected less than 4"), "%s",
          error_of(context).message);
    CHECK(strcmp(error_of(context).place, "/shapes/0/array") == 0, "%s", error_of(context).place);
    mesh.positions = NULL;
    CHECK(lampyris_scene_add_mesh(from_arrays, "none", &mesh) == LAMPYRIS_INPUT);
    lampyris_scene_release(from_file);
    lampyris_scene_release(from_arrays);
    remove("library_mesh.ply");
    OK(context, lampyris_scene_load(context, path_of("scenes/models/knot.ply"), NULL, &from_file));
    mesh.positions = vertices[0].position;
    CHECK(lampyris_scene_add_mesh(from_file, "pair", &mesh) == LAMPYRIS_INPUT);
    lampyris_scene_release(from_file);
    lampyris_context_release(context);
}

TEST_MAIN(TEST_CASE(values_are_read_and_set_by_pointers), TEST_CASE(edits_change_the_next_render),
          TEST_CASE(errors_have_status_file_place_and_what_was_expected),
          TEST_CASE(meshes_from_arrays_are_those_of_files))
