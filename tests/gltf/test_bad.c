// Tests every check of the loader by a valid file with a single error, and the resulting message.
#include "gltf_fixture.h"
#include "test.h"

#include <float.h>

struct bad_case {
    const char *find, *replacement; // in sample_json
    const char *messages[3];        // texts that the message must contain
};

static void check_rejected(bool ok, const struct err *err, const char *path,
                           const char *const messages[3], const char *what)
{
    CHECK(!ok, "loaded: %s", what);
    if (ok)
        return;
    CHECK(err->code == ERR_INPUT, "%s: code %d: %s", what, (int)err->code, err->msg);
    CHECK(strncmp(err->msg, path, strlen(path)) == 0, "%s: no file name: %s", what, err->msg);
    for (int i = 0; i < 3 && messages[i]; i++)
        CHECK(strstr(err->msg, messages[i]), "%s: \"%s\" is not in: %s", what, messages[i],
              err->msg);
}

static void check_cases(const struct bad_case *cases, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        char *json = replace_text(sample_json, cases[i].find, cases[i].replacement);
        CHECK(json, "the sample has no %s", cases[i].find);
        if (!json)
            continue;
        struct scene scene;
        struct err err;
        bool ok = load_glb(&scene, json, &sample_binary, sizeof sample_binary, &err);
        check_rejected(ok, &err, "test.glb: ", cases[i].messages, cases[i].replacement);
        scene_finish(&scene);
        free(json);
    }
}

#define CHECK_CASES(cases) check_cases((cases), sizeof(cases) / sizeof(cases)[0])

TEST(frame)
{
    static const struct bad_case cases[] = {
        {"'asset':{'version':'2.0','generator':'test'},", "", {"\"asset\" is missing"}},
        {"'asset':{", "'asset':[],'x':{", {"asset: expected an object, not an array of 0"}},
        {"'version':'2.0',", "", {"asset: \"version\" is missing"}},
        {"'version':'2.0'", "'version':'1.0'", {"asset.version: ", "2.x", "\"1.0\""}},
        {"'version':'2.0'", "'version':'3.0'", {"asset.version: "}},
        {"'version':'2.0'", "'version':'2'", {"asset.version: "}},
        {"'version':'2.0'", "'version':'2.0.1'", {"asset.version: "}},
        {"'version':'2.0'", "'version':'2.0-'", {"asset.version: "}},
        {"'version':'2.0'", "'version':2.0", {"asset.version: expected a string"}},
        {"'version':'2.0'", "'version':'2.1','minVersion':'2.1'", {"asset.minVersion: ", "2.0"}},
        {"'scene':0", "'scene':1", {"scene: 1; expected an index below 1"}},
        {"'scene':0", "'scene':-1", {"scene: "}},
        {"'scene':0", "'scene':0,'scene':0", {"line 1", "duplicate"}},
        {"'scene':0,", "'scene':0,,", {"line 1, column "}},
        {"'cameras':[", "'textures':{},'cameras':[", {"textures: expected an array"}},
        {"'cameras':[", "'textures':[1],'cameras':[", {"textures[0]: expected an object, not 1"}},
        {"'extensionsUsed':[", "'extensionsUsed':[3,", {"extensionsUsed[0]: expected a string"}},
        {"'extensionsUsed':[",
         "'extensionsRequired':{},'extensionsUsed':[",
         {"extensionsRequired: expected an array"}},
        {"'extensionsUsed':[",
         "'extensionsRequired':['KHR_texture_basisu'],'extensionsUsed':[",
         {"extensionsRequired[0]: ",
          "\"KHR_texture_basisu\" is not supported; expected textures in PNG"}},
        {"'extensionsUsed':[",
         "'extensionsRequired':[0],'extensionsUsed':[",
         {"extensionsRequired[0]: expected a string"}},
    };
    CHECK_CASES(cases);
}

TEST(buffers)
{
    static const struct bad_case cases[] = {
        {"{'byteLength':136}", "{}", {"buffers[0]: \"byteLength\" is missing"}},
        {"{'byteLength':136}", "{'byteLength':0}", {"buffers[0].byteLength: 0 is outside [1, "}},
        {"{'byteLength':136}", "{'byteLength':137}", {"buffers[0]: ", "137", "136 bytes"}},
        {"{'byteLength':136}",
         "{'byteLength':4611686018427387904}",
         {"buffers[0]: ", "4611686018427387904"}},
        {"{'byteLength':136}", "{'byteLength':136.0}", {"buffers[0].byteLength: "}},
        {"{'byteLength':136}", "{'byteLength':135}", {"bufferViews[4]: ", "beyond buffers[0]"}},
        {"{'byteLength':136}", "{'byteLength':136,'uri':7}", {"buffers[0].uri: expected a string"}},
        {"{'byteLength':136}", "{'byteLength':136,'uri':''}", {"buffers[0].uri: "}},
        {"{'byteLength':136}",
         "{'byteLength':3,'uri':'data:,AAAA'}",
         {"buffers[0].uri: ", ";base64,"}},
        {"{'byteLength':136}", "{'byteLength':3,'uri':'data:x;base64'}", {"buffers[0].uri: "}},
        {"{'byteLength':136}",
         "{'byteLength':3,'uri':'data:x;base64,AAA'}",
         {"buffers[0].uri: ", "base64"}},
        {"{'byteLength':136}",
         "{'byteLength':1,'uri':'data:x;base64,AB=='}",
         {"buffers[0].uri: ", "base64"}},
        {"{'byteLength':136}",
         "{'byteLength':1,'uri':'data:x;base64,A==='}",
         {"buffers[0].uri: ", "base64"}},
        {"{'byteLength':136}",
         "{'byteLength':1,'uri':'data:x;base64,AA=A'}",
         {"buffers[0].uri: ", "base64"}},
        {"{'byteLength':136}",
         "{'byteLength':1,'uri':'data:x;base64,AA A'}",
         {"buffers[0].uri: ", "base64"}},
        {"{'byteLength':136}",
         "{'byteLength':1,'uri':'data:x;base64,AA-_'}",
         {"buffers[0].uri: ", "base64"}},
        {"{'byteLength':136}",
         "{'byteLength':4,'uri':'data:x;base64,AAAA'}",
         {"buffers[0]: ", "4, but there are 3 bytes"}},
        {"[{'byteLength':136}",
         "[{'byteLength':1,'uri':'data:x;base64,AA=='},{'byteLength':136}",
         {"bufferViews[0]: ", "beyond buffers[0] of 1 bytes"}},
        {"'bufferViews':[{'buffer':0,",
         "'bufferViews':[{'buffer':1,",
         {"bufferViews[0].buffer: 1; expected an index below 1"}},
        {"'bufferViews':[{'buffer':0,", "'bufferViews':[{", {"\"buffer\" is missing"}},
    };
    CHECK_CASES(cases);
}

// Only the first buffer may be the binary chunk.
TEST(second_buffer_without_uri)
{
    char *json = replace_text(sample_json, "'buffers':[{'byteLength':136}",
                              "'buffers':[{'byteLength':136},{'byteLength':136}");
    char *moved = replace_text(json, "'bufferViews':[{'buffer':0", "'bufferViews':[{'buffer':1");
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, moved, &sample_binary, sizeof sample_binary, &err);
    check_rejected(ok, &err, "test.glb: ",
                   (const char *const[3]){"bufferViews[0]: buffers[1] has no \"uri\""}, "second");
    scene_finish(&scene);
    free(moved);
    free(json);
}

TEST(buffer_views)
{
    static const struct bad_case cases[] = {
        {"'byteOffset':48,'byteLength':48}",
         "'byteOffset':48}",
         {"bufferViews[1]: \"byteLength\" is missing"}},
        {"'byteOffset':48,'byteLength':48}",
         "'byteOffset':48,'byteLength':0}",
         {"bufferViews[1].byteLength: "}},
        {"'byteOffset':48,'byteLength':48}",
         "'byteOffset':-48,'byteLength':48}",
         {"bufferViews[1].byteOffset: -48"}},
        {"'byteOffset':48,'byteLength':48}",
         "'byteOffset':48.5,'byteLength':48}",
         {"bufferViews[1].byteOffset: "}},
        {"'byteOffset':48,'byteLength':48}",
         "'byteOffset':18446744073709551608,'byteLength':48}",
         {"line 1", "too big integer"}},
        {"'byteOffset':48,'byteLength':48}",
         "'byteOffset':9223372036854775800,'byteLength':48}",
         {"bufferViews[1]: ", "9223372036854775800", "beyond buffers[0]"}},
        {"'byteOffset':48,'byteLength':48}",
         "'byteOffset':9223372036854775807,'byteLength':9223372036854775807}",
         {"bufferViews[1]: ", "beyond buffers[0]"}},
        {"'byteOffset':48,'byteLength':48}",
         "'byteOffset':96,'byteLength':48}",
         {"bufferViews[1]: ", "byteOffset 96 + byteLength 48", "of 136 bytes"}},
        {"'byteStride':12", "'byteStride':13", {"bufferViews[0]: ", "13 is not a multiple of 4"}},
        {"'byteStride':12", "'byteStride':0", {"bufferViews[0].byteStride: ", "[4, 252]"}},
        {"'byteStride':12", "'byteStride':256", {"bufferViews[0].byteStride: ", "[4, 252]"}},
        {"'byteStride':12",
         "'byteStride':8",
         {"accessors[0]: elements of 12 bytes overlap at a byteStride of 8"}},
        {"'byteStride':12", "'byteStride':16", {"accessors[0]: 4 elements of 12", "do not fit"}},
        {"'byteOffset':96,'byteLength':12",
         "'byteOffset':96,'byteLength':12,'byteStride':4",
         {"accessors[2]: ", "without gaps"}},
        {"'byteOffset':96,'byteLength':12",
         "'byteOffset':97,'byteLength':12",
         {"accessors[2]: begins at byte 0 of bufferViews[2], byte 97"}},
        {"'byteOffset':48,'byteLength':48",
         "'byteOffset':50,'byteLength':48",
         {"accessors[1]: ", "byte 50 of the buffer; expected multiples of 4"}},
    };
    CHECK_CASES(cases);
}

#define NORMAL_ACCESSOR                                                                            \
    "{'bufferView':1,'componentType':5126,'count':4,'type':'VEC3','normalized':false}"

TEST(accessors)
{
    static const struct bad_case cases[] = {
        {"'attributes':{'POSITION':0",
         "'attributes':{'POSITION':3",
         {"meshes[0].primitives[0].attributes.POSITION: 3; expected an index below 3"}},
        {NORMAL_ACCESSOR,
         "{'componentType':5126,'type':'VEC3'}",
         {"accessors[1]: \"count\" is missing"}},
        {NORMAL_ACCESSOR,
         "{'componentType':5126,'count':0,'type':'VEC3'}",
         {"accessors[1].count: 0 is outside [1, 4294967294]"}},
        {NORMAL_ACCESSOR,
         "{'componentType':5126,'count':-1,'type':'VEC3'}",
         {"accessors[1].count: -1"}},
        {NORMAL_ACCESSOR,
         "{'componentType':5126,'count':4e0,'type':'VEC3'}",
         {"accessors[1].count: "}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5126,'count':1000000000,'type':'VEC3'}",
         {"accessors[1]: 1000000000 elements", "do not fit into bufferViews[1] of 48 bytes"}},
        {NORMAL_ACCESSOR,
         "{'componentType':5126,'count':1000000000,'type':'VEC3'}",
         {"accessors[1]: has 1000000000 elements without \"bufferView\"; expected at most "
          "16777216"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5126,'count':4611686018427387904,'type':'VEC3'}",
         {"accessors[1].count: 4611686018427387904 is outside"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5126,'count':5,'type':'VEC3'}",
         {"accessors[1]: 5 elements", "do not fit"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'byteOffset':9223372036854775804,'componentType':5126,'count':4,"
         "'type':'VEC3'}",
         {"accessors[1]: ", "do not fit"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'byteOffset':4,'componentType':5126,'count':4,'type':'VEC3'}",
         {"accessors[1]: ", "do not fit"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'byteOffset':2,'componentType':5126,'count':3,'type':'VEC3'}",
         {"accessors[1]: begins at byte 2"}},
        {NORMAL_ACCESSOR,
         "{'byteOffset':4,'componentType':5126,'count':4,'type':'VEC3'}",
         {"accessors[1]: has \"byteOffset\" but no \"bufferView\""}},
        {NORMAL_ACCESSOR,
         "{'bufferView':5,'componentType':5126,'count':4,'type':'VEC3'}",
         {"accessors[1].bufferView: 5; expected an index below 5"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'count':4,'type':'VEC3'}",
         {"accessors[1]: \"componentType\" is missing"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5124,'count':4,'type':'VEC3'}",
         {"accessors[1].componentType: 5124 is not a component type"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5119,'count':4,'type':'VEC3'}",
         {"accessors[1].componentType: 5119 is not a component type"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5127,'count':4,'type':'VEC3'}",
         {"accessors[1].componentType: 5127 is not a component type"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5125,'count':4,'type':'VEC3'}",
         {"accessors[1].componentType: 5125 (UNSIGNED_INT) is not allowed for NORMAL"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5120,'normalized':true,'count':4,'type':'VEC3'}",
         {"accessors[1]: BYTE for NORMAL needs KHR_mesh_quantization"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5126,'normalized':true,'count':4,'type':'VEC3'}",
         {"accessors[1].componentType: 5126 (FLOAT) is not allowed"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5126,'normalized':1,'count':4,'type':'VEC3'}",
         {"accessors[1].normalized: expected true or false"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5126,'count':4}",
         {"accessors[1]: \"type\" is missing"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5126,'count':4,'type':'VEC4'}",
         {"accessors[1].type: \"VEC4\"; expected \"VEC3\" for NORMAL"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5126,'count':3,'type':'VEC3'}",
         {"accessors[1]: 3 elements of NORMAL for 4 positions"}},
        {NORMAL_ACCESSOR,
         "{'bufferView':1,'componentType':5126,'count':4,'type':'VEC3',"
         "'sparse':[]}",
         {"accessors[1].sparse: expected an object"}},
    };
    CHECK_CASES(cases);
}

TEST(quantization)
{
    // Quantized positions need a stride of a multiple of 4.
    char *json = replace_text(sample_json, NORMAL_ACCESSOR,
                              "{'bufferView':1,'componentType':5120,'normalized':true,'count':4,"
                              "'type':'VEC3'}");
    char *declared =
        replace_text(json, "'extensionsUsed':[", "'extensionsUsed':['KHR_mesh_quantization',");
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, declared, &sample_binary, sizeof sample_binary, &err);
    check_rejected(ok, &err,
                   "test.glb: ", (const char *const[3]){"accessors[1]: vertices are 3 bytes apart"},
                   "stride 3");
    scene_finish(&scene);
    free(declared);
    free(json);
}

// The offset is aligned in the buffer, but not in its view.
TEST(alignment_in_the_view)
{
    char *view = replace_text(sample_json, "'byteOffset':48,'byteLength':48",
                              "'byteOffset':46,'byteLength':50");
    char *json = replace_text(view, "{'bufferView':1,", "{'bufferView':1,'byteOffset':2,");
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, json, &sample_binary, sizeof sample_binary, &err);
    check_rejected(ok, &err, "test.glb: ",
                   (const char *const[3]){"accessors[1]: begins at byte 2 of bufferViews[1], "
                                          "byte 48 of the buffer; expected multiples of 4"},
                   "byteOffset 2");
    scene_finish(&scene);
    free(json);
    free(view);
}

TEST(sparse)
{
    static const struct bad_case cases[] = {
        {"'sparse':{'count':2,", "'sparse':{", {"accessors[0].sparse: \"count\" is missing"}},
        {"'sparse':{'count':2,", "'sparse':{'count':0,", {"accessors[0].sparse.count: "}},
        {"'sparse':{'count':2,",
         "'sparse':{'count':5,",
         {"accessors[0].sparse.count: 5 is outside [1, 4]"}},
        {"'sparse':{'count':2,",
         "'sparse':{'count':3,",
         {"accessors[0].sparse.indices: 3 elements", "do not fit"}},
        {"'indices':{'bufferView':3,",
         "'indices':{",
         {"accessors[0].sparse.indices: \"bufferView\""}},
        {"{'bufferView':3,'componentType':5123}",
         "{'bufferView':3}",
         {"accessors[0].sparse.indices: \"componentType\" is missing"}},
        {"{'bufferView':3,'componentType':5123}",
         "{'bufferView':3,'componentType':5126}",
         {"accessors[0].sparse.indices.componentType: 5126 (FLOAT) is not allowed"}},
        {"{'bufferView':3,'componentType':5123}",
         "{'bufferView':3,'byteOffset':1,'componentType':5123}",
         {"accessors[0].sparse.indices: ", "do not fit"}},
        // The little-endian bytes are 2, 0, 3, 0, which do not ascend.
        {"{'bufferView':3,'componentType':5123}",
         "{'bufferView':3,'componentType':5121}",
         {"accessors[0].sparse.indices: element 1 is 0; expected strictly increasing indices"}},
        {"'values':{'bufferView':4}",
         "'values':{}",
         {"accessors[0].sparse.values: \"bufferView\""}},
        {"'values':{'bufferView':4}",
         "'values':{'bufferView':4,'byteOffset':4}",
         {"accessors[0].sparse.values: 2 elements", "do not fit"}},
    };
    CHECK_CASES(cases);
}

TEST(primitives)
{
    static const struct bad_case cases[] = {
        {"'primitives':[", "'primitives':7,'x':[", {"meshes[0].primitives: expected an array"}},
        {"'primitives':[", "'primitives':[],'x':[", {"meshes[0].primitives: 0 elements"}},
        {"'primitives':[", "'x':[", {"meshes[0]: \"primitives\" is missing"}},
        {"'primitives':[", "'primitives':[7,", {"meshes[0].primitives[0]: expected an object"}},
        {"{'attributes':{'POSITION':0,'NORMAL':1},",
         "{",
         {"meshes[0].primitives[0]: \"attributes\" is missing"}},
        {"'mode':4", "'mode':7", {"meshes[0].primitives[0].mode: 7 is outside [0, 6]"}},
        {"'material':0", "'material':1", {"meshes[0].primitives[0].material: 1; expected"}},
        {"'indices':2,", "'indices':3,", {"meshes[0].primitives[0].indices: 3; expected"}},
        {"'indices':2,", "'indices':0,", {"accessors[0].type: \"VEC3\"; expected \"SCALAR\""}},
        {"'indices':2,", "", {"meshes[0].primitives[0]: 4 vertices of triangles"}},
        {"'count':6,'type':'SCALAR'",
         "'count':5,'type':'SCALAR'",
         {"accessors[2]: 5 vertices of triangles; expected a multiple of 3"}},
        {"'count':6,'type':'SCALAR'",
         "'count':6,'type':'SCALAR','normalized':true",
         {"accessors[2].componentType: 5123"}},
        {"'componentType':5123,'count':6",
         "'componentType':5126,'count':3",
         {"accessors[2].componentType: 5126 (FLOAT) is not allowed for indices"}},
        {"'name':'square'", "'name':7", {"meshes[0].name: expected a string"}},
    };
    CHECK_CASES(cases);
}

TEST(fan_of_two_vertices)
{
    char *json = replace_text(sample_json, "'componentType':5123,'count':6",
                              "'componentType':5123,'count':2");
    char *fan = replace_text(json, "'mode':4", "'mode':6");
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, fan, &sample_binary, sizeof sample_binary, &err);
    check_rejected(ok, &err,
                   "test.glb: ", (const char *const[3]){"accessors[2]: 2 vertices", "at least 3"},
                   "short fan");
    scene_finish(&scene);
    free(fan);
    free(json);
}

TEST(nodes)
{
    static const struct bad_case cases[] = {
        {"'children':[1,2]", "'children':7", {"nodes[0].children: expected an array"}},
        {"'children':[1,2]", "'children':[1,3]", {"nodes[0].children[1]: 3; ", "below 3"}},
        {"'children':[1,2]", "'children':[1,-1]", {"nodes[0].children[1]: -1; "}},
        {"'children':[1,2]", "'children':[1,'2']", {"nodes[0].children[1]: expected the index"}},
        {"'children':[1,2]",
         "'children':[1,1]",
         {"nodes[0].children[1]: node 1 is already a child of nodes[0]"}},
        {"'children':[1,2]", "'children':[0]", {"nodes[0]: is its own ancestor"}},
        {"{'mesh':0,'translation'",
         "{'mesh':0,'children':[0],'translation'",
         {"is its own ancestor"}},
        {"{'mesh':0,'translation'",
         "{'mesh':0,'children':[2],'translation'",
         {"nodes[1].children[0]: node 2 is already a child of nodes[0]"}},
        {"'nodes':[0]", "'nodes':[1]", {"scenes[0].nodes[0]: node 1 is a child of nodes[0]"}},
        {"'nodes':[0]", "'nodes':[0,0]", {"scenes[0].nodes[1]: node 0 is named twice"}},
        {"'nodes':[0]", "'nodes':[3]", {"scenes[0].nodes[0]: 3; "}},
        {"'name':'root','mesh':0", "'name':'root','mesh':1", {"nodes[0].mesh: 1; expected"}},
        {"'name':'root','mesh':0", "'mesh':0.0", {"nodes[0].mesh: "}},
        {"'translation':[1,2,3]", "'translation':[1,2]", {"nodes[1].translation: 2 elements"}},
        {"'translation':[1,2,3]", "'translation':[1,2,'3']", {"nodes[1].translation[2]: "}},
        {"'translation':[1,2,3]", "'translation':[1,2,1e309]", {"line 1", "overflow"}},
        {"'rotation':[0,0,0,1]", "'rotation':[0,0,0]", {"nodes[1].rotation: 3 elements"}},
        {"'rotation':[0,0,0,1]",
         "'rotation':[0,0,0,0]",
         {"nodes[1].rotation: the zero quaternion"}},
        {"'scale':[1,1,1]", "'scale':1", {"nodes[1].scale: expected an array"}},
        {"'scale':[1,1,1]",
         "'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]",
         {"nodes[1]: both \"matrix\" and \"translation\""}},
        {"'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,5,1]",
         "'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,5]",
         {"nodes[2].matrix: 15 elements; expected 16"}},
        {"'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,5,1]",
         "'matrix':[1,0,0,0.5,0,1,0,0,0,0,1,0,0,0,5,1]",
         {"nodes[2].matrix: the last row is (0.5, 0, 0, 1)"}},
    };
    CHECK_CASES(cases);
}

TEST(infinite_transform)
{
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene,
                       "{'asset':{'version':'2.0'},'nodes':[{'scale':[1e300,1,1],'children':[1]},"
                       "{'scale':[1e300,1,1]}]}",
                       NULL, 0, &err);
    check_rejected(ok, &err, "test.glb: ",
                   (const char *const[3]){"nodes[1]: its transform in the world is not finite"},
                   "1e600");
    scene_finish(&scene);
}

TEST(cameras_and_materials)
{
    static const struct bad_case cases[] = {
        {"'camera':0", "'camera':1", {"nodes[2].camera: 1; expected"}},
        {"'type':'perspective',", "", {"cameras[0]: \"type\" is missing"}},
        {"'type':'perspective',", "'type':'fisheye',", {"cameras[0].type: "}},
        {"'perspective':{", "'x':{", {"cameras[0]: \"perspective\" is missing"}},
        {"'yfov':0.5,", "", {"cameras[0].perspective: \"yfov\" is missing"}},
        {"'yfov':0.5,", "'yfov':0,", {"cameras[0].perspective.yfov: "}},
        {"'yfov':0.5,", "'yfov':3.2,", {"cameras[0].perspective.yfov: "}},
        {"0,0,5,1]", "0,0,5e18,1]", {"nodes[2]: the camera's coordinate is 5e+18"}},
        {"'baseColorFactor':[1,0.5,0.25,1]",
         "'baseColorFactor':[1.7,0.5,0.25,1]",
         {"materials[0].pbrMetallicRoughness.baseColorFactor[0]: 1.7 is outside [0, 1]"}},
        {"'baseColorFactor':[1,0.5,0.25,1]",
         "'baseColorFactor':[1,0.5,0.25]",
         {"baseColorFactor: 3 elements; expected 4"}},
        {"'metallicFactor':0", "'metallicFactor':-1", {"metallicFactor: -1 is outside [0, 1]"}},
        {"'pbrMetallicRoughness':{",
         "'pbrMetallicRoughness':1,'x':{",
         {"materials[0].pbrMetallicRoughness: expected an object"}},
        {"'emissiveFactor':[0.5,0,0]",
         "'emissiveFactor':[-0.5,0,0]",
         {"materials[0].emissiveFactor[0]: -0.5 is outside [0, 1]"}},
        {"'emissiveStrength':4",
         "'emissiveStrength':-4",
         {"KHR_materials_emissive_strength.emissiveStrength: -4 is outside"}},
        {"'emissiveStrength':4", "'emissiveStrength':1e39", {"emissiveStrength: 1e+39 is outside"}},
        {"'alphaMode':'OPAQUE'", "'alphaMode':'GLASS'", {"materials[0].alphaMode: "}},
        {"'extensions':{'KHR_materials_emissive_strength'",
         "'extensions':[],'x':{'y'",
         {"materials[0].extensions: expected an object"}},
    };
    CHECK_CASES(cases);
}

TEST(instancing)
{
    static const struct bad_case cases[] = {
        {"'name':'root',",
         "'extensions':{'EXT_mesh_gpu_instancing':{}},",
         {"nodes[0].extensions.EXT_mesh_gpu_instancing: \"attributes\" is missing"}},
        {"'name':'root',",
         "'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{}}},",
         {"attributes: expected TRANSLATION, ROTATION or SCALE"}},
        {"'name':'root',",
         "'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'TRANSLATION':3}}},",
         {"attributes.TRANSLATION: 3; expected an index below 3"}},
        {"'name':'root',",
         "'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'ROTATION':0}}},",
         {"accessors[0].type: \"VEC3\"; expected \"VEC4\" for ROTATION"}},
    };
    CHECK_CASES(cases);
    // Different counts, and a zero quaternion.
    static const char two[] =
        "{'asset':{'version':'2.0'},'nodes':[{'mesh':0,'extensions':{'EXT_mesh_gpu_instancing':"
        "{'attributes':{%s}}}}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}],"
        "'accessors':[{'componentType':5126,'count':3,'type':'VEC3'},"
        "{'componentType':5126,'count':2,'type':'VEC3'},"
        "{'componentType':5126,'count':2,'type':'VEC4'}]}";
    static const struct {
        const char *attributes, *message;
    } pairs[] = {
        {"'TRANSLATION':0,'SCALE':1", "SCALE has 2 elements, another attribute has 3"},
        {"'ROTATION':2", "accessors[2]: element 0: the zero quaternion"},
    };
    for (size_t i = 0; i < 2; i++) {
        char json[512];
        snprintf(json, sizeof json, two, pairs[i].attributes);
        struct scene scene;
        struct err err;
        bool ok = load_glb(&scene, json, NULL, 0, &err);
        check_rejected(ok, &err, "test.glb: ", (const char *const[3]){pairs[i].message},
                       pairs[i].attributes);
        scene_finish(&scene);
    }
}

// --- what is wrong with the binary part ----------------------------------------------------------

static void check_binary(const struct sample_binary *binary, const char *message)
{
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, sample_json, binary, sizeof *binary, &err);
    check_rejected(ok, &err, "test.glb: ", (const char *const[3]){message}, message);
    scene_finish(&scene);
}

TEST(values)
{
    struct sample_binary binary = sample_binary;
    binary.positions[1][2] = NAN;
    check_binary(&binary, "accessors[0]: element 1, component 2 is nan; expected a finite number");
    binary = sample_binary;
    binary.sparse_positions[1][0] = -INFINITY;
    check_binary(&binary, "accessors[0]: element 3, component 0 is -inf; expected a finite number");
    binary = sample_binary;
    binary.normals[3][1] = INFINITY;
    check_binary(&binary, "accessors[1]: element 3, component 1 is inf; expected a finite number");
    binary = sample_binary;
    binary.indices[5] = 4;
    check_binary(&binary, "accessors[2]: element 5 is 4; expected an index below the number of "
                          "vertices, 4");
    binary = sample_binary;
    binary.indices[0] = UINT16_MAX;
    check_binary(&binary, "accessors[2]: element 0 is 65535, the primitive restart value");
    binary = sample_binary;
    binary.sparse_indices[0] = 3;
    check_binary(&binary, "accessors[0].sparse.indices: element 1 is 3; expected strictly");
    binary = sample_binary;
    binary.sparse_indices[1] = 4;
    check_binary(&binary, "accessors[0].sparse.indices: element 1 is 4; expected strictly");
    binary = sample_binary;
    binary.positions[0][0] = FLT_MAX; // large but finite; the bounds of the world are checked later
    struct scene scene;
    struct err err;
    CHECK(load_glb(&scene, sample_json, &binary, sizeof binary, &err), "%s", err.msg);
    scene_finish(&scene);
}

// --- containers ----------------------------------------------------------------------------------

static void check_patched_glb(size_t at, uint8_t value, const char *message)
{
    struct bytes glb = glb_bytes(sample_json, &sample_binary, sizeof sample_binary);
    glb.data[at] = value;
    struct scene scene;
    struct err err;
    bool ok = load_bytes(&scene, "test.glb", glb, &err);
    check_rejected(ok, &err, "test.glb: ", (const char *const[3]){message}, message);
    scene_finish(&scene);
    free(glb.data);
}

TEST(glb)
{
    struct bytes glb = glb_bytes(sample_json, &sample_binary, sizeof sample_binary);
    size_t binary_header = 12 + 8 + (strlen(sample_json) + 3) / 4 * 4;
    uint8_t first_size = glb.data[12], length = glb.data[8];
    free(glb.data);
    check_patched_glb(0, 'G', "does not begin with \"glTF\"");
    check_patched_glb(4, 1, "GLB: version 1; expected 2");
    check_patched_glb(8, (uint8_t)(length + 4), "GLB: the header states");
    check_patched_glb(12, (uint8_t)(first_size + 1), "expected a multiple of 4");
    check_patched_glb(15, 0x7f, "but ");
    check_patched_glb(16, 'X', "GLB: the first chunk is of type 0x");
    check_patched_glb(binary_header, 140, "but 136 remain");
    check_patched_glb(binary_header, 128, "GLB: ");
    // A second JSON chunk, and a chunk of unknown type, so that buffer 0 has no bytes.
    glb = glb_bytes(sample_json, &sample_binary, sizeof sample_binary);
    memcpy(glb.data + binary_header + 4, "JSON", 4);
    struct scene scene;
    struct err err;
    bool ok = load_bytes(&scene, "test.glb", glb, &err);
    check_rejected(ok, &err, "test.glb: ", (const char *const[3]){"chunk 2", "JSON"}, "JSON");
    scene_finish(&scene);
    memcpy(glb.data + binary_header + 4, "junk", 4);
    ok = load_bytes(&scene, "test.glb", glb, &err);
    check_rejected(ok, &err,
                   "test.glb: ", (const char *const[3]){"bufferViews[0]: ", "no binary chunk"},
                   "junk");
    scene_finish(&scene);
    free(glb.data);
}

static void check_text(const char *json, const char *message)
{
    struct bytes text = json_bytes(json);
    struct scene scene;
    struct err err;
    bool ok = load_bytes(&scene, "test.gltf", text, &err);
    check_rejected(ok, &err, "test.gltf: ", (const char *const[3]){message}, json);
    scene_finish(&scene);
    free(text.data);
}

TEST(json)
{
    check_text("", "line 1");
    check_text("[]", "expected an object, not an array of 0");
    check_text("{'asset':{'version':'2.0'}} x", "line 1");
    check_text("{'asset':{'version':'2.0'},'x':'\xff'}", "line 1");
    check_text("{'asset':{'version':'2.0'},'x':'\\u0000'}", "line 1");
    check_text("{'asset':{'version':'2.0'},'x':NaN}", "line 1");
    check_text("{'asset':{'version':'2.0'},'x':1e999}", "line 1");
    // jansson's own limit prevents its recursion from overflowing the stack.
    char *deep = malloc(100001);
    memset(deep, '[', 100000);
    deep[100000] = '\0';
    check_text(deep, "line 1");
    free(deep);
}

// The tree of a file of brackets would be a hundred times as large as the file.
TEST(memory_of_the_tree)
{
    const size_t size = (size_t)2 << 20;
    struct bytes text = {malloc(size + 1), size};
    memset(text.data, ' ', size);
    static const char head[] = "{\"asset\":{\"version\":\"2.0\"},\"x\":[[]";
    memcpy(text.data, head, sizeof head - 1);
    for (size_t i = sizeof head - 1; i + 8 < size; i += 3)
        memcpy(text.data + i, ",[]", 3);
    memcpy(text.data + size - 8, "]}", 2);
    text.data[size] = '\0';
    struct scene scene;
    struct err err;
    CHECK(!load_bytes(&scene, "test.gltf", text, &err) && err.code == ERR_BUDGET &&
              strstr(err.msg, "test.gltf: out of memory"),
          "%s", err.msg);
    scene_finish(&scene);
    free(text.data);
}

TEST_MAIN(TEST_CASE(frame), TEST_CASE(buffers), TEST_CASE(second_buffer_without_uri),
          TEST_CASE(buffer_views), TEST_CASE(accessors), TEST_CASE(quantization),
          TEST_CASE(alignment_in_the_view), TEST_CASE(sparse), TEST_CASE(primitives),
          TEST_CASE(fan_of_two_vertices), TEST_CASE(nodes), TEST_CASE(infinite_transform),
          TEST_CASE(cameras_and_materials), TEST_CASE(instancing), TEST_CASE(values),
          TEST_CASE(glb), TEST_CASE(json), TEST_CASE(memory_of_the_tree))
