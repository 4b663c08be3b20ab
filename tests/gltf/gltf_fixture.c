#include "gltf_fixture.h"

#include "base/hash.h"
#include "base/memory.h"
#include "json/json_parse.h"
#include "scene/gltf/gltf_load.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char sample_json[] =
    "{'asset':{'version':'2.0','generator':'test'},"
    "'scene':0,'scenes':[{'name':'main','nodes':[0]}],"
    "'nodes':[{'name':'root','mesh':0,'children':[1,2]},"
    "{'mesh':0,'translation':[1,2,3],'rotation':[0,0,0,1],'scale':[1,1,1]},"
    "{'camera':0,'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,5,1]}],"
    "'cameras':[{'type':'perspective','name':'front','perspective':{'yfov':0.5,'znear':0.1}}],"
    "'materials':[{'name':'red','pbrMetallicRoughness':{'baseColorFactor':[1,0.5,0.25,1],"
    "'metallicFactor':0},'emissiveFactor':[0.5,0,0],'alphaMode':'OPAQUE',"
    "'extensions':{'KHR_materials_emissive_strength':{'emissiveStrength':4}}}],"
    "'meshes':[{'name':'square','primitives':[{'attributes':{'POSITION':0,'NORMAL':1},"
    "'indices':2,'material':0,'mode':4}]}],"
    "'accessors':[{'bufferView':0,'byteOffset':0,'componentType':5126,'count':4,'type':'VEC3',"
    "'sparse':{'count':2,'indices':{'bufferView':3,'componentType':5123},"
    "'values':{'bufferView':4}}},"
    "{'bufferView':1,'componentType':5126,'count':4,'type':'VEC3','normalized':false},"
    "{'bufferView':2,'componentType':5123,'count':6,'type':'SCALAR'}],"
    "'bufferViews':[{'buffer':0,'byteOffset':0,'byteLength':48,'byteStride':12},"
    "{'buffer':0,'byteOffset':48,'byteLength':48},{'buffer':0,'byteOffset':96,'byteLength':12},"
    "{'buffer':0,'byteOffset':108,'byteLength':4},{'buffer':0,'byteOffset':112,'byteLength':24}],"
    "'buffers':[{'byteLength':136}],'extensionsUsed':['KHR_materials_emissive_strength']}";

const struct sample_binary sample_binary = {
    .positions = {{0, 0, 0}, {1, 0, 0}, {9, 9, 9}, {9, 9, 9}},
    .normals = {{0, 0, 1}, {0, 0, 2}, {0, 0, 1}, {0, 0, 0}},
    .indices = {0, 1, 2, 0, 2, 3},
    .sparse_indices = {2, 3},
    .sparse_positions = {{1, 1, 0}, {0, 1, 0}},
};
_Static_assert(sizeof sample_binary == 136, "as byteLength says");

struct bytes json_bytes(const char *json)
{
    struct bytes bytes = {(uint8_t *)strdup(json), strlen(json)};
    for (size_t i = 0; i < bytes.size; i++)
        if (bytes.data[i] == '\'')
            bytes.data[i] = '"';
    return bytes;
}

static uint8_t *put_u32(uint8_t *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        *at++ = (uint8_t)(value >> (8 * i));
    return at;
}

static uint8_t *put_chunk(uint8_t *at, const char type[4], const void *data, size_t size, int fill)
{
    size_t padded = (size + 3) & ~(size_t)3;
    at = put_u32(at, (uint32_t)padded);
    memcpy(at, type, 4);
    memset(at + 4, fill, padded);
    memcpy(at + 4, data, size);
    return at + 4 + padded;
}

struct bytes glb_bytes(const char *json, const void *binary, size_t size)
{
    struct bytes text = json_bytes(json);
    struct bytes glb = {.data = malloc(12 + 8 + text.size + 3 + 8 + size + 3 + 1)};
    uint8_t *end = put_chunk(glb.data + 12, "JSON", text.data, text.size, ' ');
    if (size > 0)
        end = put_chunk(end, "BIN\0", binary, size, 0);
    glb.size = (size_t)(end - glb.data);
    memcpy(glb.data, "glTF", 4);
    put_u32(put_u32(glb.data + 4, 2), (uint32_t)glb.size);
    *end = 0;
    free(text.data);
    return glb;
}

char *replace_text(const char *text, const char *find, const char *replacement)
{
    const char *found = strstr(text, find);
    if (!found)
        return NULL;
    size_t before = (size_t)(found - text);
    char *result = malloc(strlen(text) + strlen(replacement) + 1);
    memcpy(result, text, before);
    strcpy(stpcpy(result + before, replacement), found + strlen(find));
    return result;
}

char *data_uri(const void *data, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    static const char prefix[] = "data:application/octet-stream;base64,";
    const uint8_t *bytes = data;
    char *uri = malloc(sizeof prefix + (size + 2) / 3 * 4);
    char *to = stpcpy(uri, prefix);
    for (size_t i = 0; i < size; i += 3) {
        size_t n = size - i < 3 ? size - i : 3;
        uint32_t group = 0;
        for (size_t j = 0; j < 3; j++)
            group = group << 8 | (j < n ? bytes[i + j] : 0);
        for (size_t j = 0; j < 4; j++)
            *to++ = j <= n ? digits[group >> (18 - 6 * j) & 63] : '=';
    }
    *to = '\0';
    return uri;
}

struct scene empty_scene(const char *path)
{
    json_use_budget();
    memory_set_budget(memory_used() + FIXTURE_MAX_BYTES);
    return (struct scene){
        .path = path,
        .settings = settings_default(),
        .hash = HASH_INIT,
    };
}

bool load_bytes(struct scene *scene, const char *path, struct bytes bytes, struct err *err)
{
    static const double identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    const struct gltf_load_params params = {
        .source = {.path = path, .bytes = {bytes.data, bytes.size}},
        .place = identity,
        .with_cameras = true,
    };
    *scene = empty_scene(path);
    *err = (struct err){0};
    memory_take(bytes.size); // the reader of files also takes this from the budget
    bool ok = gltf_load_bytes(scene, &params, err);
    memory_give(bytes.size);
    return ok;
}

bool load_glb(struct scene *scene, const char *json, const void *binary, size_t size,
              struct err *err)
{
    struct bytes glb = glb_bytes(json, binary, size);
    bool ok = load_bytes(scene, "test.glb", glb, err);
    free(glb.data);
    return ok;
}

static bool all_finite(const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

static const char *mesh_objection(const struct scene *scene, const struct mesh *mesh)
{
    if (!mesh->name || mesh->material >= scene->material_count || mesh->triangle_count == 0)
        return "a mesh without a name, a material or triangles";
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        for (int c = 0; c < 3; c++)
            if (mesh->indices[i][c] >= mesh->vertex_count)
                return "an index beyond the vertices";
    if (!all_finite(mesh->positions[0], (size_t)mesh->vertex_count * 3) ||
        (mesh->normals && !all_finite(mesh->normals[0], (size_t)mesh->vertex_count * 3)))
        return "a vertex that is not finite";
    for (int set = 0; set < 2; set++)
        if (mesh->uvs[set] && !all_finite(mesh->uvs[set][0], (size_t)mesh->vertex_count * 2))
            return "a texture coordinate that is not finite";
    for (uint32_t i = 0; mesh->tangents && i < mesh->vertex_count; i++)
        if (!all_finite(mesh->tangents[i], 3) || fabsf(mesh->tangents[i][3]) != 1)
            return "a tangent that is not finite or has no side";
    const float *colors = mesh->colors ? mesh->colors[0] : NULL;
    for (uint32_t i = 0; colors && i < 4 * mesh->vertex_count; i++)
        if (!(colors[i] >= 0 && colors[i] <= 1))
            return "a vertex colour outside [0, 1]";
    return NULL;
}

static const char *instance_objection(const struct scene *scene, const struct instance *instance)
{
    if (instance->mesh >= scene->mesh_count || instance->material != SCENE_NONE)
        return "an instance of no mesh";
    return NULL;
}

static const char *material_objection(const struct scene *scene, const struct material *material)
{
    if (!material->name || material->model >= MATERIAL_MODEL_COUNT)
        return "a material without a name or a model";
    for (uint32_t i = 0; i < material_parameter_count; i++) {
        const struct material_parameter *p = &material_parameters[i];
        for (uint32_t c = p->first; c < p->first + p->count; c++)
            if (!(material->parameters[c] >= p->min && material->parameters[c] <= p->max))
                return p->name;
    }
    for (int c = 0; c < 3; c++)
        if (!(material->extinction[c] >= 0))
            return "an extinction out of range";
    for (uint32_t i = 0; i < material->texture_count; i++) {
        uint32_t index = material->first_texture + i;
        if (index >= scene->texture_count || scene->textures[index].image >= scene->image_count ||
            !all_finite(scene->textures[index].transform[0], 6))
            return "a texture without an image or with an infinite transform";
    }
    return NULL;
}

static const char *light_objection(const struct light *light)
{
    if (!light->name || !all_finite(light->radiant, 3) || !(light->range > 0))
        return "a light without a name, or of infinite intensity";
    for (int i = 0; i < 3; i++)
        if (!isfinite(light->position[i]) || !isfinite(light->direction[i]))
            return "a light nowhere";
    return NULL;
}

const char *scene_objection(const struct scene *scene)
{
    const char *objection = NULL;
    for (uint32_t i = 0; i < scene->mesh_count && !objection; i++)
        objection = mesh_objection(scene, &scene->meshes[i]);
    for (uint32_t i = 0; i < scene->instance_count && !objection; i++)
        objection = instance_objection(scene, &scene->instances[i]);
    for (uint32_t i = 0; i < scene->material_count && !objection; i++)
        objection = material_objection(scene, &scene->materials[i]);
    for (uint32_t i = 0; i < scene->light_count && !objection; i++)
        objection = light_objection(&scene->lights[i]);
    for (uint32_t i = 0; i < scene->camera_count && !objection; i++)
        if (!scene->cameras[i].name || !(scene->cameras[i].fov_y > 0))
            objection = "a camera without a name or a field of view";
    return objection;
}

bool has_note(const struct scene *scene, const char *text)
{
    for (uint32_t i = 0; i < scene->note_count; i++)
        if (strstr(scene->notes[i], text))
            return true;
    return false;
}
