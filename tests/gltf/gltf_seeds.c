#include "gltf_seeds.h"

#include "gltf_builder.h"
#include "material_file.h"
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void add_triangle(struct gltf_builder *b)
{
    BUILDER_FLOATS(b, "VEC3", 3, 0, 0, 0, 1, 0, 0, 0, 1, 0);
    BUILDER_FLOATS(b, "VEC3", 3, 0, 0, 1, 0, 0, 1, 0, 0, 1);
    BUILDER_FLOATS(b, "VEC2", 3, 0, 1, 1, 1, 0, 0);
}

// Makes a file with two joints, two sets of weights, and an animation of all four properties by all
// three interpolations.
static struct bytes make_skin(void)
{
    struct gltf_builder b = {0};
    const uint8_t joints[3][4] = {{0, 1}, {1}, {0}};
    const uint16_t weights[3][4] = {{65535, 1}, {9}, {65535}};
    add_triangle(&b);
    builder_accessor(&b, UNSIGNED_BYTE_CODE, "VEC4", 3, joints, sizeof joints);
    builder_accessor(&b, UNSIGNED_SHORT_CODE, "VEC4,'normalized':true", 3, weights, sizeof weights);
    BUILDER_FLOATS(&b, "MAT4", 2, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, //
                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1);
    BUILDER_FLOATS(&b, "SCALAR", 2, 0, 1);
    BUILDER_FLOATS(&b, "VEC3", 2, 0, 0, 0, 2, 0, 0);
    BUILDER_FLOATS(&b, "VEC4", 2, 0, 0, 0, 1, 0, 0, 0.7f, 0.7f);
    BUILDER_FLOATS(&b, "VEC3", 6, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 2, 2, 2, 0, 0, 0);
    BUILDER_FLOATS(&b, "SCALAR", 2, 0, 1);
    return builder_glb(
        &b, "'nodes':[{'mesh':0,'skin':0},{'children':[2]},{'translation':[1,0,0]}],"
            "'skins':[{'joints':[1,2],'inverseBindMatrices':5,'skeleton':1}],"
            "'meshes':[{'weights':[0.5],'primitives':[{'attributes':{'POSITION':0,'NORMAL':1,"
            "'TEXCOORD_0':2,'JOINTS_0':3,'WEIGHTS_0':4,'JOINTS_1':3,'WEIGHTS_1':4},"
            "'targets':[{'POSITION':1}]}]}],"
            "'animations':[{'samplers':[{'input':6,'output':7,'interpolation':'STEP'},"
            "{'input':6,'output':8},{'input':6,'output':9,'interpolation':'CUBICSPLINE'},"
            "{'input':6,'output':10}],'channels':["
            "{'sampler':0,'target':{'node':1,'path':'translation'}},"
            "{'sampler':1,'target':{'node':2,'path':'rotation'}},"
            "{'sampler':2,'target':{'node':2,'path':'scale'}},"
            "{'sampler':3,'target':{'node':0,'path':'weights'}}]}]");
}

// Makes a file with morph targets for every attribute; one is sparse without a base.
static struct bytes make_morph(void)
{
    struct gltf_builder b = {0};
    const uint8_t index[4] = {1};
    const float value[3] = {0, 0, 1};
    add_triangle(&b);
    BUILDER_FLOATS(&b, "VEC4", 3, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1);
    BUILDER_FLOATS(&b, "VEC4", 3, 1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1);
    uint32_t indices = builder_view(&b, index, sizeof index, "");
    uint32_t values = builder_view(&b, value, sizeof value, "");
    size_t length = strlen(b.accessors);
    snprintf(b.accessors + length, sizeof b.accessors - length,
             ",{'componentType':5126,'count':3,'type':'VEC3','sparse':{'count':1,"
             "'indices':{'bufferView':%u,'componentType':5121},'values':{'bufferView':%u}}}",
             indices, values);
    return builder_glb(
        &b, "'nodes':[{'mesh':0,'weights':[1,0.5]},{'mesh':0}],"
            "'meshes':[{'weights':[0,0.25],'primitives':[{'attributes':{'POSITION':0,'NORMAL':1,"
            "'TEXCOORD_0':2,'TANGENT':3,'COLOR_0':4},'targets':[{'POSITION':5,'NORMAL':0,"
            "'TANGENT':1,'TEXCOORD_0':2,'COLOR_0':4},{'POSITION':1}]}]}]");
}

// Makes a file with every mode and filter of compression.
static struct bytes make_meshopt(void)
{
    static const float positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    static const float vectors[4][4] = {{0, 0, 1, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 1}};
    static const uint32_t indices[6] = {0, 1, 2, 2, 1, 3};
    static const struct {
        const char *mode, *filter;
        size_t count, stride;
    } views[] = {{"ATTRIBUTES", "NONE", 4, 12},      {"ATTRIBUTES", "EXPONENTIAL", 4, 12},
                 {"ATTRIBUTES", "OCTAHEDRAL", 4, 4}, {"ATTRIBUTES", "QUATERNION", 4, 8},
                 {"TRIANGLES", "NONE", 6, 2},        {"INDICES", "NONE", 6, 4}};
    uint8_t filtered[64], stream[512], binary[2048];
    char json[4096], list[2048] = "";
    size_t size = 0;
    for (size_t i = 0; i < sizeof views / sizeof views[0]; i++) {
        size_t count = views[i].count, stride = views[i].stride, bytes = 0;
        if (i == 1)
            meshopt_encodeFilterExp(filtered, count, stride, 15, positions[0]);
        else if (i == 2)
            meshopt_encodeFilterOct(filtered, count, stride, 8, vectors[0]);
        else if (i == 3)
            meshopt_encodeFilterQuat(filtered, count, stride, 12, vectors[0]);
        if (i < 4)
            bytes = meshopt_encodeVertexBuffer(
                stream, sizeof stream, i == 0 ? (const void *)positions : filtered, count, stride);
        else
            bytes = i == 4 ? meshopt_encodeIndexBuffer(stream, sizeof stream, indices, count)
                           : meshopt_encodeIndexSequence(stream, sizeof stream, indices, count);
        snprintf(list + strlen(list), sizeof list - strlen(list),
                 "%s{'buffer':1,'byteLength':%zu%s,'extensions':{'EXT_meshopt_compression':{"
                 "'buffer':0,'byteOffset':%zu,'byteLength':%zu,'count':%zu,'byteStride':%zu,"
                 "'mode':'%s','filter':'%s'}}}",
                 i ? "," : "", count * stride, i == 2 ? ",'byteStride':4" : "", size, bytes, count,
                 stride, views[i].mode, views[i].filter);
        memcpy(binary + size, stream, bytes);
        size += bytes;
    }
    snprintf(json, sizeof json,
             "{'asset':{'version':'2.0'},'extensionsUsed':['EXT_meshopt_compression',"
             "'KHR_mesh_quantization'],'nodes':[{'mesh':0,'extensions':{'EXT_mesh_gpu_instancing':"
             "{'attributes':{'ROTATION':3}}}}],'meshes':[{'primitives':[{'attributes':{"
             "'POSITION':0},'indices':4},{'attributes':{'POSITION':1,'NORMAL':2},'indices':5}]}],"
             "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
             "{'bufferView':1,'componentType':5126,'count':4,'type':'VEC3'},"
             "{'bufferView':2,'componentType':5120,'normalized':true,'count':4,'type':'VEC3'},"
             "{'bufferView':3,'componentType':5122,'normalized':true,'count':4,'type':'VEC4'},"
             "{'bufferView':4,'componentType':5123,'count':6,'type':'SCALAR'},"
             "{'bufferView':5,'componentType':5125,'count':6,'type':'SCALAR'}],"
             "'bufferViews':[%s],'buffers':[{'byteLength':%zu},{'byteLength':999}]}",
             list, size);
    return glb_bytes(json, binary, size);
}

// Makes a file with a strip, a fan, colours and two sets of texture coordinates, quantized and
// interleaved.
static struct bytes make_vertices(void)
{
    struct gltf_builder b = {0};
    static const struct {
        int16_t position[4];
        uint8_t color[4];
        uint16_t uvs[2][2];
    } vertices[4] = {{{0}, {255, 0, 0, 255}, {{0, 65535}, {1, 1}}},
                     {{32767, 0, 0, 0}, {0, 255, 0, 255}, {{65535, 65535}, {2, 1}}},
                     {{0, 32767, 0, 0}, {0, 0, 255, 128}, {{0, 0}, {1, 2}}},
                     {{32767, 32767, 0, 0}, {9, 9, 9, 9}, {{65535, 0}, {2, 2}}}};
    builder_view(&b, vertices, sizeof vertices, "'byteStride':20");
    snprintf(b.accessors, sizeof b.accessors,
             "{'bufferView':0,'componentType':5122,'normalized':true,'count':4,'type':'VEC3'},"
             "{'bufferView':0,'byteOffset':8,'componentType':5121,'normalized':true,'count':4,"
             "'type':'VEC4'},"
             "{'bufferView':0,'byteOffset':12,'componentType':5123,'normalized':true,'count':4,"
             "'type':'VEC2'},"
             "{'bufferView':0,'byteOffset':16,'componentType':5123,'count':4,'type':'VEC2'}");
    b.accessor_count = 4;
    return builder_glb(&b, "'extensionsUsed':['KHR_mesh_quantization'],'nodes':[{'mesh':0}],"
                           "'meshes':[{'primitives':[{'mode':5,'attributes':{'POSITION':0,"
                           "'COLOR_0':1,'TEXCOORD_0':2,'TEXCOORD_1':3}},{'mode':6,'attributes':{"
                           "'POSITION':0}},{'mode':1,'attributes':{'POSITION':0}}]}],"
                           "'scenes':[{'nodes':[0]}]");
}

static struct bytes make_sample(void)
{
    return glb_bytes(sample_json, &sample_binary, sizeof sample_binary);
}

static uint32_t load_u32(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

// Returns the file as JSON with the binary chunk in a data URI. Damage to it reaches more code,
// because no lengths have to agree.
static struct bytes embed(struct bytes glb)
{
    static const char before[] = "\"buffers\":[{";
    size_t json_size = load_u32(glb.data + 12), binary_size = load_u32(glb.data + 20 + json_size);
    char *uri = data_uri(glb.data + 28 + json_size, binary_size);
    char *json = calloc(1, json_size + 1), *with = malloc(strlen(uri) + 64);
    while (glb.data[20 + json_size - 1] == ' ') // padding of the chunk
        json_size--;
    memcpy(json, glb.data + 20, json_size);
    snprintf(with, strlen(uri) + 64, "%s\"uri\":\"%s\",", before, uri);
    struct bytes out = {.data = (uint8_t *)replace_text(json, before, with)};
    out.size = strlen((const char *)out.data);
    free(with);
    free(json);
    free(uri);
    free(glb.data);
    return out;
}

bool gltf_seed_make(uint32_t index, struct gltf_seed *out)
{
    static const struct {
        const char *glb, *gltf;
        struct bytes (*make)(void);
    } seeds[] = {{"sample.glb", "sample.gltf", make_sample},
                 {"skin.glb", "skin.gltf", make_skin},
                 {"morph.glb", "morph.gltf", make_morph},
                 {"meshopt.glb", "meshopt.gltf", make_meshopt},
                 {"vertices.glb", "vertices.gltf", make_vertices},
                 {"materials.glb", "materials.gltf", material_seed}};
    if (index >= 2 * sizeof seeds / sizeof seeds[0])
        return false;
    bool is_glb = index % 2 == 0;
    out->name = is_glb ? seeds[index / 2].glb : seeds[index / 2].gltf;
    out->bytes = seeds[index / 2].make();
    if (!is_glb)
        out->bytes = embed(out->bytes);
    return true;
}
