// The header of a PLY file: its format, and the elements that follow. Internal to scene/.
#ifndef LAMPYRIS_SCENE_MESH_PLY_HEADER_H
#define LAMPYRIS_SCENE_MESH_PLY_HEADER_H

#include "scene/core/text.h"

enum ply_format { PLY_ASCII, PLY_LITTLE_ENDIAN, PLY_BIG_ENDIAN };

enum ply_type { PLY_I8, PLY_U8, PLY_I16, PLY_U16, PLY_I32, PLY_U32, PLY_F32, PLY_F64 };

uint32_t ply_type_size(enum ply_type type); // size in a binary file, in bytes
bool ply_type_is_float(enum ply_type type);

// The loader's use of a property. Uses before USE_POLYGON are also indices of a vertex's values.
enum ply_use {
    USE_X,
    USE_Y,
    USE_Z,
    USE_NX,
    USE_NY,
    USE_NZ,
    USE_U,
    USE_V,
    USE_RED,
    USE_GREEN,
    USE_BLUE,
    USE_ALPHA,
    USE_POLYGON,
    USE_STRIP,
    USE_NONE
};

#define VERTEX_VALUE_COUNT USE_POLYGON

struct ply_property {
    struct ply_property *next;
    enum ply_type type;
    bool is_list;
    enum ply_type count_type; // type of a list's count, an integer type
    enum ply_use use;
};

struct ply_element {
    struct ply_element *next;
    char name[32]; // shortened and printable
    uint64_t count;
    struct ply_property *properties, *last_property;
    uint64_t property_count;
    uint64_t min_row_bytes; // minimum size of a row in a binary file, with empty lists
    uint32_t uses;          // bits 1 << enum ply_use
};

struct ply_header {
    enum ply_format format;
    bool has_format;
    struct ply_element *elements, *last_element;
    struct ply_element *vertices; // the element "vertex", with at most 2^32 - 1 rows
};

// Reads the header, and leaves the reader at the first byte after it. Lists live in `arena`.
bool ply_read_header(struct arena *arena, struct text_reader *text, struct ply_header *out,
                     struct err *err);

#endif
