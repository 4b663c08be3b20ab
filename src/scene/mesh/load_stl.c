// Reads STL files (stereolithography, 3D Systems 1988), binary and ASCII. Corners at the same
// position become one vertex. Facet normals are ignored, because they follow from the corners,
// which are counter-clockwise as seen from outside. The format has no unit; numbers are taken as
// metres.
#include "scene/mesh/mesh_loader.h"

#include "base/file.h"
#include "base/log.h"

#include <math.h>
#include <string.h>

#define BINARY_HEADER_BYTES 84u // a comment of 80 bytes and the number of triangles
#define BINARY_FACET_BYTES                                                                         \
    50u                              // normal, three corners, 16 bits whose meaning depends on the
                                     // program
#define FACETS_BETWEEN_LOOKS 262144u // triangles between two polls for a stop

struct stl_parser {
    struct scene *scene;
    struct arena scratch;
    struct text_reader text; // in binary files only a byte position
    const char *start;       // start of the file
    // The bits of each coordinate of each corner; equal positions have equal bits.
    struct triangle_list axes[3];
    double (*exact)[3]; // not NULL in a second pass over an ASCII file, which reads only these:
                        // three corners for each triangle
    uint64_t exact_count;
};

// --- triangles -----------------------------------------------------------------------------------

static bool go_on(const struct stl_parser *parser, struct err *err)
{
    uint32_t count = parser->axes[0].count;
    double size = (double)(parser->text.end - parser->start);
    return count % FACETS_BETWEEN_LOOKS != 0 ||
           scene_loading(parser->scene, (double)(parser->text.at - parser->start) / size, err);
}

static bool add_triangle(struct stl_parser *parser, float corners[3][3], struct err *err)
{
    for (int axis = 0; axis < 3; axis++) {
        uint32_t bits[3];
        for (int corner = 0; corner < 3; corner++) {
            float value = corners[corner][axis] + 0.0f; // -0 becomes 0
            memcpy(&bits[corner], &value, sizeof value);
        }
        if (!triangle_list_add(&parser->axes[axis], bits[0], bits[1], bits[2], err))
            return false;
    }
    return go_on(parser, err);
}

static bool is_finite(const float corner[3])
{
    return isfinite(corner[0]) && isfinite(corner[1]) && isfinite(corner[2]);
}

// --- binary --------------------------------------------------------------------------------------

static uint32_t read_word(const char *at)
{
    const unsigned char *bytes = (const unsigned char *)at;
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

// The size decides, because many binary files begin with "solid", like ASCII files.
static bool is_binary(const struct stl_parser *parser)
{
    size_t size = text_remaining(&parser->text);
    return size >= BINARY_HEADER_BYTES &&
           size == BINARY_HEADER_BYTES + (uint64_t)BINARY_FACET_BYTES *
                                             read_word(parser->text.at + BINARY_HEADER_BYTES - 4);
}

static bool read_binary(struct stl_parser *parser, struct err *err)
{
    uint32_t count = read_word(parser->text.at + BINARY_HEADER_BYTES - 4);
    parser->text.at += BINARY_HEADER_BYTES;
    for (int axis = 0; axis < 3; axis++)
        if (!triangle_list_reserve(&parser->axes[axis], count, err))
            return false;
    for (uint32_t i = 0; i < count; i++, parser->text.at += BINARY_FACET_BYTES) {
        float corners[3][3];
        for (int word = 0; word < 9; word++) {
            uint32_t bits = read_word(parser->text.at + 12 + 4 * word);
            memcpy(&corners[word / 3][word % 3], &bits, sizeof bits);
        }
        for (int corner = 0; corner < 3; corner++)
            if (!is_finite(corners[corner]))
                return err_set(
                    err, ERR_INPUT,
                    "%s: triangle %u: corner %d is (%g, %g, %g); expected finite numbers",
                    parser->text.path, i, corner, (double)corners[corner][0],
                    (double)corners[corner][1], (double)corners[corner][2]);
        if (!add_triangle(parser, corners, err))
            return false;
    }
    return true;
}

// --- ASCII ---------------------------------------------------------------------------------------

static struct text_span next_word(struct stl_parser *parser)
{
    text_skip_space(&parser->text);
    return text_word(&parser->text);
}

static bool expect(struct stl_parser *parser, const char *word, struct err *err)
{
    text_skip_space(&parser->text);
    struct text_reader before = parser->text;
    return text_equals(text_word(&parser->text), word) || text_unexpected(&before, word, err);
}

static bool read_corner(struct stl_parser *parser, float corner[3], struct err *err)
{
    if (!expect(parser, "vertex", err))
        return false;
    for (int axis = 0; axis < 3; axis++) {
        text_skip_space(&parser->text);
        struct text_reader again = parser->text;
        if (!text_float(&parser->text, "a coordinate", &corner[axis], err))
            return false;
        if (parser->exact)
            text_take_double(&again, &parser->exact[parser->exact_count][axis]);
    }
    parser->exact_count++;
    return is_finite(corner) || text_fail(&parser->text, err,
                                          "the corner is (%g, %g, %g); expected finite numbers in "
                                          "single precision",
                                          (double)corner[0], (double)corner[1], (double)corner[2]);
}

// Reads a facet after its first word, "facet".
static bool read_facet(struct stl_parser *parser, struct err *err)
{
    float corners[3][3];
    if (!expect(parser, "normal", err))
        return false;
    for (int i = 0; i < 3; i++)
        next_word(parser); // some programs write "nan" or other words here
    if (!expect(parser, "outer", err) || !expect(parser, "loop", err))
        return false;
    for (int corner = 0; corner < 3; corner++)
        if (!read_corner(parser, corners[corner], err))
            return false;
    return expect(parser, "endloop", err) && expect(parser, "endfacet", err) &&
           (parser->exact || add_triangle(parser, corners, err));
}

// Reads any number of solids. After "solid" and "endsolid" the rest of the line is a name.
static bool read_ascii(struct stl_parser *parser, struct err *err)
{
    bool is_in_solid = false;
    for (;;) {
        text_skip_space(&parser->text);
        struct text_reader before = parser->text;
        struct text_span word = text_word(&parser->text);
        bool begins = !is_in_solid && text_equals(word, "solid");
        bool ends = is_in_solid && text_equals(word, "endsolid");
        if (word.size == 0)
            return !is_in_solid || text_unexpected(&before, "facet or endsolid", err);
        if (is_in_solid && text_equals(word, "facet")) {
            if (!read_facet(parser, err))
                return false;
        } else if (begins || ends) {
            is_in_solid = begins;
            text_next_line(&parser->text);
        } else {
            return text_unexpected(&before, is_in_solid ? "facet or endsolid" : "solid", err);
        }
    }
}

// --- the mesh ------------------------------------------------------------------------------------

static bool build_mesh(struct stl_parser *parser, uint32_t default_material, struct mesh *mesh,
                       struct err *err)
{
    struct arena *arena = &parser->scene->arena;
    const uint32_t count = parser->axes[0].count;
    struct vertex_list vertices = {0};
    if (count > 0 &&
        !mesh_merge_corners(&parser->scratch, count, parser->axes[0].indices,
                            parser->axes[1].indices, parser->axes[2].indices, &vertices, err))
        return err_prepend(err, "%s", parser->text.path);
    mesh->name = arena_strdup(arena, path_name(parser->text.path));
    mesh->vertex_count = vertices.count;
    mesh->triangle_count = count;
    mesh->positions = arena_alloc(arena, vertices.count, sizeof *mesh->positions);
    mesh->indices = arena_alloc(arena, count, sizeof *mesh->indices);
    if (!mesh->name || !mesh->positions || !mesh->indices)
        return err_memory(err, "triangles", count * sizeof *mesh->indices);
    if (count > 0) {
        memcpy(mesh->positions, vertices.corners, vertices.count * sizeof *mesh->positions);
        memcpy(mesh->indices, parser->axes[0].indices, count * sizeof *mesh->indices);
    } else {
        log_warn("%s: has no triangles", parser->text.path);
    }
    return mesh_default_material(parser->scene, default_material, false, &mesh->material, err);
}

// Keeps all digits of an ASCII file if single precision loses details of the mesh. Each corner is
// then a vertex of its own, because corners that are equal in single precision may differ.
static bool read_exact(struct stl_parser *parser, struct text_reader begin, struct mesh *mesh,
                       struct err *err)
{
    if (!mesh_is_rounded(mesh))
        return true;
    const uint64_t corners = 3 * (uint64_t)mesh->triangle_count;
    struct arena *arena = &parser->scene->arena;
    float(*positions)[3] = arena_alloc(arena, corners, sizeof *positions);
    parser->exact = arena_alloc(arena, corners, sizeof *parser->exact);
    if (!positions || !parser->exact)
        return err_memory(err, "vertices", corners * sizeof *parser->exact);
    parser->exact_count = 0;
    parser->text = begin;
    if (!read_ascii(parser, err))
        return false;
    for (uint32_t i = 0; i < corners; i++) {
        uint32_t *vertex = &mesh->indices[i / 3][i % 3];
        memcpy(positions[i], mesh->positions[*vertex], sizeof *positions);
        *vertex = i;
    }
    mesh->positions = positions;
    mesh->vertex_count = (uint32_t)corners;
    mesh_keep_exact(mesh, parser->exact);
    return true;
}

static bool fail_unknown(const struct stl_parser *parser, struct err *err)
{
    const char *path = parser->text.path;
    size_t size = text_remaining(&parser->text);
    if (size < BINARY_HEADER_BYTES)
        return err_set(
            err, ERR_INPUT,
            "%s: is not an STL file: it does not begin with \"solid\", and %zu bytes are too "
            "few for a binary file; expected at least %u",
            path, size, BINARY_HEADER_BYTES);
    uint64_t count = read_word(parser->text.at + BINARY_HEADER_BYTES - 4);
    return err_set(
        err, ERR_INPUT,
        "%s: is not an STL file: it does not begin with \"solid\", and a binary file of %llu "
        "triangles has %llu bytes, not %zu",
        path, (unsigned long long)count,
        (unsigned long long)(BINARY_HEADER_BYTES + BINARY_FACET_BYTES * count), size);
}

static bool parse(struct stl_parser *parser, uint32_t default_material, struct mesh *mesh,
                  struct err *err)
{
    if (!mesh_open(parser->scene, &parser->scratch, parser->text.path, &parser->text, err))
        return false;
    parser->start = parser->text.at;
    const struct text_reader begin = parser->text;
    struct text_reader first = begin;
    text_skip_space(&first);
    if (is_binary(parser))
        return read_binary(parser, err) && build_mesh(parser, default_material, mesh, err);
    if (!text_equals(text_word(&first), "solid"))
        return fail_unknown(parser, err);
    return read_ascii(parser, err) && build_mesh(parser, default_material, mesh, err) &&
           read_exact(parser, begin, mesh, err);
}

bool load_stl(struct scene *scene, const char *path, uint32_t default_material, uint32_t *index,
              struct err *err)
{
    struct stl_parser parser = {.scene = scene, .text = {.path = path}};
    for (int axis = 0; axis < 3; axis++)
        parser.axes[axis].arena = &parser.scratch;
    struct mesh mesh = {.name = ""};
    bool is_loaded = parse(&parser, default_material, &mesh, err);
    arena_finish(&parser.scratch);
    return is_loaded && scene_append_mesh(scene, &mesh, index, err);
}
