// Materials of OBJ files: the part of MTL that has a meaning for a path tracer of diffuse surfaces,
// lights and mirrors. Format: Wavefront, "MTL material format", 1995.
#include "mesh_loader.h"

#include "file.h"
#include "hash.h"
#include "log.h"
#include "text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A file that was read; a list.
struct mtl_file {
    struct mtl_file *next;
    const char *path;
};

// One material's statements; what its last line leaves is turned into a struct material.
struct mtl_statements {
    const char *name; // NULL before the first newmtl
    float diffuse[3], specular[3], emission[3];
    int64_t illumination_model;
};

struct mtl_parser {
    struct text_reader text;
    struct arena *arena;
    struct mtl_library *library;
    struct mtl_statements current;
    // Counted for one warning a file; the lines are those of the first.
    uint64_t clamped_count, clamped_line;
    uint64_t skipped_count, skipped_line;
};

// Room for one more material; the outgrown array stays in the arena.
static struct mtl_material *add_material(struct mtl_parser *parser)
{
    struct mtl_library *library = parser->library;
    if (library->count == library->capacity) {
        if (library->capacity > UINT32_MAX / 2)
            return NULL;
        uint32_t capacity = library->capacity < 16 ? 16 : 2 * library->capacity;
        struct mtl_material *grown = ARENA_NEW(parser->arena, struct mtl_material, capacity);
        if (!grown)
            return NULL;
        if (library->count > 0)
            memcpy(grown, library->materials, library->count * sizeof *grown);
        library->materials = grown;
        library->capacity = capacity;
    }
    return &library->materials[library->count++];
}

static bool is_black(const float color[3])
{
    return color[0] == 0.0f && color[1] == 0.0f && color[2] == 0.0f;
}

// Appends the material that was being read, if any.
static bool finish_material(struct mtl_parser *parser, struct err *err)
{
    const struct mtl_statements *read = &parser->current;
    if (!read->name)
        return true;
    struct mtl_material *added = add_material(parser);
    if (!added)
        return err_memory(err, "a material", sizeof *added);
    // Model 5 is ray-traced reflection with Fresnel's factor, 3 without; exporters also write 3 for
    // glossy metals, whose colour stands in Kd.
    bool is_mirror =
        read->illumination_model == 5 || (read->illumination_model == 3 && is_black(read->diffuse));
    *added = (struct mtl_material){
        .material = {.name = read->name, .model = is_mirror ? MATERIAL_MIRROR : MATERIAL_LAMBERT},
        .order = parser->library->count - 1,
        .scene_index = SCENE_NONE,
    };
    memcpy(added->material.base_color, is_mirror ? read->specular : read->diffuse,
           sizeof read->diffuse);
    memcpy(added->material.emission, read->emission, sizeof read->emission);
    return true;
}

static bool begin_material(struct mtl_parser *parser, struct err *err)
{
    if (!finish_material(parser, err))
        return false;
    struct text_span name = text_rest_of_line(&parser->text);
    if (name.size == 0)
        return text_fail(&parser->text, err, "newmtl: expected a name");
    parser->current = (struct mtl_statements){
        .name = text_copy(parser->arena, name),
        .diffuse = {0.5f, 0.5f, 0.5f},
        .specular = {1.0f, 1.0f, 1.0f},
    };
    return parser->current.name || err_memory(err, "a material's name", name.size + 1);
}

static void count_skipped(struct mtl_parser *parser)
{
    if (parser->skipped_count++ == 0)
        parser->skipped_line = parser->text.line;
}

// Clamps to [0, max], counting the colours that were outside.
static void clamp_color(struct mtl_parser *parser, float max, float color[3])
{
    bool is_outside = false;
    for (int c = 0; c < 3; c++) {
        float clamped = fminf(fmaxf(color[c], 0.0f), max);
        is_outside |= clamped != color[c];
        color[c] = clamped;
    }
    if (is_outside && parser->clamped_count++ == 0)
        parser->clamped_line = parser->text.line;
}

// "Kd R G B" or "Kd R" for a grey; "Kd spectral FILE" and "Kd xyz X Y Z" are skipped.
static bool read_color(struct mtl_parser *parser, const char *what, float max, float out[3],
                       struct err *err)
{
    struct text_reader ahead = parser->text;
    struct text_span word = text_word(&ahead);
    if (text_equals(word, "spectral") || text_equals(word, "xyz")) {
        count_skipped(parser);
        return true;
    }
    float color[3];
    for (int c = 0; c < 3; c++) {
        if (c == 1 && text_line_ended(&parser->text)) {
            color[1] = color[2] = color[0];
            break;
        }
        if (!text_float(&parser->text, what, &color[c], err))
            return false;
        if (!isfinite(color[c]))
            return text_fail(&parser->text, err, "%s: %g, expected a finite one", what,
                             (double)color[c]);
    }
    clamp_color(parser, max, color);
    memcpy(out, color, sizeof color);
    return true;
}

static bool read_statement(struct mtl_parser *parser, struct text_span keyword, struct err *err)
{
    struct mtl_statements *current = &parser->current;
    if (text_equals(keyword, "newmtl"))
        return begin_material(parser, err);
    if (!current->name) // Stray lines in front of the first material say nothing about any.
        return true;
    if (text_equals(keyword, "Kd"))
        return read_color(parser, "a number after Kd", 1.0f, current->diffuse, err);
    if (text_equals(keyword, "Ks"))
        return read_color(parser, "a number after Ks", 1.0f, current->specular, err);
    if (text_equals(keyword, "Ke"))
        return read_color(parser, "a number after Ke", (float)SCENE_RADIANCE_MAX, current->emission,
                          err);
    if (text_equals(keyword, "illum"))
        return text_integer(&parser->text, "an integer after illum", &current->illumination_model,
                            err);
    if (keyword.size > 4 && memcmp(keyword.data, "map_", 4) == 0)
        count_skipped(parser);
    return true;
}

static void warn_about(const struct mtl_parser *parser)
{
    if (parser->clamped_count > 0)
        log_warn("%s:%llu: colours out of range were clamped (%llu in the file)", parser->text.path,
                 (unsigned long long)parser->clamped_line,
                 (unsigned long long)parser->clamped_count);
    if (parser->skipped_count > 0)
        log_warn("%s:%llu: texture maps, spectral and XYZ colours are not read (%llu in the file)",
                 parser->text.path, (unsigned long long)parser->skipped_line,
                 (unsigned long long)parser->skipped_count);
}

static bool was_read(const struct mtl_library *library, const char *path)
{
    for (const struct mtl_file *file = library->files; file; file = file->next) {
        if (strcmp(file->path, path) == 0)
            return true;
    }
    return false;
}

static bool remember_file(struct arena *arena, struct mtl_library *library, const char *path,
                          struct err *err)
{
    struct mtl_file *file = ARENA_NEW(arena, struct mtl_file, 1);
    if (!file)
        return err_memory(err, "a material library", sizeof *file);
    *file = (struct mtl_file){.next = library->files, .path = path};
    library->files = file;
    return true;
}

bool load_mtl(struct arena *arena, const char *path, struct mtl_library *library, uint64_t *hash,
              bool *missing, struct err *err)
{
    struct file_bytes bytes;
    *missing = false;
    if (was_read(library, path))
        return true;
    if (!file_read(arena, path, 0, &bytes, err)) {
        *missing = err->code == ERR_INPUT;
        return false;
    }
    if (!remember_file(arena, library, path, err))
        return false;
    *hash = hash_bytes(*hash, bytes.data, bytes.size);
    struct mtl_parser parser = {
        .text = text_open(path, &bytes), .arena = arena, .library = library};
    parser.text.joins_lines = true;
    for (; text_remaining(&parser.text) > 0; text_next_line(&parser.text)) {
        if (text_line_ended(&parser.text))
            continue;
        struct text_span keyword = text_word(&parser.text);
        if (!read_statement(&parser, keyword, err))
            return false;
    }
    if (!finish_material(&parser, err))
        return false;
    warn_about(&parser);
    return true;
}

// --- look-up by name -----------------------------------------------------------------------------

static int compare_materials(const void *left, const void *right)
{
    const struct mtl_material *a = left, *b = right;
    int by_name = strcmp(a->material.name, b->material.name);
    return by_name != 0 ? by_name : (a->order > b->order) - (a->order < b->order);
}

void mtl_sort(struct mtl_library *library)
{
    if (library->count > 0)
        qsort(library->materials, library->count, sizeof *library->materials, compare_materials);
}

// Like strcmp of a NUL-terminated name with one of given length.
static int compare_names(const char *name, const char *wanted, size_t length)
{
    length = strnlen(wanted, length); // a damaged file may have NUL bytes in its names
    int difference = strncmp(name, wanted, length);
    return difference != 0 ? difference : name[length] != '\0';
}

struct mtl_material *mtl_find(const struct mtl_library *library, const char *name, size_t length)
{
    uint32_t begin = 0, end = library->count; // the first of equal names
    while (begin < end) {
        uint32_t middle = begin + (end - begin) / 2;
        if (compare_names(library->materials[middle].material.name, name, length) < 0)
            begin = middle + 1;
        else
            end = middle;
    }
    bool found = begin < library->count &&
                 compare_names(library->materials[begin].material.name, name, length) == 0;
    return found ? &library->materials[begin] : NULL;
}
