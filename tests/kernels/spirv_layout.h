// Reads the names, offsets and types of the structures in a SPIR-V module (SPIR-V specification
// 1.5, section 3).
#ifndef LAMPYRIS_TESTS_SPIRV_LAYOUT_H
#define LAMPYRIS_TESTS_SPIRV_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SPIRV_MAX_MEMBERS = 64 };

struct spirv_member {
    const char *name;
    uint32_t offset; // UINT32_MAX without a decoration
    uint32_t type;   // id
};

// The properties of an id.
struct spirv_id {
    const char *name;
    uint32_t opcode;             // that made it: OpTypeStruct, …
    uint32_t element;            // arrays and vectors: the type's id
    uint32_t length;             // arrays: the constant's id
    uint32_t value;              // 32-bit constants: the value; vectors: how many components
    uint32_t stride;             // arrays: ArrayStride, 0 without
    uint32_t member_count;       // structures: members
    struct spirv_member *member; // SPIRV_MAX_MEMBERS, of structures and what has member names
};

struct spirv_layout {
    struct spirv_id *ids;
    uint32_t bound; // ids are below
};

// `words` must outlive the layout: names point into it. False for what is no SPIR-V, or when out of
// memory.
bool spirv_layout_read(const uint32_t *words, size_t bytes, struct spirv_layout *out);
void spirv_layout_finish(struct spirv_layout *layout);

enum spirv_kind { SPIRV_FLOAT, SPIRV_UINT, SPIRV_STRUCT, SPIRV_OTHER };
// Bytes and kind of a type, or of the elements of an array.
uint32_t spirv_type_bytes(const struct spirv_layout *layout, uint32_t type);
enum spirv_kind spirv_type_kind(const struct spirv_layout *layout, uint32_t type);

#endif
