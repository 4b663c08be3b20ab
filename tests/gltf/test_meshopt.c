// Tests compressed buffer views: data that the library's encoders have compressed are restored.
#include "gltf_builder.h"
#include "test.h"

#include <meshoptimizer.h>

enum { SIDE = 20, VERTICES = SIDE * SIDE, INDICES = 6 * (SIDE - 1) * (SIDE - 1) };

// A height field of waves.
struct grid {
    float positions[VERTICES][3];
    float normals[VERTICES][4]; // normals of unit length; the last component is 0
    uint32_t indices[INDICES];
};

static void make_grid(struct grid *grid)
{
    uint32_t n = 0;
    *grid = (struct grid){0};
    for (uint32_t v = 0; v < VERTICES; v++) {
        double x = v % SIDE / 8.0, y = v / SIDE / 8.0, slope = cos(x);
        grid->positions[v][0] = (float)x;
        grid->positions[v][1] = (float)y;
        grid->positions[v][2] = (float)sin(x);
        grid->normals[v][0] = (float)(-slope / sqrt(1 + slope * slope));
        grid->normals[v][2] = (float)(1 / sqrt(1 + slope * slope));
    }
    for (uint32_t y = 0; y + 1 < SIDE; y++)
        for (uint32_t x = 0; x + 1 < SIDE; x++) {
            uint32_t a = y * SIDE + x;
            const uint32_t two[6] = {a, a + 1, a + SIDE, a + SIDE, a + 1, a + SIDE + 1};
            memcpy(grid->indices + n, two, sizeof two);
            n += 6;
        }
}

// A compressed stream, and the members that describe it.
struct stream {
    uint8_t bytes[16384];
    size_t size, count, stride;
    const char *mode, *filter;
};

static void encode_vertices(const void *data, size_t count, size_t stride, const char *filter,
                            struct stream *out)
{
    *out =
        (struct stream){.count = count, .stride = stride, .mode = "ATTRIBUTES", .filter = filter};
    out->size = meshopt_encodeVertexBuffer(out->bytes, sizeof out->bytes, data, count, stride);
    CHECK(out->size > 0);
}

static void encode_indices(const uint32_t *indices, size_t count, bool is_list, size_t stride,
                           struct stream *out)
{
    *out = (struct stream){.count = count, .stride = stride};
    out->mode = is_list ? "TRIANGLES" : "INDICES";
    out->filter = "NONE";
    out->size = is_list
                    ? meshopt_encodeIndexBuffer(out->bytes, sizeof out->bytes, indices, count)
                    : meshopt_encodeIndexSequence(out->bytes, sizeof out->bytes, indices, count);
    CHECK(out->size > 0);
}

// --- files ---------------------------------------------------------------------------------------

// A GLB file with streams one after the other in buffer 0. Their views refer to bytes of buffer 1,
// which has none. `members` has further members of the views' objects.
struct file {
    uint8_t binary[49152];
    size_t size;
    char views[2048];
};

static void add_stream(struct file *file, const struct stream *stream, const char *members)
{
    size_t length = strlen(file->views);
    snprintf(file->views + length, sizeof file->views - length,
             "%s{'buffer':1,'byteLength':%zu%s,'extensions':{'EXT_meshopt_compression':{'buffer':0,"
             "'byteOffset':%zu,'byteLength':%zu,'count':%zu,'byteStride':%zu,'mode':'%s',"
             "'filter':'%s'}}}",
             length ? "," : "", stream->count * stream->stride, members, file->size, stream->size,
             stream->count, stream->stride, stream->mode, stream->filter);
    memcpy(file->binary + file->size, stream->bytes, stream->size);
    file->size += stream->size;
}

#define FALLBACK "{'byteLength':100000,'extensions':{'EXT_meshopt_compression':{'fallback':true}}}"

// `lists` has the members "'nodes':[…],'meshes':[…],'accessors':[…]".
static bool load_file(const struct file *file, const char *lists, struct scene *scene,
                      struct err *err)
{
    char json[4096];
    snprintf(json, sizeof json,
             "{'asset':{'version':'2.0'},'extensionsRequired':['EXT_meshopt_compression'],"
             "'extensionsUsed':['EXT_meshopt_compression','KHR_mesh_quantization'],%s,"
             "'bufferViews':[%s],'buffers':[{'byteLength':%zu}," FALLBACK "]}",
             lists, file->views, file->size);
    return load_glb(scene, json, file->binary, file->size, err);
}

#define MESH "'nodes':[{'mesh':0}],'meshes':[{'primitives':[{%s'attributes':{%s}}]}],"
#define POSITIONS "{'bufferView':0,'componentType':5126,'count':400,'type':'VEC3'}"

static bool has_positions(const struct mesh *mesh, const struct grid *grid)
{
    return mesh->vertex_count == VERTICES &&
           memcmp(mesh->positions, grid->positions, sizeof grid->positions) == 0;
}

// Returns whether two triangles have the same vertices in the same order, beginning with any of
// them.
static bool is_same_triangle(const uint32_t a[3], const uint32_t b[3])
{
    for (int turn = 0; turn < 3; turn++)
        if (a[0] == b[turn] && a[1] == b[(turn + 1) % 3] && a[2] == b[(turn + 2) % 3])
            return true;
    return false;
}

TEST(vertices_and_triangles)
{
    static struct grid grid;
    static struct stream stream;
    make_grid(&grid);
    for (int list = 0; list < 2; list++)
        for (size_t stride = 2; stride <= 4; stride += 2) {
            static struct file file;
            char lists[1024];
            file = (struct file){0};
            encode_vertices(grid.positions, VERTICES, 12, "NONE", &stream);
            add_stream(&file, &stream, ",'byteStride':12");
            encode_indices(grid.indices, INDICES, list, stride, &stream);
            add_stream(&file, &stream, "");
            snprintf(lists, sizeof lists,
                     MESH "'accessors':[" POSITIONS ",{'bufferView':1,'componentType':%d,"
                          "'count':%d,'type':'SCALAR'}]",
                     "'indices':1,", "'POSITION':0", stride == 2 ? 5123 : 5125, (int)INDICES);
            struct scene scene;
            struct err err;
            bool ok = load_file(&file, lists, &scene, &err);
            CHECK(ok, "%s", err.msg);
            if (ok) {
                const struct mesh *mesh = &scene.meshes[0];
                uint32_t same = 0;
                CHECK(has_positions(mesh, &grid) && mesh->triangle_count == INDICES / 3);
                // The codec for triangle lists may rotate the vertices of a triangle.
                for (uint32_t t = 0; t < mesh->triangle_count; t++)
                    same += is_same_triangle(mesh->indices[t], &grid.indices[3 * t]);
                CHECK(same == INDICES / 3, "%u of %d", same, INDICES / 3);
            }
            scene_finish(&scene);
        }
}

TEST(interleaved_vertices)
{
    static struct grid grid;
    static struct stream stream;
    static struct file file;
    static struct {
        float position[3];
        int8_t normal[4];
    } vertices[VERTICES];
    make_grid(&grid);
    for (uint32_t v = 0; v < VERTICES; v++) {
        memcpy(vertices[v].position, grid.positions[v], sizeof grid.positions[v]);
        for (int i = 0; i < 3; i++)
            vertices[v].normal[i] = (int8_t)lroundf(grid.normals[v][i] * 127);
    }
    encode_vertices(vertices, VERTICES, 16, "NONE", &stream);
    add_stream(&file, &stream, ",'byteStride':16");
    char lists[1024];
    snprintf(lists, sizeof lists,
             MESH "'accessors':[" POSITIONS ",{'bufferView':0,'byteOffset':12,'normalized':true,"
                  "'componentType':5120,'count':400,'type':'VEC3'}]",
             "'mode':5,", "'POSITION':0,'NORMAL':1");
    struct scene scene;
    struct err err;
    bool ok = load_file(&file, lists, &scene, &err);
    CHECK(ok, "%s", err.msg);
    if (ok) {
        CHECK(has_positions(&scene.meshes[0], &grid));
        for (uint32_t v = 0; v < VERTICES; v++)
            for (int i = 0; i < 3; i++)
                CHECK(fabsf(scene.meshes[0].normals[v][i] - grid.normals[v][i]) < 0.01f);
    }
    scene_finish(&scene);
}

TEST(octahedral_normals)
{
    static struct grid grid;
    static struct stream stream;
    make_grid(&grid);
    for (size_t stride = 4; stride <= 8; stride += 4) {
        static struct file file;
        static uint8_t filtered[VERTICES * 8];
        char lists[1024];
        file = (struct file){0};
        encode_vertices(grid.positions, VERTICES, 12, "NONE", &stream);
        add_stream(&file, &stream, ",'byteStride':12");
        meshopt_encodeFilterOct(filtered, VERTICES, stride, stride == 4 ? 8 : 12, grid.normals[0]);
        encode_vertices(filtered, VERTICES, stride, "OCTAHEDRAL", &stream);
        add_stream(&file, &stream, stride == 4 ? ",'byteStride':4" : ",'byteStride':8");
        snprintf(lists, sizeof lists,
                 MESH "'accessors':[" POSITIONS ",{'bufferView':1,'normalized':true,"
                      "'componentType':%d,'count':400,'type':'VEC3'}]",
                 "'mode':5,", "'POSITION':0,'NORMAL':1", stride == 4 ? 5120 : 5122);
        struct scene scene;
        struct err err;
        bool ok = load_file(&file, lists, &scene, &err);
        CHECK(ok, "%s", err.msg);
        float tolerance = stride == 4 ? 0.02f : 0.002f; // tolerances of 8 and 12 bits
        for (uint32_t v = 0; ok && v < VERTICES; v++)
            for (int i = 0; i < 3; i++)
                CHECK(fabsf(scene.meshes[0].normals[v][i] - grid.normals[v][i]) < tolerance,
                      "vertex %u, %d: %g, expected %g", v, i, (double)scene.meshes[0].normals[v][i],
                      (double)grid.normals[v][i]);
        scene_finish(&scene);
    }
}

TEST(exponential_positions)
{
    static struct grid grid;
    static struct stream stream;
    static struct file file;
    static uint8_t filtered[VERTICES * 12];
    make_grid(&grid);
    meshopt_encodeFilterExp(filtered, VERTICES, 12, 15, grid.positions[0]);
    encode_vertices(filtered, VERTICES, 12, "EXPONENTIAL", &stream);
    add_stream(&file, &stream, "");
    char lists[512];
    snprintf(lists, sizeof lists, MESH "'accessors':[" POSITIONS "]", "'mode':5,", "'POSITION':0");
    struct scene scene;
    struct err err;
    bool ok = load_file(&file, lists, &scene, &err);
    CHECK(ok, "%s", err.msg);
    for (uint32_t v = 0; ok && v < VERTICES; v++)
        for (int i = 0; i < 3; i++)
            CHECK(fabsf(scene.meshes[0].positions[v][i] - grid.positions[v][i]) < 2e-4f);
    scene_finish(&scene);
}

// The instances are rotated about Z by a quarter, a third … of a turn.
TEST(quaternions)
{
    enum { COUNT = 32 };
    static struct stream stream;
    static struct file file;
    float positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, rotations[COUNT][4] = {{0}};
    int16_t filtered[COUNT][4];
    for (int i = 0; i < COUNT; i++) {
        rotations[i][2] = (float)sin(0.1 * i);
        rotations[i][3] = (float)cos(0.1 * i);
    }
    encode_vertices(positions, 3, 12, "NONE", &stream);
    add_stream(&file, &stream, "");
    meshopt_encodeFilterQuat(filtered, COUNT, 8, 16, rotations[0]);
    encode_vertices(filtered, COUNT, 8, "QUATERNION", &stream);
    add_stream(&file, &stream, "");
    struct scene scene;
    struct err err;
    bool ok =
        load_file(&file,
                  "'nodes':[{'mesh':0,'extensions':{'EXT_mesh_gpu_instancing':{'attributes':"
                  "{'ROTATION':1}}}}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}"
                  "],'accessors':[{'bufferView':0,'componentType':5126,'count':3,"
                  "'type':'VEC3'},{'bufferView':1,'componentType':5122,'normalized':true,"
                  "'count':32,'type':'VEC4'}]",
                  &scene, &err);
    CHECK(ok && scene.instance_count == COUNT, "%s", err.msg);
    for (uint32_t i = 0; ok && i < scene.instance_count; i++)
        CHECK(fabs(scene.instances[i].transform[0][0] - cos(0.2 * i)) < 1e-3 &&
              fabs(scene.instances[i].transform[1][0] - sin(0.2 * i)) < 1e-3);
    scene_finish(&scene);
}

// --- bad files -----------------------------------------------------------------------------------

// Truncates a stream at every byte: loading must fail or give a valid scene.
static void check_cuts(const struct stream *whole, const char *lists, bool is_surely_error)
{
    static struct stream cut;
    static struct file file;
    cut = *whole;
    for (cut.size = 1; cut.size < whole->size; cut.size++) {
        struct scene scene;
        struct err err;
        file = (struct file){0};
        add_stream(&file, &cut, "");
        bool ok = load_file(&file, lists, &scene, &err);
        CHECK(!(ok && is_surely_error), "%s cut to %zu bytes loaded", whole->mode, cut.size);
        CHECK(ok ? !scene_objection(&scene) : err.code == ERR_INPUT, "%s", err.msg);
        scene_finish(&scene);
    }
}

TEST(cut_streams)
{
    static struct grid grid;
    static struct stream stream;
    char lists[512];
    make_grid(&grid);
    snprintf(lists, sizeof lists, MESH "'accessors':[" POSITIONS "]", "'mode':5,", "'POSITION':0");
    encode_vertices(grid.positions, VERTICES, 12, "NONE", &stream);
    check_cuts(&stream, lists, true);
    for (int list = 0; list < 2; list++) {
        // The vertices take no bytes, because only the stream of indices exists.
        snprintf(lists, sizeof lists,
                 MESH "'accessors':[{'componentType':5126,'count':400,'type':'VEC3'},"
                      "{'bufferView':0,'componentType':5125,'count':%d,'type':'SCALAR'}]",
                 "'indices':1,", "'POSITION':0", (int)INDICES);
        encode_indices(grid.indices, INDICES, list, 4, &stream);
        check_cuts(&stream, lists, false);
    }
}

TEST(damaged_streams)
{
    static struct grid grid;
    static struct stream stream;
    static struct file file;
    char lists[512];
    uint32_t random = 1, loaded = 0;
    make_grid(&grid);
    snprintf(lists, sizeof lists,
             MESH "'accessors':[" POSITIONS ",{'bufferView':1,'componentType':5125,'count':%d,"
                  "'type':'SCALAR'}]",
             "'indices':1,", "'POSITION':0", (int)INDICES);
    encode_vertices(grid.positions, VERTICES, 12, "EXPONENTIAL", &stream);
    add_stream(&file, &stream, "");
    encode_indices(grid.indices, INDICES, true, 4, &stream);
    add_stream(&file, &stream, "");
    for (int round = 0; round < 2000; round++) {
        random = random * 1664525 + 1013904223;
        uint8_t *at = &file.binary[(random >> 8) % file.size], kept = *at;
        *at = (uint8_t)(random >> 24);
        struct scene scene;
        struct err err;
        bool ok = load_file(&file, lists, &scene, &err);
        CHECK(ok ? !scene_objection(&scene) : err.code == ERR_INPUT, "%s", err.msg);
        loaded += ok;
        scene_finish(&scene);
        *at = kept;
    }
    CHECK(loaded > 0 && loaded < 2000, "%u loaded", loaded); // both outcomes must occur
}

#define GOOD                                                                                       \
    "'buffer':1,'byteLength':4800,'extensions':{'EXT_meshopt_compression':{'buffer':0,"            \
    "'byteLength':%zu,'count':400,'byteStride':12,'mode':'ATTRIBUTES'}}"

struct bad_view {
    const char *find, *replacement, *message;
};

TEST(bad_views)
{
    static const struct bad_view cases[] = {
        {"'buffer':0,", "", "bufferViews[0].extensions.EXT_meshopt_compression: \"buffer\" is"},
        {"'buffer':0,", "'buffer':2,", "EXT_meshopt_compression.buffer: 2; expected an index"},
        {"'buffer':0,", "'buffer':1,", "buffers[1] has no \"uri\" and no binary chunk"},
        {"'buffer':0,", "'buffer':0,'byteOffset':1000000,", "byteOffset 1000000 + byteLength"},
        {"'buffer':0,", "'buffer':0,'byteOffset':9223372036854775807,", "is beyond buffers[0]"},
        {"'count':400,", "", "\"count\" is missing"},
        {"'count':400", "'count':0", "EXT_meshopt_compression.count: 0 is outside"},
        {"'count':400", "'count':1000000000",
         "bufferViews[0]: byteLength is 4800; expected the size of 1000000000"},
        {"'count':400", "'count':4611686018427387904", "EXT_meshopt_compression.count: 4611686018"},
        {"'byteStride':12,", "", "\"byteStride\" is missing"},
        {"'byteStride':12", "'byteStride':10", "a byteStride of 10; expected a multiple of 4"},
        {"'byteStride':12", "'byteStride':260", "EXT_meshopt_compression.byteStride: 260"},
        {"'byteStride':12", "'byteStride':16",
         "byteLength is 4800; expected the size of 400 elements of 16 bytes"},
        {",'mode':'ATTRIBUTES'", "", "\"mode\" is missing"},
        {"'ATTRIBUTES'", "'VERTICES'", "EXT_meshopt_compression.mode"},
        {"'ATTRIBUTES'", "'ATTRIBUTES','filter':'COLOR'", "EXT_meshopt_compression.filter"},
        {"'ATTRIBUTES'", "'ATTRIBUTES','filter':'OCTAHEDRAL'", "expected 4 or 8"},
        {"'ATTRIBUTES'", "'ATTRIBUTES','filter':'QUATERNION'", "expected 8"},
        {"'ATTRIBUTES'", "'TRIANGLES'", "a byteStride of 12; expected 2 or 4"},
        {"'byteStride':12,'mode':'ATTRIBUTES'",
         "'byteStride':4,'mode':'INDICES','filter':'EXPONENTIAL'", "a filter is given for indices"},
        {"'byteStride':12,'mode':'ATTRIBUTES'", "'byteStride':4,'mode':'TRIANGLES'",
         "400 indices of triangles; expected a multiple of 3"},
        {"'byteLength':4800", "'byteLength':4801",
         "byteLength is 4801; expected the size of 400 elements"},
        {"'byteLength':4800", "'byteLength':4800,'byteStride':16",
         "bufferViews[0]: byteStride is 16; expected 12, that of the extension"},
        {"'byteLength':4800", "'byteLength':4800,'byteOffset':99999", "is beyond buffers[1]"},
        {"'buffer':1,", "", "bufferViews[0]: \"buffer\" is missing"},
        {"'EXT_meshopt_compression':{", "'EXT_meshopt_compression':7,'x':{", "expected an object"},
        {"'ATTRIBUTES'", "'ATTRIBUTES','byteOffset':1", "bytes are not a valid stream of 400"},
    };
    static struct grid grid;
    static struct stream stream;
    static struct file file;
    char lists[512], good[512];
    make_grid(&grid);
    snprintf(lists, sizeof lists, MESH "'accessors':[" POSITIONS "]", "'mode':5,", "'POSITION':0");
    encode_vertices(grid.positions, VERTICES, 12, "NONE", &stream);
    add_stream(&file, &stream, "");
    file.binary[file.size++] = 0; // room for the last case
    snprintf(good, sizeof good, "{" GOOD "}", stream.size);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *view = replace_text(good, cases[i].find, cases[i].replacement);
        CHECK(view, "%s is not in the view", cases[i].find);
        if (!view)
            continue;
        snprintf(file.views, sizeof file.views, "%s", view);
        struct scene scene;
        struct err err;
        bool ok = load_file(&file, lists, &scene, &err);
        CHECK(!ok && err.code == ERR_INPUT && strstr(err.msg, cases[i].message), "%s: %s",
              cases[i].replacement, ok ? "loaded" : err.msg);
        scene_finish(&scene);
        free(view);
    }
}

TEST_MAIN(TEST_CASE(vertices_and_triangles), TEST_CASE(interleaved_vertices),
          TEST_CASE(octahedral_normals), TEST_CASE(exponential_positions), TEST_CASE(quaternions),
          TEST_CASE(cut_streams), TEST_CASE(damaged_streams), TEST_CASE(bad_views))
