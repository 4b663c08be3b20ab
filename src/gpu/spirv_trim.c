#include "gpu/spirv_trim.h"

#include "gpu/spirv.h"
#include <stdlib.h>
#include <string.h>

// The known properties of an id.
struct id {
    uint32_t value; // the constant's value if `known`: 32 bits, or 0 or 1
    uint32_t start; // index of the function's first word; 0 if the id is not a function
    bool known;
    bool live;    // the label or function is reachable
    bool visited; // the label has been visited
    bool dropped; // the instruction that defines the id is removed
    bool needed;  // an instruction that is kept refers to the id
    bool is_bool; // the id is the Boolean type
    bool is_int;
    bool is_bound; // the id is a variable with a binding
};

struct module {
    const uint32_t *code;
    uint32_t words, bound;
    struct id *ids;
    uint32_t *pending; // functions that are called and not yet traversed
    uint32_t pending_count;
    const uint32_t *constants;
    uint32_t constant_count;
};

// Returns whether an instruction in a function's body has a result.
static bool has_result(uint32_t op)
{
    switch (op) {
    case OP_NOP:
    case OP_LINE:
    case OP_NO_LINE:
    case OP_FUNCTION_END:
    case OP_STORE:
    case OP_COPY_MEMORY:
    case OP_COPY_MEMORY_SIZED:
    case OP_IMAGE_WRITE:
    case OP_CONTROL_BARRIER:
    case OP_MEMORY_BARRIER:
    case OP_ATOMIC_STORE:
    case OP_LABEL:
        return false;
    default:
        return op < OP_LOOP_MERGE || op > OP_UNREACHABLE;
    }
}

static bool stays_in_dead_blocks(uint32_t op)
{
    return op >= OP_LOOP_MERGE && op <= OP_UNREACHABLE;
}

// --- constants -----------------------------------------------------------------------------------

static bool evaluate_2(uint32_t op, uint32_t a, uint32_t b, uint32_t *out)
{
    int32_t sa = (int32_t)a, sb = (int32_t)b;
    // clang-format off
    switch (op) {
    case OP_I_ADD: *out = a + b; return true;
    case OP_I_SUB: *out = a - b; return true;
    case OP_I_MUL: *out = a * b; return true;
    case OP_BITWISE_OR:
    case OP_LOGICAL_OR: *out = a | b; return true;
    case OP_BITWISE_AND:
    case OP_LOGICAL_AND: *out = a & b; return true;
    case OP_BITWISE_XOR: *out = a ^ b; return true;
    case OP_LOGICAL_EQUAL:
    case OP_I_EQUAL: *out = a == b; return true;
    case OP_LOGICAL_NOT_EQUAL:
    case OP_I_NOT_EQUAL: *out = a != b; return true;
    case OP_U_GREATER_THAN: *out = a > b; return true;
    case OP_S_GREATER_THAN: *out = sa > sb; return true;
    case OP_U_GREATER_THAN_EQUAL: *out = a >= b; return true;
    case OP_S_GREATER_THAN_EQUAL: *out = sa >= sb; return true;
    case OP_U_LESS_THAN: *out = a < b; return true;
    case OP_S_LESS_THAN: *out = sa < sb; return true;
    case OP_U_LESS_THAN_EQUAL: *out = a <= b; return true;
    case OP_S_LESS_THAN_EQUAL: *out = sa <= sb; return true;
    case OP_SHIFT_LEFT_LOGICAL: *out = b < 32 ? a << b : 0; return b < 32;
    case OP_SHIFT_RIGHT_LOGICAL: *out = b < 32 ? a >> b : 0; return b < 32;
    default: return false;
    }
    // clang-format on
}

// Computes the result of an instruction from `count` operand ids. Returns false if it is not known.
static bool evaluate(const struct module *m, uint32_t op, const uint32_t *operands, uint32_t count,
                     uint32_t *out)
{
    const struct id *a = count > 0 ? &m->ids[operands[0]] : NULL;
    const struct id *b = count > 1 ? &m->ids[operands[1]] : NULL;
    if (count == 1 && a->known && (op == OP_LOGICAL_NOT || op == OP_NOT)) {
        *out = op == OP_NOT ? ~a->value : !a->value;
        return true;
    }
    if (count == 3 && op == OP_SELECT && a->known) {
        const struct id *chosen = &m->ids[operands[a->value ? 1 : 2]];
        *out = chosen->value;
        return chosen->known;
    }
    if (count != 2)
        return false;
    if (op == OP_LOGICAL_AND && ((a->known && !a->value) || (b->known && !b->value))) {
        *out = 0;
        return true;
    }
    if (op == OP_LOGICAL_OR && ((a->known && a->value) || (b->known && b->value))) {
        *out = 1;
        return true;
    }
    return a->known && b->known && evaluate_2(op, a->value, b->value, out);
}

static void know(struct module *m, uint32_t id, uint32_t value)
{
    m->ids[id].known = true;
    m->ids[id].value = value;
}

// Values that the caller sets for specialization constants are known from their decorations, which
// precede the instructions of the constants.
static void read_global(struct module *m, const uint32_t *at)
{
    uint32_t op = spirv_opcode(at), words = spirv_length(at), value;
    if (op == OP_TYPE_BOOL || op == OP_TYPE_INT) {
        m->ids[at[1]].is_bool = op == OP_TYPE_BOOL;
        m->ids[at[1]].is_int = op == OP_TYPE_INT && at[2] == 32;
    } else if (op == OP_DECORATE && words == 4 && at[2] == SPIRV_DECORATION_SPEC_ID) {
        if (at[3] < m->constant_count)
            know(m, at[1], m->constants[at[3]]);
    } else if (op == OP_DECORATE && words == 4 && at[2] == SPIRV_DECORATION_BINDING) {
        m->ids[at[1]].is_bound = m->ids[at[1]].dropped = true; // until a use of the variable is
                                                               // found
    } else if (op == OP_CONSTANT_TRUE || op == OP_CONSTANT_FALSE) {
        know(m, at[2], op == OP_CONSTANT_TRUE);
    } else if (op == OP_SPEC_CONSTANT_TRUE || op == OP_SPEC_CONSTANT_FALSE) {
        if (!m->ids[at[2]].known)
            know(m, at[2], op == OP_SPEC_CONSTANT_TRUE);
    } else if ((op == OP_CONSTANT || op == OP_SPEC_CONSTANT) && words == 4) {
        if (!m->ids[at[2]].known)
            know(m, at[2], at[3]);
    } else if (op == OP_SPEC_CONSTANT_OP && words > 4) {
        if (evaluate(m, at[3], at + 4, words - 4, &value))
            know(m, at[2], value);
    }
}

// --- reachable code ------------------------------------------------------------------------------

static bool reach(struct module *m, uint32_t label)
{
    // Blocks are in an order consistent with dominance, so that only loops branch back to blocks
    // that were visited already.
    if (m->ids[label].visited && !m->ids[label].live)
        return false;
    m->ids[label].live = true;
    return true;
}

static bool reach_targets(struct module *m, const uint32_t *at)
{
    switch (spirv_opcode(at)) {
    case OP_BRANCH:
        return reach(m, at[1]);
    case OP_BRANCH_CONDITIONAL: {
        const struct id *condition = &m->ids[at[1]];
        return ((condition->known && !condition->value) || reach(m, at[2])) &&
               ((condition->known && condition->value) || reach(m, at[3]));
    }
    case OP_SWITCH:
        for (uint32_t i = 4; i < spirv_length(at); i += 2)
            if (!reach(m, at[i]))
                return false;
        return reach(m, at[2]);
    default:
        return true;
    }
}

// A phi is known if all reachable predecessors agree on its value.
static void merge_values(struct module *m, const uint32_t *at)
{
    bool any = false;
    uint32_t value = 0;
    for (uint32_t i = 3; i + 1 < spirv_length(at); i += 2) {
        const struct id *incoming = &m->ids[at[i]], *block = &m->ids[at[i + 1]];
        if (block->visited && !block->live)
            continue;
        if (!block->visited || !incoming->known || (any && incoming->value != value))
            return;
        any = true;
        value = incoming->value;
    }
    if (any)
        know(m, at[2], value);
}

static void call(struct module *m, uint32_t function)
{
    if (!m->ids[function].live)
        m->pending[m->pending_count++] = function;
    m->ids[function].live = true;
}

// Keeps the variables that an instruction may use: calls pass them on, memory instructions and
// atomics access them. A literal operand may happen to equal a variable's id, which then is kept
// needlessly but harmlessly.
static void keep_variables(struct module *m, const uint32_t *at)
{
    uint32_t op = spirv_opcode(at);
    if (op < OP_FUNCTION_CALL || (op > OP_ARRAY_LENGTH && op != OP_COPY_OBJECT &&
                                  (op < OP_ATOMIC_LOAD || op > OP_ATOMIC_XOR)))
        return;
    for (uint32_t i = 1; i < spirv_length(at); i++)
        if (at[i] < m->bound && m->ids[at[i]].is_bound)
            m->ids[at[i]].dropped = false;
}

// Updates the known values and the reachable blocks by an instruction in a reachable block.
static bool follow(struct module *m, const uint32_t *at)
{
    uint32_t op = spirv_opcode(at), value;
    keep_variables(m, at);
    if (op == OP_PHI)
        merge_values(m, at);
    else if (op == OP_FUNCTION_CALL)
        call(m, at[3]);
    else if (op >= OP_LOGICAL_EQUAL && op <= OP_NOT && spirv_length(at) > 3 &&
             evaluate(m, op, at + 3, spirv_length(at) - 3, &value))
        know(m, at[2], value);
    return reach_targets(m, at);
}

// Marks the ids that an instruction needs even if the code that defines them is unreachable.
static void need(struct module *m, const uint32_t *at, bool live)
{
    uint32_t op = spirv_opcode(at);
    if (live && op == OP_PHI)
        for (uint32_t i = 3; i + 1 < spirv_length(at); i += 2)
            m->ids[at[i]].needed = true;
    else if (!live && (op == OP_BRANCH_CONDITIONAL || op == OP_SWITCH || op == OP_RETURN_VALUE))
        m->ids[at[1]].needed = true;
}

static bool follow_function(struct module *m, uint32_t function)
{
    bool live = true, first = true;
    for (const uint32_t *at = m->code + m->ids[function].start; spirv_opcode(at) != OP_FUNCTION_END;
         at += spirv_length(at)) {
        if (spirv_opcode(at) == OP_LABEL) {
            struct id *label = &m->ids[at[1]];
            label->visited = true;
            live = label->live = label->live || first;
            first = false;
        }
        need(m, at, live);
        if (live && !first && !follow(m, at))
            return false;
        if (!live && has_result(spirv_opcode(at)))
            m->ids[at[2]].dropped = true;
    }
    return true;
}

// --- reading and writing -------------------------------------------------------------------------

// Finds the functions of the module. Returns false if a function does not end or an instruction is
// too short to be read.
static bool read_module(struct module *m)
{
    bool in_function = false, open = false;
    for (uint32_t i = SPIRV_HEADER_WORDS; i < m->words; i += spirv_length(m->code + i)) {
        const uint32_t *at = m->code + i;
        uint32_t op = spirv_opcode(at);
        if (op == OP_FUNCTION) {
            in_function = open = true;
            m->ids[at[2]].start = i;
        }
        open = open && op != OP_FUNCTION_END;
        if (!in_function)
            read_global(m, at);
        else if (has_result(op) && spirv_length(at) < 3)
            return false;
        if (op == OP_ENTRY_POINT)
            call(m, at[2]);
    }
    return !open;
}

static void drop_function(struct module *m, const uint32_t *at)
{
    for (; spirv_opcode(at) != OP_FUNCTION_END; at += spirv_length(at)) {
        if (spirv_opcode(at) == OP_LABEL)
            m->ids[at[1]].dropped = true;
        else if (has_result(spirv_opcode(at)))
            m->ids[at[2]].dropped = true;
    }
}

// Returns whether a name or a decoration refers to an id that is removed; names and decorations
// precede the definition.
static bool is_about_dropped(const struct module *m, const uint32_t *at)
{
    uint32_t op = spirv_opcode(at);
    bool is_spec_id = op == OP_DECORATE && at[2] == SPIRV_DECORATION_SPEC_ID;
    return (op == OP_NAME || op == OP_DECORATE) &&
           (m->ids[at[1]].dropped || (is_spec_id && m->ids[at[1]].known));
}

// Specialization constants and the values derived from them become plain constants, because some
// drivers take the default value for the length of an array (MoltenVK before mid-2025).
static uint32_t write_global(const struct module *m, const uint32_t *at, uint32_t *out)
{
    uint32_t op = spirv_opcode(at), words = spirv_length(at);
    if (op == OP_VARIABLE && m->ids[at[2]].dropped)
        return 0;
    bool is_constant = op == OP_SPEC_CONSTANT_TRUE || op == OP_SPEC_CONSTANT_FALSE ||
                       (op == OP_SPEC_CONSTANT && words == 4) || op == OP_SPEC_CONSTANT_OP;
    if (is_constant && m->ids[at[2]].known && m->ids[at[1]].is_bool) {
        out[0] = spirv_head(m->ids[at[2]].value ? OP_CONSTANT_TRUE : OP_CONSTANT_FALSE, 3);
        memcpy(out + 1, at + 1, 2 * sizeof *out);
        return 3;
    }
    if (is_constant && m->ids[at[2]].known && m->ids[at[1]].is_int) {
        out[0] = spirv_head(OP_CONSTANT, 4);
        memcpy(out + 1, at + 1, 2 * sizeof *out);
        out[3] = m->ids[at[2]].value;
        return 4;
    }
    memcpy(out, at, words * sizeof *at);
    return words;
}

// Writes what remains of an instruction in a kept function. Returns the number of words written.
static uint32_t write_instruction(const struct module *m, const uint32_t *at, bool live,
                                  uint32_t *out)
{
    uint32_t op = spirv_opcode(at), words = spirv_length(at);
    if (!live && !stays_in_dead_blocks(op)) {
        if (!has_result(op) || !m->ids[at[2]].needed)
            return 0;
        out[0] = spirv_head(OP_UNDEF, 3);
        out[1] = at[1];
        out[2] = at[2];
        return 3;
    }
    memcpy(out, at, words * sizeof *at);
    return words;
}

static uint32_t write_module(const struct module *m, uint32_t *out)
{
    uint32_t written = SPIRV_HEADER_WORDS;
    bool in_function = false, live_function = true, live = true;
    memcpy(out, m->code, SPIRV_HEADER_WORDS * sizeof *out);
    for (uint32_t i = SPIRV_HEADER_WORDS; i < m->words; i += spirv_length(m->code + i)) {
        const uint32_t *at = m->code + i;
        if (spirv_opcode(at) == OP_FUNCTION) {
            in_function = live = true;
            live_function = m->ids[at[2]].live;
        }
        if (spirv_opcode(at) == OP_LABEL)
            live = m->ids[at[1]].live;
        if (spirv_opcode(at) == OP_FUNCTION_END)
            live = true;
        if (in_function ? !live_function : is_about_dropped(m, at))
            continue;
        written += in_function ? write_instruction(m, at, live || spirv_opcode(at) == OP_LABEL,
                                                   out + written)
                               : write_global(m, at, out + written);
    }
    return written;
}

static uint32_t trim(struct module *m, uint32_t *out)
{
    if (!read_module(m))
        return 0;
    while (m->pending_count > 0) {
        uint32_t function = m->pending[--m->pending_count];
        if (!m->ids[function].start || !follow_function(m, function))
            return 0;
    }
    for (uint32_t id = 0; id < m->bound; id++)
        if (m->ids[id].start && !m->ids[id].live)
            drop_function(m, m->code + m->ids[id].start);
    return write_module(m, out);
}

size_t spirv_trim(const uint32_t *code, size_t bytes, const uint32_t *constants, uint32_t count,
                  uint32_t *out)
{
    if (!spirv_is_module(code, bytes))
        return 0;
    struct module m = {.code = code,
                       .words = (uint32_t)(bytes / sizeof *code),
                       .bound = code[SPIRV_BOUND],
                       .constants = constants,
                       .constant_count = count};
    m.ids = calloc(m.bound, sizeof *m.ids);
    m.pending = calloc(m.bound, sizeof *m.pending);
    bool has_memory = m.ids && m.pending;
    size_t written = has_memory ? trim(&m, out) * sizeof *out : SPIRV_TRIM_NO_MEMORY;
    free(m.ids);
    free(m.pending);
    return written;
}

uint32_t spirv_instructions(const uint32_t *code, size_t bytes)
{
    uint32_t words = (uint32_t)(bytes / sizeof *code), count = 0;
    bool in_function = false;
    if (!spirv_is_module(code, bytes))
        return 0;
    for (uint32_t i = SPIRV_HEADER_WORDS; i < words; i += spirv_length(code + i)) {
        uint32_t op = spirv_opcode(code + i);
        in_function |= op == OP_FUNCTION;
        count += in_function && op != OP_LABEL && op != OP_LINE && op != OP_NO_LINE;
        in_function &= op != OP_FUNCTION_END;
    }
    return count;
}
