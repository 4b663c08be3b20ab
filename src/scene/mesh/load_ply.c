// Reads PLY, the Stanford triangle format (Turk 1994): ASCII and binary of both byte orders.
// Polygons are split into fans around their first corner; triangle strips alternate their winding.
// Elements and properties that a mesh does not use are skipped by their declared size.
#include "scene/mesh/mesh_loader.h"
#include "scene/mesh/ply_header.h"

#include "base/file.h"
#include "base/log.h"
#include "image/image.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct ply_parser {
    struct scene *scene;
    struct arena scratch;
    struct text_reader text; // in binary files only a byte position
    const char *start;       // start of the file
    struct ply_header header;
    // The element, row and property that are being read, for messages.
    const struct ply_element *element;
    uint64_t row;

    float (*positions)[3];
    double (*exact)[3];          // not NULL in a second pass, which reads only these positions
    struct text_reader vertices; // start of the rows of vertices
    float (*normals)[3];         // NULL if there are no nx, ny, nz
    float (*uvs)[2];             // NULL if there are no u, v
    float (*colors)[4];          // NULL if there are no red, green, blue
    struct triangle_list triangles;
    uint64_t bad_normal_count;
};

// --- values --------------------------------------------------------------------------------------

// Fails with "PATH: face 7: MESSAGE", or "PATH:LINE: face 7: MESSAGE" in ASCII files. Rows count
// from 0, as the file's indices do.
static bool ply_fail(const struct ply_parser *parser, struct err *err, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static bool ply_fail(const struct ply_parser *parser, struct err *err, const char *format, ...)
{
    char message[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    const char *element = parser->element->name;
    unsigned long long row = parser->row;
    if (parser->header.format == PLY_ASCII)
        return text_fail(&parser->text, err, "%s %llu: %s", element, row, message);
    return err_set(err, ERR_INPUT, "%s: %s %llu: %s", parser->text.path, element, row, message);
}

static bool read_ascii_value(struct ply_parser *parser, enum ply_type type, double *out,
                             struct err *err)
{
    struct text_reader *text = &parser->text;
    float real;
    int64_t integer;
    text_skip_space(text);
    if (ply_type_is_float(type) && parser->exact && text_take_double(text, out))
        return true;
    if (ply_type_is_float(type) && text_take_float(text, &real)) {
        *out = (double)real;
        return true;
    }
    struct text_reader start = *text;
    if (!ply_type_is_float(type) && text_take_integer(text, &integer) && text_word_ended(text)) {
        *out = (double)integer;
        return true;
    }
    char shown[25];
    text_printable(text_word(&start), shown, sizeof shown);
    if (shown[0] == '\0')
        return ply_fail(parser, err, "the file ends here");
    return ply_fail(parser, err, "expected %s, found '%s'",
                    ply_type_is_float(type) ? "a number" : "an integer", shown);
}

static double decode_value(uint64_t bits, enum ply_type type)
{
    float single;
    double real;
    uint32_t low_bits = (uint32_t)bits;
    switch (type) {
    case PLY_I8:
        return (int8_t)bits;
    case PLY_I16:
        return (int16_t)bits;
    case PLY_I32:
        return (int32_t)bits;
    case PLY_U8:
    case PLY_U16:
    case PLY_U32:
        return (double)bits;
    case PLY_F32:
        memcpy(&single, &low_bits, sizeof single);
        return (double)single;
    case PLY_F64:
        memcpy(&real, &bits, sizeof real);
        return real;
    }
    return 0.0;
}

static bool read_binary_value(struct ply_parser *parser, enum ply_type type, double *out,
                              struct err *err)
{
    const unsigned char *bytes = (const unsigned char *)parser->text.at;
    uint32_t size = ply_type_size(type);
    if (text_remaining(&parser->text) < size)
        return ply_fail(parser, err, "the file ends here");
    uint64_t bits = 0;
    for (uint32_t i = 0; i < size; i++) {
        uint32_t place = parser->header.format == PLY_BIG_ENDIAN ? size - 1 - i : i;
        bits |= (uint64_t)bytes[i] << 8 * place;
    }
    parser->text.at += size;
    *out = decode_value(bits, type);
    return true;
}

// Reads a value. Every value fits a double, because integers have at most 32 bits.
static bool read_value(struct ply_parser *parser, enum ply_type type, double *out, struct err *err)
{
    return parser->header.format == PLY_ASCII ? read_ascii_value(parser, type, out, err)
                                              : read_binary_value(parser, type, out, err);
}

// Checks that the rest of the file can hold `count` items of at least `size` bytes. In ASCII an
// item takes at least a digit and a blank; the last item of the file needs no blank.
static bool check_room(const struct ply_parser *parser, uint64_t count, uint64_t size,
                       struct err *err)
{
    uint64_t needed, remaining = text_remaining(&parser->text);
    uint64_t slack = parser->header.format == PLY_ASCII ? 1 : 0;
    if (!__builtin_mul_overflow(count, size, &needed) && needed <= remaining + slack)
        return true;
    return ply_fail(parser, err, "%llu entries of %llu bytes or more, but only %llu bytes remain",
                    (unsigned long long)count, (unsigned long long)size,
                    (unsigned long long)remaining);
}

// --- faces ---------------------------------------------------------------------------------------

// The corners of a polygon or strip that have been read so far.
struct corner_run {
    uint64_t count;
    uint32_t first, before_last, last;
};

static bool add_polygon_corner(struct ply_parser *parser, struct corner_run *run, uint32_t corner,
                               struct err *err)
{
    return run->count < 2 ||
           triangle_list_add(&parser->triangles, run->first, run->last, corner, err);
}

// Adds a corner to a strip. Every second triangle of a strip is reversed so that all face the same
// side. Triangles with a repeated corner only connect parts of the strip and are omitted.
static bool add_strip_corner(struct ply_parser *parser, struct corner_run *run, uint32_t corner,
                             struct err *err)
{
    uint32_t a = run->before_last, b = run->last;
    if (run->count < 2 || a == b || b == corner || a == corner)
        return true;
    bool is_turned = run->count % 2 != 0;
    return triangle_list_add(&parser->triangles, is_turned ? b : a, is_turned ? a : b, corner, err);
}

static bool add_corner(struct ply_parser *parser, const struct ply_property *property, double index,
                       struct corner_run *run, struct err *err)
{
    // -1 ends a strip; writers of unsigned indices store the same bits.
    bool is_restart = index == -1.0 || (property->type == PLY_U32 && index == (double)UINT32_MAX);
    if (property->use == USE_STRIP && is_restart) {
        *run = (struct corner_run){0};
        return true;
    }
    if (index < 0.0 || index >= (double)parser->header.vertices->count)
        return ply_fail(parser, err, "vertex index %.0f; expected 0 or more and below %llu", index,
                        (unsigned long long)parser->header.vertices->count);
    uint32_t corner = (uint32_t)index;
    if (property->use == USE_STRIP ? !add_strip_corner(parser, run, corner, err)
                                   : !add_polygon_corner(parser, run, corner, err))
        return false;
    if (run->count++ == 0)
        run->first = corner;
    run->before_last = run->last;
    run->last = corner;
    return true;
}

static bool read_list(struct ply_parser *parser, const struct ply_property *property,
                      struct err *err)
{
    double count, value;
    if (!read_value(parser, property->count_type, &count, err))
        return false;
    if (count < 0.0)
        return ply_fail(parser, err, "a list of %.0f entries; expected 0 or more", count);
    if (property->use == USE_POLYGON && count < 3.0)
        return ply_fail(parser, err, "a face of %.0f corners; expected at least 3", count);
    bool is_ascii = parser->header.format == PLY_ASCII;
    uint64_t entries = (uint64_t)count, size = is_ascii ? 2 : ply_type_size(property->type);
    if (!check_room(parser, entries, size, err))
        return false;
    if (property->use == USE_NONE && !is_ascii) {
        parser->text.at += entries * size;
        return true;
    }
    struct corner_run run = {0};
    for (uint64_t i = 0; i < entries; i++) {
        if (!read_value(parser, property->type, &value, err))
            return false;
        if (property->use != USE_NONE && !add_corner(parser, property, value, &run, err))
            return false;
    }
    return true;
}

// --- elements ------------------------------------------------------------------------------------

// Converts a colour component. Integers are sRGB-encoded, as scanners and painting programs write
// them; floating-point numbers are linear.
static float color_value(double value, enum ply_type type)
{
    double most = type == PLY_U8 ? UINT8_MAX : type == PLY_U16 ? UINT16_MAX : 1.0;
    float clamped = (float)fmin(fmax(value / most, 0.0), 1.0); // NaN becomes 0
    return ply_type_is_float(type) ? clamped : image_srgb_to_linear(clamped);
}

static bool store_vertex(struct ply_parser *parser, const double values[VERTEX_VALUE_COUNT],
                         struct err *err)
{
    if (parser->exact) {
        memcpy(parser->exact[parser->row], &values[USE_X], sizeof *parser->exact);
        return true;
    }
    float *position = parser->positions[parser->row];
    for (int c = 0; c < 3; c++) {
        position[c] = (float)values[USE_X + c];
        if (!isfinite(position[c]))
            return ply_fail(parser, err, "%c is %g; expected a finite number in single precision",
                            'x' + c, values[USE_X + c]);
    }
    if (parser->normals) {
        float given[3] = {(float)values[USE_NX], (float)values[USE_NY], (float)values[USE_NZ]};
        if (!mesh_unit_normal(given, parser->normals[parser->row]))
            parser->bad_normal_count++;
    }
    if (parser->uvs) {
        parser->uvs[parser->row][0] = (float)values[USE_U];
        parser->uvs[parser->row][1] = (float)(1.0 - values[USE_V]); // t points down in meshes
    }
    if (parser->colors)
        for (int c = 0; c < 4; c++)
            parser->colors[parser->row][c] = (float)values[USE_RED + c];
    return true;
}

static bool read_row(struct ply_parser *parser, struct err *err)
{
    double values[VERTEX_VALUE_COUNT] = {[USE_ALPHA] = 1}, value;
    for (const struct ply_property *property = parser->element->properties; property;
         property = property->next) {
        if (property->is_list) {
            if (!read_list(parser, property, err))
                return false;
            continue;
        }
        if (!read_value(parser, property->type, &value, err))
            return false;
        if (property->use >= USE_RED && property->use <= USE_BLUE)
            value = (double)color_value(value, property->type);
        if (property->use == USE_ALPHA && property->type == PLY_U8)
            value /= UINT8_MAX;
        if (property->use < VERTEX_VALUE_COUNT)
            values[property->use] = value;
    }
    return parser->element != parser->header.vertices || store_vertex(parser, values, err);
}

static bool allocate_vertices(struct ply_parser *parser, struct err *err)
{
    const uint32_t normal_uses = 1u << USE_NX | 1u << USE_NY | 1u << USE_NZ;
    const uint32_t uv_uses = 1u << USE_U | 1u << USE_V;
    const uint32_t color_uses = 1u << USE_RED | 1u << USE_GREEN | 1u << USE_BLUE;
    uint32_t uses = parser->header.vertices->uses;
    size_t count = (size_t)parser->header.vertices->count;
    struct arena *arena = &parser->scene->arena;
    parser->positions = arena_alloc(arena, count, sizeof *parser->positions);
    bool is_complete = parser->positions;
    if ((uses & normal_uses) == normal_uses)
        is_complete &=
            (parser->normals = arena_alloc(arena, count, sizeof *parser->normals)) != NULL;
    if ((uses & uv_uses) == uv_uses)
        is_complete &= (parser->uvs = arena_alloc(arena, count, sizeof *parser->uvs)) != NULL;
    if ((uses & color_uses) == color_uses)
        is_complete &= (parser->colors = arena_alloc(arena, count, sizeof *parser->colors)) != NULL;
    return is_complete || err_memory(err, "vertices", count * 4 * sizeof *parser->positions);
}

#define ROWS_BETWEEN_LOOKS 262144 // rows between two polls for a stop

static bool read_each_row(struct ply_parser *parser, struct err *err)
{
    double size = (double)(parser->text.end - parser->start);
    for (parser->row = 0; parser->row < parser->element->count; parser->row++) {
        if (!read_row(parser, err))
            return false;
        if ((parser->row + 1) % ROWS_BETWEEN_LOOKS == 0 &&
            !scene_loading(parser->scene, (double)(parser->text.at - parser->start) / size, err))
            return false;
    }
    return true;
}

// Reads all rows of parser->element. Memory is only allocated for rows that the file can hold.
static bool read_rows(struct ply_parser *parser, struct err *err)
{
    const struct ply_element *element = parser->element;
    parser->row = 0;
    if (element->property_count == 0)
        return true; // such rows take no bytes, so their count is not checked
    bool is_ascii = parser->header.format == PLY_ASCII;
    uint64_t row_bytes = is_ascii ? 2 * element->property_count : element->min_row_bytes;
    if (!check_room(parser, element->count, row_bytes, err))
        return false;
    if (element == parser->header.vertices && !allocate_vertices(parser, err))
        return false;
    if (element->uses & 1u << USE_POLYGON &&
        !triangle_list_reserve(&parser->triangles, element->count, err))
        return false;
    if (element == parser->header.vertices)
        parser->vertices = parser->text;
    return read_each_row(parser, err);
}

// --- the mesh ------------------------------------------------------------------------------------

static bool build_mesh(struct ply_parser *parser, uint32_t default_material, struct mesh *mesh,
                       struct err *err)
{
    struct arena *arena = &parser->scene->arena;
    const struct triangle_list *triangles = &parser->triangles;
    size_t size = triangles->count * sizeof *triangles->indices;
    mesh->name = arena_strdup(arena, path_name(parser->text.path));
    mesh->vertex_count = (uint32_t)parser->header.vertices->count;
    mesh->triangle_count = triangles->count;
    mesh->positions = parser->positions;
    mesh->normals = parser->normals;
    mesh->uvs[0] = parser->uvs;
    mesh->colors = parser->colors;
    mesh->indices = arena_alloc(arena, triangles->count, sizeof *mesh->indices);
    if (!mesh->name || !mesh->indices)
        return err_memory(err, "triangles", size);
    if (size > 0)
        memcpy(mesh->indices, triangles->indices, size);
    return mesh_default_material(parser->scene, default_material, mesh->colors, &mesh->material,
                                 err);
}

// Reads the vertices again, in double precision, if single precision loses details of the mesh. In
// ASCII files all digits count, whatever type is declared.
static bool read_exact(struct ply_parser *parser, struct mesh *mesh, struct err *err)
{
    if (!mesh_is_rounded(mesh))
        return true;
    const struct triangle_list triangles = parser->triangles;
    parser->exact = arena_alloc(&parser->scene->arena, mesh->vertex_count, sizeof *parser->exact);
    if (!parser->exact)
        return err_memory(err, "vertices", mesh->vertex_count * sizeof *parser->exact);
    parser->element = parser->header.vertices;
    parser->text = parser->vertices;
    if (!read_each_row(parser, err))
        return false;
    parser->triangles = triangles;
    mesh_keep_exact(mesh, parser->exact);
    return true;
}

static void warn_about(const struct ply_parser *parser)
{
    if (parser->triangles.count == 0)
        log_warn("%s: has no faces", parser->text.path);
    if (parser->bad_normal_count > 0)
        log_warn("%s: %llu normals of length zero; geometric normals are used", parser->text.path,
                 (unsigned long long)parser->bad_normal_count);
}

static bool parse(struct ply_parser *parser, uint32_t default_material, struct mesh *mesh,
                  struct err *err)
{
    if (!mesh_open(parser->scene, &parser->scratch, parser->text.path, &parser->text, err))
        return false;
    parser->start = parser->text.at;
    if (!ply_read_header(&parser->scratch, &parser->text, &parser->header, err))
        return false;
    for (parser->element = parser->header.elements; parser->element;
         parser->element = parser->element->next) {
        if (!read_rows(parser, err))
            return false;
    }
    if (!build_mesh(parser, default_material, mesh, err) || !read_exact(parser, mesh, err))
        return false;
    warn_about(parser);
    return true;
}

bool load_ply(struct scene *scene, const char *path, uint32_t default_material, uint32_t *index,
              struct err *err)
{
    struct ply_parser parser = {.scene = scene, .text = {.path = path}};
    parser.triangles.arena = &parser.scratch;
    struct mesh mesh = {.name = ""};
    bool is_loaded = parse(&parser, default_material, &mesh, err);
    arena_finish(&parser.scratch);
    return is_loaded && scene_append_mesh(scene, &mesh, index, err);
}
