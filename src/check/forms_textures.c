// Defines cases of textures with long sides, distant coordinates and bright texels
// (docs/verification.md, C31, C32 and C34). The whole floor shows one place of an image in which
// only one texel is not black.
#include "check/case_list.h"
#include "check/closed_form.h"
#include "check/made_mesh.h"
#include <math.h>

// A convex body receives light from the environment only; the texel scales its reflectance.
static double scaled(double rho, double le, double part)
{
    (void)part;
    return rho * le * 0.75;
}
static const char scaled_is[] = "0.75 rho Le";

static double bright(double rho, double le, double factor)
{
    (void)rho;
    return le * factor;
}
static const char bright_is[] = "Le times the texel";

struct image_place {
    uint32_t width, height;
    uint32_t x, y;   // position of the texel that is not black
    float u, v;      // texture coordinates of all vertices
    float value;     // value of the texel
    uint32_t scales; // GROUP_* whose first three parameters the texel scales
};

static bool add_image(struct scene *scene, const struct image_place *p, struct err *err)
{
    uint32_t index, texture_index;
    struct texture_image *image = scene_add_image(scene, &index);
    struct texture *texture = scene_add_texture(scene, &texture_index);
    float(*texels)[4] = arena_alloc(&scene->arena, (uint64_t)p->width * p->height, sizeof *texels);
    if (!image || !texture || !texels)
        return err_memory(err, "texels", (uint64_t)p->width * p->height);
    for (int c = 0; c < 4; c++)
        texels[p->y * p->width + p->x][c] = c < 3 ? p->value : 1;
    *image = (struct texture_image){.name = "made",
                                    .width = p->width,
                                    .height = p->height,
                                    .texels = texels,
                                    .greatest = p->value};
    *texture = (struct texture){.image = index,
                                .flags = TEXTURE_NEAREST | p->scales << TEXTURE_GROUP_SHIFT |
                                         7u << TEXTURE_MASK_SHIFT |
                                         0x24u << TEXTURE_CHANNELS_SHIFT, // channels 0, 1 and 2
                                .transform = {{1}, {0, 1}}};
    for (int c = 0; c < 3; c++)
        image->mean[c] = p->value / (float)(p->width * p->height);
    scene->materials[0].first_texture = texture_index;
    scene->materials[0].texture_count = 1;
    return true;
}

static bool add_place(struct scene *scene, const struct image_place *p, struct err *err)
{
    struct mesh *mesh = made_mesh_add_square(scene, 1, 0, err);
    if (!mesh || !add_image(scene, p, err))
        return false;
    mesh->uvs[0] = arena_alloc(&scene->arena, mesh->vertex_count, sizeof *mesh->uvs[0]);
    if (!mesh->uvs[0])
        return err_memory(err, "coordinates", mesh->vertex_count);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        mesh->uvs[0][i][0] = p->u;
        mesh->uvs[0][i][1] = p->v;
    }
    return true;
}

// Adds an image with a single row (or a single column if `count` is negative), whose last but one
// texel is visible.
static bool add_long(struct scene *scene, double count, struct err *err)
{
    uint32_t side = (uint32_t)fabs(count), at = side > 1 ? side - 2 : 0;
    float middle = ((float)at + 0.5f) / (float)side;
    bool is_row = count > 0;
    const struct image_place p = {.width = is_row ? side : 1,
                                  .height = is_row ? 1 : side,
                                  .x = is_row ? at : 0,
                                  .y = is_row ? 0 : at,
                                  .u = is_row ? middle : 0.5f,
                                  .v = is_row ? 0.5f : middle,
                                  .value = 0.75f};
    return add_place(scene, &p, err);
}

// Uses the texture coordinate `far` + 3/8 with an image of four texels. Such coordinates are exact
// in single precision up to 2^20.
static bool add_far(struct scene *scene, double far, struct err *err)
{
    const struct image_place p = {
        .width = 4, .height = 1, .x = 1, .u = (float)(far + 0.375), .v = 0.5f, .value = 0.75f};
    return add_place(scene, &p, err);
}

// Uses texture coordinates that are not finite, which count as 0.
static bool add_not_finite(struct scene *scene, double u, struct err *err)
{
    const struct image_place p = {
        .width = 4, .height = 4, .u = (float)u, .v = (float)-u, .value = 0.75f};
    return add_place(scene, &p, err);
}

static bool add_bright(struct scene *scene, double value, struct err *err)
{
    const struct image_place p = {.width = 2,
                                  .height = 2,
                                  .u = 0.25f,
                                  .v = 0.25f,
                                  .value = (float)value,
                                  .scales = GROUP_EMISSION};
    for (int c = 0; c < 3; c++) {
        scene->materials[0].base_color[c] = 0;
        scene->materials[0].emission[c] = (float)(1 << c);
    }
    return add_place(scene, &p, err);
}

// clang-format off
#define FLOOR {{"camera", JSON({"type": "orthographic", "position": [0, 0.0005, 0],                \
    "target": [0, 0, 0], "up": [0, 0, 1], "height": 5e-5})},                                       \
    {"environment", JSON({"radiance": [1, 2, 4]})}, {"shapes", "[]"}}
#define TEXTURED(title, parameter, add)                                                            \
    FORM(title, "plane.json", scaled, parameter, WITHOUT_VARIANCE, BSDF_ALONE, FLOOR, 0, add)

static const struct check_case forms[] = {
    TEXTURED("C31 texture of 1 x 1", 1, add_long),
    TEXTURED("C31 texture of 16384 x 1", 16384, add_long),
    TEXTURED("C31 texture of 65535 x 1", 65535, add_long),
    TEXTURED("C31 texture of 1 x 65535", -65535, add_long),
    TEXTURED("C32 coordinates of 1e6", 1e6, add_far),
    TEXTURED("C32 coordinates of -1e6", -1e6, add_far),
    TEXTURED("C32 coordinates that are NaN", NAN, add_not_finite),
    TEXTURED("C32 infinite coordinates", INFINITY, add_not_finite),
    FORM("C34 texel of 4e6", "plane.json", bright, 4e6, WITHOUT_VARIANCE, BSDF_ALONE, FLOOR, 0,
     add_bright),
};
// clang-format on

CHECK_GROUP(check_textures, "textures", "textures: long sides, far coordinates, bright texels",
            forms);
