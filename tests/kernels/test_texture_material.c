// Tests the effect of textures and vertex colours on a material and its shading frame, and the
// attributes stored for them: the renderer's routines against references in double precision.
#include "texture_fixture.h"

enum { COUNT = 20000 };

static union texture_item items[COUNT], inputs[COUNT];

static void widen(const float v[3], double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (double)v[c];
}

static float distance(const float *a, const double *b, int count)
{
    double worst = 0;
    for (int c = 0; c < count; c++)
        worst = fmax(worst, fabs((double)a[c] - b[c]));
    return (float)worst;
}

// --- parameters ----------------------------------------------------------------------------------

// Makes a scene whose material 1 is `material` with the textures that `add` adds; vertex colours
// and both sets of coordinates exist.
static struct scene *begin(struct setup *setup, const struct material *material)
{
    scene_start(&setup->scene, 8, 8);
    add_material(&setup->scene, material);
    add_square(&setup->scene, 1);
    return &setup->scene;
}

static void use_plain(struct scene *scene, uint32_t flags, const float color[4])
{
    add_texture(scene, add_plain_image(scene, color), flags);
}

static bool apply_one(struct setup *setup, uint32_t material)
{
    memset(items, 0, sizeof *items);
    items[0].u[0][0] = material;
    items[0].f[2][2] = 1;
    items[0].f[3][0] = items[0].f[3][3] = 1;
    return texture_run(setup, ROUTINE_APPLY, items, 1);
}

static void check_group(const float got[4], double a, double b, double c, double d)
{
    const double expected[4] = {a, b, c, d};
    CHECK(distance(got, expected, 4) < 1e-6f, "(%.7g, %.7g, %.7g, %.7g), expected (%g, %g, %g, %g)",
          (double)got[0], (double)got[1], (double)got[2], (double)got[3], a, b, c, d);
}

// Vertex colours scale the base colour first.
TEST(textures_scale_groups)
{
    struct setup setup;
    static const float a[4] = {0.5f, 0.25f, 0.125f, 0.75f}, b[4] = {0.5f, 1, 0.0625f, 0.25f};
    struct material m;
    material_init(&m);
    m.roughness = 0.75f;
    m.metallic = 0.5f;
    m.anisotropic = 0.25f;
    m.anisotropic_rotation = 0.125f;
    for (int c = 0; c < 3; c++)
        m.base_color[c] = m.emission[c] = 1;
    struct scene *scene = begin(&setup, &m);
    use_plain(scene, texture_scales(GROUP_BASE, (int[]){0, 1, 2, 3}), a);
    use_plain(scene, texture_scales(GROUP_BASE, (int[]){3, 3, -1, -1}), b);
    // glTF: green is roughness, blue metallic. Gloss in alpha is 1 - roughness.
    use_plain(scene, texture_scales(GROUP_METAL, (int[]){-1, 1, 2, -1}), a);
    use_plain(scene,
              texture_scales(GROUP_METAL, (int[]){-1, 3, -1, -1}) | 2u << TEXTURE_INVERT_SHIFT, b);
    use_plain(scene, texture_scales(GROUP_EMISSION, (int[]){2, 2, 0, -1}), b);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    REQUIRE(apply_one(&setup, 1));
    check_group(items[0].f[0], 0.5 * 0.5 * 0.25, 0.25 * 0.25 * 0.25, 0.125 * 0.125, 0.75 * 0.75);
    check_group(items[0].f[1], 0.25, 1 - (1 - 0.75 * 0.25) * 0.25, 0.5 * 0.125, 0.125);
    check_group(items[0].f[2], 0.0625, 0.0625, 0.5, (double)items[0].f[2][3]);
    setup_close(&setup);
}

// Values above 1 in an HDR image count as 1, except for emission.
TEST(only_emission_is_scaled_up)
{
    struct setup setup;
    static const float bright[4] = {3, 0.5f, 1e6f, 2};
    struct material m;
    material_init(&m);
    for (int c = 0; c < 3; c++)
        m.emission[c] = 2;
    struct scene *scene = begin(&setup, &m);
    scene->meshes[0].colors = NULL;
    use_plain(scene, texture_scales(GROUP_BASE, (int[]){0, 1, 2, 3}), bright);
    use_plain(scene, texture_scales(GROUP_EMISSION, (int[]){0, 1, 2, -1}), bright);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    REQUIRE(apply_one(&setup, 1));
    check_group(items[0].f[0], 0.5, 0.25, 0.5, 1);
    CHECK(items[0].f[2][0] == 6 && items[0].f[2][1] == 1 && items[0].f[2][2] == 2e6f);
    setup_close(&setup);
}

TEST(colors_of_unlit_materials_are_shown)
{
    struct setup setup;
    struct material m;
    material_init(&m);
    m.flags |= MATERIAL_UNLIT;
    for (int c = 0; c < 3; c++)
        m.emission[c] = 2;
    begin(&setup, &m);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    REQUIRE(apply_one(&setup, 1));
    check_group(items[0].f[0], 0.5, 0.5, 0.5, 0.75);
    check_group(items[0].f[2], 1, 0.5, 0.25, (double)items[0].f[2][3]);
    setup_close(&setup);
}

// KHR_materials_anisotropy: the texture's direction is rotated by the material's rotation, and blue
// scales the strength.
TEST(anisotropy)
{
    static const double directions[][2] = {{1, 0.5}, {0.5, 1}, {0, 0.5},
                                           {0.5, 0}, {1, 1},   {0.5, 0.5}};
    static const double turns[] = {0, 0.25, 0.5, -0.25, 0.125, 0};
    for (size_t i = 0; i < sizeof turns / sizeof *turns; i++) {
        struct setup setup;
        struct material m;
        const float color[4] = {(float)directions[i][0], (float)directions[i][1], 0.25f, 1};
        material_init(&m);
        m.model = MATERIAL_PRINCIPLED;
        m.anisotropic = 0.5f;
        m.anisotropic_rotation = 0.0625f;
        use_plain(begin(&setup, &m), TEXTURE_USE_ANISOTROPY << TEXTURE_USE_SHIFT, color);
        OPEN_SETUP(&setup, TEXTURE_SLOTS);
        REQUIRE(apply_one(&setup, 1));
        double turn = (double)items[0].f[1][3] - 0.0625 - turns[i];
        CHECK(items[0].f[1][0] == 0.125f && fabs(turn - round(turn)) < 1e-6, "%g %g",
              (double)items[0].f[1][0], (double)items[0].f[1][3]);
        setup_close(&setup);
    }
}

// --- normal maps ---------------------------------------------------------------------------------

// The normal (x, y, z) of the map is scale x along the tangent, made orthogonal to the normal, plus
// scale y along sign * vec3_cross(normal, tangent), plus z along the normal.
static void expected_normal(const union texture_item *in, const double local[3], double out[3])
{
    double n[3], t[3], b[3];
    widen(in->f[2], n);
    widen(in->f[3], t);
    double along = vec3_dot(n, t);
    for (int c = 0; c < 3; c++)
        t[c] -= along * n[c];
    vec3_normalize(t);
    vec3_cross(n, t, b);
    for (int c = 0; c < 3; c++)
        out[c] = local[0] * t[c] + local[1] * (double)in->f[3][3] * b[c] + local[2] * n[c];
    vec3_normalize(out);
}

TEST(normal_maps)
{
    static const float colors[][4] = {
        {0.5f, 0.5f, 1, 1}, {1, 0.5f, 0.5f, 1}, {0.75f, 0.25f, 0.875f, 1}, {0, 1, 0.75f, 1}};
    static const float scales[] = {1, 0.5f, -2, 3};
    struct random random = {5};
    for (int i = 0; i < 4; i++) {
        struct setup setup;
        struct material m;
        material_init(&m);
        m.normal_scale = scales[i];
        use_plain(begin(&setup, &m), TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT, colors[i]);
        OPEN_SETUP(&setup, TEXTURE_SLOTS);
        const double local[3] = {(double)scales[i] * (2 * (double)colors[i][0] - 1),
                                 (double)scales[i] * (2 * (double)colors[i][1] - 1),
                                 2 * (double)colors[i][2] - 1};
        for (uint32_t k = 0; k < COUNT; k++) {
            items[k].u[0][0] = 1;
            random_direction(&random, items[k].f[2]);
            random_direction(&random, items[k].f[3]);
            items[k].f[3][3] = k % 2 ? -1 : 1;
        }
        memcpy(inputs, items, sizeof items);
        REQUIRE(texture_run(&setup, ROUTINE_APPLY, items, COUNT));
        float worst = 0;
        for (uint32_t k = 0; k < COUNT; k++) {
            double expected[3], n[3], t[3];
            expected_normal(&inputs[k], local, expected);
            widen(inputs[k].f[2], n);
            widen(inputs[k].f[3], t);
            // The tangent's direction is lost in rounding errors as it approaches the normal's.
            double across = sqrt(fmax(1e-12, 1 - vec3_dot(n, t) * vec3_dot(n, t)));
            float error = distance(items[k].f[3], expected, 3);
            worst = fmaxf(worst, error * (float)across);
            CHECK(error * (float)across < 2e-6f, "%g at %g", (double)error, across);
        }
        printf("  worst error %.2g\n", (double)worst);
        setup_close(&setup);
    }
}

// A tangent along the normal, or a map with a zero vector, still gives a unit normal.
TEST(normal_maps_without_a_frame)
{
    struct setup setup;
    struct material m;
    material_init(&m);
    m.normal_scale = 0;
    struct scene *scene = begin(&setup, &m);
    use_plain(scene, TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT, (float[]){1, 0, 0.5f, 1});
    m.normal_scale = 1;
    uint32_t second = add_material(scene, &m);
    use_plain(scene, TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT, (float[]){1, 0.5f, 1, 1});
    add_square(scene, second);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    memset(items, 0, 2 * sizeof *items);
    for (int i = 0; i < 2; i++) {
        items[i].u[0][0] = i ? second : 1;
        items[i].f[2][1] = items[i].f[3][1] = 1; // both are along y
    }
    REQUIRE(texture_run(&setup, ROUTINE_APPLY, items, 2));
    CHECK(items[0].f[3][1] == 1 && items[0].f[3][0] == 0, "%g", (double)items[0].f[3][1]);
    const float *n = items[1].f[3];
    CHECK(fabsf(n[1] - sqrtf(0.5f)) < 1e-6f && fabsf(n[0] * n[0] + n[2] * n[2] - 0.5f) < 1e-6f,
          "%g %g %g", (double)n[0], (double)n[1], (double)n[2]);
    setup_close(&setup);
}

// --- the frame -----------------------------------------------------------------------------------

// For any normals and viewer: the frame is orthonormal, its normal faces the viewer, and its mirror
// direction is above the surface. A normal that fulfils this is not changed.
TEST(frames_face_the_viewer_and_reflect_upwards)
{
    struct setup setup;
    struct material m;
    struct random random = {9};
    material_init(&m);
    m.model = MATERIAL_PRINCIPLED;
    m.anisotropic = 0.5f;
    begin(&setup, &m);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    for (uint32_t k = 0; k < COUNT; k++) {
        items[k].u[0][0] = 1;
        float *ns = items[k].f[1], *ng = items[k].f[2], *wo = items[k].f[3];
        random_direction(&random, ng);
        random_direction(&random, ns);
        do
            random_direction(&random, wo);
        while (!(wo[0] * ng[0] + wo[1] * ng[1] + wo[2] * ng[2] > 0));
        if (k % 4 == 1) // at a grazing angle
            for (int c = 0; c < 3; c++)
                wo[c] += ng[c] * (1e-4f - (wo[0] * ng[0] + wo[1] * ng[1] + wo[2] * ng[2]));
        if (k % 4 == 2) // equal to the geometric normal
            memcpy(ns, ng, sizeof(float[3]));
        if (k % 4 == 3) // opposite to the viewer, the worst case
            for (int c = 0; c < 3; c++)
                ns[c] = -wo[c];
        double unit[3];
        widen(wo, unit);
        vec3_normalize(unit);
        for (int c = 0; c < 3; c++)
            wo[c] = (float)unit[c];
        wo[3] = k % 2 ? 1 : -1;
    }
    memcpy(inputs, items, sizeof items);
    REQUIRE(texture_run(&setup, ROUTINE_FRAME, items, COUNT));
    double rounding = setup.gpu.rounds_to_nearest ? 0x1p-24 : 0x1p-23;
    uint32_t kept = 0;
    double lowest = 1, skew = 0;
    for (uint32_t k = 0; k < COUNT; k++) {
        double ns[3], ng[3], wo[3], axes[3][3], mirrored[3], wanted[3], b[3];
        widen(inputs[k].f[1], ns);
        widen(inputs[k].f[2], ng);
        widen(inputs[k].f[3], wo);
        for (int i = 0; i < 3; i++)
            widen(items[k].f[i], axes[i]);
        const double *n = axes[2];
        for (int c = 0; c < 3; c++) {
            mirrored[c] = 2 * vec3_dot(wo, n) * n[c] - wo[c];
            wanted[c] = 2 * vec3_dot(wo, ns) * ns[c] - wo[c];
        }
        for (int i = 0; i < 3; i++)
            skew = fmax(skew, fmax(fabs(vec3_norm(axes[i]) - 1),
                                   fabs(vec3_dot(axes[i], axes[(i + 1) % 3]))));
        vec3_cross(n, axes[0], b);
        CHECK(vec3_dot(b, axes[1]) * (double)inputs[k].f[3][3] > 0.99, "item %u is turned over", k);
        CHECK(vec3_dot(n, wo) > 0 && vec3_dot(n, ng) > 0, "item %u: %g %g", k, vec3_dot(n, wo),
              vec3_dot(n, ng));
        CHECK(vec3_dot(mirrored, ng) > 0, "item %u reflects to %g", k, vec3_dot(mirrored, ng));
        lowest = fmin(lowest, vec3_dot(mirrored, ng));
        // Normals are not changed if the mirror direction is above the height to which
        // bend_normal() bends.
        if (vec3_dot(wanted, ng) > fmin(sqrt(32 * rounding), vec3_dot(wo, ng)) + 1e-5) {
            kept++;
            double sign = vec3_dot(ns, wo) < 0 ? -1 : 1;
            CHECK(fabs(sign * vec3_dot(n, ns) - 1) < 1e-6, "item %u was bent to %g", k,
                  vec3_dot(n, ns));
        }
        // The geometric normal is never bent.
        CHECK(k % 4 != 2 || vec3_dot(n, ng) > 1 - 1e-6, "item %u: %g", k, vec3_dot(n, ng));
    }
    printf("  %u of %u kept, lowest reflection %.2g, skew %.2g\n", kept, COUNT, lowest, skew);
    CHECK(kept > COUNT / 4 && skew < 1e-6);
    setup_close(&setup);
}

// --- surfaces ------------------------------------------------------------------------------------

// Interpolates a vertex attribute by the barycentric coordinates of corners 1 and 2.
static double between(const float *a, const float *b, const float *c, const float uv[2])
{
    return (1 - (double)uv[0] - (double)uv[1]) * (double)*a + (double)uv[0] * (double)*b +
           (double)uv[1] * (double)*c;
}

TEST(corners_are_interpolated)
{
    struct setup setup;
    struct material m;
    struct random random = {11};
    material_init(&m);
    struct scene *scene = begin(&setup, &m);
    uint32_t image = add_image(scene, 4, 4, false, 1);
    add_texture(scene, image, TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT);
    add_texture(scene, image, texture_scales(GROUP_BASE, (int[]){0, 1, 2, 3}) | TEXTURE_UV1);
    struct mesh *mesh = &scene->meshes[0];
    for (int v = 0; v < 6; v++) {
        random_direction(&random, mesh->tangents[v]);
        mesh->tangents[v][3] = v < 3 ? 1 : -1;
        // Far from the origin, where coordinates are multiples of 2^-4.
        mesh->uvs[1][v][0] += 1e6f;
    }
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    CHECK(setup.r.specialization.features & FEATURE_COLORS);
    for (uint32_t k = 0; k < COUNT; k++) {
        float u = (float)random_unit(&random), v = (float)random_unit(&random);
        bool flip = u + v > 1;
        memset(&items[k], 0, sizeof items[k]);
        items[k].u[0][3] = k & 1;
        items[k].f[0][2] = k & 2 ? 1 : -1; // seen from above and from below
        items[k].f[1][2] = k & 2 ? -1 : 1;
        items[k].f[2][0] = flip ? 1 - u : u;
        items[k].f[2][1] = flip ? 1 - v : v;
    }
    memcpy(inputs, items, sizeof items);
    REQUIRE(texture_run(&setup, ROUTINE_SURFACE, items, COUNT));
    for (uint32_t k = 0; k < COUNT; k++) {
        const float *b = inputs[k].f[2];
        uint32_t first = 3 * setup.r.bvh.triangle_order[k & 1];
        double uv[4], color[4], tangent[4], side = k & 2 ? 1 : -1;
        for (int i = 0; i < 4; i++) {
            float corner[3][4];
            for (uint32_t c = 0; c < 3; c++)
                corner_color(first + c, corner[c]);
            float(*const set)[2] = mesh->uvs[i / 2] + first;
            uv[i] = between(&set[0][i % 2], &set[1][i % 2], &set[2][i % 2], b);
            color[i] = between(&corner[0][i], &corner[1][i], &corner[2][i], b);
            tangent[i] = between(&mesh->tangents[first][i], &mesh->tangents[first + 1][i],
                                 &mesh->tangents[first + 2][i], b);
        }
        double l = vec3_norm(tangent);
        for (int i = 0; i < 4; i++)
            tangent[i] *= side / (i < 3 ? l : 1);
        CHECK(distance(items[k].f[0], uv, 2) < 1e-6f &&
                  distance(&items[k].f[0][3], &uv[3], 1) < 1e-6f,
              "%g %g", (double)items[k].f[0][0], uv[0]);
        CHECK(distance(&items[k].f[0][2], &uv[2], 1) <= 0.0625f, "%.9g, expected %.9g",
              (double)items[k].f[0][2], uv[2]);
        CHECK(distance(items[k].f[2], color, 4) < 1e-6f);
        CHECK(l < 0.05 || distance(items[k].f[1], tangent, 4) < 1e-4f / l, "%g %g %g %g at %g",
              (double)items[k].f[1][0], (double)items[k].f[1][1], (double)items[k].f[1][2],
              (double)items[k].f[1][3], l);
        CHECK((double)items[k].f[3][2] == side && (items[k].f[3][3] == 1) == (side > 0));
    }
    setup_close(&setup);
}

// Spheres and discs have coordinates and tangents in closed form, on both sides.
TEST(shapes_have_coordinates)
{
    struct setup setup;
    struct material m;
    struct random random = {13};
    const double center[3] = {1, -2, 3}, normal[3] = {0.36, 0.48, 0.8}, at[3] = {4, 0, 0};
    const double radius = 1.5, disc_radius = 0.75;
    material_init(&m);
    scene_start(&setup.scene, 8, 8);
    uint32_t material = add_material(&setup.scene, &m);
    uint32_t image = add_image(&setup.scene, 4, 4, false, 1);
    add_texture(&setup.scene, image, TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT);
    add_sphere(&setup.scene, center, radius, material);
    add_disc(&setup.scene, at, normal, disc_radius, material);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    for (uint32_t k = 0; k < COUNT; k++) {
        float d[3], out[3];
        double side = k & 2 ? 1 : -1, n[3];
        memset(&items[k], 0, sizeof items[k]);
        items[k].u[0][3] = PRIMITIVE_SHAPE | (k & 1);
        random_direction(&random, d);
        for (int c = 0; c < 3 && k < 16; c++) // along the axes
            d[c] = (k / 2 % 3 == (uint32_t)c) * (k & 1 ? -1.0f : 1.0f);
        widen(d, n);
        for (int c = 0; c < 3; c++)
            out[c] = k & 1 ? (float)normal[c] : d[c];
        if (k & 1) { // a point of the disc
            double height = vec3_dot(n, normal);
            for (int c = 0; c < 3; c++)
                n[c] -= height * normal[c];
        }
        for (int c = 0; c < 3; c++) {
            double point = k & 1 ? at[c] + disc_radius * n[c] : center[c] + radius * n[c];
            items[k].f[0][c] = (float)(point + side * (double)out[c]);
            items[k].f[1][c] = (float)(-side * (double)out[c]);
        }
        items[k].f[1][3] = 1;
    }
    memcpy(inputs, items, sizeof items);
    REQUIRE(texture_run(&setup, ROUTINE_SURFACE, items, COUNT));
    double worst_uv = 0, worst_tangent = 0;
    for (uint32_t k = 0; k < COUNT; k++) {
        double point[3], n[3], uv[2], t[3], b[3], side = k & 2 ? 1 : -1;
        for (int c = 0; c < 3; c++)
            point[c] = (double)inputs[k].f[0][c] + (double)inputs[k].f[1][c];
        widen(items[k].f[1], t);
        for (int c = 0; c < 3; c++) {
            n[c] = k & 1 ? normal[c] : (point[c] - center[c]) / radius;
            t[c] *= side;
        }
        vec3_cross(n, t, b); // upwards in the image
        if (k & 1) {
            double from[3] = {point[0] - at[0], point[1] - at[1], point[2] - at[2]};
            uv[0] = 0.5 + 0.5 * vec3_dot(from, t) / disc_radius;
            uv[1] = 0.5 - 0.5 * vec3_dot(from, b) / disc_radius;
            worst_tangent = fmax(worst_tangent, fabs(vec3_dot(t, n)));
        } else {
            double across = sqrt(n[0] * n[0] + n[2] * n[2]);
            uv[0] = across > 0 ? 0.5 + atan2(n[0], n[2]) / (2 * M_PI) : 0.5;
            uv[1] = acos(fmin(fmax(n[1], -1), 1)) / M_PI;
            if (across > 1e-3)
                worst_tangent = fmax(worst_tangent,
                                     fmax(fabs(t[0] - n[2] / across), fabs(t[2] + n[0] / across)));
        }
        CHECK(items[k].f[1][3] == (float)side && fabs(vec3_norm(t) - 1) < 1e-6);
        for (int c = 0; c < 2; c++) {
            double error = fabs((double)items[k].f[0][c] - uv[c]);
            if (!(k & 1) && c == 0) { // the seam, and the pole, where u is not defined
                error = fmin(error, 1 - error);
                error *= sqrt(n[0] * n[0] + n[2] * n[2]);
            }
            worst_uv = fmax(worst_uv, error);
            CHECK(error < 1e-4, "shape %u, (%g, %g, %g): %g, expected %g", k & 1, n[0], n[1], n[2],
                  (double)items[k].f[0][c], uv[c]);
        }
        CHECK(items[k].f[0][2] == items[k].f[0][0] && items[k].f[0][3] == items[k].f[0][1]);
    }
    printf("  worst error of coordinates %.2g, of tangents %.2g\n", worst_uv, worst_tangent);
    CHECK(worst_tangent < 1e-3);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(textures_scale_groups), TEST_CASE(only_emission_is_scaled_up),
          TEST_CASE(colors_of_unlit_materials_are_shown), TEST_CASE(anisotropy),
          TEST_CASE(normal_maps), TEST_CASE(normal_maps_without_a_frame),
          TEST_CASE(frames_face_the_viewer_and_reflect_upwards),
          TEST_CASE(corners_are_interpolated), TEST_CASE(shapes_have_coordinates))
