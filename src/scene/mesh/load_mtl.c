// Reads the materials of OBJ files: the statements of MTL. Format: Wavefront, "MTL material
// format", 1995, and the statements for physically based materials that exporters share
// ("Physically-Based rendering extension" of the MTL format, Exocortex, 2014).
#include "scene/mesh/mesh_loader.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/log.h"
#include "scene/core/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// An element of the list of files that were read.
struct mtl_file {
    struct mtl_file *next;
    const char *path;
};

struct mtl_parser {
    struct text_reader text;
    struct arena *arena;
    struct mtl_library *library;
    struct mtl_statements current;
    // Counts for one warning per file; the lines are those of the first occurrence.
    uint64_t clamped_count, clamped_line;
    uint64_t skipped_count, skipped_line;
};

// Appends the material that is being read, if any.
static bool finish_material(struct mtl_parser *parser, struct err *err)
{
    const struct mtl_statements *read = &parser->current;
    if (!read->name)
        return true;
    struct mtl_library *library = parser->library;
    struct mtl_material *added = arena_append(parser->arena, &library->materials, &library->count,
                                              &library->capacity, sizeof *added, NULL);
    if (!added)
        return err_memory(err, "a material", sizeof *added);
    *added = (struct mtl_material){
        .file = parser->text.path,
        .order = library->count - 1,
        .scene_index = SCENE_NONE,
    };
    mtl_material_make(read, &added->material);
    memcpy(added->maps, read->maps, sizeof added->maps);
    return true;
}

static bool begin_material(struct mtl_parser *parser, struct err *err)
{
    if (!finish_material(parser, err))
        return false;
    struct text_span name = text_rest_of_line(&parser->text);
    if (name.size == 0)
        return text_fail(&parser->text, err, "newmtl: expected a name");
    mtl_statements_init(&parser->current, text_copy(parser->arena, name));
    return parser->current.name || err_memory(err, "a material's name", name.size + 1);
}

static void count_skipped(struct mtl_parser *parser)
{
    if (parser->skipped_count++ == 0)
        parser->skipped_line = parser->text.line;
}

// Clamps a colour to [0, max], and counts colours that were outside.
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

// Reads "Kd R G B", or "Kd R" for a grey. "Kd spectral FILE" and "Kd xyz X Y Z" are skipped.
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
            return text_fail(&parser->text, err, "%s: %g; expected a finite number", what,
                             (double)color[c]);
    }
    clamp_color(parser, max, color);
    memcpy(out, color, sizeof color);
    return true;
}

// Reads a number and clamps it to [0, max]; clamped numbers are counted with the colours.
static bool read_scalar(struct mtl_parser *parser, const char *what, float max, float *out,
                        struct err *err)
{
    float value[3];
    if (!text_float(&parser->text, what, &value[0], err))
        return false;
    if (!isfinite(value[0]))
        return text_fail(&parser->text, err, "%s: %g; expected a finite number", what,
                         (double)value[0]);
    value[1] = value[2] = value[0];
    clamp_color(parser, max, value);
    *out = value[0];
    return true;
}

// Reads all numbers of an option such as "-o U [V [W]]" and keeps the first two.
static void read_pair(struct text_reader *text, float out[2])
{
    float unused;
    for (int i = 0; i < 3; i++)
        if (!text_take_float(text, i < 2 ? &out[i] : &unused))
            break;
}

// Reads "map_Kd [OPTION…] FILE": the file's name is the rest of the line and may contain blanks.
static bool read_map(struct mtl_parser *parser, enum mtl_map_kind kind, struct err *err)
{
    struct text_reader *text = &parser->text;
    struct mtl_map map = {.line = text->line, .scale = {1, 1}, .bump_scale = 1};
    for (;;) {
        struct text_reader ahead = *text;
        struct text_span option = text_word(&ahead);
        if (option.size < 2 || option.data[0] != '-')
            break;
        *text = ahead;
        float unused[2];
        if (text_equals(option, "-o"))
            read_pair(text, map.offset);
        else if (text_equals(option, "-s"))
            read_pair(text, map.scale);
        else if (text_equals(option, "-bm"))
            text_take_float(text, &map.bump_scale);
        else if (text_equals(option, "-clamp"))
            map.is_clamped = text_equals(text_word(text), "on");
        else if (text_equals(option, "-mm") || text_equals(option, "-t"))
            read_pair(text, unused);
        else // skips -blendu, -blendv, -cc, -boost, -texres, -imfchan and -type
            text_word(text);
    }
    struct text_span name = text_rest_of_line(text);
    if (name.size == 0)
        return text_fail(text, err, "a texture map: expected a file name");
    map.path = text_copy(parser->arena, name);
    if (!map.path)
        return err_memory(err, "a path", name.size + 1);
    for (int i = 0; i < 2; i++)
        if (!isfinite(map.offset[i]) || !isfinite(map.scale[i]) || !isfinite(map.bump_scale))
            return text_fail(text, err, "a texture map: an option's number is not finite");
    parser->current.maps[kind] = map;
    return true;
}

#define EXPONENT_MAX 1e6f
#define IOR_MAX 100.0f

static bool read_statement(struct mtl_parser *parser, struct text_span keyword, struct err *err)
{
    struct mtl_statements *current = &parser->current;
    const struct {
        const char *word, *what;
        float max;
        float *color, *scalar;
    } numbers[] = {
        {"Kd", "a number after Kd", 1, current->diffuse, NULL},
        {"Ks", "a number after Ks", 1, current->specular, NULL},
        {"Ka", "a number after Ka", 1, current->ambient, NULL},
        {"Tf", "a number after Tf", 1, current->filter, NULL},
        {"Ke", "a number after Ke", (float)SCENE_RADIANCE_MAX, current->emission, NULL},
        {"Ns", "a number after Ns", EXPONENT_MAX, NULL, &current->exponent},
        {"Ni", "a number after Ni", IOR_MAX, NULL, &current->ior},
        {"d", "a number after d", 1, NULL, &current->opacity},
        {"Pr", "a number after Pr", 1, NULL, &current->roughness},
        {"Pm", "a number after Pm", 1, NULL, &current->metallic},
        {"Ps", "a number after Ps", 1, NULL, &current->sheen},
        {"Pc", "a number after Pc", 1, NULL, &current->coat},
        {"Pcr", "a number after Pcr", 1, NULL, &current->coat_roughness},
        {"aniso", "a number after aniso", 1, NULL, &current->anisotropy},
        {"anisor", "a number after anisor", 1, NULL, &current->anisotropy_rotation},
    };
    static const struct {
        const char *word;
        enum mtl_map_kind kind;
    } maps[] = {
        {"map_Kd", MTL_MAP_DIFFUSE},   {"map_Ke", MTL_MAP_EMISSION}, {"map_d", MTL_MAP_OPACITY},
        {"map_Pr", MTL_MAP_ROUGHNESS}, {"map_Pm", MTL_MAP_METALLIC}, {"map_Bump", MTL_MAP_BUMP},
        {"map_bump", MTL_MAP_BUMP},    {"bump", MTL_MAP_BUMP},       {"norm", MTL_MAP_NORMAL},
    };
    if (text_equals(keyword, "newmtl"))
        return begin_material(parser, err);
    if (!current->name) // statements before the first newmtl belong to no material
        return true;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (text_equals(keyword, numbers[i].word))
            return numbers[i].color
                       ? read_color(parser, numbers[i].what, numbers[i].max, numbers[i].color, err)
                       : read_scalar(parser, numbers[i].what, numbers[i].max, numbers[i].scalar,
                                     err);
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
        if (text_equals(keyword, maps[i].word))
            return read_map(parser, maps[i].kind, err);
    if (text_equals(keyword, "Tr")) {
        float transparency;
        if (!read_scalar(parser, "a number after Tr", 1, &transparency, err))
            return false;
        current->opacity = 1.0f - transparency;
        return true;
    }
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
        log_warn("%s:%llu: spectral and XYZ colours and maps of other kinds are not read "
                 "(%llu in the file)",
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

// --- lookup by name ------------------------------------------------------------------------------

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

// Compares like strcmp(). `name` is NUL-terminated, `wanted` has `length` bytes.
static int compare_names(const char *name, const char *wanted, size_t length)
{
    const char *nul = memchr(wanted, '\0', length); // damaged names may contain NUL bytes
    length = nul ? (size_t)(nul - wanted) : length;
    int difference = strncmp(name, wanted, length);
    return difference != 0 ? difference : name[length] != '\0';
}

struct mtl_material *mtl_find(const struct mtl_library *library, const char *name, size_t length)
{
    uint32_t begin = 0, end = library->count; // finds the first of equal names
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
