// Reads the header of PLY files: lines of words up to "end_header".
#include "scene/mesh/ply_header.h"

#include <string.h>

static const struct {
    const char *name, *other_name;
    uint32_t size;
} ply_types[] = {
    [PLY_I8] = {"char", "int8", 1},      [PLY_U8] = {"uchar", "uint8", 1},
    [PLY_I16] = {"short", "int16", 2},   [PLY_U16] = {"ushort", "uint16", 2},
    [PLY_I32] = {"int", "int32", 4},     [PLY_U32] = {"uint", "uint32", 4},
    [PLY_F32] = {"float", "float32", 4}, [PLY_F64] = {"double", "float64", 8},
};

uint32_t ply_type_size(enum ply_type type)
{
    return ply_types[type].size;
}

bool ply_type_is_float(enum ply_type type)
{
    return type == PLY_F32 || type == PLY_F64;
}

struct header_parser {
    struct arena *arena;
    struct text_reader *text;
    struct ply_header *header;
};

static bool read_type(struct header_parser *parser, enum ply_type *type, struct err *err)
{
    struct text_reader start = *parser->text;
    struct text_span word = text_word(parser->text);
    for (size_t i = 0; i < sizeof ply_types / sizeof ply_types[0]; i++) {
        if (text_equals(word, ply_types[i].name) || text_equals(word, ply_types[i].other_name)) {
            *type = (enum ply_type)i;
            return true;
        }
    }
    return text_unexpected(&start, "a type such as float or uchar", err);
}

static bool is_corner_list(enum ply_use use)
{
    return use == USE_POLYGON || use == USE_STRIP;
}

static bool read_format(struct header_parser *parser, struct err *err)
{
    static const char *const names[] = {
        [PLY_ASCII] = "ascii",
        [PLY_LITTLE_ENDIAN] = "binary_little_endian",
        [PLY_BIG_ENDIAN] = "binary_big_endian",
    };
    struct text_reader start = *parser->text;
    struct text_span word = text_word(parser->text);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (!text_equals(word, names[i]))
            continue;
        parser->header->format = (enum ply_format)i;
        parser->header->has_format = true;
        start = *parser->text;
        return text_equals(text_word(parser->text), "1.0") ||
               text_unexpected(&start, "format version 1.0", err);
    }
    return text_unexpected(&start, "the format ascii, binary_little_endian or binary_big_endian",
                           err);
}

static bool read_element(struct header_parser *parser, struct err *err)
{
    struct ply_element *element = ARENA_NEW(parser->arena, struct ply_element, 1);
    if (!element)
        return err_memory(err, "a PLY element", sizeof *element);
    text_printable(text_word(parser->text), element->name, sizeof element->name);
    int64_t count;
    if (!text_integer(parser->text, "an element's name and count", &count, err))
        return false;
    if (count < 0)
        return text_fail(parser->text, err, "element %s: a count of %lld; expected 0 or more",
                         element->name, (long long)count);
    element->count = (uint64_t)count;
    if (parser->header->last_element)
        parser->header->last_element->next = element;
    else
        parser->header->elements = element;
    parser->header->last_element = element;
    if (strcmp(element->name, "vertex") != 0)
        return true;
    if (parser->header->vertices)
        return text_fail(parser->text, err, "element vertex is declared twice");
    parser->header->vertices = element;
    return true;
}

static enum ply_use find_use(const struct ply_element *element, struct text_span name, bool is_list)
{
    static const struct {
        const char *element, *property;
        enum ply_use use;
    } uses[] = {
        {"vertex", "x", USE_X},
        {"vertex", "y", USE_Y},
        {"vertex", "z", USE_Z},
        {"vertex", "nx", USE_NX},
        {"vertex", "ny", USE_NY},
        {"vertex", "nz", USE_NZ},
        {"vertex", "u", USE_U},
        {"vertex", "v", USE_V},
        {"vertex", "s", USE_U},
        {"vertex", "t", USE_V},
        {"vertex", "texture_u", USE_U},
        {"vertex", "texture_v", USE_V},
        {"vertex", "red", USE_RED},
        {"vertex", "green", USE_GREEN},
        {"vertex", "blue", USE_BLUE},
        {"vertex", "alpha", USE_ALPHA},
        {"vertex", "diffuse_red", USE_RED},
        {"vertex", "diffuse_green", USE_GREEN},
        {"vertex", "diffuse_blue", USE_BLUE},
        {"face", "vertex_indices", USE_POLYGON},
        {"face", "vertex_index", USE_POLYGON},
        {"tristrips", "vertex_indices", USE_STRIP},
        {"tristrips", "vertex_index", USE_STRIP},
    };
    for (size_t i = 0; i < sizeof uses / sizeof uses[0]; i++) {
        if (strcmp(element->name, uses[i].element) == 0 && text_equals(name, uses[i].property) &&
            is_list == (uses[i].use >= VERTEX_VALUE_COUNT))
            return uses[i].use;
    }
    return USE_NONE;
}

// Reads a property's type: "float" or "list uchar int".
static bool read_property_type(struct header_parser *parser, struct ply_property *property,
                               struct err *err)
{
    struct text_reader ahead = *parser->text;
    property->is_list = text_equals(text_word(&ahead), "list");
    if (property->is_list) {
        *parser->text = ahead;
        if (!read_type(parser, &property->count_type, err))
            return false;
        if (ply_type_is_float(property->count_type))
            return text_unexpected(&ahead, "an integer type for a list's count", err);
    }
    return read_type(parser, &property->type, err);
}

static bool read_property(struct header_parser *parser, struct err *err)
{
    struct ply_element *element = parser->header->last_element;
    if (!element)
        return text_fail(parser->text, err, "a property before the first element");
    struct ply_property *property = ARENA_NEW(parser->arena, struct ply_property, 1);
    if (!property)
        return err_memory(err, "a PLY property", sizeof *property);
    if (!read_property_type(parser, property, err))
        return false;
    struct text_span name = text_word(parser->text);
    property->use = find_use(element, name, property->is_list);
    if (property->use != USE_NONE && element->uses & 1u << property->use)
        return text_fail(parser->text, err, "%.*s is declared twice in element %s", (int)name.size,
                         name.data, element->name);
    if (is_corner_list(property->use) && ply_type_is_float(property->type))
        return text_fail(parser->text, err, "%.*s: expected an integer type", (int)name.size,
                         name.data);
    element->uses |= 1u << property->use;
    if (element->last_property)
        element->last_property->next = property;
    else
        element->properties = property;
    element->last_property = property;
    element->property_count++;
    element->min_row_bytes +=
        ply_type_size(property->is_list ? property->count_type : property->type);
    return true;
}

// Reads one line; sets *is_last at "end_header".
static bool read_header_line(struct header_parser *parser, bool *is_last, struct err *err)
{
    struct text_reader start = *parser->text;
    struct text_span keyword = text_word(parser->text);
    *is_last = text_equals(keyword, "end_header");
    if (*is_last || text_equals(keyword, "comment") || text_equals(keyword, "obj_info"))
        return true;
    if (text_equals(keyword, "format"))
        return read_format(parser, err);
    if (text_equals(keyword, "element"))
        return read_element(parser, err);
    if (text_equals(keyword, "property"))
        return read_property(parser, err);
    return text_unexpected(&start, "a line of a PLY header", err);
}

// Checks conditions that depend on the whole header.
static bool check_header(const struct ply_header *header, const char *path, struct err *err)
{
    const uint32_t needed = 1u << USE_X | 1u << USE_Y | 1u << USE_Z;
    if (!header->has_format)
        return err_set(err, ERR_INPUT, "%s: the header has no format line", path);
    if (!header->vertices)
        return err_set(err, ERR_INPUT, "%s: the header has no element vertex", path);
    if ((header->vertices->uses & needed) != needed)
        return err_set(err, ERR_INPUT, "%s: element vertex: expected properties x, y and z", path);
    if (header->vertices->count > UINT32_MAX)
        return err_set(err, ERR_INPUT, "%s: %llu vertices; expected at most 4294967295", path,
                       (unsigned long long)header->vertices->count);
    return true;
}

bool ply_read_header(struct arena *arena, struct text_reader *text, struct ply_header *out,
                     struct err *err)
{
    *out = (struct ply_header){0};
    struct header_parser parser = {.arena = arena, .text = text, .header = out};
    struct text_reader start = *text;
    if (!text_equals(text_word(text), "ply"))
        return text_unexpected(&start, "'ply', the first line of a PLY file", err);
    // If lines end with CR alone, an LF after the header belongs to the data.
    bool has_bare_cr = text->at[0] == '\r' && text->at[1] != '\n';
    bool is_last = false;
    while (!is_last) {
        text_next_line(text);
        if (text_remaining(text) == 0)
            return text_fail(text, err, "the file ends inside the header");
        if (!read_header_line(&parser, &is_last, err))
            return false;
    }
    if (has_bare_cr && text->at[0] == '\r')
        text->at++;
    else
        text_next_line(text);
    return check_header(out, text->path, err);
}
