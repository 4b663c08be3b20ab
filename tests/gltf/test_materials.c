// Tests materials and textures loaded from glTF files; every expected number is written here.
#include "base/memory.h"
#include "gltf_fixture.h"
#include "gltf_picture.h"
#include "material_file.h"
#include "scene/gltf/gltf_load.h"
#include "test.h"

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
    // Opaque materials ignore alpha.
    CHECK(m[1].opacity == 1 && m[1].metallic == 0.5f && m[1].roughness == 0.25f);
    CHECK(m[1].texture_count == 2);
    check_scale(&scene, 1, GROUP_BASE, "rgb-");
    check_scale(&scene, 1, GROUP_METAL, "-gb-");
    // A factor of 0 is not replaced by a texture.
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
            "{'alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorFactor':[1,1,1,0.25]}},"
            "{'alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorTexture':{'index':1}}},"
            "{'alphaMode':'MASK','alphaCutoff':1}," // alpha of 1 is visible
            "{'alphaMode':'MASK','alphaCutoff':1.5}",
        .count = 6,
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
    // If alpha is 1 everywhere, the material is opaque.
    CHECK(!(m[3].flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND)));
    CHECK(!(m[4].flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND)));
    CHECK(m[5].flags & MATERIAL_ALPHA_MASK);
    scene_finish(&scene);
}

// Vertex colours can make a material less opaque. A mesh may lack attributes that a texture needs.
TEST(attributes_of_meshes)
{
    static const struct {
        float positions[3][3];
        uint8_t colors[2][3][4];
    } binary = {.colors = {{{255, 255, 255, 255}, {255, 255, 255, 254}, {255, 255, 255, 255}},
                           {{0, 0, 0, 255}, {0, 0, 0, 255}, {0, 0, 0, 255}}}};
    static const char json[] =
        "{'asset':{'version':'2.0'},'nodes':[{'mesh':0}],'meshes':[{'primitives':["
        "{'attributes':{'POSITION':0,'COLOR_0':1},'material':0},"
        "{'attributes':{'POSITION':0,'COLOR_0':2},'material':1}]}],'accessors':["
        "{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
        "{'bufferView':1,'componentType':5121,'normalized':true,'count':3,'type':'VEC4'},"
        "{'bufferView':2,'componentType':5121,'normalized':true,'count':3,'type':'VEC4'}],"
        "'bufferViews':[{'buffer':0,'byteLength':36},{'buffer':0,'byteOffset':36,'byteLength':12},"
        "{'buffer':0,'byteOffset':48,'byteLength':12}],'buffers':[{'byteLength':60}],"
        "'images':[{'uri':'%s'}],'textures':[{'source':0}],"
        "'materials':[{'alphaMode':'BLEND'},{'alphaMode':'BLEND','normalTexture':{'index':0}}]}";
    char text[4096], *uri = png_uri(material_pictures[0], "image/png");
    snprintf(text, sizeof text, json, uri);
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, text, &binary, sizeof binary, &err);
    CHECK(ok && scene.material_count == 2, "%s", err.msg);
    if (ok) {
        CHECK(scene.materials[0].flags & MATERIAL_ALPHA_BLEND);
        CHECK(!(scene.materials[1].flags & MATERIAL_ALPHA_BLEND));
        CHECK(has_note(&scene, "1 meshes lack the texture coordinates of their textures"));
    }
    scene_finish(&scene);
    free(uri);
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
    // An image that is used as numbers and as colours becomes two images.
    const struct texture *normal = &scene.textures[m->first_texture];
    CHECK(scene.image_count == 2 && fabsf(scene.images[normal->image].mean[0] - 0.50196f) < 1e-3f);
    // The factor is black, so the texture is not even decoded.
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
        // The first example of the extension without its scale: u = v / 4, v = 1 - u / 2.
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

// Images are in a buffer view and in a file beside the document, which is missing here. Images of
// unused materials are not read.
TEST(image_sources)
{
    struct bytes png = png_bytes(3, 2, material_pictures[0]);
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
        CHECK(has_note(&scene, "1 textures are ignored: they name no image"));
        CHECK(has_note(&scene, "1 meshes lack the texture coordinates"));
        CHECK(has_note(&scene, "1 images are not of the type") == mislabelled);
        scene_finish(&scene);
    }
    free(binary);
    free(png.data);
}

// --- bad input -----------------------------------------------------------------------------------

static const struct {
    const char *material, *lists, *message;
} bad_rows[] = {
    {"{'pbrMetallicRoughness':{'baseColorTexture':{'index':2}}}", TWO_TEXTURES,
     "materials[0].pbrMetallicRoughness.baseColorTexture.index: 2; expected an index below 2"},
    {"{'pbrMetallicRoughness':{'baseColorTexture':{}}}", TWO_TEXTURES,
     "baseColorTexture: \"index\" is missing"},
    {"{'pbrMetallicRoughness':{'baseColorTexture':0}}", TWO_TEXTURES,
     "baseColorTexture: expected an object, not 0"},
    {"{'pbrMetallicRoughness':{'roughnessFactor':1.5}}", NULL,
     "materials[0].pbrMetallicRoughness.roughnessFactor: 1.5 is outside [0, 1]"},
    {"{'pbrMetallicRoughness':{'baseColorFactor':[1,1,1]}}", NULL, "baseColorFactor: "},
    {"{'alphaCutoff':-1}", NULL, "materials[0].alphaCutoff: -1 is outside"},
    {"{'normalTexture':{'index':0,'texCoord':7}}", TWO_TEXTURES,
     "materials[0].normalTexture: \"texCoord\" is 7, but only sets 0 and 1 are read"},
    {"{'normalTexture':{'index':0,'texCoord':-1}}", TWO_TEXTURES, "normalTexture.texCoord: "},
    {"{'normalTexture':{'index':0,'scale':'big'}}", TWO_TEXTURES, "normalTexture.scale: "},
    {"{'normalTexture':{'index':0,'extensions':{'KHR_texture_transform':{'texCoord':2}}}}",
     TWO_TEXTURES, "\"texCoord\" is 2"},
    {"{'normalTexture':{'index':0,'extensions':{'KHR_texture_transform':{'offset':[1]}}}}",
     TWO_TEXTURES, "KHR_texture_transform.offset: "},
    {"{'normalTexture':{'index':0,'extensions':{'KHR_texture_transform':{'scale':[1,1e30]}}}}",
     TWO_TEXTURES, "is beyond 1e+13"},
    {"{'normalTexture':{'index':0}}",
     ",'textures':[{'source':0,'sampler':0}],'samplers':[{'wrapS':1}],'images':[{'uri':'%s'}]",
     "samplers[0].wrapS: 1 is not a value of a sampler's \"wrapS\"; the default is 10497"},
    {"{'normalTexture':{'index':0}}",
     ",'textures':[{'source':0,'sampler':0}],'samplers':[{'magFilter':9987}],"
     "'images':[{'uri':'%s'}]",
     "samplers[0].magFilter: 9987"},
    {"{'normalTexture':{'index':0}}",
     ",'textures':[{'source':0,'sampler':0}],'samplers':[{'minFilter':3}],'images':[{'uri':'%s'}]",
     "samplers[0].minFilter: 3"},
    {"{'normalTexture':{'index':0}}", ",'textures':[{'source':0,'sampler':0}],'images':[{}]",
     "textures[0].sampler: 0; expected an index below 0"},
    {"{'normalTexture':{'index':0}}", ",'textures':[{'source':1}],'images':[{}]",
     "textures[0].source: 1; expected an index below 1"},
    {"{'normalTexture':{'index':0}}", ",'textures':[{'source':0}],'images':[{}]",
     "images[0]: expected one of \"uri\" and \"bufferView\""},
    {"{'normalTexture':{'index':0}}", ",'textures':[{'source':0}],'images':[{'uri':7}]",
     "images[0].uri: expected a string, not 7"},
    {"{'normalTexture':{'index':0}}", ",'textures':[{'source':0}],'images':[{'bufferView':1}]",
     "images[0].bufferView: 1; expected an index below 1"},
    {"{'normalTexture':{'index':0}}", ",'textures':[{'source':0}],'images':[{'bufferView':0}]",
     "test.glb: images[0]: expected a PNG, JPEG or WebP file"},
    {"{'normalTexture':{'index':0}}", ",'textures':[{'source':0}],'images':[{'uri':'../a.png'}]",
     "images[0].uri: "},
    {"{'normalTexture':{'index':0}}", ",'textures':[{'source':0}],'images':[{'uri':'/etc/passwd'}]",
     "images[0].uri: "},
    {"{'normalTexture':{'index':0}}",
     ",'textures':[{'source':0}],'images':[{'uri':'data:image/png;base64,iVBORw0KGgoAAAAN'}]",
     "test.glb: images[0]: "},
    {"{" EXTENSION("clearcoat", "'clearcoatFactor':2") "}", NULL,
     "KHR_materials_clearcoat.clearcoatFactor: 2 is outside [0, 1]"},
    {"{" EXTENSION("sheen", "'sheenColorFactor':[1,2,1]") "}", NULL, "sheenColorFactor[1]: 2"},
    {"{" EXTENSION("ior", "'ior':0.5") "}", NULL, "ior: 0.5 is between 0 and 1"},
    {"{" EXTENSION("ior", "'ior':-1") "}", NULL, "ior: -1 is outside"},
    {"{" EXTENSION("specular", "'specularColorFactor':[-1,0,0]") "}", NULL,
     "specularColorFactor[0]: -1 is outside"},
    {"{" EXTENSION("anisotropy", "'anisotropyStrength':-0.5") "}", NULL,
     "anisotropyStrength: -0.5"},
    {"{" EXTENSION("transmission", "'transmissionFactor':true") "}", NULL, "transmissionFactor: "},
    {"{" EXTENSION("volume", "'attenuationDistance':0") "}", NULL, "attenuationDistance: 0"},
    {"{" EXTENSION("volume", "'thicknessFactor':-1") "}", NULL, "thicknessFactor: -1"},
    {"{" EXTENSION("dispersion", "'dispersion':-1") "}", NULL, "dispersion: -1"},
    {"{" EXTENSION("iridescence", "'iridescenceIor':0.5") "}", NULL, "iridescenceIor: 0.5"},
    {"{" EXTENSION("unlit", "") ",'alphaMode':7}", NULL, "materials[0].alphaMode: "},
    {"{'extensions':{'KHR_materials_unlit':true}}", NULL,
     "KHR_materials_unlit: expected an object, not true"},
    {"{" EXTENSION("pbrSpecularGlossiness", "'glossinessFactor':3") "}", NULL,
     "glossinessFactor: 3 is outside [0, 1]"},
};

TEST(bad_input)
{
    for (size_t i = 0; i < sizeof bad_rows / sizeof *bad_rows; i++) {
        struct scene scene;
        struct err err;
        const struct material_file file = {bad_rows[i].material, 1, bad_rows[i].lists};
        char *json = material_json(&file);
        bool ok = load_material_json(&scene, json, &err);
        CHECK(!ok && err.code == ERR_INPUT, "%s", bad_rows[i].message);
        CHECK(ok ||
                  (strncmp(err.msg, "test.glb: ", 10) == 0 && strstr(err.msg, bad_rows[i].message)),
              "%s\n  expected: %s", err.msg, bad_rows[i].message);
        scene_finish(&scene);
        free(json);
    }
}

// A truncated or damaged image is either an error or an image.
TEST(damaged_picture)
{
    struct bytes png = png_bytes(4, 4, material_pictures[0]);
    for (size_t i = 0; i < png.size; i++) {
        uint8_t *copy = malloc(png.size);
        memcpy(copy, png.data, png.size);
        copy[i] ^= 0x55;
        char *uri = data_uri(copy, i % 2 ? png.size : i), lists[2048];
        snprintf(lists, sizeof lists, ",'textures':[{'source':0}],'images':[{'uri':'%s'}]", uri);
        char *json =
            material_json(&(struct material_file){"{'normalTexture':{'index':0}}", 1, lists});
        struct scene scene;
        struct err err;
        bool ok = load_material_json(&scene, json, &err);
        CHECK(ok || (err.code == ERR_INPUT && strstr(err.msg, "test.glb: images[0]")),
              "byte %zu: %s", i, err.msg);
        CHECK(!ok || i % 2, "cut after %zu bytes", i);
        scene_finish(&scene);
        free(json);
        free(uri);
        free(copy);
    }
    free(png.data);
}

// One of two images that are decoded at the same time needs nearly all memory. Half of the memory
// for each is not enough, and must not be the limit.
TEST(memory_of_images)
{
    static const double identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    struct bytes png = png_bytes(128, 120, material_pictures[0]);
    char *uri = data_uri(png.data, png.size), *lists = malloc(strlen(uri) + 256);
    sprintf(lists, ",'textures':[{'source':0},{'source':1}],'images':[{'uri':'%s'},{'uri':'%%s'}]",
            uri);
    char *text = malloc(strlen(lists) + 8192),
         *json = material_json(&(struct material_file){"{'normalTexture':{'index':0},"
                                                       "'emissiveFactor':[1,1,1],"
                                                       "'emissiveTexture':{'index':1}}",
                                                       1, NULL});
    strcpy(text, json);
    char *picture = png_uri(material_pictures[1], "image/png");
    sprintf(text + strlen(json) - 1, lists, picture);
    strcat(text, "}");
    const float positions[3][3] = {{0}};
    struct bytes glb = glb_bytes(text, positions, sizeof positions);
    size_t least = 0;
    for (size_t limit = 64 << 10; limit < 4 << 20; limit += 64 << 10) {
        const struct gltf_load_params params = {
            .source = {.path = "test.glb", .bytes = {glb.data, glb.size}},
            .place = identity,
        };
        struct scene scene = empty_scene("test.glb");
        struct err err = {0};
        memory_set_budget(memory_used() + limit);
        bool ok = gltf_load_bytes(&scene, &params, &err);
        CHECK(ok || (strncmp(err.msg, "test.glb: ", 10) == 0 && strstr(err.msg, " memory")),
              "%zu bytes: code %d, %s", limit, (int)err.code, err.msg);
        CHECK(ok || least == 0, "%zu bytes are less than %zu", least, limit);
        CHECK(!ok || scene.image_count == 2);
        if (ok && least == 0)
            least = limit;
        scene_finish(&scene);
    }
    CHECK(least > 0 && least < 2 << 20, "%zu", least);
    free(glb.data);
    free(picture);
    free(json);
    free(text);
    free(lists);
    free(uri);
    free(png.data);
}

TEST_MAIN(TEST_CASE(metallic_roughness), TEST_CASE(alpha), TEST_CASE(attributes_of_meshes),
          TEST_CASE(normals_and_emission), TEST_CASE(unlit), TEST_CASE(samplers_and_transforms),
          TEST_CASE(image_sources), TEST_CASE(bad_input), TEST_CASE(damaged_picture),
          TEST_CASE(memory_of_images))
