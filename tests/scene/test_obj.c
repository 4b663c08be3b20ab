// Tests OBJ and MTL: what is read, what is refused, and that nothing crashes.
#include "mesh_files.h"

#include "base/file.h"
#include "image/image.h"
#include "scene/core/text.h"

#include <math.h>
#include <sys/stat.h>

static bool load(struct scene *scene, const char *path, struct err *err)
{
    uint32_t mesh;
    return load_obj(scene, path, SCENE_NONE, false, &mesh, err);
}

// Loads `text` as mesh.obj; the caller finishes the scene. Returns a zero mesh on failure.
static struct mesh load_text(struct scene *scene, const char *text)
{
    return load_checked(load, write_text("mesh.obj", text), scene);
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

TEST(one_triangle)
{
    struct scene scene;
    struct mesh mesh = load_text(&scene, "# comment\nv 0 0 0\nv 1.5 0 -2e1\nv 0 .25 +3.\nf 1 2 3");
    CHECK(mesh.vertex_count == 3 && mesh.triangle_count == 1 && !mesh.normals);
    CHECK(strcmp(mesh.name, "mesh.obj") == 0, "%s", mesh.name);
    check_triangle(&mesh, 0, 0, 1, 2);
    if (mesh.vertex_count == 3) {
        CHECK(mesh.positions[1][0] == 1.5f && mesh.positions[1][2] == -20.0f);
        CHECK(mesh.positions[2][1] == 0.25f && mesh.positions[2][2] == 3.0f);
    }
    CHECK(scene.material_count == 1 && scene.materials[0].model == MATERIAL_LAMBERT);
    CHECK(!mesh.triangle_material && warnings == 0, "%s", warning);
    scene_finish(&scene);
}

TEST(polygons_become_fans)
{
    struct scene scene;
    struct mesh mesh = load_text(&scene, SQUARE "v -1 .5 0\nf 1 2 3 4 5\nf 1 2 3\n");
    CHECK(mesh.triangle_count == 4, "%u", mesh.triangle_count);
    check_triangle(&mesh, 0, 0, 1, 2);
    check_triangle(&mesh, 1, 0, 2, 3);
    check_triangle(&mesh, 2, 0, 3, 4);
    check_triangle(&mesh, 3, 0, 1, 2);
    scene_finish(&scene);
}

TEST(all_forms_of_indices)
{
    struct scene scene;
    struct mesh mesh = load_text(&scene, SQUARE "vt 0 0\nf 1/1 2/1 3/1\nf -4 -3 -2\nf -1/-1 1/1 2");
    CHECK(mesh.triangle_count == 3 && !mesh.normals && mesh.uvs[0]);
    // A corner without texture coordinates is a separate vertex.
    check_triangle(&mesh, 0, 0, 1, 2);
    check_triangle(&mesh, 1, 3, 4, 5);
    check_triangle(&mesh, 2, 6, 0, 4);
    scene_finish(&scene);

    // If there are normals, vertices are numbered in the order of their first use.
    mesh = load_text(&scene, SQUARE "vn 0 0 2\nf 1//1 2//1 4//-1\nf 1//-1 2//1 3");
    CHECK(mesh.vertex_count == 4 && mesh.triangle_count == 2 && mesh.normals);
    check_triangle(&mesh, 0, 0, 1, 2);
    check_triangle(&mesh, 1, 0, 1, 3);
    if (mesh.normals) {
        CHECK(mesh.normals[0][2] == 1.0f, "%g", (double)mesh.normals[0][2]);
        CHECK(mesh.normals[3][2] == 0.0f, "a missing normal: %g", (double)mesh.normals[3][2]);
        CHECK(mesh.positions[2][1] == 1.0f && mesh.positions[2][0] == 0.0f);
    }
    scene_finish(&scene);
}

TEST(vertices_may_stand_below_faces)
{
    struct scene scene;
    struct mesh mesh = load_text(&scene, "f 1//1 2//1 3//1\nvn 0 1 0\n" SQUARE);
    CHECK(mesh.vertex_count == 3 && mesh.triangle_count == 1);
    scene_finish(&scene);
}

TEST(line_ends_continuations_and_comments)
{
    static const char *const texts[] = {
        "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nf 1 2 3\r\n",
        "v 0 0 0\rv 1 0 0\rv 1 1 0\rf 1 2 3\r",
        "\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n",
        "v 0 \\\n 0 0\nv 1 0 0\nv 1 1\\\r\n0\nf 1 \\\n2\\\n\\\n 3\\\n",
        "# in C:\\models\\\nv 0 0 0 # here # too\n\n\tv\t1 0 0 1\n  v 1 1 0 .5 .5\nf 1 2 3 # 4\n",
        "o \\\n a\ng b \\\n c\ns off\nv 0 0 0\nv 1 0 0\nv 1 1 0\nfo 1 2 3 \n",
        "usemtl \\\nv 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct scene scene;
        struct mesh mesh = load_text(&scene, texts[i]);
        CHECK(mesh.vertex_count == 3 && mesh.triangle_count == 1, "text %zu", i);
        scene_finish(&scene);
    }
}

TEST(what_has_no_faces_is_empty)
{
    struct scene scene;
    struct mesh mesh = load_text(&scene, "");
    CHECK(mesh.vertex_count == 0 && mesh.triangle_count == 0 && scene.material_count == 1);
    scene_finish(&scene);
    mesh = load_text(&scene, SQUARE "l 1 2\np 3\n");
    CHECK(mesh.triangle_count == 0 && warnings == 1 && strstr(warning, "mesh.obj:5"), "%s",
          warning);
    scene_finish(&scene);
}

TEST(pairs_of_position_and_normal_are_merged)
{
    // A cube with 8 positions, 6 normals, and 24 pairs of them.
    struct scene scene;
    struct mesh mesh =
        load_text(&scene, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                          "vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 0 1 0\nvn -1 0 0\nvn 1 0 0\n"
                          "f 4//1 3//1 2//1 1//1\nf 5//2 6//2 7//2 8//2\nf 1//3 2//3 6//3 5//3\n"
                          "f 3//4 4//4 8//4 7//4\nf 1//5 5//5 8//5 4//5\nf 2//6 3//6 7//6 6//6\n");
    CHECK(mesh.vertex_count == 24 && mesh.triangle_count == 12, "%u", mesh.vertex_count);
    for (uint32_t t = 0; t < mesh.triangle_count && mesh.normals; t++) {
        const uint32_t *corners = mesh.indices[t];
        const float *n = mesh.normals[corners[0]];
        for (int c = 0; c < 3; c++) {
            // The normal of a face of the unit cube is +-1 on the axis on which all its corners are
            // at 1 or at 0.
            const float *p = mesh.positions[corners[c]];
            for (int axis = 0; axis < 3; axis++)
                CHECK(n[axis] == 0.0f || p[axis] == (n[axis] > 0.0f ? 1.0f : 0.0f), "triangle %u",
                      t);
            CHECK(memcmp(n, mesh.normals[corners[c]], sizeof(float[3])) == 0, "triangle %u", t);
        }
    }
    scene_finish(&scene);
}

TEST(normals_without_direction_are_missing)
{
    struct scene scene;
    struct mesh mesh =
        load_text(&scene, SQUARE "vn 0 0 0\nvn nan 0 1\nvn 1e-30 0 0\nvn 3e38 3e38 0\n"
                                 "f 1//1 2//2 3//3\nf 1//4 2//4 3//4\n");
    CHECK(warnings == 1 && strstr(warning, "2 such"), "%s", warning);
    if (mesh.normals) {
        CHECK(mesh.normals[0][0] == 0.0f && mesh.normals[1][2] == 0.0f);
        CHECK(mesh.normals[2][0] == 1.0f, "%g", (double)mesh.normals[2][0]);
        CHECK(fabsf(mesh.normals[3][0] - sqrtf(0.5f)) < 1e-6f);
    }
    scene_finish(&scene);
}

// --- materials -----------------------------------------------------------------------------------

static const struct material *find_material(const struct scene *scene, const char *name)
{
    static const struct material none = {.name = "", .model = MATERIAL_MODEL_COUNT};
    for (uint32_t i = 0; i < scene->material_count; i++) {
        if (strcmp(scene->materials[i].name, name) == 0)
            return &scene->materials[i];
    }
    return &none;
}

#define FAR                                                                                        \
    "v 500000.0625 5400000.123 100.1\nv 500001.0625 5400000.123 100.1\nv 500000.0625 5400001 "     \
    "100\n"

// If there are attributes, vertices are copied.
TEST(far_positions_stay_exact)
{
    static const char *const texts[] = {
        FAR "f 1 2 3\n",
        "vt 0 0\nvt 1 0\n" FAR "v 0 0 0\nf 1/1 2/2 3/1\n",
        "f 1//1 2//1 3//1\nvn 0 0 1\n" FAR,
    };
    struct scene scene;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct mesh mesh = load_text(&scene, texts[i]);
        check_far_corners(&mesh);
        scene_finish(&scene);
    }
    // Two triangles of a metre, 1e7 m apart, and a mesh that needs no such precision.
    struct mesh mesh =
        load_text(&scene, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 10000000.25 0 0\n"
                          "v 10000001.25 0 0\nv 10000000.25 1 0\nf 1 2 3\nf 4 5 6\n");
    CHECK(mesh.exact_positions && mesh.exact_positions[3][0] == 10000000.25);
    scene_finish(&scene);
    mesh = load_text(&scene, "v 0.1 0 0\nv 1.1 0 0\nv 0 1.3 0\nv 0 1.3 0\nf 1 2 3\nf 3 4 3\n");
    CHECK(mesh.vertex_count == 4 && !mesh.exact_positions);
    scene_finish(&scene);
}

TEST(materials)
{
    write_text("a b.mtl", "# stray\nKd 1 1 1\nnewmtl red wall\nKd .8 .1 .2\nillum 2\nNs 10\n"
                          "newmtl lamp\r\nKe 10 20 30\r\n"
                          "newmtl unused\nKd 1 1 1\n"
                          "newmtl mirror\nillum 5\nKs .9 .8 .7\nKd .1 .1 .1\n"
                          "newmtl metal\nillum 3\nKd .6 .5 .4\nKs 1 1 1\n"
                          "newmtl chrome\nKd 0\nillum 3\n"
                          "newmtl lamp\nKe 1 1 1\n");
    struct scene scene;
    struct mesh mesh = load_text(&scene, "mtllib a b.mtl\n" SQUARE
                                         "f 1 2 3\nusemtl red wall \nf 1 2 3 4\nusemtl lamp\n"
                                         "f 1 2 3\nusemtl unused\nusemtl mirror\nf 1 2 3\n"
                                         "usemtl metal\nf 1 2 3\nusemtl chrome\nf 1 2 3\n"
                                         "usemtl red wall\nf 1 2 3\nusemtl nobody\nf 1 2 3\n");
    CHECK(scene.material_count == 6, "%u", scene.material_count);
    REQUIRE(mesh.triangle_count == 9 && mesh.triangle_material, "%u", mesh.triangle_count);
    static const char *const names[] = {"default", "red wall", "red wall", "lamp",   "mirror",
                                        "metal",   "chrome",   "red wall", "default"};
    for (uint32_t t = 0; t < 9; t++) {
        const char *name = scene.materials[mesh.triangle_material[t]].name;
        CHECK(strcmp(name, names[t]) == 0, "triangle %u: %s", t, name);
    }
    const struct material *red = find_material(&scene, "red wall");
    CHECK(red->model == MATERIAL_LAMBERT && red->base_color[0] == 0.8f && red->emission[0] == 0.0f);
    const struct material *lamp = find_material(&scene, "lamp");
    CHECK(lamp->emission[0] == 10.0f && lamp->emission[2] == 30.0f && lamp->base_color[1] == 0.5f,
          "the first of two definitions counts");
    const struct material *mirror = find_material(&scene, "mirror");
    CHECK(mirror->model == MATERIAL_MIRROR && mirror->base_color[2] == 0.7f);
    const struct material *metal = find_material(&scene, "metal");
    CHECK(metal->model == MATERIAL_PRINCIPLED && metal->base_color[0] == 0.6f &&
          metal->metallic == 1.0f && metal->roughness == 1.0f);
    const struct material *chrome = find_material(&scene, "chrome");
    CHECK(chrome->model == MATERIAL_MIRROR && chrome->base_color[0] == 1.0f);
    CHECK(warnings == 1 && strstr(warning, "mesh.obj:20"), "%s", warning);
    scene_finish(&scene);
}

static bool is_near(float value, double expected)
{
    return fabs((double)value - expected) < 1e-6;
}

TEST(materials_of_exporters)
{
    write_text("pbr.mtl",
               "newmtl pbr\nKd .2 .4 .6\nPr .3\nPm .7\nPs .1\nPc .5\nPcr .25\naniso .4\n"
               "anisor .125\nNi 1.45\nd .5\n"
               "newmtl shiny\nNs 250\nKa 1 1 1\nKs .5 .5 .5\nKd .8 .8 .8\nNi 1.45\nd 1\nillum 2\n"
               "newmtl glass\nKd .8 .8 .8\nTf .9 1 .8\nNi 1.33\nillum 6\nd .1\n"
               "newmtl half\nKa .5 .5 .5\nNs 1000\nillum 3\nTr .25\n"
               "newmtl matt\nKs 0 0 0\nPr .3\nPm 0\n");
    struct scene scene;
    load_text(&scene, "mtllib pbr.mtl\n" SQUARE "usemtl pbr\nf 1 2 3\nusemtl shiny\nf 1 2 3\n"
                      "usemtl glass\nf 1 2 3\nusemtl half\nf 1 2 3\n"
                      "usemtl matt\nf 1 2 3\n");
    CHECK(warnings == 0, "%s", warning);
    const struct material *m = find_material(&scene, "pbr");
    CHECK(m->model == MATERIAL_PRINCIPLED && is_near(m->base_color[2], 0.6) &&
          is_near(m->roughness, 0.3) && is_near(m->metallic, 0.7) && is_near(m->sheen, 0.1));
    CHECK(is_near(m->clearcoat, 0.5) && is_near(m->clearcoat_roughness, 0.25) &&
          (m->flags & MATERIAL_COAT_GGX) && (m->flags & MATERIAL_GLTF_LAYERS) &&
          is_near(m->anisotropic, 0.4) && is_near(m->anisotropic_rotation, 0.125) &&
          is_near(m->ior, 1.45));
    CHECK(is_near(m->opacity, 0.5) && (m->flags & MATERIAL_ALPHA_BLEND));
    m = find_material(&scene, "shiny");
    CHECK(m->model == MATERIAL_PRINCIPLED && is_near(m->roughness, 0.5) &&
              is_near(m->specular, 0.5) && m->metallic == 0.0f &&
              !(m->flags & MATERIAL_ALPHA_BLEND),
          "%g", (double)m->roughness);
    m = find_material(&scene, "glass");
    CHECK(m->transmission == 1.0f && m->roughness == 0.0f && is_near(m->ior, 1.33) &&
          is_near(m->base_color[2], 0.8) && m->opacity == 1.0f);
    m = find_material(&scene, "half");
    CHECK(m->roughness == 0.0f && is_near(m->metallic, 0.5) && is_near(m->opacity, 0.75));
    CHECK(m->specular_weight == 1.0f);
    // Without reflection the material is Lambertian.
    m = find_material(&scene, "matt");
    CHECK(m->specular_weight == 0.0f && material_shading_model(m) == MATERIAL_LAMBERT);
    scene_finish(&scene);
}

// Writes a PNG of one pixel with the image library.
static void write_pixel(const char *name, float red, float green, float blue)
{
    float pixel[1][3] = {{red, green, blue}};
    const struct image image = {.width = 1, .height = 1, .pixels = pixel};
    struct err err = {0};
    bool is_written =
        image_write(&(struct image_write_params){.path = in_folder(name), .image = &image}, &err);
    REQUIRE(is_written, "%s", err.msg);
}

TEST(textures_of_exporters)
{
    write_pixel("color map.png", 0.5f, 0.25f, 1.0f);
    write_pixel("normals.png", 0.2140411f, 0.2140411f, 1.0f); // the sRGB code of a half
    write_pixel("heights.png", 0.2f, 0.2f, 0.2f);
    write_text("maps.mtl", "newmtl a\nKd 0 0 0\nmap_Kd -s 2 3 1 -o .5 .25 color map.png\n"
                           "map_Pr -clamp on heights.png\nbump -bm .5 normals.png\n"
                           "newmtl b\nmap_Bump heights.png\nmap_d heights.png\n");
    struct scene scene;
    struct mesh mesh =
        load_text(&scene, "mtllib maps.mtl\n" SQUARE "vt .25 .5\nvt 1\nusemtl a\nf 1/1 2/2 3/1\n"
                          "usemtl b\nf 1/1 2 3\n");
    CHECK(warnings == 1 && strstr(warning, "holds heights"), "%u %s", warnings, warning);
    const struct material *a = find_material(&scene, "a"), *b = find_material(&scene, "b");
    REQUIRE(a->texture_count == 3 && b->texture_count == 1, "%u and %u textures", a->texture_count,
            b->texture_count);
    CHECK(a->base_color[0] == 1.0f && is_near(a->normal_scale, 0.5));
    CHECK(b->flags & MATERIAL_ALPHA_BLEND);
    const struct texture *color = &scene.textures[a->first_texture];
    CHECK((color->flags >> TEXTURE_MASK_SHIFT & 15u) == 7u &&
          (color->flags >> TEXTURE_GROUP_SHIFT & 15u) == GROUP_BASE);
    // s = 2 u + .5; t = 1 - (3 v + .25), where v' = 1 - v is this program's coordinate.
    CHECK(color->transform[0][0] == 2.0f && color->transform[0][2] == 0.5f);
    CHECK(color->transform[1][1] == 3.0f && is_near(color->transform[1][2], 1.0 - 3.0 - 0.25));
    const float *mean = scene.images[color->image].mean;
    CHECK(fabs((double)mean[0] - 0.5) < 0.01 && fabs((double)mean[1] - 0.25) < 0.01);
    const struct texture *rough = &scene.textures[a->first_texture + 1];
    CHECK((rough->flags >> TEXTURE_WRAP_S_SHIFT & 3u) == TEXTURE_WRAP_CLAMP);
    CHECK((scene.textures[a->first_texture + 2].flags >> TEXTURE_USE_SHIFT & 3u) ==
          TEXTURE_USE_NORMAL);
    REQUIRE(mesh.uvs[0] && mesh.vertex_count == 5, "%u vertices", mesh.vertex_count);
    CHECK(mesh.uvs[0][0][0] == 0.25f && mesh.uvs[0][0][1] == 0.5f);
    CHECK(mesh.uvs[0][1][0] == 1.0f && mesh.uvs[0][1][1] == 1.0f, "v left out is 0");
    scene_finish(&scene);
}

TEST(colours_of_vertices)
{
    struct scene scene;
    struct mesh mesh =
        load_text(&scene, "v 0 0 0 1 0 0\nv 1 0 0 0.5 2 nan\nv 0 1 0 0 0 1\nf 1 2 3\n");
    REQUIRE(mesh.colors, "no colours");
    CHECK(mesh.colors[0][0] == 1.0f && mesh.colors[0][3] == 1.0f);
    CHECK(is_near(mesh.colors[1][0], 0.21404114) && mesh.colors[1][1] == 1.0f &&
              mesh.colors[1][2] == 0.0f,
          "sRGB, within [0, 1]");
    scene_finish(&scene);
    mesh = load_text(&scene, "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
    CHECK(!mesh.colors, "not all vertices have one");
    scene_finish(&scene);
}

TEST(one_material_needs_no_list)
{
    write_text("one.mtl", "newmtl a\nnewmtl b\n");
    struct scene scene;
    struct mesh mesh =
        load_text(&scene, "mtllib one.mtl\n" SQUARE "usemtl b\nf 1 2 3\nusemtl b\nf 1 2 3\n");
    CHECK(!mesh.triangle_material && scene.material_count == 1);
    CHECK(strcmp(scene.materials[mesh.material].name, "b") == 0);
    scene_finish(&scene);
}

TEST(a_given_default_material_is_used)
{
    struct scene scene = {0};
    struct err err = {0};
    uint32_t wanted, mesh;
    struct material *added = scene_add_material(&scene, NULL);
    added = scene_add_material(&scene, &wanted);
    REQUIRE(added, "out of memory");
    bool is_loaded =
        load_obj(&scene, write_text("mesh.obj", SQUARE "f 1 2 3"), wanted, false, &mesh, &err);
    REQUIRE(is_loaded, "%s", err.msg);
    CHECK(mesh == 0 && scene.mesh_count == 1 && scene.meshes[0].material == wanted);
    CHECK(scene.material_count == 2 && scene.hash != 0);
    scene_finish(&scene);
}

TEST(libraries_are_read_once)
{
    write_text("twice.mtl", "newmtl a\nKd 2 2 2\n");
    struct scene scene;
    load_text(&scene, "mtllib twice.mtl\nmtllib twice.mtl\nmtllib no.mtl\nmtllib no.mtl\n");
    CHECK(warnings == 2, "one clamped colour, two lines that name nothing: %u", warnings);
    CHECK(strstr(warning, "mesh.obj:3") && strstr(warning, "2 such"), "%s", warning);
    scene_finish(&scene);
}

TEST(colours_are_clamped_and_counted)
{
    write_text("c.mtl", "newmtl a\nKd 1.5 .5 -1\nKe -1 2 3\nKs 1 1 1\nmap_Kd x.png\n"
                        "Kd spectral x.rfl\n");
    struct scene scene;
    load_text(&scene, "mtllib c.mtl\n" SQUARE "usemtl a\nf 1 2 3\n");
    CHECK(warnings == 2, "clamped colours and a spectral one: %u", warnings);
    // A missing image is reported when the scene is complete.
    REQUIRE(scene.image_count == 1);
    CHECK(scene.images[0].is_missing && strstr(scene.images[0].name, "c.mtl:5") &&
              strstr(scene.images[0].name, "x.png"),
          "%s", scene.images[0].name);
    const struct material *a = find_material(&scene, "a");
    CHECK(a->base_color[0] == 1.0f && a->base_color[1] == 0.5f && a->base_color[2] == 0.0f);
    CHECK(a->emission[0] == 0.0f && a->emission[1] == 2.0f);
    scene_finish(&scene);
}

TEST(material_libraries_are_confined)
{
    // The OBJ file is in a subfolder beside the library.
    write_text("outside.mtl", "newmtl a\nKd 1 0 0\n");
    CHECK(mkdir(in_folder("inner"), 0700) == 0);
    CHECK(symlink("../outside.mtl", in_folder("inner/link.mtl")) == 0);
    CHECK(mkfifo(in_folder("inner/pipe.mtl"), 0600) == 0);
    static const char *const names[] = {"../outside.mtl", "link.mtl", "/etc/hostname",
                                        "pipe.mtl",       "none.mtl", ""};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, "mtllib %s\n" SQUARE "usemtl a\nf 1 2 3\n", names[i]);
        struct scene scene = {0};
        struct err err = {0};
        warnings = 0;
        bool is_loaded = load(&scene, write_text("inner/mesh.obj", text), &err);
        CHECK(is_loaded, "%s: %s", names[i], err.msg);
        CHECK(warnings == 2, "%s: %u warnings", names[i], warnings);
        CHECK(find_material(&scene, "a")->model == MATERIAL_MODEL_COUNT, "%s", names[i]);
        scene_finish(&scene);
    }
    for (size_t i = 0; i < 2; i++) {
        char text[256];
        snprintf(text, sizeof text, "mtllib %s\n" SQUARE "usemtl a\nf 1 2 3\n", names[i]);
        struct scene scene = {0};
        struct err err = {0};
        uint32_t mesh;
        bool is_loaded =
            load_obj(&scene, write_text("inner/mesh.obj", text), SCENE_NONE, true, &mesh, &err);
        CHECK(is_loaded && find_material(&scene, "a")->model == MATERIAL_LAMBERT, "%s: %s",
              names[i], err.msg);
        scene_finish(&scene);
    }
}

// --- errors --------------------------------------------------------------------------------------

TEST(errors_name_file_line_value_and_expectation)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {SQUARE "f 1 0 2\n", "mesh.obj:5: vertex 0; expected indices from 1"},
        {SQUARE "f 1 2 5\n", "mesh.obj:5: vertex 5, but the file has 4"},
        {SQUARE "f 1 2 -5\n", "mesh.obj:5: vertex -5, but only 4 are defined above"},
        {SQUARE "f 1 2 99999999999999999999\n", "mesh.obj:5: vertex 9223372036854775807, but"},
        {SQUARE "f 1 2 -99999999999999999999\n", "mesh.obj:5: vertex -9223372036854775807, but"},
        {"f -1 -2 -3\n" SQUARE, "mesh.obj:1: vertex -1, but only 0 are defined above"},
        {SQUARE "f 1//1 2//1 3//1\n", "mesh.obj:5: normal 1, but the file has 0"},
        {SQUARE "vn 0 0 1\nf 1//0 2//1 3//1\n", "mesh.obj:6: normal 0; expected"},
        {SQUARE "f 1/2 2/1 3/1\n", "mesh.obj:5: texture coordinate 2, but the file has 0"},
        {SQUARE "f 1 2\n", "mesh.obj:5: a face of 2 corners; expected at least 3"},
        {SQUARE "f\n", "mesh.obj:5: a face of 0 corners"},
        {SQUARE "f 1 2 x\n", "mesh.obj:5: expected a face's index, found 'x'"},
        {SQUARE "f 1 2 3/\n", "mesh.obj:5: expected a face's index, found the end of the line"},
        {SQUARE "f 1 2 3//\n", "expected a face's index"},
        {SQUARE "f 1 2 3.5\n", "mesh.obj:5: expected a corner v, v/t, v//n or v/t/n, found '3.5'"},
        {SQUARE "f 1 2 3/1/1/1\n", "texture coordinate 1, but"},
        {"v 1 2\n", "mesh.obj:1: expected three numbers after v, found the end of the line"},
        {"v 1 2", "mesh.obj:1: expected three numbers after v, found the end of the file"},
        {"v 1 2 3x\n", "found '3x'"},
        {"v 1 0x10 3\n", "found '0x10'"},
        {"v 1 1.#INF 3\n", "found '1.#INF'"},
        {"v 1 \x1b[2J 3\n", "found '?[2J'"},
        {"v 1 2 3\nv 0 nan 0\n", "mesh.obj:2: vertex 2: y is nan; expected a finite number"},
        {"v 1 2 -inf\n", "mesh.obj:1: vertex 1: z is -inf; expected a finite number"},
        {"v 1e39 2 3\n", "mesh.obj:1: vertex 1: x is inf; expected a finite number"},
        {"vn 1 2\n", "mesh.obj:1: expected three numbers after vn"},
        {"v 0 \\\n 0 \\\n a\n", "mesh.obj:3: expected three numbers after v, found 'a'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_mesh_refused(load, write_text("mesh.obj", cases[i].text), cases[i].message);
}

TEST(errors_in_mtl_files)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"newmtl\n", "bad.mtl:1: newmtl: expected a name"},
        {"newmtl a\nKd\n", "bad.mtl:2: expected a number after Kd, found the end of the line"},
        {"newmtl a\nKd 1 2\n", "bad.mtl:2: expected a number after Kd"},
        {"newmtl a\nKe 1 2 red\n", "bad.mtl:2: expected a number after Ke, found 'red'"},
        {"newmtl a\nKd 1 inf 1\n", "bad.mtl:2: a number after Kd: inf; expected a finite number"},
        {"newmtl a\nillum x\n", "bad.mtl:2: expected an integer after illum, found 'x'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_text("bad.mtl", cases[i].text);
        check_mesh_refused(load, write_text("mesh.obj", "mtllib bad.mtl\n" SQUARE),
                           cases[i].message);
    }
}

TEST(files_that_cannot_be_read)
{
    check_mesh_refused(load, in_folder("nothing.obj"), "nothing.obj");
    check_mesh_refused(load, folder, "folder");
}

TEST(memory_limits_are_errors)
{
    write_text("m.mtl", "newmtl a\nnewmtl b\n");
    check_memory_limits(load, write_text("mesh.obj", "mtllib m.mtl\n" SQUARE
                                                     "vn 0 0 1\nusemtl a\nf 1//1 2//1 3//1\n"
                                                     "usemtl b\nf 1//1 2//1 3 4//1\n"));
}

// --- damage --------------------------------------------------------------------------------------

static const char sample[] = "mtllib s.mtl\n" SQUARE "vn 0 0 1\nvn 0 .6 .8\nvt 0 0\n# c\\\no name\n"
                             "usemtl a\nf 1/1/1 2//2 3 -1/-1\nusemtl b \\\nf 1 2 \\\n 3\n"
                             "v 1e-3 -2.5E+2 0.1234567890123456789\nf -1 -2 -3\nl 1 2\n";

TEST(cut_and_damaged_files_never_crash)
{
    write_text("s.mtl", "newmtl a\nKd .1 .2 .3\nnewmtl b\n");
    cut_everywhere(load, "cut.obj", sample, sizeof sample - 1);
    flip_bytes(load, "cut.obj", sample, sizeof sample - 1, 10000);
}

TEST(cut_and_damaged_libraries_never_crash)
{
    static const char library[] = "newmtl a\nKd .1 .2 .3\nKe 1 2 3\nillum 5\nKs 1\nnewmtl b\n";
    char path[512];
    snprintf(path, sizeof path, "%s",
             write_text("t.obj", "mtllib t.mtl\n" SQUARE "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n"));
    for (size_t length = 0; length < sizeof library; length++) {
        write_bytes("t.mtl", library, length);
        check_loads_or_fails(load, path, "library cut at", length);
    }
}

// --- real meshes ---------------------------------------------------------------------------------

TEST(real_meshes)
{
    static const struct {
        const char *name;
        uint32_t triangles, vertices; // counted by other means: faces, their corners, and lines "v"
    } meshes[] = {
        {"mesh/nefertiti.obj", 99938, 49971}, {"mesh/stanford-bunny.obj", 69451, 35947},
        {"mesh/spot.obj", 5856, 3225},        {"mesh/teapot.obj", 6320, 3644},
        {"mesh/suzanne.obj", 968, 507},
    };
    for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; i++) {
        const char *path = data_file(meshes[i].name);
        if (!path)
            SKIP("no %s", meshes[i].name);
        struct scene scene = {0};
        struct err err = {0};
        bool is_loaded = load(&scene, path, &err);
        REQUIRE(is_loaded, "%s", err.msg);
        const struct mesh *mesh = &scene.meshes[0];
        CHECK(mesh->triangle_count == meshes[i].triangles, "%s: %u", path, mesh->triangle_count);
        CHECK(mesh->vertex_count == meshes[i].vertices, "%s: %u", path, mesh->vertex_count);
        check_mesh(&scene, mesh);
        scene_finish(&scene);
    }
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(one_triangle),
        TEST_CASE(polygons_become_fans),
        TEST_CASE(all_forms_of_indices),
        TEST_CASE(vertices_may_stand_below_faces),
        TEST_CASE(line_ends_continuations_and_comments),
        TEST_CASE(what_has_no_faces_is_empty),
        TEST_CASE(pairs_of_position_and_normal_are_merged),
        TEST_CASE(normals_without_direction_are_missing),
        TEST_CASE(far_positions_stay_exact),
        TEST_CASE(materials),
        TEST_CASE(materials_of_exporters),
        TEST_CASE(textures_of_exporters),
        TEST_CASE(colours_of_vertices),
        TEST_CASE(one_material_needs_no_list),
        TEST_CASE(a_given_default_material_is_used),
        TEST_CASE(libraries_are_read_once),
        TEST_CASE(colours_are_clamped_and_counted),
        TEST_CASE(material_libraries_are_confined),
        TEST_CASE(errors_name_file_line_value_and_expectation),
        TEST_CASE(errors_in_mtl_files),
        TEST_CASE(files_that_cannot_be_read),
        TEST_CASE(memory_limits_are_errors),
        TEST_CASE(cut_and_damaged_files_never_crash),
        TEST_CASE(cut_and_damaged_libraries_never_crash),
        TEST_CASE(real_meshes),
    };
    if (!begin_mesh_tests())
        return 1;
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
