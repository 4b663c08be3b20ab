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
    uint32_t offset; // UINT32_MAX if it is not decorated
    uint32_t type;   // id of its type
};

// The properties of an id.
struct spirv_id {
    const char *name;
    uint32_t opcode;             // opcode of its definition: OpTypeStruct, …
    uint32_t element;            // id of the element type, for arrays and vectors
    uint32_t length;             // id of the constant, for arrays
    uint32_t value;              // value of a 32-bit constant; number of components of a vector
    uint32_t stride;             // ArrayStride of an array; 0 if it has none
    uint32_t member_count;       // number of members of a structure
    struct spirv_member *member; // SPIRV_MAX_MEMBERS elements, for structures and ids with member
                                 // names
};

struct spirv_layout {
    struct spirv_id *ids;
    uint32_t bound; // all ids are below this
};

// Reads a module. `words` must outlive the layout, because names point into it. Returns false if it
// is not SPIR-V, or when out of memory.
bool spirv_layout_read(const uint32_t *words, size_t bytes, struct spirv_layout *out);
void spirv_layout_finish(struct spirv_layout *layout);

enum spirv_kind { SPIRV_FLOAT, SPIRV_UINT, SPIRV_STRUCT, SPIRV_OTHER };
// Returns the bytes and the kind of a type, or of the elements of an array.
uint32_t spirv_type_bytes(const struct spirv_layout *layout, uint32_t type);
enum spirv_kind spirv_type_kind(const struct spirv_layout *layout, uint32_t type);

#endif
