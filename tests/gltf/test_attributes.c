// Tests vertex attributes other than positions, with every component type that they may have.
#include "gltf_fixture.h"
#include "test.h"

static bool near(float a, double b)
{
    return fabs((double)a - b) < 1e-6;
}

// A triangle whose attribute `key` has three elements of `type` and component type `code`, `size`
// bytes apart.
struct attribute_file {
    const char *key, *type, *code, *extensions;
    bool normalized;
    const void *elements;
    uint32_t size;
};

static bool load_attribute(struct scene *scene, const struct attribute_file *file, struct err *err)
{
    struct {
        float positions[3][3], normals[3][3];
        uint8_t elements[3 * 16];
    } binary = {
        .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        .normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
    };
    char json[1024];
    memcpy(binary.elements, file->elements, 3 * (size_t)file->size);
    snprintf(json, sizeof json,
             "{'asset':{'version':'2.0'},'nodes':[{'mesh':0}],'extensionsUsed':[%s],'meshes':[{"
             "'primitives':[{'attributes':{'POSITION':0,'NORMAL':1,'%s':2}}]}],'accessors':["
             "{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
             "{'bufferView':1,'componentType':5126,'count':3,'type':'VEC3'},"
             "{'bufferView':2,'componentType':%s,'normalized':%s,'count':3,'type':'%s'}],"
             "'bufferViews':[{'buffer':0,'byteLength':36},"
             "{'buffer':0,'byteOffset':36,'byteLength':36},"
             "{'buffer':0,'byteOffset':72,'byteLength':%u,'byteStride':%u}],"
             "'buffers':[{'byteLength':%zu}]}",
             file->extensions ? file->extensions : "", file->key, file->code,
             file->normalized ? "true" : "false", file->type, 3 * file->size, file->size,
             sizeof binary);
    return load_glb(scene, json, &binary, sizeof binary, err);
}

static const float *find_values(const struct mesh *mesh, const char *key)
{
    if (strcmp(key, "TANGENT") == 0)
        return mesh->tangents ? mesh->tangents[0] : NULL;
    if (strcmp(key, "COLOR_0") == 0)
        return mesh->colors ? mesh->colors[0] : NULL;
    float(*uvs)[2] = mesh->uvs[strcmp(key, "TEXCOORD_1") == 0];
    return uvs ? uvs[0] : NULL;
}

// Checks that the mesh has exactly the numbers `expected`, `width` for each vertex.
static void check_attribute(const struct attribute_file *file, uint32_t width,
                            const double *expected)
{
    struct scene scene;
    struct err err;
    bool ok = load_attribute(&scene, file, &err);
    CHECK(ok, "%s %s: %s", file->key, file->code, err.msg);
    const float *values = ok ? find_values(&scene.meshes[0], file->key) : NULL;
    CHECK(values, "%s %s is not there", file->key, file->code);
    for (uint32_t i = 0; values && i < 3 * width; i++)
        CHECK(near(values[i], expected[i]), "%s %s, number %u: %.9g; expected %.9g", file->key,
              file->code, i, (double)values[i], expected[i]);
    scene_finish(&scene);
}

#define QUANTIZED "'KHR_mesh_quantization'"

TEST(texture_coordinates)
{
    const float f32[3][2] = {{0, 1}, {-2.5f, 0.25f}, {1e6f, 3}};
    const uint8_t u8[3][4] = {{0, 255}, {51, 102}, {255, 1}};
    const uint16_t u16[3][2] = {{0, 65535}, {13107, 1}, {65535, 0}};
    const int8_t i8[3][4] = {{-128, 127}, {0, 1}, {-1, 2}};
    const int16_t i16[3][2] = {{-32768, 32767}, {0, 1}, {-1, 2}};
    for (int set = 0; set < 2; set++) {
        const char *key = set ? "TEXCOORD_1" : "TEXCOORD_0";
        check_attribute(&(struct attribute_file){key, "VEC2", "5126", NULL, false, f32, 8}, 2,
                        (const double[]){0, 1, -2.5, 0.25, 1e6, 3});
        check_attribute(&(struct attribute_file){key, "VEC2", "5121", NULL, true, u8, 4}, 2,
                        (const double[]){0, 1, 0.2, 0.4, 1, 1 / 255.0});
        check_attribute(&(struct attribute_file){key, "VEC2", "5123", NULL, true, u16, 4}, 2,
                        (const double[]){0, 1, 0.2, 1 / 65535.0, 1, 0});
        check_attribute(&(struct attribute_file){key, "VEC2", "5121", QUANTIZED, false, u8, 4}, 2,
                        (const double[]){0, 255, 51, 102, 255, 1});
        check_attribute(&(struct attribute_file){key, "VEC2", "5120", QUANTIZED, true, i8, 4}, 2,
                        (const double[]){-1, 1, 0, 1 / 127.0, -1 / 127.0, 2 / 127.0});
        check_attribute(&(struct attribute_file){key, "VEC2", "5122", QUANTIZED, true, i16, 4}, 2,
                        (const double[]){-1, 1, 0, 1 / 32767.0, -1 / 32767.0, 2 / 32767.0});
        check_attribute(&(struct attribute_file){key, "VEC2", "5122", QUANTIZED, false, i16, 4}, 2,
                        (const double[]){-32768, 32767, 0, 1, -1, 2});
    }
}

TEST(colors)
{
    const float f32[3][4] = {{0, 0.5f, 1, 0.25f}, {1, 1, 1, 1}, {0.125f, 0, 0, 0}};
    const float rgb[3][3] = {{0, 0.5f, 1}, {1, 1, 1}, {0.125f, 0, 0.75f}};
    const uint8_t u8[3][4] = {{0, 51, 255, 102}, {255, 255, 255, 255}, {1, 0, 0, 0}};
    const uint16_t u16[3][4] = {{0, 13107, 65535, 1}, {65535, 65535, 65535, 65535}, {1, 0, 0, 0}};
    check_attribute(&(struct attribute_file){"COLOR_0", "VEC4", "5126", NULL, false, f32, 16}, 4,
                    (const double[]){0, 0.5, 1, 0.25, 1, 1, 1, 1, 0.125, 0, 0, 0});
    check_attribute(&(struct attribute_file){"COLOR_0", "VEC3", "5126", NULL, false, rgb, 12}, 4,
                    (const double[]){0, 0.5, 1, 1, 1, 1, 1, 1, 0.125, 0, 0.75, 1});
    check_attribute(&(struct attribute_file){"COLOR_0", "VEC4", "5121", NULL, true, u8, 4}, 4,
                    (const double[]){0, 0.2, 1, 0.4, 1, 1, 1, 1, 1 / 255.0, 0, 0, 0});
    check_attribute(&(struct attribute_file){"COLOR_0", "VEC3", "5121", NULL, true, u8, 4}, 4,
                    (const double[]){0, 0.2, 1, 1, 1, 1, 1, 1, 1 / 255.0, 0, 0, 1});
    check_attribute(&(struct attribute_file){"COLOR_0", "VEC4", "5123", NULL, true, u16, 8}, 4,
                    (const double[]){0, 0.2, 1, 1 / 65535.0, 1, 1, 1, 1, 1 / 65535.0, 0, 0, 0});
    check_attribute(&(struct attribute_file){"COLOR_0", "VEC3", "5123", NULL, true, u16, 8}, 4,
                    (const double[]){0, 0.2, 1, 1, 1, 1, 1, 1, 1 / 65535.0, 0, 0, 1});
}

TEST(tangents)
{
    const float f32[3][4] = {{2, 0, 0, 1}, {0, 3, 4, -1}, {0, 0, 1, 0}};
    const int8_t i8[3][4] = {{127, 0, 0, 127}, {0, 127, 127, -128}, {0, 0, -128, 127}};
    const int16_t i16[3][4] = {{32767, 0, 0, 32767}, {0, 9, 12, -32767}, {0, 0, -32768, 1}};
    const double root = sqrt(0.5);
    check_attribute(&(struct attribute_file){"TANGENT", "VEC4", "5126", NULL, false, f32, 16}, 4,
                    (const double[]){1, 0, 0, 1, 0, 0.6, 0.8, -1, 0, 0, 1, 1});
    check_attribute(&(struct attribute_file){"TANGENT", "VEC4", "5120", QUANTIZED, true, i8, 4}, 4,
                    (const double[]){1, 0, 0, 1, 0, root, root, -1, 0, 0, -1, 1});
    check_attribute(&(struct attribute_file){"TANGENT", "VEC4", "5122", QUANTIZED, true, i16, 8}, 4,
                    (const double[]){1, 0, 0, 1, 0, 0.6, 0.8, -1, 0, 0, -1, 1});
}

TEST(numbers_that_are_mended)
{
    const float uvs[3][2] = {{NAN, 1}, {INFINITY, -INFINITY}, {2, 3}};
    const float colors[3][4] = {{2, 0, 0, 1}, {0, -1, 0, 1}, {1, 1, 1, 1}};
    struct scene scene;
    struct err err;
    CHECK(load_attribute(
              &scene, &(struct attribute_file){"TEXCOORD_0", "VEC2", "5126", NULL, false, uvs, 8},
              &err),
          "%s", err.msg);
    CHECK(has_note(&scene, "3 texture coordinates that are not finite become 0"));
    if (scene.mesh_count == 1) {
        const float *uv = scene.meshes[0].uvs[0][0];
        CHECK(uv[0] == 0 && uv[1] == 1 && uv[2] == 0 && uv[3] == 0 && uv[4] == 2 && uv[5] == 3);
    }
    scene_finish(&scene);
    CHECK(load_attribute(
              &scene, &(struct attribute_file){"COLOR_0", "VEC4", "5126", NULL, false, colors, 16},
              &err),
          "%s", err.msg);
    CHECK(has_note(&scene, "2 vertex colours outside [0, 1] are clamped"));
    if (scene.mesh_count == 1)
        CHECK(scene.meshes[0].colors[0][0] == 1 && scene.meshes[0].colors[1][1] == 0);
    scene_finish(&scene);
}

// Section 3.7.2.1: a mesh without normals is flat, and its tangents are ignored.
TEST(tangents_without_normals)
{
    const float binary[7][4] = {{0, 0, 0, 1}, {0, 0, 0, 1}, {0},
                                {1, 0, 0, 1}, {1, 0, 0, 1}, {1, 0, 0, 1}};
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene,
                       "{'asset':{'version':'2.0'},'nodes':[{'mesh':0}],'meshes':[{'primitives':["
                       "{'attributes':{'POSITION':0,'TANGENT':1}}]}],'accessors':["
                       "{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
                       "{'bufferView':1,'componentType':5126,'count':3,'type':'VEC4'}],"
                       "'bufferViews':[{'buffer':0,'byteLength':48},"
                       "{'buffer':0,'byteOffset':48,'byteLength':48}],"
                       "'buffers':[{'byteLength':96}]}",
                       binary, sizeof binary, &err);
    CHECK(ok, "%s", err.msg);
    CHECK(ok && !scene.meshes[0].normals && !scene.meshes[0].tangents);
    scene_finish(&scene);
}

static void check_rejected(const struct attribute_file *file, const char *message)
{
    struct scene scene;
    struct err err;
    bool ok = load_attribute(&scene, file, &err);
    CHECK(!ok && err.code == ERR_INPUT && strstr(err.msg, message), "%s %s: %s", file->key,
          file->code, ok ? "loaded" : err.msg);
    scene_finish(&scene);
}

TEST(wrong_types)
{
    const float zeros[12] = {0}, infinite[12] = {[5] = INFINITY};
    check_rejected(&(struct attribute_file){"TEXCOORD_0", "VEC3", "5126", NULL, false, zeros, 12},
                   "accessors[2].type: \"VEC3\"; expected \"VEC2\" for TEXCOORD");
    check_rejected(&(struct attribute_file){"TEXCOORD_0", "VEC2", "5121", NULL, false, zeros, 4},
                   "accessors[2]: UNSIGNED_BYTE for TEXCOORD needs KHR_mesh_quantization");
    check_rejected(&(struct attribute_file){"TEXCOORD_0", "VEC2", "5125", NULL, false, zeros, 8},
                   "accessors[2].componentType: 5125 (UNSIGNED_INT) is not allowed");
    check_rejected(&(struct attribute_file){"COLOR_0", "VEC2", "5126", NULL, false, zeros, 8},
                   "accessors[2].type: \"VEC2\"; expected \"VEC4\" for COLOR");
    check_rejected(&(struct attribute_file){"COLOR_0", "VEC4", "5121", NULL, false, zeros, 4},
                   "accessors[2].componentType: 5121 (UNSIGNED_BYTE) is not allowed");
    check_rejected(&(struct attribute_file){"COLOR_0", "VEC4", "5126", NULL, false, infinite, 16},
                   "accessors[2]: element 1, component 1 is inf; expected a finite number");
    check_rejected(&(struct attribute_file){"TANGENT", "VEC3", "5126", NULL, false, zeros, 12},
                   "accessors[2].type: \"VEC3\"; expected \"VEC4\" for TANGENT");
    check_rejected(&(struct attribute_file){"TANGENT", "VEC4", "5120", NULL, true, zeros, 4},
                   "needs KHR_mesh_quantization");
}

TEST_MAIN(TEST_CASE(texture_coordinates), TEST_CASE(colors), TEST_CASE(tangents),
          TEST_CASE(numbers_that_are_mended), TEST_CASE(tangents_without_normals),
          TEST_CASE(wrong_types))
