#include "material_file.h"

#include "gltf_picture.h"
#include "test.h"

const uint8_t material_pictures[2][4] = {{128, 64, 255, 51}, {0, 102, 255, 255}};

char *material_json(const struct material_file *file)
{
    char *uris[2] = {png_uri(material_pictures[0], "image/png"),
                     png_uri(material_pictures[1], "image/png")};
    char *json = malloc(16384), primitives[2048] = "";
    for (uint32_t i = 0; i < file->count; i++)
        sprintf(primitives + strlen(primitives),
                "%s{'attributes':{'POSITION':0,'TEXCOORD_0':1,'TEXCOORD_1':1},'material':%u}",
                i > 0 ? "," : "", i);
    int length = sprintf(json,
                         "{'asset':{'version':'2.0'},'nodes':[{'mesh':0}],"
                         "'meshes':[{'primitives':[%s]}],"
                         "'accessors':[{'bufferView':0,'componentType':5126,'count':3,"
                         "'type':'VEC3'},{'componentType':5126,'count':3,'type':'VEC2'}],"
                         "'bufferViews':[{'buffer':0,'byteLength':36}],"
                         "'buffers':[{'byteLength':36}],'materials':[%s]",
                         primitives, file->materials);
    if (file->lists)
        length += sprintf(json + length, file->lists, uris[0], uris[1]);
    strcpy(json + length, "}");
    free(uris[0]);
    free(uris[1]);
    return json;
}

static const float triangle[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

bool load_material_json(struct scene *scene, const char *json, struct err *err)
{
    return load_glb(scene, json, triangle, sizeof triangle, err);
}

bool load_materials(struct scene *scene, const struct material_file *file)
{
    struct err err;
    char *json = material_json(file);
    bool ok = load_material_json(scene, json, &err);
    CHECK(ok, "%s", err.msg);
    if (ok)
        CHECK(!scene_objection(scene), "%s", scene_objection(scene));
    ok = ok && scene->material_count == file->count;
    CHECK(ok, "%u materials", scene->material_count);
    if (!ok)
        scene_finish(scene);
    free(json);
    return ok;
}

// The members of every extension. Each texture is one of two.
static const char seed_materials[] =
    "{'name':'layers','alphaMode':'MASK','alphaCutoff':0.25,'pbrMetallicRoughness':"
    "{'baseColorFactor':[1,0.5,0.25,0.75],'baseColorTexture':{'index':0,'texCoord':1},"
    "'metallicFactor':0.5,'roughnessFactor':0.5,'metallicRoughnessTexture':{'index':1}},"
    "'normalTexture':{'index':1,'scale':0.5},'emissiveFactor':[1,1,0.5],"
    "'emissiveTexture':{'index':0,'extensions':{'KHR_texture_transform':{'offset':[0.5,0.25],"
    "'rotation':1.5,'scale':[2,-1],'texCoord':0}}},'extensions':{"
    "'KHR_materials_emissive_strength':{'emissiveStrength':3},"
    "'KHR_materials_clearcoat':{'clearcoatFactor':0.5,'clearcoatTexture':{'index':0},"
    "'clearcoatRoughnessFactor':0.25,'clearcoatNormalTexture':{'index':1}},"
    "'KHR_materials_sheen':{'sheenColorFactor':[1,0.5,0],'sheenRoughnessFactor':0.5,"
    "'sheenRoughnessTexture':{'index':0}},"
    "'KHR_materials_ior':{'ior':1.25},'KHR_materials_specular':{'specularFactor':0.5,"
    "'specularColorFactor':[2,1,0],'specularColorTexture':{'index':1}},"
    "'KHR_materials_iridescence':{'iridescenceFactor':1,'iridescenceIor':1.5,"
    "'iridescenceThicknessMinimum':200,'iridescenceThicknessMaximum':600,"
    "'iridescenceThicknessTexture':{'index':0}},"
    "'KHR_materials_anisotropy':{'anisotropyStrength':0.5,'anisotropyRotation':2,"
    "'anisotropyTexture':{'index':1}}}},"
    "{'extensions':{'KHR_materials_transmission':{'transmissionFactor':1},"
    "'KHR_materials_volume':{'thicknessFactor':1,'attenuationDistance':0.5,"
    "'attenuationColor':[1,0.5,0]},'KHR_materials_dispersion':{'dispersion':0.5}}},"
    "{'extensions':{'KHR_materials_pbrSpecularGlossiness':{'diffuseFactor':[1,1,0,1],"
    "'specularFactor':[1,0.5,0],'glossinessFactor':0.5,'specularGlossinessTexture':{'index':0}},"
    "'KHR_materials_diffuse_transmission':{'diffuseTransmissionFactor':0.5}}},"
    "{'alphaMode':'BLEND','extensions':{'KHR_materials_unlit':{}}}";

struct bytes material_seed(void)
{
    static const char lists[] =
        ",'textures':[{'source':0,'sampler':0},{'source':1}],'samplers':[{'wrapS':33071,"
        "'wrapT':33648,'magFilter':9728,'minFilter':9987}],'images':[{'uri':'%s'},{'uri':'%s',"
        "'mimeType':'image/png'}],'extensions':{'KHR_lights_punctual':{'lights':["
        "{'type':'point','color':[1,0.5,0.25],'intensity':8,'range':20},{'type':'directional'},"
        "{'type':'spot','spot':{'innerConeAngle':0.25,'outerConeAngle':0.75}}]}},"
        "'scene':0,'scenes':[{'nodes':[0,1,2,3]}]";
    static const char nodes[] = "'nodes':[{'mesh':0},"
                                "{'extensions':{'KHR_lights_punctual':{'light':0}}},"
                                "{'extensions':{'KHR_lights_punctual':{'light':1}}},"
                                "{'extensions':{'KHR_lights_punctual':{'light':2}}}]";
    char *json = material_json(&(struct material_file){seed_materials, 4, lists});
    char *lit = replace_text(json, "'nodes':[{'mesh':0}]", nodes);
    struct bytes glb = glb_bytes(lit, triangle, sizeof triangle);
    free(lit);
    free(json);
    return glb;
}

bool near(float a, double b)
{
    return fabs((double)a - b) < 1e-6;
}

bool near3(const float *a, double x, double y, double z)
{
    return near(a[0], x) && near(a[1], y) && near(a[2], z);
}

const struct texture *scale_of(const struct scene *scene, uint32_t material, uint32_t group)
{
    const struct material *m = &scene->materials[material];
    const struct texture *found = NULL;
    uint32_t count = 0;
    for (uint32_t i = 0; i < m->texture_count; i++) {
        const struct texture *texture = &scene->textures[m->first_texture + i];
        if ((texture->flags >> TEXTURE_USE_SHIFT & 3) != TEXTURE_USE_SCALE ||
            (texture->flags >> TEXTURE_GROUP_SHIFT & 15) != group)
            continue;
        found = texture;
        count++;
    }
    return count == 1 ? found : NULL;
}

void check_scale(const struct scene *scene, uint32_t material, uint32_t group, const char *expected)
{
    const struct texture *texture = scale_of(scene, material, group);
    char found[5] = "none";
    for (uint32_t i = 0; texture && i < 4; i++) {
        bool is_inverse = texture->flags >> (TEXTURE_INVERT_SHIFT + i) & 1;
        uint32_t channel = texture->flags >> (TEXTURE_CHANNELS_SHIFT + 2 * i) & 3;
        found[i] = (is_inverse ? "RGBA" : "rgba")[channel];
        if (!(texture->flags >> (TEXTURE_MASK_SHIFT + i) & 1))
            found[i] = '-';
    }
    CHECK(strcmp(found, expected) == 0, "material %u, group %u: %s, expected %s", material, group,
          found, expected);
}

const struct texture_image *image_of(const struct scene *scene, uint32_t material, uint32_t group)
{
    static const struct texture_image none;
    const struct texture *texture = scale_of(scene, material, group);
    return texture ? &scene->images[texture->image] : &none;
}
