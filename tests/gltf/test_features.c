// Tests scenes loaded from valid files; every expected number is written or computed here.
#include "gltf_fixture.h"
#include "test.h"

static bool near3(const float *a, double x, double y, double z)
{
    return fabs((double)a[0] - x) < 1e-6 && fabs((double)a[1] - y) < 1e-6 &&
           fabs((double)a[2] - z) < 1e-6;
}

static bool near_double3(const double *a, double x, double y, double z)
{
    return fabs(a[0] - x) < 1e-12 && fabs(a[1] - y) < 1e-12 && fabs(a[2] - z) < 1e-12;
}

TEST(sample)
{
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, sample_json, &sample_binary, sizeof sample_binary, &err);
    CHECK(ok, "%s", err.msg);
    if (ok) {
        CHECK(!scene_objection(&scene), "%s", scene_objection(&scene));
        CHECK(scene.mesh_count == 1 && scene.instance_count == 2 && scene.camera_count == 1 &&
                  scene.material_count == 1,
              "%u meshes, %u instances, %u cameras, %u materials", scene.mesh_count,
              scene.instance_count, scene.camera_count, scene.material_count);
        const struct mesh *mesh = &scene.meshes[0];
        CHECK(strcmp(mesh->name, "square") == 0 && mesh->vertex_count == 4 &&
              mesh->triangle_count == 2);
        // Two positions are from the sparse part.
        CHECK(near3(mesh->positions[1], 1, 0, 0) && near3(mesh->positions[2], 1, 1, 0) &&
              near3(mesh->positions[3], 0, 1, 0));
        // Normals are normalised; a zero normal remains zero.
        CHECK(near3(mesh->normals[1], 0, 0, 1) && near3(mesh->normals[3], 0, 0, 0));
        CHECK(mesh->indices[1][0] == 0 && mesh->indices[1][1] == 2 && mesh->indices[1][2] == 3);
        const struct material *red = &scene.materials[0];
        CHECK(red->model == MATERIAL_PRINCIPLED && strcmp(red->name, "red") == 0);
        CHECK(near3(red->base_color, 1, 0.5, 0.25) && near3(red->emission, 2, 0, 0));
        const struct camera *camera = &scene.cameras[0];
        CHECK(strcmp(camera->name, "front") == 0 && camera->fov_y == 0.5);
        CHECK(near_double3(camera->position, 0, 0, 5) &&
              near_double3(camera->direction, 0, 0, -1) && near_double3(camera->up, 0, 1, 0));
        CHECK(scene.instances[1].transform[0][3] == 1 && scene.instances[1].transform[2][3] == 3);
        CHECK(scene.note_count == 0, "%s", scene.note_count ? scene.notes[0] : "");
    }
    scene_finish(&scene);
}

TEST(hash_covers_the_file)
{
    struct scene a, b, c;
    struct err err;
    struct sample_binary changed = sample_binary;
    changed.positions[0][0] = 0.5f;
    CHECK(load_glb(&a, sample_json, &sample_binary, sizeof sample_binary, &err), "%s", err.msg);
    CHECK(load_glb(&b, sample_json, &sample_binary, sizeof sample_binary, &err), "%s", err.msg);
    CHECK(load_glb(&c, sample_json, &changed, sizeof changed, &err), "%s", err.msg);
    CHECK(a.hash == b.hash && a.hash != c.hash);
    scene_finish(&a);
    scene_finish(&b);
    scene_finish(&c);
}

// A file with one mesh without a material. Each %s is replaced by the primitive, the accessors, the
// buffer views and the rest of the document, in this order.
#define ONE_MESH                                                                                   \
    "{'asset':{'version':'2.0'},'nodes':[{'mesh':0}],'meshes':[{'primitives':[%s]}],"              \
    "'accessors':[%s],'bufferViews':[%s],'buffers':[{'byteLength':%zu}]%s}"

struct one_mesh {
    const char *primitive, *accessors, *views, *rest;
    const void *binary;
    size_t size;
};

static bool load_one_mesh(struct scene *scene, const struct one_mesh *file, struct err *err)
{
    char json[2048];
    int length = snprintf(json, sizeof json, ONE_MESH, file->primitive, file->accessors,
                          file->views, file->size, file->rest ? file->rest : "");
    *scene = (struct scene){0};
    if (length < 0 || (size_t)length >= sizeof json)
        return err_set(err, ERR_BUG, "the test's file is too long");
    return load_glb(scene, json, file->binary, file->size, err);
}

#define POSITIONS_ONLY "{'attributes':{'POSITION':0}}"
#define VEC3_FLOATS "{'bufferView':0,'componentType':5126,'count':%d,'type':'VEC3'}"

static void check_mode(const char *mode, uint32_t triangles, const uint32_t (*expected)[3],
                       uint32_t vertices)
{
    static const float positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                          {1, 1, 0}, {0, 2, 0}, {1, 2, 0}};
    char primitive[128], accessor[128], view[128];
    snprintf(primitive, sizeof primitive, "{'attributes':{'POSITION':0},'mode':%s}", mode);
    snprintf(accessor, sizeof accessor, VEC3_FLOATS, (int)vertices);
    snprintf(view, sizeof view, "{'buffer':0,'byteLength':%d}", 12 * (int)vertices);
    struct scene scene;
    struct err err;
    bool ok = load_one_mesh(
        &scene, &(struct one_mesh){primitive, accessor, view, NULL, positions, sizeof positions},
        &err);
    CHECK(ok, "mode %s: %s", mode, err.msg);
    if (ok && triangles == 0)
        CHECK(scene.mesh_count == 0 && has_note(&scene, "1 primitives of points or lines"));
    if (ok && triangles > 0) {
        const struct mesh *mesh = &scene.meshes[0];
        CHECK(mesh->triangle_count == triangles, "mode %s: %u", mode, mesh->triangle_count);
        CHECK(mesh->triangle_count == triangles &&
                  memcmp(mesh->indices, expected, triangles * sizeof *expected) == 0,
              "mode %s", mode);
        CHECK(!mesh->normals && has_note(&scene, "1 primitives without a material are grey"));
    }
    scene_finish(&scene);
}

TEST(primitive_modes)
{
    check_mode("4", 2, (const uint32_t[][3]){{0, 1, 2}, {3, 4, 5}}, 6);
    check_mode("5", 4, (const uint32_t[][3]){{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}}, 6);
    check_mode("6", 4, (const uint32_t[][3]){{1, 2, 0}, {2, 3, 0}, {3, 4, 0}, {4, 5, 0}}, 6);
    check_mode("5", 1, (const uint32_t[][3]){{0, 1, 2}}, 3);
    for (int mode = 0; mode <= 3; mode++)
        check_mode((const char *[]){"0", "1", "2", "3"}[mode], 0, NULL, 6);
}

static void check_index_type(const char *code, size_t index_size)
{
    struct {
        float positions[3][3];
        uint8_t indices[12];
    } binary = {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const uint8_t order[3] = {2, 0, 1};
    for (size_t i = 0; i < 3; i++)
        binary.indices[i * index_size] = order[i];
    char accessors[256];
    snprintf(accessors, sizeof accessors,
             "{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
             "{'bufferView':1,'componentType':%s,'count':3,'type':'SCALAR'}",
             code);
    struct scene scene;
    struct err err;
    const struct one_mesh file = {
        .primitive = "{'attributes':{'POSITION':0},'indices':1}",
        .accessors = accessors,
        .views = "{'buffer':0,'byteLength':36},{'buffer':0,'byteOffset':36,'byteLength':12}",
        .binary = &binary,
        .size = sizeof binary,
    };
    bool ok = load_one_mesh(&scene, &file, &err);
    CHECK(ok, "%s: %s", code, err.msg);
    if (ok)
        CHECK(scene.meshes[0].indices[0][0] == 2 && scene.meshes[0].indices[0][1] == 0 &&
                  scene.meshes[0].indices[0][2] == 1,
              "%s", code);
    scene_finish(&scene);
}

// Strips that repeated vertices join, and a strip that consists only of repeated vertices.
TEST(turns_of_strips)
{
    const struct {
        float positions[4][3];
        uint16_t indices[14];
    } binary = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                {0, 1, 2, 3, 3, 0, 0, 1, 2, 2, 1, 1, 1, 2}};
    const struct one_mesh file = {
        .primitive = "{'attributes':{'POSITION':0},'indices':1,'mode':5},"
                     "{'attributes':{'POSITION':0},'indices':2,'mode':5}",
        .accessors = "{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
                     "{'bufferView':1,'componentType':5123,'count':9,'type':'SCALAR'},"
                     "{'bufferView':1,'byteOffset':20,'componentType':5123,'count':3,"
                     "'type':'SCALAR'}",
        .views = "{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':28}",
        .binary = &binary,
        .size = sizeof binary,
    };
    static const uint32_t expected[3][3] = {{0, 1, 2}, {1, 3, 2}, {0, 1, 2}};
    struct scene scene;
    struct err err;
    bool ok = load_one_mesh(&scene, &file, &err);
    CHECK(ok, "%s", err.msg);
    CHECK(ok && scene.mesh_count == 1 && scene.meshes[0].triangle_count == 3 &&
              memcmp(scene.meshes[0].indices, expected, sizeof expected) == 0,
          "%u triangles", scene.mesh_count ? scene.meshes[0].triangle_count : 0);
    CHECK(has_note(&scene,
                   "1 primitives are skipped: all of their triangles have a repeated vertex"));
    scene_finish(&scene);
}

TEST(index_types)
{
    check_index_type("5121", 1);
    check_index_type("5123", 2);
    check_index_type("5125", 4);
}

TEST(interleaved_vertices)
{
    // Position, normal and a texture coordinate that the loader ignores, 32 bytes per vertex.
    const float binary[3][8] = {
        {0, 0, 0, 0, 0, 1, 7, 7}, {1, 0, 0, 0, 1, 0, 7, 7}, {0, 1, 0, 1, 0, 0, 7, 7}};
    const struct one_mesh file = {
        .primitive = "{'attributes':{'POSITION':0,'NORMAL':1}}",
        .accessors = "{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
                     "{'bufferView':0,'byteOffset':12,'componentType':5126,'count':3,"
                     "'type':'VEC3'}",
        .views = "{'buffer':0,'byteLength':96,'byteStride':32}",
        .binary = binary,
        .size = sizeof binary,
    };
    struct scene scene;
    struct err err;
    bool ok = load_one_mesh(&scene, &file, &err);
    CHECK(ok, "%s", err.msg);
    if (ok)
        CHECK(near3(scene.meshes[0].positions[2], 0, 1, 0) &&
              near3(scene.meshes[0].normals[1], 0, 1, 0) &&
              near3(scene.meshes[0].normals[2], 1, 0, 0));
    scene_finish(&scene);
}

// Checks quantized positions in each integer type: one vertex has -128 or 0, 1, and 127 or the
// greatest value.
static void check_quantized(const char *code, bool normalized, const void *binary, size_t size,
                            const double expected[3])
{
    char accessors[192];
    snprintf(accessors, sizeof accessors,
             "{'bufferView':0,'componentType':%s,'normalized':%s,'count':3,'type':'VEC3'}", code,
             normalized ? "true" : "false");
    char view[128];
    snprintf(view, sizeof view, "{'buffer':0,'byteLength':%zu,'byteStride':%zu}", size, size / 3);
    const struct one_mesh file = {
        .primitive = POSITIONS_ONLY,
        .accessors = accessors,
        .views = view,
        .rest = ",'extensionsRequired':['KHR_mesh_quantization'],"
                "'extensionsUsed':['KHR_mesh_quantization']",
        .binary = binary,
        .size = size,
    };
    struct scene scene;
    struct err err;
    bool ok = load_one_mesh(&scene, &file, &err);
    CHECK(ok, "%s: %s", code, err.msg);
    if (ok)
        CHECK(near3(scene.meshes[0].positions[0], expected[0], expected[1], expected[2]),
              "%s, normalized %d: %g %g %g", code, normalized,
              (double)scene.meshes[0].positions[0][0], (double)scene.meshes[0].positions[0][1],
              (double)scene.meshes[0].positions[0][2]);
    scene_finish(&scene);
}

TEST(quantized_positions)
{
    const int8_t i8[3][4] = {{-128, 1, 127, 0}};
    const uint8_t u8[3][4] = {{0, 1, 255, 0}};
    const int16_t i16[3][4] = {{-32768, 1, 32767, 0}};
    const uint16_t u16[3][4] = {{0, 1, 65535, 0}};
    check_quantized("5120", false, i8, sizeof i8, (const double[]){-128, 1, 127});
    check_quantized("5120", true, i8, sizeof i8, (const double[]){-1, 1 / 127.0, 1});
    check_quantized("5121", false, u8, sizeof u8, (const double[]){0, 1, 255});
    check_quantized("5121", true, u8, sizeof u8, (const double[]){0, 1 / 255.0, 1});
    check_quantized("5122", false, i16, sizeof i16, (const double[]){-32768, 1, 32767});
    check_quantized("5122", true, i16, sizeof i16, (const double[]){-1, 1 / 32767.0, 1});
    check_quantized("5123", false, u16, sizeof u16, (const double[]){0, 1, 65535});
    check_quantized("5123", true, u16, sizeof u16, (const double[]){0, 1 / 65535.0, 1});
}

TEST(quantized_normals)
{
    const struct {
        float positions[3][3];
        int8_t normals[3][4];
    } binary = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 127}, {127, 127, 0}, {-128, 0, 0}}};
    const struct one_mesh file = {
        .primitive = "{'attributes':{'POSITION':0,'NORMAL':1}}",
        .accessors = "{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
                     "{'bufferView':1,'componentType':5120,'normalized':true,'count':3,"
                     "'type':'VEC3'}",
        .views = "{'buffer':0,'byteLength':36},"
                 "{'buffer':0,'byteOffset':36,'byteLength':12,'byteStride':4}",
        .rest = ",'extensionsUsed':['KHR_mesh_quantization']",
        .binary = &binary,
        .size = sizeof binary,
    };
    struct scene scene;
    struct err err;
    bool ok = load_one_mesh(&scene, &file, &err);
    CHECK(ok, "%s", err.msg);
    if (ok)
        CHECK(near3(scene.meshes[0].normals[0], 0, 0, 1) &&
              near3(scene.meshes[0].normals[1], sqrt(0.5), sqrt(0.5), 0) &&
              near3(scene.meshes[0].normals[2], -1, 0, 0));
    scene_finish(&scene);
}

TEST(sparse_without_base)
{
    const struct {
        uint8_t indices[4];
        float values[2][3];
    } binary = {{1, 2}, {{1, 0, 0}, {0, 1, 0}}};
    const struct one_mesh file = {
        .primitive = POSITIONS_ONLY,
        .accessors = "{'componentType':5126,'count':3,'type':'VEC3','sparse':{'count':2,"
                     "'indices':{'bufferView':0,'componentType':5121},"
                     "'values':{'bufferView':1}}}",
        .views = "{'buffer':0,'byteLength':4},{'buffer':0,'byteOffset':4,'byteLength':24}",
        .binary = &binary,
        .size = sizeof binary,
    };
    struct scene scene;
    struct err err;
    bool ok = load_one_mesh(&scene, &file, &err);
    CHECK(ok, "%s", err.msg);
    if (ok)
        CHECK(near3(scene.meshes[0].positions[0], 0, 0, 0) &&
              near3(scene.meshes[0].positions[1], 1, 0, 0) &&
              near3(scene.meshes[0].positions[2], 0, 1, 0));
    scene_finish(&scene);
}

TEST(data_uris)
{
    char *uri = data_uri(&sample_binary, sizeof sample_binary);
    char *buffer = malloc(strlen(uri) + 64);
    snprintf(buffer, strlen(uri) + 64, "{'byteLength':136,'uri':'%s'}", uri);
    char *json = replace_text(sample_json, "{'byteLength':136}", buffer);
    struct bytes text = json_bytes(json);
    struct scene scene;
    struct err err;
    CHECK(load_bytes(&scene, "test.gltf", text, &err), "%s", err.msg);
    CHECK(scene.mesh_count == 1 && near3(scene.meshes[0].positions[2], 1, 1, 0));
    scene_finish(&scene);
    free(text.data);
    free(json);
    free(buffer);
    free(uri);
}

// Shared vertices are decoded once, for any number of primitives.
TEST(primitives_share_accessors)
{
    const struct {
        float positions[4][3];
        uint16_t indices[6];
    } binary = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {0, 1, 2, 1, 3, 2}};
    const struct one_mesh file = {
        .primitive = "{'attributes':{'POSITION':0},'indices':1},"
                     "{'attributes':{'POSITION':0},'indices':2}",
        .accessors = "{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
                     "{'bufferView':1,'componentType':5123,'count':3,'type':'SCALAR'},"
                     "{'bufferView':1,'byteOffset':6,'componentType':5123,'count':3,"
                     "'type':'SCALAR'}",
        .views = "{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':12}",
        .binary = &binary,
        .size = sizeof binary,
    };
    struct scene scene;
    struct err err;
    bool ok = load_one_mesh(&scene, &file, &err);
    CHECK(ok, "%s", err.msg);
    if (ok) {
        CHECK(scene.mesh_count == 2 && scene.instance_count == 2 && scene.material_count == 1);
        CHECK(scene.mesh_count == 2 && scene.meshes[0].positions == scene.meshes[1].positions &&
              scene.meshes[1].indices[0][1] == 3);
    }
    scene_finish(&scene);
}

// --- nodes ---------------------------------------------------------------------------------------

// Loads a file of nodes. The instances of mesh nodes are in the scene in the order of the nodes.
static bool load_nodes(struct scene *scene, const char *nodes, struct err *err)
{
    static const float triangle[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    char json[2048];
    int length = snprintf(json, sizeof json,
                          "{'asset':{'version':'2.0'},%s,"
                          "'meshes':[{'primitives':[" POSITIONS_ONLY "]}],"
                          "'accessors':[{'bufferView':0,'componentType':5126,'count':3,"
                          "'type':'VEC3'}],'bufferViews':[{'buffer':0,'byteLength':36}],"
                          "'buffers':[{'byteLength':36}]}",
                          nodes);
    *scene = (struct scene){0};
    if (length < 0 || (size_t)length >= sizeof json)
        return err_set(err, ERR_BUG, "the test's file is too long");
    return load_glb(scene, json, triangle, sizeof triangle, err);
}

static void transform(const struct instance *instance, const double p[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = instance->transform[i][0] * p[0] + instance->transform[i][1] * p[1] +
                 instance->transform[i][2] * p[2] + instance->transform[i][3];
}

TEST(node_transforms)
{
    struct scene scene;
    struct err err;
    // A quarter turn about Z (by a quaternion of length two), scaled and translated, below another
    // translation.
    bool ok = load_nodes(&scene,
                         "'nodes':[{'translation':[10,0,0],'children':[1,2]},"
                         "{'mesh':0,'translation':[1,2,3],"
                         "'rotation':[0,0,1.4142135623730951,1.4142135623730951],"
                         "'scale':[2,3,4]},"
                         "{'mesh':0,'matrix':[0,2,0,0,-3,0,0,0,0,0,4,0,1,2,3,1]}]",
                         &err);
    CHECK(ok, "%s", err.msg);
    CHECK(scene.instance_count == 2 && scene.mesh_count == 1);
    for (uint32_t i = 0; ok && i < scene.instance_count; i++) {
        double p[3];
        transform(&scene.instances[i], (const double[]){1, 1, 1}, p);
        CHECK(near_double3(p, 10 + 1 - 3, 2 + 2, 3 + 4), "%g %g %g", p[0], p[1], p[2]);
    }
    scene_finish(&scene);
}

static uint32_t count_instances(const char *nodes)
{
    struct scene scene;
    struct err err;
    bool ok = load_nodes(&scene, nodes, &err);
    CHECK(ok, "%s", err.msg);
    uint32_t count = scene.instance_count;
    scene_finish(&scene);
    return count;
}

TEST(scene_choice)
{
    static const char nodes[] = "'nodes':[{'mesh':0,'children':[1,2]},{'mesh':0},{'mesh':0},"
                                "{'mesh':0}]%s";
    static const struct {
        const char *scenes;
        uint32_t instances;
    } cases[] = {
        {"", 4}, // all nodes are roots
        {",'scenes':[{'nodes':[3]},{'nodes':[0]}]", 1},
        {",'scene':1,'scenes':[{'nodes':[3]},{'nodes':[0]}]", 3},
        {",'scene':0,'scenes':[{'nodes':[3,0]}]", 4},
        {",'scenes':[{}]", 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, nodes, cases[i].scenes);
        uint32_t count = count_instances(text);
        CHECK(count == cases[i].instances, "%s: %u", cases[i].scenes, count);
    }
}

TEST(zero_scale_is_left_to_the_scene)
{
    CHECK(count_instances("'nodes':[{'mesh':0,'scale':[0,0,0]}]") == 1);
}

TEST(gpu_instancing)
{
    const struct {
        float translations[2][3];
        int8_t rotations[2][4];
        float scales[2][3];
        float positions[3][3];
    } binary = {
        {{1, 2, 3}, {4, 5, 6}},
        {{0, 0, 0, 127}, {0, 0, 127, 127}}, // the second one is a quarter turn about Z
        {{1, 1, 1}, {2, 2, 2}},
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
    };
    static const char json[] =
        "{'asset':{'version':'2.0'},'extensionsRequired':['EXT_mesh_gpu_instancing'],"
        "'nodes':[{'mesh':0,'translation':[100,0,0],'extensions':{'EXT_mesh_gpu_instancing':"
        "{'attributes':{'TRANSLATION':0,'ROTATION':1,'SCALE':2,'_ID':7}}}}],"
        "'meshes':[{'primitives':[{'attributes':{'POSITION':3}}]}],"
        "'accessors':[{'bufferView':0,'componentType':5126,'count':2,'type':'VEC3'},"
        "{'bufferView':1,'componentType':5120,'normalized':true,'count':2,'type':'VEC4'},"
        "{'bufferView':2,'componentType':5126,'count':2,'type':'VEC3'},"
        "{'bufferView':3,'componentType':5126,'count':3,'type':'VEC3'}],"
        "'bufferViews':[{'buffer':0,'byteLength':24},"
        "{'buffer':0,'byteOffset':24,'byteLength':8},"
        "{'buffer':0,'byteOffset':32,'byteLength':24},"
        "{'buffer':0,'byteOffset':56,'byteLength':36}],'buffers':[{'byteLength':92}]}";
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, json, &binary, sizeof binary, &err);
    CHECK(ok, "%s", err.msg);
    CHECK(scene.instance_count == 2, "%u", scene.instance_count);
    if (ok && scene.instance_count == 2) {
        double p[3];
        transform(&scene.instances[0], (const double[]){1, 0, 0}, p);
        CHECK(near_double3(p, 102, 2, 3), "%g %g %g", p[0], p[1], p[2]);
        transform(&scene.instances[1], (const double[]){1, 0, 0}, p);
        CHECK(near_double3(p, 104, 7, 6), "%g %g %g", p[0], p[1], p[2]);
    }
    scene_finish(&scene);
}

TEST(cameras)
{
    struct scene scene;
    struct err err;
    // A half turn about Y makes the camera look along +Z. A camera without a name gets that of its
    // node.
    bool ok = load_glb(
        &scene,
        "{'asset':{'version':'2.0'},"
        "'nodes':[{'camera':1},{'name':'back','camera':0,'rotation':[0,1,0,0],'scale':[2,3,4]},"
        "{'camera':0,'scale':[0,0,0]}],"
        "'cameras':[{'type':'perspective','perspective':{'yfov':1,'znear':0.1}},"
        "{'type':'orthographic','orthographic':{'xmag':1,'ymag':1.5,'zfar':2,'znear':1}}]}",
        NULL, 0, &err);
    CHECK(ok, "%s", err.msg);
    CHECK(scene.camera_count == 2, "%u", scene.camera_count);
    if (ok && scene.camera_count == 2) {
        CHECK(scene.cameras[0].kind == CAMERA_ORTHOGRAPHIC && scene.cameras[0].height == 3);
        CHECK(scene.cameras[1].kind == CAMERA_PERSPECTIVE &&
              strcmp(scene.cameras[1].name, "back") == 0);
        CHECK(near_double3(scene.cameras[1].direction, 0, 0, 1) &&
              near_double3(scene.cameras[1].up, 0, 1, 0));
        CHECK(has_note(&scene, "1 orthographic cameras take their height from ymag") &&
              has_note(&scene, "1 cameras are skipped"));
    }
    scene_finish(&scene);
}

TEST(ignored_extensions)
{
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene,
                       "{'asset':{'version':'2.7'},"
                       "'extensionsUsed':['KHR_materials_unlit','EXT_a','EXT_b']}",
                       NULL, 0, &err);
    CHECK(ok, "%s", err.msg);
    CHECK(has_note(&scene, "test.glb: unsupported extensions are ignored: EXT_a, EXT_b"));
    scene_finish(&scene);
}

TEST_MAIN(TEST_CASE(sample), TEST_CASE(hash_covers_the_file), TEST_CASE(primitive_modes),
          TEST_CASE(turns_of_strips), TEST_CASE(index_types), TEST_CASE(interleaved_vertices),
          TEST_CASE(quantized_positions), TEST_CASE(quantized_normals),
          TEST_CASE(sparse_without_base), TEST_CASE(data_uris),
          TEST_CASE(primitives_share_accessors), TEST_CASE(node_transforms),
          TEST_CASE(scene_choice), TEST_CASE(zero_scale_is_left_to_the_scene),
          TEST_CASE(gpu_instancing), TEST_CASE(cameras), TEST_CASE(ignored_extensions))
