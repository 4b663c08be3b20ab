// Pairs of tiny scenes, with and without a single need, show that unnecessary parts are left out:
// the Vulkan objects for the need must exist for the first scene and not for the second, and all
// others must be the same.
#include "flatten/geometry.h"
#include "kernel_fixture.h"
#include "render/probe/replay.h"
#include "scene/sky/ies.h"
#include "shared/sdf.h"

#define BIT(n) (1u << (n))

// The traits of a tiny scene.
#define TRAIT(n) (UINT64_C(1) << (n))
enum {
    QUAD = TRAIT(0),
    SPHERE = TRAIT(1),
    DISC = TRAIT(2),
    SMOOTH = TRAIT(3),        // the quad has normals
    MIRROR_QUAD = TRAIT(4),   // the quad is a mirror, not diffuse
    MIRROR_SPHERE = TRAIT(5), // the sphere is a mirror, not diffuse
    BRIGHT_QUAD = TRAIT(6),   // the quad emits
    BRIGHT_SPHERE = TRAIT(7), // the sphere emits
    BRIGHT_DISC = TRAIT(8),   // the disc emits
    SKY = TRAIT(9),           // a constant environment
    SKY_IMAGE = TRAIT(10),    // an environment image
    JITTER = TRAIT(11),
    ROULETTE = TRAIT(12),
    ONLY_BSDF = TRAIT(13),
    ONLY_NEE = TRAIT(14),
    NO_BOUNCE = TRAIT(15),
    SPARE_MIRROR = TRAIT(16), // a material without a surface
    LAMP = TRAIT(17),         // a point light
    PRINCIPLED_SPHERE = TRAIT(18),
    GLASS_SPHERE = TRAIT(19),
    PHONG_SPHERE = TRAIT(20),
    THIN = TRAIT(21),          // all surfaces are thin
    UVS = TRAIT(22),           // the quad has two sets of texture coordinates
    COLORS = TRAIT(23),        // the quad has vertex colours
    BRUSHED_QUAD = TRAIT(24),  // the quad is anisotropic
    TEXTURE = TRAIT(25),       // all surfaces have a texture of 8-bit codes
    FLOAT_TEXTURE = TRAIT(26), // all surfaces have a texture of floats
    TEXTURE_1 = TRAIT(27),     // all surfaces have a texture with the second set of coordinates
    NORMAL_MAP = TRAIT(28),
    MASK = TRAIT(29), // all surfaces have an alpha mask
    LENS = TRAIT(32),
    TILES = TRAIT(31), // tiles have numbers of samples of their own
    NEE_DEPTH = TRAIT(40),
    CLAMP = TRAIT(41),
    MIN_DENSITY = TRAIT(30),
    SPLIT = TRAIT(55),   // paths split at their first vertex
    PROFILE = TRAIT(42), // the lamp has an IES profile
    SUN = TRAIT(43),     // a directional light with an angular diameter
    PLACED = TRAIT(44),  // the quad is an instance with a space of its own
    PLANE = TRAIT(45),
    SHEET = TRAIT(46), // an analytic quad
    BOX = TRAIT(47),
    CYLINDER = TRAIT(48),
    TUBE = TRAIT(49),
    GLOBE = TRAIT(50),         // a sphere of 1e6 m
    BRIGHT_SHAPES = TRAIT(51), // sheet, box, cylinder and open cylinder emit
    FIELD = TRAIT(52),         // a distance field
    FAR = TRAIT(53),           // the camera is 1e6 times as far away
    TINY = TRAIT(54),          // the quad is 2e-7 m large, and 0.3 m away
};

static void *present(void *memory)
{
    if (!memory) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return memory;
}

// Appends a texture of one texel, white or a normal straight up.
static void add_texture(struct scene *scene, struct material *material, bool is_float,
                        uint32_t flags)
{
    static const uint8_t codes[4] = {128, 128, 255, 255};
    static const float floats[4] = {0.5f, 0.5f, 1, 1};
    static float values[256][4];
    uint32_t image;
    struct texture_image *added = present(scene_add_image(scene, &image));
    *added = (struct texture_image){
        .name = "texel", .width = 1, .height = 1, .hash = image, .green = {0, 1}};
    for (int i = 0; i < 256; i++)
        for (int c = 0; c < 4; c++)
            values[i][c] = (float)i / 255;
    added->texels = is_float ? (const void *)floats : (const void *)codes;
    added->values = is_float ? NULL : (const float(*)[4])values;
    memcpy(added->mean, floats, sizeof floats);
    uint32_t index;
    struct texture *texture = present(scene_add_texture(scene, &index));
    *texture =
        (struct texture){.image = image, .flags = flags, .transform = {{1, 0, 0}, {0, 1, 0}}};
    if (material->texture_count++ == 0)
        material->first_texture = index;
}

static void add_textures(struct scene *scene, uint64_t has, struct material *material)
{
    // Red, green and blue scale the base colour.
    const uint32_t base = TEXTURE_USE_SCALE << TEXTURE_USE_SHIFT |
                          GROUP_BASE << TEXTURE_GROUP_SHIFT | 7u << TEXTURE_MASK_SHIFT |
                          0x24u << TEXTURE_CHANNELS_SHIFT;
    if (has & TEXTURE)
        add_texture(scene, material, false, base);
    if (has & FLOAT_TEXTURE)
        add_texture(scene, material, true, base);
    if (has & TEXTURE_1)
        add_texture(scene, material, false, base | TEXTURE_UV1);
    if (has & NORMAL_MAP)
        add_texture(scene, material, false, TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT);
}

// Makes the material of a part, with this `model`; it emits if `bright` is among the traits.
static uint32_t make_material(struct scene *scene, uint64_t has, uint32_t model, uint64_t bright)
{
    struct material material;
    material_init(&material);
    material.model = model;
    material.flags |= has & THIN ? MATERIAL_THIN : 0u;
    material.flags |= has & MASK ? MATERIAL_ALPHA_MASK : 0u;
    material.base_color[0] = 0.7f;
    for (int c = 0; c < 3 && (has & bright); c++)
        material.emission[c] = 2;
    if (model == MATERIAL_PRINCIPLED && (has & BRUSHED_QUAD))
        material.metallic = material.anisotropic = 0.5f;
    add_textures(scene, has, &material);
    return add_material(scene, &material);
}

static void add_quad(struct scene *scene, uint64_t has, uint32_t material)
{
    static const float quad[2][3][3] = {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}},
                                        {{-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}};
    static const float normals[2][3][3] = {{{-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}},
                                           {{-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {-0.6f, 0, 0.8f}}};
    static float uvs[6][2], colors[6][4];
    add_smooth_triangles(scene, quad, has & SMOOTH ? normals : NULL, 2, material);
    struct mesh *mesh = &scene->meshes[scene->mesh_count - 1];
    for (int v = 0; v < 6; v++) {
        for (int c = 0; c < 2; c++)
            uvs[v][c] = quad[v / 3][v % 3][c];
        for (int c = 0; c < 4; c++)
            colors[v][c] = (float)(v + c + 1) / 10;
    }
    for (int c = 0; c < 3 && has & TINY; c++) {
        struct instance *instance = &scene->instances[scene->instance_count - 1];
        instance->transform[c][c] = 1e-7;
        instance->transform[c][3] = 0.3;
    }
    if (has & UVS)
        mesh->uvs[0] = mesh->uvs[1] = uvs;
    if (has & COLORS)
        mesh->colors = colors;
}

static uint32_t sphere_model(uint64_t has)
{
    return has & MIRROR_SPHERE       ? MATERIAL_MIRROR
           : has & PRINCIPLED_SPHERE ? MATERIAL_PRINCIPLED
           : has & GLASS_SPHERE      ? MATERIAL_DIELECTRIC
           : has & PHONG_SPHERE      ? MATERIAL_PHONG
                                     : MATERIAL_LAMBERT;
}

// A constant profile with two angles.
static float profile_values[4] = {0, 180, 1, 1};
static const struct light_profile profile = {
    .vertical_count = 2,
    .horizontal_count = 1,
    .vertical = profile_values,
    .relative = profile_values + 2,
    .solid_angle = 4 * M_PI,
};

static void add_shape(struct scene *scene, uint64_t has, uint64_t trait, enum shape_kind kind,
                      double x)
{
    if (!(has & trait))
        return;
    uint32_t material = make_material(scene, has, MATERIAL_LAMBERT, BRIGHT_SHAPES);
    *(struct shape *)present(scene_add_shape(scene, NULL)) = (struct shape){
        .kind = kind,
        .material = material,
        .center = {x, -0.6, 0.5},
        .normal = {0, 1, 0},
        .radius = 0.2,
        .axes = {{0, 0.2, 0}, {kind < SHAPE_CYLINDER ? 0.2 : 1, 0, 0}, {0, 0, -0.2}}};
}

// Adds a ball of 0.2 m as a distance field.
static void add_field(struct scene *scene, uint64_t has)
{
    static struct gpu_sdf_instruction code = {.op = SDF_SPHERE, .a = {0.2f}};
    uint32_t index;
    struct sdf *sdf = present(scene_add_sdf(scene, &index));
    *sdf = (struct sdf){.min = {-0.2, -0.2, -0.2},
                        .max = {0.2, 0.2, 0.2},
                        .code = &code,
                        .count = 1,
                        .lipschitz = 1,
                        .magnitude = 0.2};
    add_shape(scene, has, FIELD, SHAPE_SDF, 0);
    struct shape *shape = &scene->shapes[scene->shape_count - 1];
    shape->axes[1][0] = 0.2;
    shape->sdf = index;
}

static void add_shapes(struct scene *scene, uint64_t has)
{
    if (has & FIELD)
        add_field(scene, has);
    add_shape(scene, has & ~(uint64_t)BRIGHT_SHAPES, PLANE, SHAPE_PLANE, 0);
    add_shape(scene, has, SHEET, SHAPE_QUAD, -0.6);
    add_shape(scene, has, BOX, SHAPE_BOX, -0.2);
    add_shape(scene, has, CYLINDER, SHAPE_CYLINDER, 0.2);
    add_shape(scene, has, TUBE, SHAPE_TUBE, 0.6);
    if (has & GLOBE)
        add_sphere(scene, (double[3]){0, -1e6 - 1, 0}, 1e6,
                   make_material(scene, has, MATERIAL_LAMBERT, 0));
}

static void make_scene(uint64_t has, struct scene *scene)
{
    scene_start(scene, 16, 16);
    if (has & QUAD) {
        uint32_t model = has & MIRROR_QUAD    ? MATERIAL_MIRROR
                         : has & BRUSHED_QUAD ? MATERIAL_PRINCIPLED
                                              : MATERIAL_LAMBERT;
        add_quad(scene, has, make_material(scene, has, model, BRIGHT_QUAD));
    }
    if (has & SPHERE)
        add_sphere(scene, (double[3]){0.3, 0.2, 1}, 0.4,
                   make_material(scene, has, sphere_model(has), BRIGHT_SPHERE));
    if (has & DISC)
        add_disc(scene, (double[3]){-0.5, 0.8, 1}, (double[3]){1, -1, 1}, 0.3,
                 make_material(scene, has, MATERIAL_LAMBERT, BRIGHT_DISC));
    add_shapes(scene, has);
    if (has & SPARE_MIRROR)
        add_material(scene, &(struct material){.name = "spare", .model = MATERIAL_MIRROR});
    if (has & PROFILE)
        scene->profiles = &profile;
    if (has & LAMP)
        *(struct light *)present(scene_add_light(scene, NULL)) =
            (struct light){.name = "lamp",
                           .kind = LIGHT_POINT,
                           .position = {1, 2, 3},
                           .radiant = {5, 5, 5},
                           .range = INFINITY,
                           .profile = scene->profiles};
    if (has & SUN)
        *(struct light *)present(scene_add_light(scene, NULL)) =
            (struct light){.name = "sun",
                           .kind = LIGHT_DIRECTIONAL,
                           .direction = {0, 0, -1},
                           .radiant = {5, 5, 5},
                           .range = INFINITY,
                           .angular_radius = 0.1};
    if (has & SKY)
        scene->environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    if (has & SKY_IMAGE)
        add_environment_image(scene, 4, 2);
    struct settings *settings = &scene->settings;
    settings->pixel_jitter = has & JITTER;
    scene->cameras[0].lens_radius = has & LENS ? 0.1 : 0.0;
    scene->cameras[0].focus_distance = has & LENS ? 2.0 : 0.0;
    for (int c = 0; c < 3; c++)
        scene->cameras[0].position[c] -= has & FAR ? 1e6 * scene->cameras[0].direction[c] : 0.0;
    settings->roulette_min_bounces = has & ROULETTE ? 1 : UINT32_MAX;
    settings->max_bounces = has & NO_BOUNCE ? 0 : 4;
    settings->clamp_limit = has & CLAMP ? 2.0f : 0.0f;
    settings->min_density = has & MIN_DENSITY ? 0.01f : 0.0f;
    settings->split_lobes = has & SPLIT ? 1 : 0;
    settings->nee = !(has & ONLY_BSDF);
    settings->nee_depth = has & NEE_DEPTH ? 1 : UINT32_MAX;
    settings->mis = has & ONLY_NEE ? MIS_NONE : MIS_POWER;
}

// The parts of a renderer that were created for a scene.
struct inventory {
    uint64_t features; // of the scene; emitters are from bit 32 on
    uint32_t kernels;  // pipelines, as bits of enum kernel_id
    uint32_t buffers;  // VkBuffers, as bits of bindings
    uint32_t planned;  // bindings in the memory plan, as bits
    uint64_t queue_rows, plan_bytes;
};

#define EMITS(emitter) ((uint64_t)(emitter) << 32)
#define MEETS(geometry) ((uint64_t)(geometry) << 48)

static struct inventory take_inventory(const struct renderer *r)
{
    struct inventory out = {.plan_bytes = r->plan.total_bytes};
    for (uint32_t bit = 0; bit < 32; bit++)
        if (feature_name(BIT(bit)))
            out.features |= r->specialization.features & BIT(bit);
    out.features |= EMITS(r->specialization.emitters) | MEETS(r->specialization.geometry);
    for (int id = 0; id < KERNEL_COUNT; id++)
        out.kernels |= r->kernels[id].pipeline ? BIT(id) : 0;
    for (uint32_t b = 0; b < BINDING_COUNT; b++) {
        bool created = b == BINDING_FILM ? r->film[0].handle : r->buffers[b].handle;
        out.buffers |= created ? BIT(b) : 0;
        out.planned |= r->plan.buffers[b].name ? BIT(b) : 0;
    }
    out.queue_rows = (r->buffers[BINDING_QUEUES].bytes - QUEUES_OFFSET) / (4 * r->plan.wave_slots);
    return out;
}

static bool make(struct gpu *gpu, uint64_t has, bool compile_all, struct inventory *out)
{
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    make_scene(has, &scene);
    const struct renderer_params params = {
        .gpu = gpu,
        .scene = &scene,
        .wave = 1024,
        .compile_all = compile_all,
        .tiles = has & TILES,
        .instancing = has & PLACED ? INSTANCING_ON : INSTANCING_AUTO,
    };
    bool ok = renderer_create(&params, &r, &err);
    CHECK(ok, "%s", err.msg);
    if (ok)
        *out = take_inventory(&r);
    renderer_finish(&r);
    scene_finish(&scene);
    return ok;
}

struct pair {
    const char *name;
    uint64_t with, without;
    // The following parts exist with the need and not without it; all others are the same.
    uint64_t features;
    uint32_t kernels, buffers;
    uint32_t queue_rows;
    uint32_t kernels_instead; // kernels that exist only without the need
};

#define SHADOW_KERNELS BIT(KERNEL_intersect_shadow)
#define SHADOW_BUFFERS (BIT(BINDING_EMITTERS) | BIT(BINDING_SHADOW_RAYS))

static const struct pair pairs[] = {
    {"triangles", QUAD | SPHERE, SPHERE, FEATURE_TRIANGLES, 0, BIT(BINDING_TRIANGLES), 0},
    {"spheres", QUAD | SPHERE, QUAD, MEETS(GEOMETRY_SPHERES), 0, BIT(BINDING_SHAPES), 0},
    {"discs", QUAD | DISC, QUAD, MEETS(GEOMETRY_DISCS), 0, BIT(BINDING_SHAPES), 0},
    {"spheres beside discs", DISC | SPHERE, DISC, MEETS(GEOMETRY_SPHERES), 0, 0, 0},
    {"instances", QUAD | PLACED, QUAD, MEETS(GEOMETRY_INSTANCES), 0, BIT(BINDING_SHAPES), 0},
    {"planes", QUAD | PLANE, QUAD, MEETS(GEOMETRY_PLANES), 0, BIT(BINDING_SHAPES), 0},
    {"quads", DISC | SHEET, DISC, MEETS(GEOMETRY_QUADS), 0, 0, 0},
    {"boxes", DISC | BOX, DISC, MEETS(GEOMETRY_BOXES), 0, 0, 0},
    {"cylinders", DISC | CYLINDER, DISC, MEETS(GEOMETRY_CYLINDERS), 0, 0, 0},
    {"tubes", DISC | TUBE, DISC, MEETS(GEOMETRY_TUBES), 0, 0, 0},
    {"distance fields", DISC | FIELD, DISC, MEETS(GEOMETRY_SDFS), 0, 0, 0},
    {"large spheres", SPHERE | GLOBE, SPHERE, MEETS(GEOMETRY_LARGE_SPHERES), 0, 0, 0},
    {"emissive quads", BRIGHT_SHAPES | BOX | SHEET, BRIGHT_SHAPES | BOX,
     MEETS(GEOMETRY_QUADS) | EMITS(EMITTER_QUADS), 0, 0, 0},
    {"emissive boxes", BRIGHT_SHAPES | SHEET | BOX, BRIGHT_SHAPES | SHEET,
     MEETS(GEOMETRY_BOXES) | EMITS(EMITTER_BOXES), 0, 0, 0},
    {"emissive cylinders", BRIGHT_SHAPES | BOX | CYLINDER, BRIGHT_SHAPES | BOX,
     MEETS(GEOMETRY_CYLINDERS) | EMITS(EMITTER_CYLINDERS), 0, 0, 0},
    {"emissive tubes", BRIGHT_SHAPES | BOX | TUBE, BRIGHT_SHAPES | BOX,
     MEETS(GEOMETRY_TUBES) | EMITS(EMITTER_TUBES), 0, 0, 0},
    {"normals", QUAD | SMOOTH, QUAD, FEATURE_NORMALS, 0, BIT(BINDING_ATTRIBUTES), 0},
    {"diffuse", QUAD | SPHERE | MIRROR_SPHERE, QUAD | MIRROR_QUAD | SPHERE | MIRROR_SPHERE, 0, 0, 0,
     0},
    {"diffuse to connect with", QUAD | SPHERE | BRIGHT_SPHERE | MIRROR_SPHERE,
     QUAD | MIRROR_QUAD | SPHERE | BRIGHT_SPHERE | MIRROR_SPHERE, FEATURE_NEE, SHADOW_KERNELS,
     SHADOW_BUFFERS, 1},
    {"mirror", QUAD | SPHERE | MIRROR_SPHERE, QUAD | SPHERE | SPARE_MIRROR, 0, 0, 0, 0},
    {"emissive triangles", QUAD | BRIGHT_QUAD, QUAD,
     FEATURE_EMISSION | EMITS(EMITTER_TRIANGLES) | FEATURE_NEE, SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"emissive spheres", QUAD | SPHERE | BRIGHT_SPHERE, QUAD | SPHERE,
     FEATURE_EMISSION | EMITS(EMITTER_SPHERES) | FEATURE_NEE, SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"emissive discs", QUAD | DISC | BRIGHT_DISC, QUAD | DISC,
     FEATURE_EMISSION | EMITS(EMITTER_DISCS) | FEATURE_NEE, SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"emissive triangles beside spheres", QUAD | BRIGHT_QUAD | SPHERE | BRIGHT_SPHERE,
     QUAD | SPHERE | BRIGHT_SPHERE, EMITS(EMITTER_TRIANGLES), 0, 0, 0},
    {"small triangles", QUAD | BRIGHT_QUAD | DISC | TINY, QUAD | BRIGHT_QUAD | DISC,
     MEETS(GEOMETRY_SMALL_TRIANGLES), 0, 0, 0},
    {"emissive spheres beside triangles", QUAD | BRIGHT_QUAD | SPHERE | BRIGHT_SPHERE,
     QUAD | BRIGHT_QUAD | SPHERE, EMITS(EMITTER_SPHERES), 0, 0, 0},
    {"emissive discs beside triangles", QUAD | BRIGHT_QUAD | DISC | BRIGHT_DISC,
     QUAD | BRIGHT_QUAD | DISC, EMITS(EMITTER_DISCS), 0, 0, 0},
    {"next-event estimation", QUAD | BRIGHT_QUAD, QUAD | BRIGHT_QUAD | ONLY_BSDF, FEATURE_NEE,
     SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"a bounce to connect from", QUAD | BRIGHT_QUAD, QUAD | BRIGHT_QUAD | NO_BOUNCE, FEATURE_NEE,
     SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"emitters hit by the BSDF", QUAD | BRIGHT_QUAD, QUAD | BRIGHT_QUAD | ONLY_NEE,
     FEATURE_BSDF_HITS_EMITTERS, 0, 0, 0},
    {"environment", QUAD | SKY, QUAD, FEATURE_ENVIRONMENT, BIT(KERNEL_shade_miss), 0, 1},
    {"environment image", QUAD | SKY_IMAGE | ONLY_BSDF, QUAD | SKY | ONLY_BSDF,
     FEATURE_ENVIRONMENT_IMAGE, 0, BIT(BINDING_ENVIRONMENT), 0},
    {"environment to connect to", QUAD | SKY_IMAGE, QUAD | SKY_IMAGE | ONLY_BSDF,
     EMITS(EMITTER_ENVIRONMENT) | FEATURE_NEE, SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"suns", QUAD | SUN, QUAD, EMITS(EMITTER_SUNS) | FEATURE_NEE | FEATURE_ENVIRONMENT,
     SHADOW_KERNELS | BIT(KERNEL_shade_miss), SHADOW_BUFFERS, 2},
    {"roulette", QUAD | ROULETTE, QUAD, FEATURE_ROULETTE, 0, 0, 0},
    {"shadow rays by depth", QUAD | BRIGHT_QUAD | NEE_DEPTH, QUAD | BRIGHT_QUAD, FEATURE_NEE_DEPTH,
     0, 0, 0},
    {"clamp", QUAD | CLAMP, QUAD, FEATURE_CLAMP, 0, 0, 0},
    {"least density", QUAD | MIN_DENSITY, QUAD, FEATURE_MIN_DENSITY, 0, 0, 0},
    {"split lobes", SPHERE | PRINCIPLED_SPHERE | SPLIT, SPHERE | PRINCIPLED_SPHERE,
     FEATURE_SPLIT_LOBES, 0, 0, 0},
    {"lobes of two parts", SPHERE | PRINCIPLED_SPHERE | SPLIT, SPHERE | SPLIT, FEATURE_SPLIT_LOBES,
     0, 0, 0},
    {"lens", QUAD | LENS, QUAD, FEATURE_LENS, 0, 0, 0},
    {"far camera", QUAD | FAR, QUAD, FEATURE_FAR_CAMERA, 0, 0, 0},
    {"jitter", QUAD | JITTER, QUAD, FEATURE_JITTER, 0, 0, 0},
    {"tiles", QUAD | TILES, QUAD, FEATURE_TILES, 0, 0, 2},
    {"point lights", QUAD | LAMP, QUAD, EMITS(EMITTER_LIGHTS) | FEATURE_NEE, SHADOW_KERNELS,
     SHADOW_BUFFERS, 1},
    {"photometric profiles", QUAD | LAMP | PROFILE, QUAD | LAMP, EMITS(EMITTER_PROFILES), 0, 0, 0},
    {"point lights beside triangles", QUAD | BRIGHT_QUAD | LAMP, QUAD | BRIGHT_QUAD,
     EMITS(EMITTER_LIGHTS), 0, 0, 0},
    {"classes", QUAD | SPHERE | PRINCIPLED_SPHERE, QUAD | SPHERE, FEATURE_CLASSES,
     BIT(KERNEL_shade_diffuse) | BIT(KERNEL_shade_principled), 0, 1, BIT(KERNEL_shade_surface)},
    {"a class of its own", SPHERE | GLASS_SPHERE | THIN, SPHERE, 0, 0, 0, 0},
    {"two classes, none diffuse", QUAD | BRUSHED_QUAD | SPHERE | PHONG_SPHERE,
     QUAD | BRUSHED_QUAD | SPHERE | PRINCIPLED_SPHERE, FEATURE_CLASSES,
     BIT(KERNEL_shade_principled) | BIT(KERNEL_shade_classical), 0, 1, BIT(KERNEL_shade_surface)},
    {"textures", QUAD | UVS | TEXTURE, QUAD | UVS,
     FEATURE_TEXTURES | FEATURE_TEXELS_CODES | FEATURE_UV0, 0,
     BIT(BINDING_TEXELS) | BIT(BINDING_ATTRIBUTES), 0},
    {"textures of shapes", SPHERE | TEXTURE, SPHERE, FEATURE_TEXTURES | FEATURE_TEXELS_CODES, 0,
     BIT(BINDING_TEXELS), 0},
    {"float textures", SPHERE | TEXTURE | FLOAT_TEXTURE, SPHERE | TEXTURE, FEATURE_TEXELS_FLOAT, 0,
     0, 0},
    {"8-bit textures", SPHERE | TEXTURE | FLOAT_TEXTURE, SPHERE | FLOAT_TEXTURE,
     FEATURE_TEXELS_CODES, 0, 0, 0},
    {"texture coordinates", QUAD | UVS | TEXTURE, QUAD | TEXTURE, FEATURE_UV0, 0,
     BIT(BINDING_ATTRIBUTES), 0},
    {"second texture coordinates", QUAD | UVS | TEXTURE | TEXTURE_1, QUAD | UVS | TEXTURE,
     FEATURE_UV1, 0, 0, 0},
    {"normal maps", SPHERE | TEXTURE | NORMAL_MAP, SPHERE | TEXTURE, FEATURE_NORMAL_MAPS, 0, 0, 0},
    {"tangents", QUAD | BRUSHED_QUAD | UVS, QUAD | BRUSHED_QUAD, FEATURE_TANGENTS, 0,
     BIT(BINDING_ATTRIBUTES), 0},
    {"colours", QUAD | COLORS, QUAD, FEATURE_COLORS, 0, BIT(BINDING_ATTRIBUTES), 0},
    {"alpha", QUAD | MASK, QUAD, FEATURE_ALPHA, 0, 0, 0},
    {"media", SPHERE | GLASS_SPHERE, SPHERE | GLASS_SPHERE | THIN, FEATURE_MEDIA, 0, 0, 0},
    {"surfaces", QUAD | SKY, SKY, FEATURE_TRIANGLES, BIT(KERNEL_shade_surface),
     BIT(BINDING_TRIANGLES) | BIT(BINDING_MATERIALS), 0},
    {"anything to see", SKY, 0, FEATURE_ENVIRONMENT,
     BIT(KERNEL_shade_miss) | BIT(KERNEL_intersect_closest), 0, 1},
};

static void check_pair(struct gpu *gpu, const struct pair *pair)
{
    struct inventory with, without;
    if (!make(gpu, pair->with, false, &with) || !make(gpu, pair->without, false, &without))
        return;
    CHECK(with.features == (without.features | pair->features) &&
              !(without.features & pair->features),
          "%s: features 0x%llx and 0x%llx", pair->name, (unsigned long long)with.features,
          (unsigned long long)without.features);
    uint32_t kept = without.kernels & ~pair->kernels_instead;
    CHECK(with.kernels == (kept | pair->kernels) && !(without.kernels & pair->kernels) &&
              kept + pair->kernels_instead == without.kernels,
          "%s: kernels 0x%x and 0x%x", pair->name, with.kernels, without.kernels);
    CHECK(with.buffers == (without.buffers | pair->buffers) && !(without.buffers & pair->buffers),
          "%s: buffers 0x%x and 0x%x", pair->name, with.buffers, without.buffers);
    CHECK(with.planned == with.buffers && without.planned == without.buffers,
          "%s: plan 0x%x, 0x%x; buffers 0x%x, 0x%x", pair->name, with.planned, without.planned,
          with.buffers, without.buffers);
    CHECK(with.queue_rows == without.queue_rows + pair->queue_rows, "%s: %llu and %llu queues",
          pair->name, (unsigned long long)with.queue_rows, (unsigned long long)without.queue_rows);
    bool shrinks = pair->buffers || pair->queue_rows;
    CHECK(!shrinks || with.plan_bytes > without.plan_bytes, "%s: %llu bytes planned, not fewer",
          pair->name, (unsigned long long)without.plan_bytes);

    printf("  %-34s %d kernels, %8lld bytes fewer", pair->name, __builtin_popcount(pair->kernels),
           (long long)(with.plan_bytes - without.plan_bytes));
    for (uint32_t bit = 0; bit < 32; bit++)
        if (pair->features >> bit & 1u)
            printf(", %s", feature_name(BIT(bit)));
    for (uint32_t bit = 0; bit < 16; bit++) {
        if (pair->features & EMITS(BIT(bit)))
            printf(", %s", emitter_name(BIT(bit)));
        if (pair->features & MEETS(BIT(bit)))
            printf(", %s", geometry_name(BIT(bit)));
    }
    putchar('\n');
}

TEST(each_need)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        check_pair(&gpu, &pairs[i]);
    gpu_close(&gpu);
}

// Bits of the geometry for which there are pairs.
#define GEOMETRY_PAIRED                                                                            \
    (GEOMETRY_SHAPES | GEOMETRY_LARGE_SPHERES | GEOMETRY_INSTANCES | GEOMETRY_SMALL_TRIANGLES)

static uint64_t named_bits(void)
{
    uint64_t named = MEETS(GEOMETRY_PAIRED);
    for (uint32_t bit = 0; bit < 32; bit++) {
        named |= feature_name(BIT(bit)) ? BIT(bit) : 0;
        named |= emitter_name(BIT(bit)) ? EMITS(BIT(bit)) : 0;
    }
    return named;
}

// Every feature with a name must be removed by some pair.
TEST(no_feature_is_forgotten)
{
    uint64_t seen = 0, named = named_bits();
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        seen |= pairs[i].features;
    CHECK(seen == named, "tested 0x%llx, named 0x%llx", (unsigned long long)seen,
          (unsigned long long)named);
}

// Features that process data which scenes may lack; these are not compiled in on request.
#define WITH_DATA                                                                                  \
    (FEATURE_CLASSES | FEATURE_TEXTURES | FEATURE_TEXELS_FLOAT | FEATURE_TEXELS_CODES |            \
     FEATURE_UV0 | FEATURE_UV1 | FEATURE_TANGENTS | FEATURE_COLORS | FEATURE_ALPHA |               \
     FEATURE_NORMAL_MAPS | FEATURE_TILES)
// Kernels of other integrators.
#define OTHER_KERNELS                                                                              \
    (BIT(KERNEL_shade_ao) | BIT(KERNEL_shade_whitted) | BIT(KERNEL_generate_light_rays) |          \
     BIT(KERNEL_shade_light) | BIT(KERNEL_intersect_camera) | BIT(KERNEL_add_splats))
#define SORT_KERNELS (BIT(KERNEL_sort_count) | BIT(KERNEL_sort_scan) | BIT(KERNEL_sort_scatter))
#define CLASS_KERNELS (((1u << CLASS_COUNT) - 1u) << KERNEL_shade_diffuse)

TEST(everything_is_created_on_demand)
{
    const uint64_t data = QUAD | UVS | COLORS | TEXTURE | FLOAT_TEXTURE | TEXTURE_1 | NORMAL_MAP |
                          MASK | SPHERE | PRINCIPLED_SPHERE | TILES;
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    struct inventory empty, all, full;
    if (make(&gpu, 0, false, &empty) && make(&gpu, JITTER, true, &all) &&
        make(&gpu, JITTER | data, true, &full)) {
        const uint64_t by_shape = MEETS(GEOMETRY_SDFS | GEOMETRY_LARGE_SPHERES |
                                        GEOMETRY_INSTANCES | GEOMETRY_SMALL_TRIANGLES);
        // A feature that a setting selects, and one that doubles the code.
        uint64_t by_setting = FEATURE_SPLIT_LOBES;
        uint64_t named = named_bits() & ~by_shape & ~by_setting;
        uint32_t buffers = (BIT(BINDING_COUNT) - 1) & ~(BIT(BINDING_SUSPENDED) | BIT(BINDING_SORT));
        CHECK(all.kernels == (BIT(KERNEL_COUNT) - 1) - CLASS_KERNELS - OTHER_KERNELS - SORT_KERNELS,
              "kernels 0x%x", all.kernels);
        CHECK(all.buffers == (buffers & ~BIT(BINDING_TEXELS)), "buffers 0x%x", all.buffers);
        CHECK(all.features == (named & ~(uint64_t)WITH_DATA), "features 0x%llx",
              (unsigned long long)all.features);
        CHECK(all.queue_rows == 5 && empty.queue_rows == 3, "%llu and %llu queues",
              (unsigned long long)all.queue_rows, (unsigned long long)empty.queue_rows);
        CHECK(full.features == named && full.buffers == buffers, "features 0x%llx, buffers 0x%x",
              (unsigned long long)full.features, full.buffers);
        CHECK(full.queue_rows == 8, "%llu queues", (unsigned long long)full.queue_rows);
    }
    gpu_close(&gpu);
}

// --- lobes ---------------------------------------------------------------------------------------

// A material, and the lobes that shading needs for it.
struct lobe_case {
    uint32_t model, flags, parameter; // a single parameter differs from its default
    float value;
    uint32_t lobes;
};

#define ROUGH_PRINCIPLED (LOBE_PRINCIPLED | LOBE_BURLEY | LOBE_ROUGH | LOBE_COMPENSATE)

static const struct lobe_case lobe_cases[] = {
    {MATERIAL_LAMBERT, 0, 0, 0, LOBE_LAMBERT},
    {MATERIAL_MIRROR, 0, 0, 0, LOBE_MIRROR},
    {MATERIAL_PHONG, 0, 0, 0, LOBE_PHONG},
    {MATERIAL_BLINN_PHONG, 0, 0, 0, LOBE_BLINN_PHONG},
    {MATERIAL_MICROFACET, 0, 0, 0, LOBE_MICROFACET | LOBE_ROUGH},
    {MATERIAL_MICROFACET, MATERIAL_SEPARABLE, 0, 0, LOBE_MICROFACET | LOBE_ROUGH | LOBE_SEPARABLE},
    {MATERIAL_MICROFACET, MASKING_RATIONAL << MATERIAL_MASKING_SHIFT, 0, 0,
     LOBE_MICROFACET | LOBE_ROUGH},
    {MATERIAL_MICROFACET, MASKING_SCHLICK << MATERIAL_MASKING_SHIFT, 0, 0,
     LOBE_MICROFACET | LOBE_ROUGH | LOBE_MASKINGS},
    {MATERIAL_MICROFACET, MASKING_RATIONAL_UNBOUNDED << MATERIAL_MASKING_SHIFT, 0, 0,
     LOBE_MICROFACET | LOBE_ROUGH | LOBE_MASKINGS},
    {MATERIAL_MICROFACET, MATERIAL_UNCOUPLED, 0, 0, LOBE_MICROFACET | LOBE_ROUGH | LOBE_UNCOUPLED},
    {MATERIAL_DIELECTRIC, 0, 0, 0, LOBE_DIELECTRIC | LOBE_ROUGH},
    {MATERIAL_DIELECTRIC, 0, PARAMETER_ROUGHNESS, 0, LOBE_DIELECTRIC | LOBE_DELTA},
    {MATERIAL_DIELECTRIC, MATERIAL_COMPENSATE, 0, 0,
     LOBE_DIELECTRIC | LOBE_ROUGH | LOBE_COMPENSATE},
    {MATERIAL_DIELECTRIC, MATERIAL_COMPENSATE, PARAMETER_ROUGHNESS, 0,
     LOBE_DIELECTRIC | LOBE_DELTA},
    {MATERIAL_DIELECTRIC, 0, PARAMETER_DISPERSION, 1,
     LOBE_DIELECTRIC | LOBE_ROUGH | LOBE_DISPERSION},
    {MATERIAL_DIELECTRIC, MATERIAL_THIN, 0, 0, LOBE_DIELECTRIC | LOBE_ROUGH | LOBE_THIN},
    {MATERIAL_DIELECTRIC, MATERIAL_SEPARABLE, 0, 0, LOBE_DIELECTRIC | LOBE_ROUGH | LOBE_SEPARABLE},
    {MATERIAL_CONDUCTOR, 0, 0, 0, LOBE_CONDUCTOR | LOBE_ROUGH},
    {MATERIAL_CONDUCTOR, MATERIAL_COMPENSATE, 0, 0, LOBE_CONDUCTOR | LOBE_ROUGH | LOBE_COMPENSATE},
    {MATERIAL_PRINCIPLED, 0, 0, 0, LOBE_PRINCIPLED | LOBE_BURLEY | LOBE_ROUGH},
    {MATERIAL_PRINCIPLED, MATERIAL_GLTF_LAYERS, 0, 0, LOBE_PRINCIPLED | LOBE_GLTF | LOBE_ROUGH},
    {MATERIAL_PRINCIPLED, MATERIAL_GLTF_LAYERS, PARAMETER_SPECULAR_WEIGHT, 0, LOBE_LAMBERT},
    {MATERIAL_PRINCIPLED, 0, PARAMETER_SPECULAR_WEIGHT, 0,
     LOBE_PRINCIPLED | LOBE_BURLEY | LOBE_ROUGH},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE, 0, 0, ROUGH_PRINCIPLED},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE, PARAMETER_ROUGHNESS, 0,
     LOBE_PRINCIPLED | LOBE_BURLEY | LOBE_DELTA | LOBE_COMPENSATE},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE, PARAMETER_METALLIC, 0.5f,
     ROUGH_PRINCIPLED | LOBE_METAL},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE, PARAMETER_SUBSURFACE, 0.5f,
     ROUGH_PRINCIPLED | LOBE_SUBSURFACE},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE, PARAMETER_SHEEN, 0.5f,
     ROUGH_PRINCIPLED | LOBE_SHEEN},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE, PARAMETER_SHEEN_COLOR + 2, 0.5f,
     ROUGH_PRINCIPLED | LOBE_CHARLIE},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE, PARAMETER_CLEARCOAT, 0.5f,
     ROUGH_PRINCIPLED | LOBE_CLEARCOAT},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE | MATERIAL_COAT_GGX, PARAMETER_CLEARCOAT, 0.5f,
     ROUGH_PRINCIPLED | LOBE_CLEARCOAT | LOBE_DELTA},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE | MATERIAL_EXACT_COAT, PARAMETER_CLEARCOAT, 0.5f,
     ROUGH_PRINCIPLED | LOBE_CLEARCOAT | LOBE_EXACT_COAT},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE | MATERIAL_EXACT_COAT, 0, 0, ROUGH_PRINCIPLED},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE | MATERIAL_MIXED_FRESNEL, 0, 0,
     ROUGH_PRINCIPLED | LOBE_MIXED_FRESNEL},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE, PARAMETER_TRANSMISSION, 0.5f,
     ROUGH_PRINCIPLED | LOBE_TRANSMISSION},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE, PARAMETER_ANISOTROPIC, 0.5f,
     ROUGH_PRINCIPLED | LOBE_ANISOTROPIC},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE, PARAMETER_IRIDESCENCE, 0.5f,
     ROUGH_PRINCIPLED | LOBE_IRIDESCENCE},
    {MATERIAL_PRINCIPLED, MATERIAL_COMPENSATE | MATERIAL_THIN, PARAMETER_DIFFUSE_TRANSMISSION, 0.5f,
     ROUGH_PRINCIPLED | LOBE_THIN | LOBE_DIFFUSE_TRANSMISSION},
};

// Returns the lobes of a scene with one sphere of that material.
static uint32_t lobes_of(struct gpu *gpu, const struct lobe_case *c)
{
    struct scene scene;
    struct arena arena = {0};
    struct flat_scene flat;
    struct bvh bvh;
    struct err err = {0};
    struct material material;
    material_init(&material);
    material.model = c->model;
    material.flags = c->flags;
    if (c->parameter || c->value > 0.0f)
        material.parameters[c->parameter] = c->value;
    scene_start(&scene, 16, 16);
    add_sphere(&scene, (double[3]){0}, 1, add_material(&scene, &material));
    uint32_t lobes = 0;
    bool ok =
        geometry_prepare(&(struct geometry_params){.scene = &scene}, &arena, &flat, &bvh, &err);
    CHECK(ok, "%s", err.msg);
    if (ok)
        lobes = specialize(&(struct specialize_params){.scene = &scene,
                                                       .flat = &flat,
                                                       .bvh = &bvh,
                                                       .gpu = gpu,
                                                       .camera = &scene.cameras[0]})
                    .lobes;
    arena_finish(&arena);
    scene_finish(&scene);
    return lobes;
}

// A material has exactly the lobes that it needs. Each lobe with a name is needed by some material.
TEST(lobes)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    uint32_t seen = 0, named = 0;
    for (size_t i = 0; i < sizeof lobe_cases / sizeof lobe_cases[0]; i++) {
        uint32_t lobes = lobes_of(&gpu, &lobe_cases[i]);
        CHECK(lobes == lobe_cases[i].lobes, "case %zu: lobes 0x%x, not 0x%x", i, lobes,
              lobe_cases[i].lobes);
        seen |= lobe_cases[i].lobes;
    }
    for (uint32_t bit = 0; bit < 32; bit++)
        named |= lobe_name(BIT(bit)) ? BIT(bit) : 0;
    CHECK(seen == named, "tested 0x%x, named 0x%x", seen, named);
    gpu_close(&gpu);
}

// --- the same picture ----------------------------------------------------------------------------

static bool render(struct gpu *gpu, const struct scene *scene, bool compile_all,
                   struct arena *arena, struct film_image *image)
{
    struct renderer r;
    struct err err = {0};
    const struct renderer_params params = {
        .gpu = gpu, .scene = scene, .wave = 1024, .compile_all = compile_all};
    bool ok = renderer_create(&params, &r, &err) &&
              renderer_render(&r, &(struct render_call){.samples = 8}, &err) &&
              renderer_read(&r, arena, image, &err);
    CHECK(ok, "%s", err.msg);
    renderer_finish(&r);
    return ok;
}

// Compiling unnecessary features in does not change any bit, if the driver compiles the rest
// equally (lavapipe).
TEST(everything_changes_no_bit)
{
    static const uint64_t scenes[] = {
        QUAD | SKY,
        QUAD | BRIGHT_QUAD | JITTER,
        QUAD | SMOOTH | SPHERE | BRIGHT_SPHERE | ROULETTE,
        SPHERE | DISC | BRIGHT_DISC | MIRROR_SPHERE | SKY_IMAGE,
        QUAD | SPHERE | GLASS_SPHERE | SKY | LAMP,
        QUAD | SMOOTH | UVS | SPHERE | GLASS_SPHERE | THIN | SKY | DISC | BRIGHT_DISC,
        QUAD | UVS | TEXTURE | NORMAL_MAP | COLORS | SPHERE | GLASS_SPHERE | SKY | LAMP,
        QUAD | UVS | TEXTURE_1 | FLOAT_TEXTURE | MASK | SPHERE | PHONG_SPHERE | BRIGHT_SPHERE,
        QUAD | SPHERE | PRINCIPLED_SPHERE | SKY | LAMP,
        QUAD | UVS | BRUSHED_QUAD | SPHERE | PRINCIPLED_SPHERE | SKY | LAMP,
    };
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0] && gpu.info.is_cpu; i++) {
        struct scene scene;
        struct arena arena = {0};
        struct film_image lean, full;
        make_scene(scenes[i], &scene);
        if (render(&gpu, &scene, false, &arena, &lean) &&
            render(&gpu, &scene, true, &arena, &full)) {
            size_t size = 16 * 16 * sizeof *lean.half_a;
            CHECK(memcmp(lean.half_a, full.half_a, size) == 0 &&
                      memcmp(lean.half_b, full.half_b, size) == 0,
                  "scene 0x%llx", (unsigned long long)scenes[i]);
        }
        arena_finish(&arena);
        scene_finish(&scene);
    }
    gpu_close(&gpu);
}

// --- suspended traversals ------------------------------------------------------------------------

// There are more identical triangles than a ray's budget. Only then are a buffer and two queues for
// suspended traversals created.
TEST(suspended_traversals_are_made_when_needed)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    static const float triangle[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    scene_start(&scene, 1, 1);
    scene.settings.pixel_jitter = false;
    scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    bool ok = renderer_create(&(struct renderer_params){.gpu = &gpu, .scene = &scene}, &r, &err);
    uint32_t count = ok ? r.specialization.iteration_budget + 1000 : 1;
    renderer_finish(&r);
    float(*triangles)[3][3] = malloc(count * sizeof *triangles);
    for (uint32_t i = 0; triangles && i < count; i++)
        memcpy(triangles[i], triangle, sizeof triangle);
    if (triangles)
        add_triangles(&scene, (const float(*)[3][3])triangles, count, 0);
    ok = ok && triangles &&
         renderer_create(&(struct renderer_params){.gpu = &gpu, .scene = &scene}, &r, &err);
    if (ok) {
        struct inventory before = take_inventory(&r);
        CHECK(!(before.buffers & BIT(BINDING_SUSPENDED)), "created too soon");
        ok = renderer_render(&r, &(struct render_call){.samples = 1}, &err);
        struct inventory after = take_inventory(&r);
        CHECK(after.buffers == (before.buffers | BIT(BINDING_SUSPENDED)), "buffers 0x%x and 0x%x",
              before.buffers, after.buffers);
        CHECK(after.queue_rows == before.queue_rows + 2, "%llu and %llu queues",
              (unsigned long long)before.queue_rows, (unsigned long long)after.queue_rows);
        struct arena arena = {0};
        struct replay path = {0};
        bool followed = renderer_replay(&r, 0, 0, 0, &arena, &path, &err);
        CHECK(followed && path.vertex_count > 0 && path.vertices[0].primitive == 0,
              "not the lowest of the identical triangles");
        arena_finish(&arena);
        CHECK(r.stats.suspended > 0 && r.stats.voided_waves == 1, "%llu suspended",
              (unsigned long long)r.stats.suspended);
    }
    CHECK(ok, "%s", err.msg);
    free(triangles);
    renderer_finish(&r);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(each_need), TEST_CASE(no_feature_is_forgotten), TEST_CASE(lobes),
          TEST_CASE(everything_is_created_on_demand), TEST_CASE(everything_changes_no_bit),
          TEST_CASE(suspended_traversals_are_made_when_needed))
