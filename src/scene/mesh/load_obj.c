// Reads the polygons of a Wavefront OBJ file as one mesh. Format: Wavefront, "Object Files (.obj)",
// appendix B1 of the Advanced Visualizer manual, 1995.
//
// A first pass over the text counts elements, so that every array is allocated once and every index
// can be checked where it is used, even if it refers to a vertex further down. A second pass reads
// them. Polygons are split into fans around their first corner, which is right for convex polygons;
// a modelling program may split others differently. Lines, points, curves and surfaces are skipped.
#include "scene/mesh/mesh_loader.h"

#include "base/file.h"
#include "base/log.h"
#include "image/image.h"

#include <math.h>
#include <string.h>

struct obj_counts {
    uint64_t positions, texture_coordinates, normals;
    uint64_t triangles;
    uint64_t material_statements;
    uint64_t colored_positions; // positions with six numbers, of which the last three are a colour
};

struct obj_parser {
    struct scene *scene;
    struct arena scratch;
    struct text_reader text, start; // the current position, and the start of the file
    uint32_t default_material;      // SCENE_NONE: not yet made
    bool allow_outside_paths;
    struct obj_counts counts; // counts in the whole file
    struct obj_counts seen;   // counts in the part that the second pass has read
    struct mtl_library library;
    struct err missing_library; // why the first missing library could not be read
    uint64_t missing_library_count, missing_library_line;
    struct mtl_material *wanted_material; // material of the next faces; NULL: the default one
    uint32_t material;                    // index of wanted_material in the scene, or SCENE_NONE

    float (*positions)[3];
    double (*exact)[3]; // positions before rounding, if they are needed
    float (*normals)[3];
    float (*uvs)[2];
    float (*colors)[4];              // colours of positions; NULL if the file has none
    uint32_t (*indices)[3];          // indices of positions
    uint32_t (*normal_indices)[3];   // NULL if the file has no normals
    uint32_t (*uv_indices)[3];       // NULL if the file has no texture coordinates
    uint32_t *triangle_material;     // NULL if the file has no usemtl
    uint32_t unknown_material_count; // number of usemtl statements that name an unknown material
    uint64_t unknown_material_line;  // line of the first of these
    uint64_t skipped_count, skipped_line;
    uint64_t bad_normal_count, bad_normal_line;
};

enum obj_keyword {
    OBJ_POSITION,
    OBJ_TEXTURE_COORDINATE,
    OBJ_NORMAL,
    OBJ_FACE,
    OBJ_USE_MATERIAL,
    OBJ_MATERIAL_LIBRARY,
    OBJ_NO_GEOMETRY, // statements about names and groups
    OBJ_SKIPPED,     // geometry of other kinds, and unknown statements
};

static enum obj_keyword read_keyword(struct text_reader *text)
{
    static const struct {
        const char *word;
        enum obj_keyword keyword;
    } keywords[] = {
        {"v", OBJ_POSITION},
        {"f", OBJ_FACE},
        {"vn", OBJ_NORMAL},
        {"vt", OBJ_TEXTURE_COORDINATE},
        {"o", OBJ_NO_GEOMETRY},
        {"g", OBJ_NO_GEOMETRY},
        {"s", OBJ_NO_GEOMETRY},
        {"usemtl", OBJ_USE_MATERIAL},
        {"fo", OBJ_FACE}, // the statement for faces before version 3.0
        {"mtllib", OBJ_MATERIAL_LIBRARY},
    };
    struct text_span word = text_word(text);
    for (size_t i = 0; i < sizeof keywords / sizeof keywords[0]; i++) {
        if (text_equals(word, keywords[i].word))
            return keywords[i].keyword;
    }
    return OBJ_SKIPPED;
}

// --- the first pass: counts and material libraries -----------------------------------------------

static uint64_t count_words(struct text_reader *text)
{
    uint64_t count = 0;
    for (; !text_line_ended(text); count++)
        text_word(text);
    return count;
}

// Returns the path of a material library; NULL with *err set if it is not permitted, or when out of
// memory.
static char *library_path(struct obj_parser *parser, struct text_span name, struct err *err)
{
    char *relative = text_copy(&parser->scratch, name);
    char *folder = path_folder(&parser->scratch, parser->text.path);
    if (!relative || !folder) {
        err_memory(err, "a path", name.size + 1);
        return NULL;
    }
    const struct file_reference reference = {
        .folder = folder,
        .allow_outside = parser->allow_outside_paths,
    };
    return file_resolve(&parser->scratch, &reference, relative, err);
}

// Reads a material library. If it is missing or not permitted, the geometry is loaded without its
// materials, with a warning; in a strict scene that is an error.
static bool read_material_library(struct obj_parser *parser, struct err *err)
{
    struct text_span name = text_rest_of_line(&parser->text);
    struct err reason = {0};
    bool missing = true;
    char *path = library_path(parser, name, &reason);
    if (path &&
        load_mtl(&parser->scratch, path, &parser->library, &parser->scene->hash, &missing, &reason))
        return true;
    if (!missing || reason.code != ERR_INPUT)
        return err_set(err, reason.code, "%s", reason.msg);
    if (parser->scene->is_strict)
        return err_set(err, ERR_INPUT, "%s:%llu: mtllib: %s", parser->text.path,
                       (unsigned long long)parser->text.line, reason.msg);
    if (parser->missing_library_count++ == 0) {
        parser->missing_library = reason;
        parser->missing_library_line = parser->text.line;
    }
    return true;
}

static bool count_statement(struct obj_parser *parser, struct err *err)
{
    struct obj_counts *counts = &parser->counts;
    uint64_t line = parser->text.line, corners;
    switch (read_keyword(&parser->text)) {
    case OBJ_POSITION:
        counts->positions++;
        counts->colored_positions += count_words(&parser->text) == 6;
        break;
    case OBJ_TEXTURE_COORDINATE:
        counts->texture_coordinates++;
        break;
    case OBJ_NORMAL:
        counts->normals++;
        break;
    case OBJ_FACE:
        corners = count_words(&parser->text);
        if (corners < 3)
            return text_fail(&parser->text, err, "a face of %llu corners; expected at least 3",
                             (unsigned long long)corners);
        counts->triangles += corners - 2;
        break;
    case OBJ_USE_MATERIAL:
        counts->material_statements++;
        break;
    case OBJ_MATERIAL_LIBRARY:
        return read_material_library(parser, err);
    case OBJ_NO_GEOMETRY:
        break;
    case OBJ_SKIPPED:
        if (parser->skipped_count++ == 0)
            parser->skipped_line = line;
        break;
    }
    return true;
}

#define LINES_BETWEEN_LOOKS 262144 // lines between two polls for a stop

// Calls `read` at the first word of every line that has one. Progress is reported from `from` to
// `to`.
static bool for_each_statement(struct obj_parser *parser, const struct text_reader *start,
                               double from, double to,
                               bool (*read)(struct obj_parser *, struct err *), struct err *err)
{
    double size = (double)text_remaining(start);
    parser->text = *start;
    for (uint64_t lines = 1; text_remaining(&parser->text) > 0; text_next_line(&parser->text)) {
        double left = (double)text_remaining(&parser->text);
        if (lines++ % LINES_BETWEEN_LOOKS == 0 &&
            !scene_loading(parser->scene, from + (to - from) * (1 - left / size), err))
            return false;
        if (!text_line_ended(&parser->text) && !read(parser, err))
            return false;
    }
    return true;
}

// --- the second pass: numbers --------------------------------------------------------------------

// Reads the colour after a position (an extension of MeshLab and others), which is sRGB-encoded in
// [0, 1].
static bool read_color(struct obj_parser *parser, float color[4], struct err *err)
{
    for (int c = 0; c < 3; c++) {
        float encoded;
        if (!text_float(&parser->text, "three numbers of a colour after v x y z", &encoded, err))
            return false;
        color[c] = image_srgb_to_linear(fminf(fmaxf(encoded, 0.0f), 1.0f)); // NaN becomes 0
    }
    color[3] = 1.0f;
    return true;
}

static bool read_texture_coordinate(struct obj_parser *parser, struct err *err)
{
    float *uv = parser->uvs[parser->seen.texture_coordinates++];
    if (!text_float(&parser->text, "a number after vt", &uv[0], err))
        return false;
    float v = 0.0f; // the second coordinate is optional
    text_take_float(&parser->text, &v);
    uv[1] = 1.0f - v; // t points down in meshes
    return true;
}

// Reads a position. A weight after the three numbers has no meaning for polygons and is ignored.
static bool read_position(struct obj_parser *parser, struct err *err)
{
    uint64_t index = parser->seen.positions++;
    float *position = parser->positions[index];
    for (int c = 0; c < 3; c++) {
        if (!text_float(&parser->text, "three numbers after v", &position[c], err))
            return false;
        if (!isfinite(position[c]))
            return text_fail(&parser->text, err, "vertex %llu: %c is %g; expected a finite number",
                             (unsigned long long)parser->seen.positions, 'x' + c,
                             (double)position[c]);
    }
    return !parser->colors || read_color(parser, parser->colors[index], err);
}

static bool read_exact_position(struct obj_parser *parser, struct err *err)
{
    if (read_keyword(&parser->text) != OBJ_POSITION)
        return true;
    double *position = parser->exact[parser->seen.positions++];
    for (int c = 0; c < 3; c++)
        if (!text_double(&parser->text, "three numbers after v", &position[c], err))
            return false;
    return true;
}

static bool read_normal(struct obj_parser *parser, struct err *err)
{
    float given[3];
    for (int c = 0; c < 3; c++) {
        if (!text_float(&parser->text, "three numbers after vn", &given[c], err))
            return false;
    }
    if (!mesh_unit_normal(given, parser->normals[parser->seen.normals++]) &&
        parser->bad_normal_count++ == 0)
        parser->bad_normal_line = parser->text.line;
    return true;
}

// Reads one index and converts it to count from 0. In the file, positive indices count from 1 over
// the whole file, and negative ones count back from the last element defined so far.
static bool read_index(struct obj_parser *parser, const char *what, uint64_t seen, uint64_t count,
                       uint32_t *out, struct err *err)
{
    int64_t given;
    if (!text_integer(&parser->text, "a face's index", &given, err))
        return false;
    if (given == 0)
        return text_fail(&parser->text, err, "%s 0; expected indices from 1 on or negative", what);
    if (given > 0 && (uint64_t)given > count)
        return text_fail(&parser->text, err, "%s %lld, but the file has %llu", what,
                         (long long)given, (unsigned long long)count);
    if (given < 0 && (uint64_t)-given > seen)
        return text_fail(&parser->text, err, "%s %lld, but only %llu are defined above", what,
                         (long long)given, (unsigned long long)seen);
    *out = (uint32_t)(given > 0 ? (uint64_t)given - 1 : seen - (uint64_t)-given);
    return true;
}

// Reads one corner: v, v/t, v//n or v/t/n.
static bool read_corner(struct obj_parser *parser, uint32_t *position, uint32_t *normal,
                        uint32_t *uv, struct err *err)
{
    struct text_reader *text = &parser->text;
    const struct obj_counts *counts = &parser->counts, *seen = &parser->seen;
    text_skip_blanks(text);
    struct text_reader start = *text;
    *normal = *uv = MESH_NO_INDEX;
    if (!read_index(parser, "vertex", seen->positions, counts->positions, position, err))
        return false;
    if (*text->at == '/' && text->at[1] != '/') {
        text->at++;
        if (!read_index(parser, "texture coordinate", seen->texture_coordinates,
                        counts->texture_coordinates, uv, err))
            return false;
    } else if (*text->at == '/') {
        text->at++;
    }
    if (*text->at == '/') {
        text->at++;
        if (!read_index(parser, "normal", seen->normals, counts->normals, normal, err))
            return false;
    }
    if (!text_word_ended(text))
        return text_unexpected(&start, "a corner v, v/t, v//n or v/t/n", err);
    return true;
}

static void add_triangle(struct obj_parser *parser, const uint32_t positions[3],
                         const uint32_t normals[3], const uint32_t uvs[3])
{
    uint64_t triangle = parser->seen.triangles++;
    memcpy(parser->indices[triangle], positions, sizeof parser->indices[triangle]);
    if (parser->normal_indices)
        memcpy(parser->normal_indices[triangle], normals, sizeof parser->normal_indices[triangle]);
    if (parser->uv_indices)
        memcpy(parser->uv_indices[triangle], uvs, sizeof parser->uv_indices[triangle]);
    if (parser->triangle_material)
        parser->triangle_material[triangle] = parser->material;
}

static bool read_face(struct obj_parser *parser, struct err *err)
{
    uint32_t positions[3], normals[3], uvs[3]; // the fan's centre, previous and current corner
    for (uint64_t corner = 0; !text_line_ended(&parser->text); corner++) {
        uint32_t slot = corner < 2 ? (uint32_t)corner : 2;
        if (!read_corner(parser, &positions[slot], &normals[slot], &uvs[slot], err))
            return false;
        if (slot < 2)
            continue;
        add_triangle(parser, positions, normals, uvs);
        positions[1] = positions[2];
        normals[1] = normals[2];
        uvs[1] = uvs[2];
    }
    return true;
}

static void select_material(struct obj_parser *parser)
{
    struct text_span name = text_rest_of_line(&parser->text);
    parser->material = SCENE_NONE;
    parser->wanted_material = mtl_find(&parser->library, name.data, name.size);
    if (!parser->wanted_material && parser->unknown_material_count++ == 0)
        parser->unknown_material_line = parser->text.line;
}

// Sets parser->material for the faces that follow. A material is added to the scene when the first
// face uses it.
static bool require_material(struct obj_parser *parser, struct err *err)
{
    struct mtl_material *wanted = parser->wanted_material;
    if (parser->material != SCENE_NONE)
        return true;
    if (!wanted) {
        uint32_t *fallback = &parser->default_material;
        if (!mesh_default_material(parser->scene, *fallback, parser->colors, fallback, err))
            return false;
        parser->material = *fallback;
        return true;
    }
    if (wanted->scene_index == SCENE_NONE &&
        !mtl_material_add(parser->scene, wanted, parser->allow_outside_paths, err))
        return false;
    parser->material = wanted->scene_index;
    return true;
}

static bool read_statement(struct obj_parser *parser, struct err *err)
{
    switch (read_keyword(&parser->text)) {
    case OBJ_POSITION:
        return read_position(parser, err);
    case OBJ_TEXTURE_COORDINATE:
        return read_texture_coordinate(parser, err);
    case OBJ_NORMAL:
        return read_normal(parser, err);
    case OBJ_FACE:
        return require_material(parser, err) && read_face(parser, err);
    case OBJ_USE_MATERIAL:
        select_material(parser);
        return true;
    case OBJ_MATERIAL_LIBRARY:
    case OBJ_NO_GEOMETRY:
    case OBJ_SKIPPED:
        return true;
    }
    return true;
}

// --- memory --------------------------------------------------------------------------------------

static bool allocate(struct obj_parser *parser, struct err *err)
{
    const struct obj_counts *counts = &parser->counts;
    struct arena *scene_arena = &parser->scene->arena, *scratch = &parser->scratch;
    bool has_normals = counts->normals > 0;
    if (counts->positions > UINT32_MAX || counts->normals >= MESH_NO_INDEX ||
        counts->texture_coordinates >= MESH_NO_INDEX || counts->triangles > UINT32_MAX)
        return err_set(err, ERR_INPUT,
                       "%s: %llu vertices, %llu normals, %llu triangles, "
                       "expected fewer than 4294967295 of each",
                       parser->text.path, (unsigned long long)counts->positions,
                       (unsigned long long)counts->normals, (unsigned long long)counts->triangles);
    bool has_uvs = counts->texture_coordinates > 0;
    // If there are normals or texture coordinates, merge_vertices() makes new vertices, and the
    // positions in the file's order are only temporary.
    bool merges = has_normals || has_uvs;
    parser->positions = arena_alloc(merges ? scratch : scene_arena, (size_t)counts->positions,
                                    sizeof *parser->positions);
    parser->indices = arena_alloc(scene_arena, (size_t)counts->triangles, sizeof *parser->indices);
    bool is_complete = parser->positions && parser->indices;
    if (has_normals) {
        parser->normals = arena_alloc(scratch, (size_t)counts->normals, sizeof *parser->normals);
        parser->normal_indices =
            arena_alloc(scratch, (size_t)counts->triangles, sizeof *parser->normal_indices);
        is_complete &= parser->normals && parser->normal_indices;
    }
    if (has_uvs) {
        parser->uvs =
            arena_alloc(scratch, (size_t)counts->texture_coordinates, sizeof *parser->uvs);
        parser->uv_indices =
            arena_alloc(scratch, (size_t)counts->triangles, sizeof *parser->uv_indices);
        is_complete &= parser->uvs && parser->uv_indices;
    }
    if (counts->positions > 0 && counts->colored_positions == counts->positions) {
        parser->colors = arena_alloc(merges ? scratch : scene_arena, (size_t)counts->positions,
                                     sizeof *parser->colors);
        is_complete &= parser->colors != NULL;
    }
    if (counts->material_statements > 0) {
        parser->triangle_material = ARENA_NEW(scratch, uint32_t, (size_t)counts->triangles);
        is_complete &= parser->triangle_material != NULL;
    }
    if (!is_complete)
        return err_memory(err, parser->text.path,
                          counts->positions * sizeof *parser->positions +
                              counts->triangles * sizeof *parser->indices);
    return true;
}

// --- the mesh ------------------------------------------------------------------------------------

// Stores one material if all triangles have the same one, else one for each triangle.
static bool set_materials(struct obj_parser *parser, struct mesh *mesh, struct err *err)
{
    const uint32_t *materials = parser->triangle_material;
    if (!materials || mesh->triangle_count == 0) {
        mesh->material = parser->default_material;
        return mesh_default_material(parser->scene, mesh->material, parser->colors, &mesh->material,
                                     err);
    }
    mesh->material = materials[0];
    uint32_t agreeing = 1;
    while (agreeing < mesh->triangle_count && materials[agreeing] == materials[0])
        agreeing++;
    if (agreeing == mesh->triangle_count)
        return true;
    size_t size = mesh->triangle_count * sizeof *materials;
    mesh->triangle_material = ARENA_NEW(&parser->scene->arena, uint32_t, mesh->triangle_count);
    if (!mesh->triangle_material)
        return err_memory(err, "triangle materials", size);
    memcpy(mesh->triangle_material, materials, size);
    return true;
}

// Makes one vertex for each distinct combination of position, normal and texture coordinates.
static bool merge_vertices(struct obj_parser *parser, struct mesh *mesh, struct vertex_list *list,
                           struct err *err)
{
    if (!mesh_merge_corners(&parser->scratch, parser->counts.triangles, parser->indices,
                            parser->normal_indices, parser->uv_indices, list, err))
        return false;
    struct arena *arena = &parser->scene->arena;
    mesh->vertex_count = list->count;
    mesh->positions = arena_alloc(arena, list->count, sizeof *mesh->positions);
    if (parser->normals)
        mesh->normals = arena_alloc(arena, list->count, sizeof *mesh->normals);
    if (parser->uvs)
        mesh->uvs[0] = arena_alloc(arena, list->count, sizeof *mesh->uvs[0]);
    if (parser->colors)
        mesh->colors = arena_alloc(arena, list->count, sizeof *mesh->colors);
    if (!mesh->positions || !mesh->normals != !parser->normals || !mesh->uvs[0] != !parser->uvs ||
        !mesh->colors != !parser->colors)
        return err_memory(err, "vertices", list->count * 4 * sizeof *mesh->positions);
    for (uint32_t v = 0; v < list->count; v++) {
        const uint32_t *corner = list->corners[v];
        memcpy(mesh->positions[v], parser->positions[corner[0]], sizeof mesh->positions[v]);
        if (corner[1] != MESH_NO_INDEX)
            memcpy(mesh->normals[v], parser->normals[corner[1]], sizeof mesh->normals[v]);
        if (corner[2] != MESH_NO_INDEX)
            memcpy(mesh->uvs[0][v], parser->uvs[corner[2]], sizeof mesh->uvs[0][v]);
        if (mesh->colors)
            memcpy(mesh->colors[v], parser->colors[corner[0]], sizeof mesh->colors[v]);
    }
    return true;
}

// Reads the positions again, in double precision, if single precision loses details of the mesh.
// `list` maps the mesh's vertices to the file's; NULL: both have the same indices.
static bool read_exact(struct obj_parser *parser, const struct vertex_list *list, struct mesh *mesh,
                       struct err *err)
{
    if (!mesh_is_rounded(mesh))
        return true;
    struct arena *arena = &parser->scene->arena;
    size_t count = (size_t)parser->counts.positions;
    double(*exact)[3] = arena_alloc(arena, mesh->vertex_count, sizeof *exact);
    parser->exact = list ? arena_alloc(&parser->scratch, count, sizeof *exact) : exact;
    if (!exact || !parser->exact)
        return err_memory(err, "vertices", (count + mesh->vertex_count) * sizeof *exact);
    parser->seen.positions = 0;
    if (!for_each_statement(parser, &parser->start, 1, 1, read_exact_position, err))
        return false;
    for (uint32_t v = 0; list && v < mesh->vertex_count; v++)
        memcpy(exact[v], parser->exact[list->corners[v][0]], sizeof *exact);
    mesh_keep_exact(mesh, exact);
    return true;
}

static bool build_mesh(struct obj_parser *parser, struct mesh *mesh, struct err *err)
{
    struct vertex_list list;
    bool merges = parser->normal_indices || parser->uv_indices;
    mesh->triangle_count = (uint32_t)parser->counts.triangles;
    mesh->indices = parser->indices;
    mesh->name = arena_strdup(&parser->scene->arena, path_name(parser->text.path));
    if (!mesh->name)
        return err_memory(err, "a mesh's name", strlen(parser->text.path) + 1);
    if (merges) {
        if (!merge_vertices(parser, mesh, &list, err))
            return false;
    } else {
        mesh->vertex_count = (uint32_t)parser->counts.positions;
        mesh->positions = parser->positions;
        mesh->colors = parser->colors;
    }
    return read_exact(parser, merges ? &list : NULL, mesh, err) && set_materials(parser, mesh, err);
}

static void warn_about(const struct obj_parser *parser)
{
    const char *path = parser->text.path;
    if (parser->skipped_count > 0)
        log_warn("%s:%llu: only vertices, faces and materials are read; the line is skipped (%llu "
                 "such lines in the file)",
                 path, (unsigned long long)parser->skipped_line,
                 (unsigned long long)parser->skipped_count);
    if (parser->missing_library_count > 0)
        log_warn("%s:%llu: mtllib: %s; loading continues without it (%llu such lines in the file)",
                 path, (unsigned long long)parser->missing_library_line,
                 parser->missing_library.msg, (unsigned long long)parser->missing_library_count);
    if (parser->unknown_material_count > 0)
        log_warn("%s:%llu: usemtl names an unknown material; the default material is used (%u "
                 "such lines)",
                 path, (unsigned long long)parser->unknown_material_line,
                 parser->unknown_material_count);
    if (parser->bad_normal_count > 0)
        log_warn("%s:%llu: a normal has length zero; the geometric normal is used (%llu such "
                 "lines)",
                 path, (unsigned long long)parser->bad_normal_line,
                 (unsigned long long)parser->bad_normal_count);
}

static bool parse(struct obj_parser *parser, struct mesh *mesh, struct err *err)
{
    if (!mesh_open(parser->scene, &parser->scratch, parser->text.path, &parser->start, err))
        return false;
    parser->start.joins_lines = true;
    if (!for_each_statement(parser, &parser->start, 0, 0.3, count_statement, err) ||
        !allocate(parser, err))
        return false;
    mtl_sort(&parser->library);
    if (!for_each_statement(parser, &parser->start, 0.3, 1, read_statement, err) ||
        !build_mesh(parser, mesh, err))
        return false;
    warn_about(parser);
    return true;
}

bool load_obj(struct scene *scene, const char *path, uint32_t default_material,
              bool allow_outside_paths, uint32_t *index, struct err *err)
{
    struct obj_parser parser = {
        .scene = scene,
        .text = {.path = path},
        .default_material = default_material,
        .material = SCENE_NONE,
        .allow_outside_paths = allow_outside_paths,
    };
    struct mesh mesh = {.name = ""};
    bool is_loaded = parse(&parser, &mesh, err);
    arena_finish(&parser.scratch);
    return is_loaded && scene_append_mesh(scene, &mesh, index, err);
}
