#include "spirv_layout.h"

#include <stdlib.h>

enum {
    MAGIC = 0x07230203,
    HEADER_WORDS = 5,
    OP_NAME = 5,
    OP_MEMBER_NAME = 6,
    OP_TYPE_INT = 21,
    OP_TYPE_FLOAT = 22,
    OP_TYPE_VECTOR = 23,
    OP_TYPE_ARRAY = 28,
    OP_TYPE_RUNTIME_ARRAY = 29,
    OP_TYPE_STRUCT = 30,
    OP_CONSTANT = 43,
    OP_DECORATE = 71,
    OP_MEMBER_DECORATE = 72,
    DECORATION_ARRAY_STRIDE = 6,
    DECORATION_OFFSET = 35,
};

static struct spirv_member *member_of(struct spirv_id *id, uint32_t index)
{
    if (!id->member) {
        id->member = calloc(SPIRV_MAX_MEMBERS, sizeof *id->member);
        for (uint32_t i = 0; id->member && i < SPIRV_MAX_MEMBERS; i++)
            id->member[i].offset = UINT32_MAX;
    }
    return id->member && index < SPIRV_MAX_MEMBERS ? &id->member[index] : NULL;
}

static bool read_struct(struct spirv_id *id, const uint32_t *types, uint32_t count)
{
    id->member_count = count;
    for (uint32_t i = 0; i < count; i++) {
        struct spirv_member *member = member_of(id, i);
        if (!member)
            return false;
        member->type = types[i];
    }
    return true;
}

// Instructions that name or decorate an id precede its definition.
static bool read_instruction(struct spirv_layout *layout, const uint32_t *op, uint32_t count)
{
    uint32_t opcode = op[0] & 0xffffu;
    uint32_t result = opcode == OP_CONSTANT ? 2 : 1;
    bool known = opcode == OP_NAME || opcode == OP_MEMBER_NAME || opcode == OP_CONSTANT ||
                 opcode == OP_DECORATE || opcode == OP_MEMBER_DECORATE ||
                 (opcode >= OP_TYPE_INT && opcode <= OP_TYPE_STRUCT);
    if (!known)
        return true;
    if (count <= result || op[result] >= layout->bound)
        return false;
    struct spirv_id *id = &layout->ids[op[result]];
    struct spirv_member *member = NULL;
    if (opcode == OP_MEMBER_NAME || opcode == OP_MEMBER_DECORATE) {
        member = count > 3 ? member_of(id, op[2]) : NULL;
        if (!member)
            return false;
    }
    switch (opcode) {
    case OP_NAME:
        id->name = (const char *)&op[2];
        return true;
    case OP_MEMBER_NAME:
        member->name = (const char *)&op[3];
        return true;
    case OP_MEMBER_DECORATE:
        if (op[3] == DECORATION_OFFSET && count > 4)
            member->offset = op[4];
        return true;
    case OP_DECORATE:
        if (count > 3 && op[2] == DECORATION_ARRAY_STRIDE)
            id->stride = op[3];
        return true;
    case OP_CONSTANT:
        id->value = op[3];
        break;
    case OP_TYPE_ARRAY:
        id->length = op[3];
        id->element = op[2];
        break;
    case OP_TYPE_VECTOR:
        id->element = op[2];
        id->value = op[3];
        break;
    case OP_TYPE_RUNTIME_ARRAY:
        id->element = op[2];
        break;
    default:
        break;
    }
    id->opcode = opcode;
    return opcode != OP_TYPE_STRUCT || read_struct(id, op + 2, count - 2);
}

bool spirv_layout_read(const uint32_t *words, size_t bytes, struct spirv_layout *out)
{
    size_t count = bytes / sizeof *words;
    *out = (struct spirv_layout){0};
    if (count < HEADER_WORDS || words[0] != MAGIC)
        return false;
    out->bound = words[3];
    out->ids = calloc(out->bound, sizeof *out->ids);
    bool ok = out->ids != NULL;
    for (size_t at = HEADER_WORDS; at < count && ok;) {
        uint32_t length = words[at] >> 16;
        ok = length > 0 && at + length <= count && read_instruction(out, &words[at], length);
        at += length;
    }
    if (!ok)
        spirv_layout_finish(out);
    return ok;
}

void spirv_layout_finish(struct spirv_layout *layout)
{
    for (uint32_t i = 0; layout->ids && i < layout->bound; i++)
        free(layout->ids[i].member);
    free(layout->ids);
    *layout = (struct spirv_layout){0};
}

uint32_t spirv_type_bytes(const struct spirv_layout *layout, uint32_t type)
{
    const struct spirv_id *id = &layout->ids[type];
    switch (id->opcode) {
    case OP_TYPE_INT:
    case OP_TYPE_FLOAT:
        return 4;
    case OP_TYPE_ARRAY:
        return id->stride * layout->ids[id->length].value;
    case OP_TYPE_VECTOR:
        return 4 * id->value;
    default:
        return 0;
    }
}

enum spirv_kind spirv_type_kind(const struct spirv_layout *layout, uint32_t type)
{
    const struct spirv_id *id = &layout->ids[type];
    switch (id->opcode) {
    case OP_TYPE_INT:
        return SPIRV_UINT;
    case OP_TYPE_FLOAT:
        return SPIRV_FLOAT;
    case OP_TYPE_STRUCT:
        return SPIRV_STRUCT;
    case OP_TYPE_ARRAY:
    case OP_TYPE_VECTOR:
        return spirv_type_kind(layout, id->element);
    default:
        return SPIRV_OTHER;
    }
}
