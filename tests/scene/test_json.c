// Tests the JSON format: values, overrides, and that nothing crashes. Documents that are refused,
// with their messages, are in bad_scenes.json, which check_format.py runs.
#include "mesh_files.h"

#include "base/memory.h"
#include "shared/types.h"
#include <sys/stat.h>

// A PNG with one texel.
static const unsigned char texel_png[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
    0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00,
    0x00, 0x1f, 0x15, 0xc4, 0x89, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x44, 0x41, 0x54, 0x78,
    0xda, 0x63, 0x64, 0xf8, 0xcf, 0x50, 0x0f, 0x00, 0x03, 0x86, 0x01, 0x80, 0x5a, 0x34,
    0x7d, 0x6b, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

#define ONE_TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n"

// Loads a file with overrides KEY, VALUE, …, NULL. The caller finishes the scene.
static bool load_file_with(struct scene *scene, const char *path, const char *const *overrides,
                           struct err *err)
{
    struct scene_override list[8];
    struct scene_load_params params = {.path = path, .overrides = list};
    *err = (struct err){0};
    for (; overrides && *overrides; overrides += 2)
        list[params.override_count++] = (struct scene_override){overrides[0], overrides[1]};
    return scene_load(&params, scene, err);
}

#define WITH(...) ((const char *const[]){__VA_ARGS__, NULL})

// Loads {"lampyris": 1, BODY} with overrides. If that is refused, records a failure and returns
// {0}.
static struct scene load_body_with(const char *body, const char *const *overrides)
{
    char text[4096];
    struct scene scene;
    struct err err;
    snprintf(text, sizeof text, "{\"lampyris\": 1%s%s}", *body ? ", " : "", body);
    bool ok = load_file_with(&scene, write_text("scene.json", text), overrides, &err);
    CHECK(ok, "%s", err.msg);
    return scene;
}

static struct scene load_body(const char *body)
{
    return load_body_with(body, NULL);
}

static bool is_near(const double *a, const double *b, int count, double tolerance)
{
    for (int i = 0; i < count; i++)
        if (!(fabs(a[i] - b[i]) <= tolerance))
            return false;
    return true;
}

#define IS_VECTOR(v, ...) is_near((v), (const double[]){__VA_ARGS__}, 3, 1e-12)

static bool is_color(const float *c, float r, float g, float b)
{
    return c[0] == r && c[1] == g && c[2] == b;
}

TEST(an_empty_document_is_a_scene)
{
    struct scene scene = load_body("");
    CHECK(scene.settings.width == 512 && scene.settings.spp == 64 && scene.settings.pixel_jitter);
    CHECK(scene.settings.max_bounces == 9 && scene.settings.roulette_min_bounces == 3);
    CHECK(scene.camera_count == 1 && scene.material_count == 1 && scene.environment.present);
    CHECK(scene.note_count == 2, "%u notes", scene.note_count);
    scene_finish(&scene);
}

TEST(camera)
{
    struct scene scene =
        load_body("\"camera\": {\"position\": [1, 2, 3], \"target\": [1, 2, -7], \"up\": [1, 0, 0],"
                  " \"fov_degrees\": 60, \"name\": \"front\"}");
    REQUIRE(scene.camera_count == 1);
    const struct camera *camera = &scene.cameras[0];
    CHECK(IS_VECTOR(camera->position, 1, 2, 3) && IS_VECTOR(camera->direction, 0, 0, -1));
    CHECK(IS_VECTOR(camera->up, 1, 0, 0) && strcmp(camera->name, "front") == 0);
    CHECK(fabs(camera->fov_y - M_PI / 3) < 1e-15, "%g", camera->fov_y);
    CHECK(!scene.camera_is_framed);
    scene_finish(&scene);

    scene = load_body("\"camera\": {\"position\": [0, 0, 0], \"direction\": [0, 0, 9],"
                      " \"focal_length_mm\": 12}");
    REQUIRE(scene.camera_count == 1);
    CHECK(IS_VECTOR(scene.cameras[0].direction, 0, 0, 1) &&
          IS_VECTOR(scene.cameras[0].up, 0, 1, 0));
    CHECK(fabs(scene.cameras[0].fov_y - M_PI / 2) < 1e-15, "%g", scene.cameras[0].fov_y);
    scene_finish(&scene);
}

TEST(film_and_settings)
{
    struct scene scene = load_body(
        "\"film\": {\"width\": 7, \"height\": 5, \"exposure\": -1.5, \"tone\": \"agx\"},"
        "\"settings\": {\"spp\": 4294967295, \"seed\": 3, \"max_bounces\": 0, \"mis\": "
        "\"balance\", \"nee\": false,"
        " \"roulette_min_bounces\": \"off\", \"pixel_jitter\": false, \"filter\": \"box\"}");
    const struct settings *s = &scene.settings;
    CHECK(s->width == 7 && s->height == 5 && s->exposure == -1.5f && s->tone_curve == TONE_AGX);
    CHECK(s->spp == UINT32_MAX && s->seed == 3 && s->max_bounces == 0 && !s->pixel_jitter);
    CHECK(s->mis == MIS_BALANCE && !s->nee && s->roulette_min_bounces == UINT32_MAX);
    scene_finish(&scene);
}

// Scenes saved by earlier versions, which attenuated light by distance, have this key.
TEST(no_fading_by_distance_is_read)
{
    struct scene scene = load_body("\"settings\": {\"falloff\": 0, \"spp\": 9}");
    CHECK(scene.settings.spp == 9);
    scene_finish(&scene);
}

// The former accumulation is read as binned sums, which have replaced it.
TEST(compensated_sums_are_read_as_binned)
{
    struct scene scene = load_body("\"settings\": {\"film_accumulation\": \"compensated\"}");
    CHECK(scene.settings.accumulation == ACCUMULATION_BINNED);
    scene_finish(&scene);
}

TEST(materials_keep_their_order)
{
    struct scene scene = load_body("\"materials\": {\"z\": {\"base_color\": [0.25, 0.5, 1]},"
                                   " \"comment\": \"none\", \"a\": {\"type\": \"mirror\"},"
                                   " \"m\": {\"emission\": [1, 2, 3]}}");
    REQUIRE(scene.material_count == 3, "%u", scene.material_count);
    const struct material *m = scene.materials;
    CHECK(strcmp(m[0].name, "z") == 0 && strcmp(m[1].name, "a") == 0);
    CHECK(is_color(m[0].base_color, 0.25f, 0.5f, 1) && is_color(m[0].emission, 0, 0, 0));
    CHECK(m[1].model == MATERIAL_MIRROR && is_color(m[1].base_color, 1, 1, 1));
    CHECK(m[2].model == MATERIAL_LAMBERT && is_color(m[2].base_color, 0.5f, 0.5f, 0.5f));
    CHECK(is_color(m[2].emission, 1, 2, 3));
    scene_finish(&scene);
}

TEST(materials_of_every_model)
{
    struct scene scene = load_body(
        "\"materials\": {"
        "\"p\": {\"type\": \"principled\", \"metallic\": 0.25, \"clearcoat_roughness\": 0.5,"
        " \"masking\": \"separable\", \"compensate\": false, \"sheen_color\": [0.25, 0.5, 1]},"
        "\"d\": {\"type\": \"dielectric\", \"ior\": 1.25, \"priority\": 9, \"absorption\":"
        " {\"color\": [1, 0.5, 0], \"distance\": 2}},"
        "\"c\": {\"type\": \"conductor\", \"conductor_eta\": [0.001, 2, 3]},"
        "\"b\": {\"type\": \"blinn_phong\", \"smoothness\": 0.5},"
        "\"m\": {\"type\": \"microfacet\", \"distribution\": \"phong\", \"masking\": \"lh\","
        " \"fresnel\": \"exact\", \"roughness\": 0.75},"
        "\"t\": {\"type\": \"dielectric\", \"thin\": true, \"roughness\": 0.125},"
        "\"g\": {\"type\": \"conductor\", \"metal\": \"gold\"},"
        "\"l\": {\"type\": \"principled\", \"layers\": \"gltf\", \"specular_weight\": 0},"
        "\"n\": {\"like\": \"l\", \"layers\": \"burley\"},"
        "\"w\": {\"type\": \"microfacet\", \"distribution\": \"phong\", \"phong_exponent\": 30,"
        " \"masking\": \"rational_unbounded\", \"diffuse\": \"uncoupled\"}}");
    REQUIRE(scene.material_count == 10, "%u", scene.material_count);
    const struct material *m = scene.materials;
    CHECK(m[0].model == MATERIAL_PRINCIPLED && m[0].metallic == 0.25f && m[0].roughness == 0.5f);
    CHECK(m[0].flags == (MATERIAL_COAT_GGX | MATERIAL_SEPARABLE) && m[0].clearcoat_gloss == 1);
    CHECK(is_color(m[0].sheen_color, 0.25f, 0.5f, 1) && m[0].clearcoat_roughness == 0.5f);
    CHECK(m[7].flags & MATERIAL_GLTF_LAYERS && material_class(&m[7]) == CLASS_DIFFUSE);
    CHECK(!(m[8].flags & MATERIAL_GLTF_LAYERS) && material_class(&m[8]) == CLASS_PRINCIPLED);
    CHECK(m[1].model == MATERIAL_DIELECTRIC && m[1].roughness == 0 && m[1].ior == 1.25f);
    CHECK(m[1].medium_priority == 9 && m[1].extinction[0] == 0 && isinf(m[1].extinction[2]));
    CHECK(fabsf(m[1].extinction[1] - logf(2) / 2) < 1e-7f, "%g", (double)m[1].extinction[1]);
    CHECK(m[2].model == MATERIAL_CONDUCTOR && m[2].conductor_eta[0] == 0.001f);
    CHECK(m[2].flags == MATERIAL_COMPENSATE && m[2].roughness == 0 && m[2].conductor_k[1] == 3.9f);
    // The expected value is 1000^(1/4).
    CHECK(m[3].model == MATERIAL_BLINN_PHONG && fabsf(m[3].exponent - 5.6234133f) < 1e-6f);
    CHECK(m[4].model == MATERIAL_MICROFACET && m[4].roughness == 0.75f);
    CHECK((m[4].flags & ~MATERIAL_COMPENSATE) ==
          (DISTRIBUTION_PHONG << MATERIAL_DISTRIBUTION_SHIFT |
           MASKING_LH << MATERIAL_MASKING_SHIFT | MATERIAL_EXACT_FRESNEL));
    CHECK((m[5].flags & MATERIAL_THIN) && m[5].roughness == 0.125f && m[5].medium_priority == 1);
    CHECK(material_has_inside(&m[1]) && !material_has_inside(&m[5]));
    CHECK(is_color(m[6].conductor_eta, 0.21f, 0.43f, 1.38f) && m[6].conductor_k[2] == 1.914f);
    // alpha = 1/4 corresponds to the exponent 2 / alpha^2 - 2 = 30.
    CHECK(m[9].roughness == 0.5f, "%g", (double)m[9].roughness);
    CHECK((m[9].flags & ~MATERIAL_COMPENSATE) ==
          (DISTRIBUTION_PHONG << MATERIAL_DISTRIBUTION_SHIFT |
           MASKING_RATIONAL_UNBOUNDED << MATERIAL_MASKING_SHIFT | MATERIAL_UNCOUPLED));
    scene_finish(&scene);
}

TEST(materials_like_others)
{
    write_bytes("texel.png", texel_png, sizeof texel_png);
    char textures[256];
    snprintf(textures, sizeof textures, "[{\"file\": \"%s/texel.png\", \"use\": \"normal\"}]",
             folder);
    struct scene scene = load_body_with(
        "\"materials\": {\"a\": {\"type\": \"principled\", \"metallic\": 0.25, \"roughness\": "
        "0.75},"
        "\"b\": {\"like\": \"a\", \"roughness\": 1}, \"c\": {\"like\": \"b\", \"metallic\": 0}}",
        WITH("materials.a.textures", textures, "materials.b.metallic", "0.5"));
    REQUIRE(scene.material_count == 3, "%u", scene.material_count);
    const struct material *m = scene.materials;
    CHECK(m[0].metallic == 0.25f && m[0].roughness == 0.75f);
    CHECK(m[1].model == MATERIAL_PRINCIPLED && m[1].metallic == 0.5f && m[1].roughness == 1);
    CHECK(m[2].model == MATERIAL_PRINCIPLED && m[2].metallic == 0 && m[2].roughness == 1);
    // A path given by the user remains relative to the user's folder when it is inherited.
    CHECK(scene.texture_count == 3 && scene.image_count == 1 && m[2].texture_count == 1);
    scene_finish(&scene);
}

#define ALPHA_FLAGS (MATERIAL_ALPHA_BLEND | MATERIAL_ALPHA_MASK)

TEST(alpha_blends_what_may_be_transparent)
{
    write_bytes("texel.png", texel_png, sizeof texel_png);
    struct scene scene = load_body(
        "\"materials\": {\"a\": {}, \"b\": {\"opacity\": 0.5},"
        "\"c\": {\"opacity\": 0.5, \"alpha\": \"opaque\"}, \"d\": {\"alpha\": \"mask\","
        " \"alpha_cutoff\": 0.25}, \"e\": {\"textures\": [{\"file\": \"texel.png\","
        " \"parameters\": {\"base_color\": \"rgb\", \"opacity\": \"a\"}}]},"
        "\"f\": {\"textures\": [{\"file\": \"texel.png\", \"parameters\": {\"base_color\":"
        " \"rgb\"}}]}}");
    const uint32_t expected[] = {
        0, MATERIAL_ALPHA_BLEND, 0, MATERIAL_ALPHA_MASK, MATERIAL_ALPHA_BLEND, 0};
    REQUIRE(scene.material_count == 6, "%u", scene.material_count);
    for (int i = 0; i < 6; i++)
        CHECK((scene.materials[i].flags & ALPHA_FLAGS) == expected[i], "%d: %x", i,
              scene.materials[i].flags);
    CHECK(scene.materials[3].alpha_cutoff == 0.25f && scene.image_count == 1);
    scene_finish(&scene);
}

TEST(textures_scale_groups_of_parameters)
{
    write_bytes("texel.png", texel_png, sizeof texel_png);
    struct scene scene = load_body(
        "\"materials\": {\"x\": {\"type\": \"principled\", \"textures\": ["
        "{\"file\": \"texel.png\", \"parameters\": {\"base_color\": \"g\"}, \"wrap\": \"clamp\"},"
        "{\"file\": \"texel.png\", \"parameters\": {\"roughness\": \"g\", \"metallic\": \"b\","
        " \"clearcoat\": \"r\"}, \"wrap\": [\"mirror\", \"repeat\"], \"filter\": \"nearest\","
        " \"uv_set\": 1, \"offset\": [5, 6], \"scale\": [2, 3], \"rotation_degrees\": 450}]},"
        "\"y\": {\"type\": \"principled\", \"roughness\": 0.25, \"textures\": ["
        "{\"file\": \"texel.png\", \"parameters\": {\"roughness\": \"a\", \"metallic\": \"a\"},"
        " \"invert\": true}, {\"file\": \"texel.png\", \"use\": \"normal\"},"
        " {\"file\": \"texel.png\", \"use\": \"anisotropy\"}]}}");
    REQUIRE(scene.material_count == 2 && scene.texture_count == 6, "%u", scene.texture_count);
    const struct material *x = &scene.materials[0], *y = &scene.materials[1];
    CHECK(x->first_texture == 0 && x->texture_count == 3 && y->first_texture == 3);
    CHECK(x->base_color[1] == 1 && x->roughness == 1 && x->metallic == 1 && x->clearcoat == 1);
    CHECK(y->roughness == 0.25f && y->metallic == 0 && y->anisotropic == 1);

    const struct texture *t = scene.textures;
    // Bits of a mask, and channels of two bits each, with component 0 lowest.
    const uint32_t wrapped = TEXTURE_WRAP_MIRROR | TEXTURE_NEAREST | TEXTURE_UV1;
    CHECK(t[0].flags == (TEXTURE_WRAP_CLAMP | TEXTURE_WRAP_CLAMP << TEXTURE_WRAP_T_SHIFT |
                         GROUP_BASE << TEXTURE_GROUP_SHIFT | 7u << TEXTURE_MASK_SHIFT |
                         0x15u << TEXTURE_CHANNELS_SHIFT),
          "%x", t[0].flags);
    CHECK(t[1].flags == (wrapped | GROUP_METAL << TEXTURE_GROUP_SHIFT | 6u << TEXTURE_MASK_SHIFT |
                         0x24u << TEXTURE_CHANNELS_SHIFT),
          "%x", t[1].flags);
    CHECK(t[2].flags ==
              (wrapped | GROUP_CLEARCOAT << TEXTURE_GROUP_SHIFT | 1u << TEXTURE_MASK_SHIFT),
          "%x", t[2].flags);
    CHECK(t[3].flags == (GROUP_METAL << TEXTURE_GROUP_SHIFT | 6u << TEXTURE_MASK_SHIFT |
                         6u << TEXTURE_INVERT_SHIFT | 0x3cu << TEXTURE_CHANNELS_SHIFT),
          "%x", t[3].flags);
    CHECK(t[4].flags == TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT, "%x", t[4].flags);
    CHECK(t[5].flags == TEXTURE_USE_ANISOTROPY << TEXTURE_USE_SHIFT, "%x", t[5].flags);
    // A file that is used for colours and for numbers becomes two images, one of which is
    // sRGB-decoded.
    CHECK(scene.image_count == 2 && t[1].image == t[4].image && t[0].image != t[1].image);

    // A quarter turn: s = 5 + 3 v, t = 6 - 2 u.
    const float turned[2][3] = {{0, 3, 5}, {-2, 0, 6}};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 3; j++)
            CHECK(fabsf(t[1].transform[i][j] - turned[i][j]) < 1e-6f, "%d %d: %g", i, j,
                  (double)t[1].transform[i][j]);
    scene_finish(&scene);
}

TEST(lights)
{
    struct scene scene = load_body(
        "\"lights\": [{\"type\": \"point\", \"name\": \"bulb\", \"position\": [1, 2, 3],"
        " \"power\": [100, 0, 0], \"range\": 7},"
        "{\"type\": \"spot\", \"position\": [0, 3, 0], \"target\": [0, 0, 0],"
        " \"inner_degrees\": 30, \"outer_degrees\": 60, \"intensity\": [1, 2, 3]},"
        "{\"type\": \"spot\", \"position\": [0, 3, 0], \"direction\": [0, 0, 9],"
        " \"inner_degrees\": 30, \"outer_degrees\": 60, \"power\": [1, 1, 1]},"
        "{\"type\": \"directional\", \"direction\": [0, -2, 0], \"irradiance\": [4, 5, 6]}]");
    REQUIRE(scene.light_count == 4 && !scene.environment.present);
    const struct light *l = scene.lights;
    CHECK(l[0].kind == LIGHT_POINT && l[0].range == 7 && strcmp(l[0].name, "bulb") == 0);
    CHECK(IS_VECTOR(l[0].position, 1, 2, 3));
    CHECK(fabs((double)l[0].radiant[0] - 100 / (4 * M_PI)) < 1e-6, "%g", (double)l[0].radiant[0]);
    CHECK(l[1].kind == LIGHT_SPOT && IS_VECTOR(l[1].direction, 0, -1, 0) && isinf(l[1].range));
    CHECK(fabs((double)l[1].inner_angle - M_PI / 6) < 1e-7 &&
          fabs((double)l[1].outer_angle - M_PI / 3) < 1e-7);
    CHECK(is_color(l[1].radiant, 1, 2, 3) && IS_VECTOR(l[2].direction, 0, 0, 1));
    // Compares the loader's closed form with the midpoint rule over cosines.
    double solid_angle = 0, outer = cos(M_PI / 3), inner = cos(M_PI / 6);
    const int steps = 100000;
    for (int i = 0; i < steps; i++) {
        double f = fmin(1, (1 - outer) * (i + 0.5) / steps / (inner - outer));
        solid_angle += 2 * M_PI * f * f * (1 - outer) / steps;
    }
    CHECK(fabs((double)l[2].radiant[1] * solid_angle - 1) < 1e-6, "%g", solid_angle);
    CHECK(l[3].kind == LIGHT_DIRECTIONAL && IS_VECTOR(l[3].direction, 0, -1, 0));
    CHECK(is_color(l[3].radiant, 4, 5, 6) && scene.note_count == 1);
    scene_finish(&scene);
}

#define WHITE "\"materials\": {\"white\": {}, \"red\": {\"base_color\": [1, 0, 0]}}, "

static void check_outward(const struct mesh *mesh, const double center[3])
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const double *v[3];
        double e[2][3], out[3], normal[3];
        for (int c = 0; c < 3; c++)
            v[c] = mesh->exact_positions[mesh->indices[t][c]];
        for (int i = 0; i < 3; i++) {
            e[0][i] = v[1][i] - v[0][i];
            e[1][i] = v[2][i] - v[0][i];
            out[i] = v[0][i] - center[i];
        }
        for (int i = 0; i < 3; i++)
            normal[i] =
                e[0][(i + 1) % 3] * e[1][(i + 2) % 3] - e[0][(i + 2) % 3] * e[1][(i + 1) % 3];
        CHECK(normal[0] * out[0] + normal[1] * out[1] + normal[2] * out[2] > 0, "triangle %u", t);
    }
}

// Triangles that are counter-clockwise on the surface must be so in the image, whose v points
// downwards.
static void check_not_mirrored(const struct mesh *mesh)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const float *a = mesh->uvs[0][mesh->indices[t][0]], *b = mesh->uvs[0][mesh->indices[t][1]],
                    *c = mesh->uvs[0][mesh->indices[t][2]];
        float area = (b[0] - a[0]) * (a[1] - c[1]) - (c[0] - a[0]) * (a[1] - b[1]);
        CHECK(area == 1, "triangle %u: %g", t, (double)area);
    }
}

TEST(primitives)
{
    struct scene scene = load_body(
        WHITE "\"shapes\": ["
              "{\"type\": \"quad\", \"material\": \"red\", \"corner\": [1, 1, 1], \"u\": [2, 0, 0],"
              " \"v\": [0, 3, 0]},"
              "{\"type\": \"quad\", \"material\": \"white\", \"vertices\": [[0, 0, 0], [1, 0, 0],"
              " [2, 2, 0], [0, 1, 0]]},"
              "{\"type\": \"box\", \"material\": \"red\", \"min\": [0, 0, 0], \"max\": [1, 2, 3]},"
              "{\"type\": \"sphere\", \"material\": \"red\", \"radius\": 2},"
              "{\"type\": \"disc\", \"material\": \"white\", \"center\": [1, 2, 3], \"radius\": 4,"
              " \"normal\": [0, 0, -5]},"
              "{\"type\": \"generated\", \"material\": \"red\", \"triangles\": 100}]");
    REQUIRE(scene.mesh_count == 4 && scene.instance_count == 4 && scene.shape_count == 2);
    const struct mesh *quad = &scene.meshes[0], *box = &scene.meshes[2];
    CHECK(quad->material == 1 && quad->vertex_count == 4 && quad->triangle_count == 2);
    CHECK(IS_VECTOR(quad->exact_positions[2], 3, 4, 1) && quad->positions[2][1] == 4);
    CHECK(IS_VECTOR(scene.meshes[1].exact_positions[2], 2, 2, 0) && scene.meshes[1].material == 0);
    CHECK(box->vertex_count == 24 && box->triangle_count == 12);
    check_not_mirrored(quad);
    check_not_mirrored(box);
    // On the side at +z the image is upright, with its upper left corner at the left.
    for (uint32_t v = 20; v < 24; v++)
        CHECK((box->uvs[0][v][0] == 0 && box->uvs[0][v][1] == 0) ==
              IS_VECTOR(box->exact_positions[v], 0, 2, 3));
    check_outward(box, (const double[]){0.5, 1, 1.5});
    CHECK(scene.instances[2].material == SCENE_NONE && scene.instances[2].mesh == 2);
    CHECK(scene.shapes[0].kind == SHAPE_SPHERE && scene.shapes[0].radius == 2);
    CHECK(IS_VECTOR(scene.shapes[0].center, 0, 0, 0) && scene.shapes[0].material == 1);
    CHECK(scene.shapes[1].kind == SHAPE_DISC && IS_VECTOR(scene.shapes[1].normal, 0, 0, -1));
    CHECK(scene.meshes[3].triangle_count >= 8 && scene.meshes[3].normals);
    scene_finish(&scene);
}

TEST(transforms_apply_in_their_order)
{
    struct scene scene = load_body(
        WHITE
        "\"shapes\": ["
        "{\"type\": \"box\", \"material\": \"red\", \"min\": [0, 0, 0], \"max\": [1, 1, 1],"
        " \"transform\": [{\"scale\": [2, 3, 4]}, {\"rotate\": {\"axis\": [0, 0, 2],"
        " \"degrees\": 90}}, {\"translate\": [10, 0, 0]}]},"
        "{\"type\": \"box\", \"material\": \"red\", \"min\": [0, 0, 0], \"max\": [1, 1, 1],"
        " \"transform\": {\"matrix\": [1, 2, 3, 4,  5, 6, 7, 8,  9, 10, 11, 12,  0, 0, 0, 1]}},"
        "{\"type\": \"disc\", \"material\": \"red\", \"center\": [1, 0, 0],"
        " \"normal\": [0, 1, 0], \"radius\": 1, \"transform\": [{\"scale\": -2},"
        " {\"rotate\": {\"axis\": [1, 0, 0], \"degrees\": 450}}]}]");
    REQUIRE(scene.instance_count == 2 && scene.shape_count == 1);
    // x' = 10 - 3 y, y' = 2 x, z' = 4 z
    const double expected[12] = {0, -3, 0, 10, 2, 0, 0, 0, 0, 0, 4, 0};
    CHECK(is_near(scene.instances[0].transform[0], expected, 12, 1e-15));
    const double rows[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    CHECK(is_near(scene.instances[1].transform[0], rows, 12, 0));
    const struct shape *disc = &scene.shapes[0];
    CHECK(fabs(disc->radius - 2) < 1e-15 && IS_VECTOR(disc->center, -2, 0, 0));
    CHECK(IS_VECTOR(disc->normal, 0, 0, -1), "%g %g %g", disc->normal[0], disc->normal[1],
          disc->normal[2]);
    scene_finish(&scene);
}

TEST(mesh_files_fit_their_box)
{
    write_text("one.obj", ONE_TRIANGLE);
    struct scene scene = load_body(
        WHITE "\"shapes\": [{\"type\": \"mesh\", \"file\": \"one.obj\", \"material\": \"red\","
              " \"transform\": {\"translate\": [5, 5, 5]},"
              " \"fit\": {\"min\": [-3, 1, -2], \"max\": [1, 2, 2]}}]");
    REQUIRE(scene.instance_count == 1);
    // The size is 1 x 2 x 0, so the height decides: the scale is 1/2. The middle goes to x = -1 and
    // z = 0.
    const double expected[12] = {.5, 0, 0, -1.25, 0, .5, 0, 1, 0, 0, .5, 0};
    CHECK(is_near(scene.instances[0].transform[0], expected, 12, 1e-15));
    CHECK(scene.instances[0].material == 1);
    scene_finish(&scene);
}

TEST(mesh_files_keep_their_materials)
{
    write_text("one.obj", ONE_TRIANGLE);
    struct scene scene = load_body("\"shapes\": [{\"type\": \"mesh\", \"file\": \"one.obj\"}]");
    REQUIRE(scene.instance_count == 1 && scene.material_count == 1);
    CHECK(scene.instances[0].material == SCENE_NONE);
    scene_finish(&scene);
}

TEST(gltf_and_ply_are_meshes_too)
{
    write_text("one.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                          "property float y\nproperty float z\nelement face 1\n"
                          "property list uchar int vertex_indices\nend_header\n"
                          "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    write_text("one.gltf",
               "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0,"
               "\"scenes\": [{\"nodes\": [0]}],"
               "\"nodes\": [{\"mesh\": 0, \"translation\": [0, 7, 0]}],"
               "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}],"
               "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3,"
               " \"type\": \"VEC3\", \"min\": [0, 0, 0], \"max\": [0, 0, 0]}],"
               "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36}],"
               "\"buffers\": [{\"byteLength\": 36, \"uri\": \"data:application/octet-stream;base64,"
               "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA\"}]}");
    struct scene scene =
        load_body(WHITE "\"shapes\": [{\"type\": \"mesh\", \"file\": \"one.ply\"},"
                        "{\"type\": \"mesh\", \"file\": \"one.gltf\", \"name\": \"g\","
                        " \"transform\": {\"scale\": 2}},"
                        "{\"type\": \"instance\", \"of\": \"g\", \"material\": \"red\"}]");
    REQUIRE(scene.instance_count == 3, "%u", scene.instance_count);
    CHECK(scene.instances[1].transform[1][3] == 14, "%g", scene.instances[1].transform[1][3]);
    CHECK(scene.instances[2].mesh == scene.instances[1].mesh && scene.instances[2].material == 1);
    scene_finish(&scene);
}

TEST(instances_copy_what_stands_in_the_world)
{
    struct scene scene = load_body(
        WHITE
        "\"shapes\": ["
        "{\"type\": \"sphere\", \"name\": \"ball\", \"material\": \"red\", \"radius\": 1,"
        " \"transform\": {\"translate\": [1, 0, 0]}},"
        "{\"type\": \"box\", \"name\": \"box\", \"material\": \"red\", \"min\": [0, 0, 0],"
        " \"max\": [1, 1, 1], \"transform\": {\"translate\": [1, 0, 0]}},"
        "{\"type\": \"instance\", \"of\": \"ball\", \"material\": \"white\", \"name\": \"ball-2\","
        " \"transform\": {\"scale\": 3}},"
        "{\"type\": \"instance\", \"of\": \"ball-2\", \"transform\": {\"translate\": [0, 1, 0]}},"
        "{\"type\": \"instance\", \"of\": \"box\", \"material\": \"white\","
        " \"transform\": {\"scale\": [1, 2, 1]}}]");
    REQUIRE(scene.shape_count == 3 && scene.instance_count == 2 && scene.mesh_count == 1);
    CHECK(scene.shapes[0].radius == 1 && scene.shapes[0].material == 1);
    CHECK(fabs(scene.shapes[1].radius - 3) < 1e-14 && IS_VECTOR(scene.shapes[1].center, 3, 0, 0));
    CHECK(scene.shapes[1].material == 0 && scene.shapes[2].material == 0);
    CHECK(IS_VECTOR(scene.shapes[2].center, 3, 1, 0));
    CHECK(scene.instances[1].mesh == 0 && scene.instances[1].material == 0);
    CHECK(scene.instances[0].material == SCENE_NONE && scene.instances[1].transform[1][1] == 2);
    scene_finish(&scene);
}

TEST(overrides)
{
    static const char body[] =
        "\"define\": {\"w\": 7, \"color\": null, \"s\": {\"radius\": 1}},"
        "\"film\": {\"width\": \"${w}\"}, \"settings\": {},"
        "\"materials\": {\"a\": {\"base_color\": \"${color}\"}, \"b\": {\"emission\": [1, 1, 1]}},"
        "\"shapes\": [{\"type\": \"sphere\", \"radius\": 1, \"material\": \"a\"}]";
    struct scene scene = load_body_with(
        body, WITH("w", "9", "color", "[0, 0.5, 1]", "settings.spp", "5", "shapes.0.material", "b",
                   "shapes[0].radius", "2", "materials.b.emission[1]", "6", "camera",
                   "{\"position\": [0, 0, 9], \"target\": [0, 0, 0], \"fov_degrees\": 9}"));
    REQUIRE(scene.material_count == 2 && scene.shape_count == 1);
    CHECK(scene.settings.width == 9 && scene.settings.spp == 5);
    CHECK(is_color(scene.materials[0].base_color, 0, 0.5f, 1));
    CHECK(is_color(scene.materials[1].emission, 1, 6, 1));
    CHECK(scene.shapes[0].radius == 2 && scene.shapes[0].material == 1);
    CHECK(scene.cameras[0].position[2] == 9 && !scene.camera_is_framed);
    scene_finish(&scene);
}

TEST(overrides_that_are_no_json_are_strings)
{
    struct scene scene =
        load_body_with("\"define\": {\"tone\": null}, \"film\": {\"tone\": \"${tone}\"}",
                       WITH("tone", "reinhard"));
    CHECK(scene.settings.tone_curve == TONE_REINHARD);
    scene_finish(&scene);
    scene = load_body_with("\"film\": {}", WITH("film.tone", "\"aces\""));
    CHECK(scene.settings.tone_curve == TONE_ACES);
    scene_finish(&scene);
}

TEST(paths_confined_to_the_folder)
{
    char outside[128], inner[160];
    snprintf(inner, sizeof inner, "%s/inner", folder);
    CHECK(mkdir(inner, 0700) == 0);
    write_text("one.obj", ONE_TRIANGLE);
    const char *path = write_text("inner/scene.json",
                                  "{\"lampyris\": 1, \"define\": {\"mesh\": \"../one.obj\"},"
                                  " \"shapes\": [{\"type\": \"mesh\", \"file\": \"${mesh}\"}]}");
    struct scene scene;
    struct err err = {0};
    CHECK(!load_file_with(&scene, path, NULL, &err) && err.code == ERR_INPUT, "%s", err.msg);
    CHECK(strstr(err.msg, "shapes[0].file: path \"../one.obj\" contains \"..\""), "%s", err.msg);

    // If it is allowed, the path is relative to the scene's folder.
    const struct scene_load_params allowed = {.path = path, .allow_outside_paths = true};
    CHECK(scene_load(&allowed, &scene, &err) && scene.mesh_count == 1, "%s", err.msg);
    scene_finish(&scene);

    // A path on the command line is the user's own, both as a definition and within a whole shape.
    snprintf(outside, sizeof outside, "%s/one.obj", folder);
    CHECK(load_file_with(&scene, path, WITH("mesh", outside), &err), "%s", err.msg);
    scene_finish(&scene);
    char shape[256];
    snprintf(shape, sizeof shape, "{\"type\": \"mesh\", \"file\": \"%s\"}", outside);
    CHECK(load_file_with(&scene, path, WITH("shapes[0]", shape), &err), "%s", err.msg);
    scene_finish(&scene);
}

static uint64_t hash_of(const char *path, const char *const *overrides)
{
    struct scene scene;
    struct err err;
    bool ok = load_file_with(&scene, path, overrides, &err);
    CHECK(ok, "%s", err.msg);
    uint64_t hash = scene.hash;
    scene_finish(&scene);
    return hash;
}

TEST(the_hash_covers_every_input)
{
    char path[512];
    write_text("one.obj", ONE_TRIANGLE);
    snprintf(path, sizeof path, "%s",
             write_text("scene.json", "{\"lampyris\": 1, \"film\": {}, \"shapes\":"
                                      " [{\"type\": \"mesh\", \"file\": \"one.obj\"}]}"));
    uint64_t hash = hash_of(path, NULL);
    CHECK(hash == hash_of(path, NULL));
    uint64_t with_override = hash_of(path, WITH("film.width", "8"));
    CHECK(with_override != hash && with_override != hash_of(path, WITH("film.width", "9")));
    write_text("one.obj", ONE_TRIANGLE "\n");
    uint64_t with_other_mesh = hash_of(path, NULL);
    CHECK(with_other_mesh != hash);
    write_text("scene.json", "{\"lampyris\": 1, \"film\": {}, \"shapes\" :"
                             " [{\"type\": \"mesh\", \"file\": \"one.obj\"}]}");
    CHECK(hash_of(path, NULL) != with_other_mesh);
}

TEST(memory_limits_are_errors)
{
    const char *path = write_text(
        "scene.json", "{\"lampyris\": 1, \"materials\": {\"a\": {}}, \"shapes\":"
                      " [{\"type\": \"generated\", \"material\": \"a\", \"triangles\": 1000}]}");
    bool loaded = false;
    for (size_t limit = 64; limit < ((size_t)1 << 24); limit += limit / 4) {
        const struct scene_load_params params = {.path = path};
        struct scene scene;
        struct err err = {0};
        memory_set_budget(memory_used() + limit);
        loaded = scene_load(&params, &scene, &err);
        CHECK(loaded || err.code == ERR_BUDGET, "%zu bytes: code %d: %s", limit, err.code, err.msg);
        memory_set_budget(0);
        CHECK(loaded || !scene.arena.blocks, "%zu bytes: not finished", limit);
        scene_finish(&scene);
    }
    CHECK(loaded, "16 MiB are not enough");
}

// Returns the place of the document's closing brace.
static size_t document_end(const char *text, size_t size)
{
    while (size > 0 && text[size - 1] != '}')
        size--;
    return size;
}

static void cut_scene_everywhere(const char *name)
{
    char source[512], *text = malloc(1 << 20);
    const char *root = getenv("LAMPYRIS_SOURCE_ROOT");
    REQUIRE(text && root, "LAMPYRIS_SOURCE_ROOT is not set");
    char mesh_path[512], path[512];
    snprintf(mesh_path, sizeof mesh_path, "%s", write_text("one.obj", ONE_TRIANGLE));
    snprintf(source, sizeof source, "%s/scenes/%s", root, name);
    FILE *file = fopen(source, "rb");
    REQUIRE(file, "no %s", source);
    size_t size = fread(text, 1, 1 << 20, file);
    fclose(file);
    snprintf(path, sizeof path, "%s", write_bytes("cut.json", text, size));
    const char *const given[] = {"mesh", mesh_path, NULL};
    bool needs_mesh = strcmp(name, "mesh_room.json") == 0;

    size_t end = document_end(text, size);
    for (size_t length = size; length-- > 0;) {
        struct scene scene;
        struct err err = {0};
        CHECK(truncate(path, (off_t)length) == 0);
        bool ok = load_file_with(&scene, path, needs_mesh ? given : NULL, &err);
        CHECK(ok == (length >= end), "%s cut at %zu: %s", name, length, err.msg);
        CHECK(ok || (err.code == ERR_INPUT && err.msg[0]), "%s cut at %zu: code %d", name, length,
              err.code);
        scene_finish(&scene);
    }
    free(text);
}

TEST(scenes_cut_at_every_byte)
{
    cut_scene_everywhere("cornell.json");
    cut_scene_everywhere("furnace.json");
    cut_scene_everywhere("furnace_sky.json");
    cut_scene_everywhere("mesh_room.json");
    cut_scene_everywhere("glow_worms.json");
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(an_empty_document_is_a_scene),
        TEST_CASE(camera),
        TEST_CASE(film_and_settings),
        TEST_CASE(no_fading_by_distance_is_read),
        TEST_CASE(compensated_sums_are_read_as_binned),
        TEST_CASE(materials_keep_their_order),
        TEST_CASE(materials_of_every_model),
        TEST_CASE(materials_like_others),
        TEST_CASE(alpha_blends_what_may_be_transparent),
        TEST_CASE(textures_scale_groups_of_parameters),
        TEST_CASE(lights),
        TEST_CASE(primitives),
        TEST_CASE(transforms_apply_in_their_order),
        TEST_CASE(mesh_files_fit_their_box),
        TEST_CASE(mesh_files_keep_their_materials),
        TEST_CASE(gltf_and_ply_are_meshes_too),
        TEST_CASE(instances_copy_what_stands_in_the_world),
        TEST_CASE(overrides),
        TEST_CASE(overrides_that_are_no_json_are_strings),
        TEST_CASE(paths_confined_to_the_folder),
        TEST_CASE(the_hash_covers_every_input),
        TEST_CASE(memory_limits_are_errors),
        TEST_CASE(scenes_cut_at_every_byte),
    };
    if (!begin_mesh_tests())
        return 1;
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
