// What materials and textures of glTF files become: every expected number is written out.
#include "gltf_fixture.h"
#include "gltf_picture.h"
#include "test.h"

static const uint8_t picture[2][4] = {{128, 64, 255, 51}, {0, 102, 255, 255}};

// A file of one triangle a material. `lists` are the document's further members, each with a comma
// before it; %s in them is the URI of the first picture.
struct material_file {
    const char *materials;
    uint32_t count;
    const char *lists;
};

#define TWO_TEXTURES                                                                               \
    ",'textures':[{'source':0},{'source':1}],"                                                     \
    "'images':[{'uri':'%s'},{'uri':'%s'}]"

static char *material_json(const struct material_file *file)
{
    char *uris[2] = {png_uri(picture[0], "image/png"), png_uri(picture[1], "image/png")};
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

static bool load_materials(struct scene *scene, const struct material_file *file)
{
    static const float positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    struct err err;
    char *json = material_json(file);
    bool ok = load_glb(scene, json, positions, sizeof positions, &err);
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

static bool near(float a, double b)
{
    return fabs((double)a - b) < 1e-6;
}

static bool near3(const float *a, double x, double y, double z)
{
    return near(a[0], x) && near(a[1], y) && near(a[2], z);
}

// The texture of a material that scales a group; NULL: none, or two.
static const struct texture *scale_of(const struct scene *scene, uint32_t material, uint32_t group)
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

// That a group is scaled like this: "rgb-" is the texel's colours and nothing for the fourth; upper
// case for the inverse.
static void check_scale(const struct scene *scene, uint32_t material, uint32_t group,
                        const char *expected)
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

static const struct texture_image *image_of(const struct scene *scene, uint32_t material,
                                            uint32_t group)
{
    static const struct texture_image none;
    const struct texture *texture = scale_of(scene, material, group);
    return texture ? &scene->images[texture->image] : &none;
}

// --- the core ------------------------------------------------------------------------------------

TEST(metallic_roughness)
{
    struct scene scene;
    const struct material_file file = {
        .materials = "{},{'name':'all','doubleSided':false,'occlusionTexture':{'index':0},"
                     "'pbrMetallicRoughness':{'baseColorFactor':[0.1,0.2,0.3,0.4],"
                     "'baseColorTexture':{'index':0},'metallicFactor':0.5,'roughnessFactor':0.25,"
                     "'metallicRoughnessTexture':{'index':1}}},"
                     "{'pbrMetallicRoughness':{'metallicFactor':0,'metallicRoughnessTexture':"
                     "{'index':1}}}",
        .count = 3,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = scene.materials;
    CHECK(m[0].model == MATERIAL_PRINCIPLED && near3(m[0].base_color, 1, 1, 1));
    CHECK(m[0].metallic == 1 && m[0].roughness == 1 && m[0].opacity == 1 && m[0].ior == 1.5f);
    CHECK(m[0].texture_count == 0 && !(m[0].flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND)));
    CHECK(strcmp(m[1].name, "all") == 0 && near3(m[1].base_color, 0.1, 0.2, 0.3));
    // Opaque materials have no alpha.
    CHECK(m[1].opacity == 1 && m[1].metallic == 0.5f && m[1].roughness == 0.25f);
    CHECK(m[1].texture_count == 2);
    check_scale(&scene, 1, GROUP_BASE, "rgb-");
    check_scale(&scene, 1, GROUP_METAL, "-gb-");
    // What is 0 stays 0 without a texel.
    check_scale(&scene, 2, GROUP_METAL, "-g--");
    // The colours are sRGB: ((128 / 255 + 0.055) / 1.055)^2.4 = 0.2158605.
    CHECK(fabsf(image_of(&scene, 1, GROUP_BASE)->mean[0] - 0.2158605f) < 1e-4f);
    CHECK(fabsf(image_of(&scene, 1, GROUP_METAL)->mean[1] - 0.4f) < 1e-4f);
    CHECK(scene.note_count == 0, "%s", scene.note_count ? scene.notes[0] : "");
    scene_finish(&scene);
}

TEST(alpha)
{
    struct scene scene;
    const struct material_file file = {
        .materials =
            "{'alphaMode':'MASK','pbrMetallicRoughness':{'baseColorFactor':[1,1,1,0.5]}},"
            "{'alphaMode':'MASK','alphaCutoff':0.75,'pbrMetallicRoughness':{'baseColorTexture':"
            "{'index':0}}},"
            "{'alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorFactor':[1,1,1,0.25]}}",
        .count = 3,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = scene.materials;
    CHECK((m[0].flags & MATERIAL_ALPHA_MASK) && m[0].opacity == 0.5f && m[0].alpha_cutoff == 0.5f);
    CHECK((m[1].flags & MATERIAL_ALPHA_MASK) && m[1].alpha_cutoff == 0.75f);
    check_scale(&scene, 1, GROUP_BASE, "rgba");
    CHECK(image_of(&scene, 1, GROUP_BASE)->has_alpha);
    CHECK((m[2].flags & MATERIAL_ALPHA_BLEND) && m[2].opacity == 0.25f);
    scene_finish(&scene);
}

TEST(normals_and_emission)
{
    struct scene scene;
    const struct material_file file = {
        .materials = "{'normalTexture':{'index':0,'scale':-0.5},'emissiveFactor':[1,0.5,0],"
                     "'emissiveTexture':{'index':0},'extensions':"
                     "{'KHR_materials_emissive_strength':{'emissiveStrength':10}}},"
                     "{'emissiveTexture':{'index':1}}",
        .count = 2,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = &scene.materials[0];
    CHECK(m->normal_scale == -0.5f && near3(m->emission, 10, 5, 0));
    CHECK(m->texture_count == 2 &&
          (scene.textures[m->first_texture].flags >> TEXTURE_USE_SHIFT & 3) == TEXTURE_USE_NORMAL);
    check_scale(&scene, 0, GROUP_EMISSION, "rg--");
    // One image as numbers and as colours: two.
    const struct texture *normal = &scene.textures[m->first_texture];
    CHECK(scene.image_count == 2 && fabsf(scene.images[normal->image].mean[0] - 0.50196f) < 1e-3f);
    // Black, whatever the texture: it is not even decoded.
    CHECK(scene.materials[1].texture_count == 0);
    scene_finish(&scene);
}

TEST(unlit)
{
    struct scene scene;
    const struct material_file file = {
        .materials = "{'emissiveFactor':[1,0,0],'alphaMode':'BLEND','pbrMetallicRoughness':"
                     "{'baseColorFactor':[0.5,0.25,1,0.5],'baseColorTexture':{'index':0}},"
                     "'extensions':{'KHR_materials_unlit':{},'KHR_materials_clearcoat':"
                     "{'clearcoatFactor':1}}}",
        .count = 1,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = &scene.materials[0];
    CHECK(m->model == MATERIAL_LAMBERT && (m->flags & MATERIAL_UNLIT) && m->clearcoat == 0);
    CHECK(near3(m->base_color, 0, 0, 0) && near3(m->emission, 0.5, 0.25, 1) && m->opacity == 0.5f);
    check_scale(&scene, 0, GROUP_EMISSION, "rgb-");
    check_scale(&scene, 0, GROUP_BASE, "---a");
    CHECK(scene.image_count == 1);
    scene_finish(&scene);
}

// --- textures ------------------------------------------------------------------------------------

TEST(samplers_and_transforms)
{
    struct scene scene;
#define TEXTURED(info) "{'pbrMetallicRoughness':{'baseColorTexture':{" info "}}}"
    const struct material_file file = {
        .materials = TEXTURED("'index':0") "," TEXTURED("'index':1,'texCoord':1") "," TEXTURED(
            "'index':2,'texCoord':1,'extensions':{'KHR_texture_transform':{'offset':[0,1],"
            "'rotation':1.5707963267948966,'scale':[0.5,0.25],'texCoord':0}}"),
        .count = 3,
        .lists = ",'textures':[{'source':0},{'source':0,'sampler':0},{'source':0,'sampler':1}],"
                 "'samplers':[{'wrapS':33071,'wrapT':33648,'magFilter':9728,'minFilter':9987},"
                 "{'wrapS':10497,'magFilter':9729}],'images':[{'uri':'%s','name':'a'}]",
    };
    if (!load_materials(&scene, &file))
        return;
    static const float expected[3][2][3] = {
        {{1, 0, 0}, {0, 1, 0}},
        {{1, 0, 0}, {0, 1, 0}},
        // The extension's first example, but for the scale: u = v / 4, v = 1 - u / 2.
        {{0, 0.25f, 0}, {-0.5f, 0, 1}},
    };
    static const uint32_t flags[3] = {
        TEXTURE_WRAP_REPEAT << TEXTURE_WRAP_S_SHIFT | TEXTURE_WRAP_REPEAT << TEXTURE_WRAP_T_SHIFT,
        TEXTURE_WRAP_CLAMP << TEXTURE_WRAP_S_SHIFT | TEXTURE_WRAP_MIRROR << TEXTURE_WRAP_T_SHIFT |
            TEXTURE_NEAREST | TEXTURE_UV1,
        0,
    };
    CHECK(scene.image_count == 1 && scene.texture_count == 3);
    for (uint32_t i = 0; i < 3; i++) {
        const struct texture *texture = scale_of(&scene, i, GROUP_BASE);
        REQUIRE(texture, "%u", i);
        CHECK((texture->flags & 0xffu) == flags[i], "%u: %x", i, texture->flags & 0xffu);
        for (int row = 0; row < 2; row++)
            CHECK(near3(texture->transform[row], (double)expected[i][row][0],
                        (double)expected[i][row][1], (double)expected[i][row][2]),
                  "%u: row %d", i, row);
    }
    scene_finish(&scene);
}

// Images from a buffer view and from a file beside the document, which is not there here; unused
// materials leave theirs alone.
TEST(image_sources)
{
    struct bytes png = png_bytes(3, 2, picture[0]);
    const char json[] = "{'asset':{'version':'2.0'},'nodes':[{'mesh':0}],'meshes':[{'primitives':"
                        "[{'attributes':{'POSITION':0},'material':1}]}],"
                        "'accessors':[{'componentType':5126,'count':3,'type':'VEC3'}],"
                        "'bufferViews':[{'buffer':0,'byteOffset':4,'byteLength':%zu}],"
                        "'buffers':[{'byteLength':%zu}],"
                        "'images':[{'uri':'missing.png'},{'bufferView':0,'mimeType':'image/%s'}],"
                        "'textures':[{'source':0},{'source':1},{}],'materials':["
                        "{'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}},"
                        "{'pbrMetallicRoughness':{'baseColorTexture':{'index':1},"
                        "'metallicRoughnessTexture':{'index':2}}}]}";
    uint8_t *binary = calloc(4 + png.size, 1);
    memcpy(binary + 4, png.data, png.size);
    for (int mislabelled = 0; mislabelled < 2; mislabelled++) {
        char text[2048];
        snprintf(text, sizeof text, json, png.size, 4 + png.size, mislabelled ? "jpeg" : "png");
        struct scene scene;
        struct err err;
        bool ok = load_glb(&scene, text, binary, 4 + png.size, &err);
        CHECK(ok, "%s", err.msg);
        CHECK(scene.image_count == 1 && scene.texture_count == 1);
        if (scene.image_count == 1)
            CHECK(scene.images[0].width == 3 && scene.images[0].height == 2 &&
                  strcmp(scene.images[0].name, "test.glb: images[1]") == 0);
        CHECK(scene.material_count == 2 && scene.materials[0].texture_count == 0);
        CHECK(has_note(&scene, "1 textures are left out: they name no image"));
        CHECK(has_note(&scene, "1 images are not of the type") == mislabelled);
        scene_finish(&scene);
    }
    free(binary);
    free(png.data);
}

TEST_MAIN(TEST_CASE(metallic_roughness), TEST_CASE(alpha), TEST_CASE(normals_and_emission),
          TEST_CASE(unlit), TEST_CASE(samplers_and_transforms), TEST_CASE(image_sources))
