// Tests materials loaded from glTF's extensions; every expected number is written here.
#include "material_file.h"
#include "scene/core/texture_load.h"
#include "test.h"

TEST(clearcoat_and_sheen)
{
    struct scene scene;
    const struct material_file file = {
        .materials = "{" EXTENSION(
            "clearcoat",
            "'clearcoatFactor':0.5,'clearcoatTexture':{'index':0},"
            "'clearcoatRoughnessFactor':0.25,"
            "'clearcoatRoughnessTexture':{'index':0}") "},"
                                                       "{" EXTENSION(
                                                           "clearcoat",
                                                           "'clearcoatFactor':1,'"
                                                           "clearcoatNormalTexture':{'index':"
                                                           "0}") "},"
                                                                 "{" EXTENSION(
                                                                     "sheen",
                                                                     "'sheenColorFactor':[0.5,"
                                                                     "0.25,1],'"
                                                                     "sheenColorTexture':"
                                                                     "{'index':0},'"
                                                                     "sheenRoughnessFactor':0."
                                                                     "75,"
                                                                     "'sheenRoughnessTexture':{"
                                                                     "'index':0}") "}",
        .count = 3,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = scene.materials;
    CHECK((m[0].flags & MATERIAL_COAT_GGX) && m[0].clearcoat == 0.5f);
    CHECK(m[0].clearcoat_roughness == 0.25f && m[0].texture_count == 1);
    check_scale(&scene, 0, GROUP_CLEARCOAT, "rg--");
    CHECK(m[1].clearcoat == 1 && m[1].clearcoat_roughness == 0 && m[1].texture_count == 0);
    CHECK(has_note(&scene, "1 materials: the normals of the clear coat are approximated"));
    CHECK(near3(m[2].sheen_color, 0.5, 0.25, 1) && m[2].sheen_roughness == 0.75f);
    // One image has both parameters; its alpha is linear.
    CHECK(m[2].texture_count == 1);
    check_scale(&scene, 2, GROUP_SHEEN, "rgba");
    CHECK(fabsf(image_of(&scene, 2, GROUP_SHEEN)->mean[3] - 0.2f) < 1e-4f);
    scene_finish(&scene);
}

TEST(ior_and_specular)
{
    struct scene scene;
    const struct material_file file = {
        .materials = "{" EXTENSION("ior", "'ior':2.5") "},{" EXTENSION(
            "ior",
            "") "},"
                "{" EXTENSION(
                    "specular",
                    "'specularFactor':0.5,'specularTexture':{'index':0},"
                    "'specularColorFactor':[2,1,0.5],"
                    "'specularColorTexture':{'index':0}") "},"
                                                          "{'extensions':{'KHR_materials_ior':{'"
                                                          "ior':0},'KHR_materials_specular':"
                                                          "{'specularColorFactor':[0.5,0.25,1]}}}",
        .count = 4,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = scene.materials;
    CHECK(m[0].ior == 2.5f && m[1].ior == 1.5f);
    CHECK(m[2].specular_weight == 0.5f && near3(m[2].specular_color, 2, 1, 0.5));
    CHECK(m[2].texture_count == 1);
    check_scale(&scene, 2, GROUP_SPECULAR, "rgba");
    // With an infinite index, the specular colour itself is reflected; the loaded value is relative
    // to 0.04.
    CHECK(m[3].ior == 1.5f && near3(m[3].specular_color, 12.5, 6.25, 25));
    CHECK(scene.note_count == 0);
    scene_finish(&scene);
}

TEST(specular_glossiness)
{
    struct scene scene;
    const struct material_file file = {
        .materials =
            "{'alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorTexture':{'index':1}}"
            "," EXTENSION("pbrSpecularGlossiness",
                          "'diffuseFactor':[0.5,0.25,1,0.75],'diffuseTexture':{'index':0},"
                          "'specularFactor':[0.04,0.5,1],'glossinessFactor':0.25,"
                          "'specularGlossinessTexture':{'index':0}") "},"
                                                                     "{" EXTENSION(
                                                                         "pbrSpecularGlossiness",
                                                                         "'glossinessFactor':0,"
                                                                         "'specularGlossinessTextur"
                                                                         "e':{'index':0}") "}",
        .count = 2,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = scene.materials;
    CHECK(m[0].metallic == 0 && m[0].roughness == 0.75f && m[0].opacity == 0.75f);
    CHECK(near3(m[0].base_color, 0.5, 0.25, 1) && near3(m[0].specular_color, 1, 12.5, 25));
    CHECK(scene.image_count == 1 && m[0].texture_count == 3);
    check_scale(&scene, 0, GROUP_BASE, "rgba");
    check_scale(&scene, 0, GROUP_SPECULAR, "rgb-");
    check_scale(&scene, 0, GROUP_METAL, "-A--");
    // A glossiness of 0 remains 0, with any texture.
    CHECK(m[1].roughness == 1 && m[1].texture_count == 1 && near3(m[1].specular_color, 25, 25, 25));
    CHECK(has_note(&scene, "2 specular-glossiness materials"));
    scene_finish(&scene);
}

// The widths that the extension defines follow from the loaded parameters.
TEST(anisotropy)
{
#define ANISOTROPIC(roughness, members)                                                            \
    "{'pbrMetallicRoughness':{'roughnessFactor':" roughness                                        \
    "}," EXTENSION("anisotropy", members) "}"
    struct scene scene;
    const struct material_file file = {
        .materials =
            ANISOTROPIC("0.6", "'anisotropyStrength':0.5,'anisotropyRotation':1") "," ANISOTROPIC(
                "0.1", "'anisotropyStrength':1") "," ANISOTROPIC("0.6",
                                                                 "'anisotropyStrength':0.5,'"
                                                                 "anisotropyRotation':-7,"
                                                                 "'anisotropyTexture':{'index':"
                                                                 "0}") "," ANISOTROPIC("0.6",
                                                                                       "'anisot"
                                                                                       "ropyRot"
                                                                                       "ation':"
                                                                                       "1,'"
                                                                                       "anisotr"
                                                                                       "opyText"
                                                                                       "ure':{'"
                                                                                       "index':"
                                                                                       "0}"),
        .count = 4,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = scene.materials;
    double alpha = pow((double)m[0].roughness, 2);
    double aspect = sqrt(1 - 0.9 * (double)m[0].anisotropic);
    CHECK(fabs(alpha / aspect - (0.36 + 0.64 * 0.25)) < 1e-6, "%g", alpha / aspect);
    CHECK(fabs(alpha * aspect - 0.36) < 1e-6, "%g", alpha * aspect);
    CHECK(fabs((double)m[0].anisotropic_rotation - 1 / (2 * M_PI)) < 1e-6);
    // Widths of 1 and 0.01 differ too much, so only their mean is kept.
    CHECK(m[1].anisotropic == 1 && fabsf(m[1].roughness - sqrtf(0.1f)) < 1e-6f);
    CHECK(has_note(&scene, "2 materials: anisotropy is approximated"));
    CHECK(fabs((double)m[2].anisotropic_rotation - (-7 + 2 * M_PI) / (2 * M_PI)) < 1e-6);
    CHECK(m[2].texture_count == 1);
    if (m[2].texture_count == 1)
        CHECK((scene.textures[m[2].first_texture].flags >> TEXTURE_USE_SHIFT & 3) ==
              TEXTURE_USE_ANISOTROPY);
    CHECK(m[3].anisotropic == 0 && m[3].roughness == 0.6f && m[3].texture_count == 0);
    scene_finish(&scene);
}

// A material that only reflects diffusely is shaded as Lambertian, in the cheapest class. A
// material with any other reflection is not.
static const char plain_materials[] =
    "{'pbrMetallicRoughness':{'metallicFactor':0},"
    "'extensions':{'KHR_materials_specular':{'specularFactor':0}}},"
    "{'pbrMetallicRoughness':{'metallicFactor':0},"
    "'extensions':{'KHR_materials_specular':{'specularFactor':0},"
    "'KHR_materials_sheen':{'sheenColorFactor':[0,0,0.1]}}},"
    "{'pbrMetallicRoughness':{'metallicFactor':0},"
    "'extensions':{'KHR_materials_specular':{'specularFactor':0},"
    "'KHR_materials_clearcoat':{'clearcoatFactor':0.1}}},"
    "{'pbrMetallicRoughness':{'metallicFactor':0}},"
    "{'pbrMetallicRoughness':{'metallicFactor':0},"
    "'extensions':{'KHR_materials_specular':{'specularFactor':0},"
    "'KHR_materials_transmission':{'transmissionFactor':0.5}}}";

TEST(lambert)
{
    static const uint32_t classes[5] = {CLASS_DIFFUSE, CLASS_PRINCIPLED, CLASS_PRINCIPLED,
                                        CLASS_PRINCIPLED, CLASS_TRANSMISSIVE};
    const struct material_file file = {.materials = plain_materials, .count = 5};
    struct scene scene;
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = scene.materials;
    for (int i = 0; i < 5; i++) {
        CHECK(m[i].model == MATERIAL_PRINCIPLED && m[i].flags & MATERIAL_GLTF_LAYERS);
        CHECK(material_class(&m[i]) == classes[i], "material %d: class %u", i,
              material_class(&m[i]));
    }
    scene_finish(&scene);
}

TEST(transmission_and_volume)
{
    struct scene scene;
    const struct material_file file = {
        .materials = "{" EXTENSION(
            "transmission",
            "'transmissionFactor':0.5,'transmissionTexture':"
            "{'index':0}") "},"
                           "{'extensions':{'KHR_materials_transmission':{'transmissionFactor':1},"
                           "'KHR_materials_volume':{'thicknessFactor':0.1,'attenuationDistance':2,"
                           "'attenuationColor':[0.5,1,0]},'KHR_materials_dispersion':{'dispersion':"
                           "0.25}}},"
                           "{'extensions':{'KHR_materials_transmission':{'transmissionFactor':1},"
                           "'KHR_materials_volume':{'thicknessFactor':0.1,'attenuationColor':[0.5,"
                           "1,0],"
                           "'thicknessTexture':{'index':0}}}},"
                           "{'extensions':{'KHR_materials_transmission':{'transmissionFactor':1},"
                           "'KHR_materials_volume':{'attenuationDistance':2,'attenuationColor':[0."
                           "5,1,0]}}},"
                           "{" EXTENSION("volume", "'thicknessFactor':0.1") "}",
        .count = 5,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = scene.materials;
    CHECK(m[0].transmission == 0.5f && (m[0].flags & MATERIAL_THIN) && !material_has_inside(m));
    check_scale(&scene, 0, GROUP_INTERFACE, "r---");
    CHECK(material_has_inside(&m[1]) && (m[1].flags & MATERIAL_TINT_EACH));
    CHECK(fabsf(m[1].extinction[0] - 0.34657359f) < 1e-6f && m[1].extinction[1] == 0); // ln(2) / 2
    CHECK(isinf(m[1].extinction[2]) && m[1].dispersion == 0.25f);
    // Without an attenuation distance nothing is absorbed. Without a thickness there is no inside.
    CHECK(material_has_inside(&m[2]) && m[2].extinction[0] == 0 && m[2].texture_count == 0);
    CHECK((m[3].flags & MATERIAL_THIN) && m[3].extinction[0] == 0);
    CHECK(!(m[4].flags & MATERIAL_THIN) && !material_has_inside(&m[4]));
    CHECK(scene.note_count == 0);
    scene_finish(&scene);
}

TEST(diffuse_transmission)
{
    struct scene scene;
    const struct material_file file = {
        .materials = "{" EXTENSION(
            "diffuse_transmission",
            "'diffuseTransmissionFactor':0.5,"
            "'diffuseTransmissionTexture':{'index':0}") "},"
                                                        "{" EXTENSION(
                                                            "diffuse_transmission",
                                                            "'diffuseTransmissionFactor':0.5,"
                                                            "'diffuseTransmissionColorFactor':[1,0."
                                                            "5,0]") "},"
                                                                    "{'extensions':{'KHR_materials_"
                                                                    "diffuse_transmission':{'"
                                                                    "diffuseTransmissionFactor':1},"
                                                                    "'KHR_materials_volume':{'"
                                                                    "thicknessFactor':1}}},"
                                                                    "{" EXTENSION(
                                                                        "diffuse_transmission",
                                                                        "'diffuseTransmissionColorF"
                                                                        "actor':[1,0.5,0]") "}",
        .count = 4,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = scene.materials;
    CHECK(m[0].diffuse_transmission == 0.5f && (m[0].flags & MATERIAL_THIN));
    check_scale(&scene, 0, GROUP_DIFFUSE, "---a");
    CHECK(has_note(&scene, "1 materials: light that is transmitted diffusely has the base colour"));
    CHECK(has_note(&scene, "1 materials: diffuse transmission into volumes is ignored"));
    CHECK(m[3].diffuse_transmission == 0 && !(m[3].flags & MATERIAL_THIN));
    scene_finish(&scene);
}

// The thickness is mix(minimum, maximum, green), even if the minimum is greater. Green is 0.4 here.
TEST(iridescence)
{
#define FILM(members) "{" EXTENSION("iridescence", "'iridescenceFactor':0.5," members) "}"
#define THICK(minimum, maximum)                                                                    \
    "'iridescenceThicknessTexture':{'index':1},'iridescenceThicknessMinimum':" minimum             \
    ",'iridescenceThicknessMaximum':" maximum
    struct scene scene;
    const struct material_file file = {
        .materials = FILM("'iridescenceIor':1.8,'iridescenceTexture':{'index':0}") "," FILM(
            "'iridescenceThi"
            "cknessMinimum':"
            "200,'"
            "iridescenceThic"
            "knessMaximum':"
            "300") "," FILM(THICK("200",
                                  "700")) "," FILM(THICK("700",
                                                         "200")) "," FILM(THICK("0",
                                                                                "500")) "," FILM(THICK("0",
                                                                                                       "0")) "," FILM(THICK("300",
                                                                                                                            "300")),
        .count = 7,
        .lists = TWO_TEXTURES,
    };
    if (!load_materials(&scene, &file))
        return;
    const struct material *m = scene.materials;
    CHECK(m[0].iridescence == 0.5f && m[0].film_ior == 1.8f && m[0].film_thickness == 400);
    check_scale(&scene, 0, GROUP_FILM, "r---");
    CHECK(m[1].film_thickness == 300 && m[1].film_ior == 1.3f && m[1].texture_count == 0);
    static const double thickness[7] = {0, 0, 400, 500, 200, 0, 300};
    for (uint32_t i = 2; i < 7; i++) {
        double found = (double)m[i].film_thickness;
        if (m[i].texture_count > 0) {
            check_scale(&scene, i, GROUP_FILM, "-g--");
            const struct texture_image *image = image_of(&scene, i, GROUP_FILM);
            found *= (double)image->mean[1];
            float texel[4];
            texture_texel(image, 0, texel);
            CHECK(fabsf(texel[1] - image->mean[1]) < 5e-4f, "%g", (double)texel[1]);
        }
        CHECK(fabs(found - thickness[i]) < 0.3, "material %u: %g", i, found);
    }
    CHECK(scene.note_count == 0);
    scene_finish(&scene);
}

TEST_MAIN(TEST_CASE(clearcoat_and_sheen), TEST_CASE(ior_and_specular),
          TEST_CASE(specular_glossiness), TEST_CASE(anisotropy), TEST_CASE(lambert),
          TEST_CASE(transmission_and_volume), TEST_CASE(diffuse_transmission),
          TEST_CASE(iridescence))
