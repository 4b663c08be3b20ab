#include "render/sdf_inline.h"

#include "base/hash.h"
#include "gpu/spirv.h"
#include "shared/sdf.h"
#include <stdlib.h>
#include <string.h>

// Names of the functions of lib/sdf.glsl, indexed by operation; metaballs have two functions.
static const char *const function_names[SDF_OPERATIONS + 1] = {
    "sdf_sphere(",    "sdf_box(",          "sdf_frame(",      "sdf_torus(",      "sdf_capsule(",
    "sdf_cone(",      "sdf_solid_angle(",  "sdf_cylinder(",   "sdf_plane(",      "sdf_gyroid(",
    "sdf_metaballs(", "sdf_mandelbulb(",   "sdf_menger(",     "sdf_apollonian(", "sdf_pyramid(",
    "sdf_union(",     "sdf_intersection(", "sdf_difference(", "sdf_round(",      "sdf_shell(",
    "sdf_factor(",    "sdf_transform(",    "sdf_repeat(",     "sdf_twist(",      "sdf_mirror(",
    "sdf_ball(", // at the index of SDF_RESTORE, which has no function
    "sdf_value(",
};
enum { FUNCTION_BALL = SDF_RESTORE, FUNCTION_VALUE = SDF_OPERATIONS };

struct function {
    uint32_t id, result, start, body, end; // word offsets: `body` is after the parameters, `end`
                                           // after the function
    uint32_t parameters[4], types[4], parameter_count;
};

// A growing array of words. `failed`: memory ran out.
struct words {
    uint32_t *at;
    size_t count, room;
    bool failed;
};

struct rewrite {
    const uint32_t *code;
    size_t words;
    uint32_t bound, bool_type, first_function; // first_function: offset of the first function
    struct function functions[SDF_OPERATIONS + 1];
    uint32_t float_type, uint_type, vec2_type, vec3_type, vec4_type;
    uint32_t rounds; // id of the variable sdf_rounds
    struct words constants, body;
};

// --- reading -------------------------------------------------------------------------------------

static void read_name(struct rewrite *w, const uint32_t *at)
{
    const char *name = (const char *)&at[2];
    for (uint32_t f = 0; f <= SDF_OPERATIONS; f++)
        if (strncmp(name, function_names[f], strlen(function_names[f])) == 0)
            w->functions[f].id = at[1];
    if (strcmp(name, "sdf_rounds") == 0)
        w->rounds = at[1];
}

static struct function *find_function(struct rewrite *w, uint32_t id)
{
    for (uint32_t f = 0; f <= SDF_OPERATIONS; f++)
        if (w->functions[f].id == id)
            return &w->functions[f];
    return NULL;
}

// Finds the functions, which have at most four parameters.
static bool read_module(struct rewrite *w)
{
    struct function *open = NULL;
    for (size_t i = SPIRV_HEADER_WORDS, length; i < w->words; i += length) {
        const uint32_t *at = w->code + i;
        uint32_t op = spirv_opcode(at);
        length = spirv_length(at);
        if (op == OP_NAME && length > 2)
            read_name(w, at);
        if (op == OP_TYPE_BOOL)
            w->bool_type = at[1];
        if (op == OP_FUNCTION) {
            w->first_function = w->first_function ? w->first_function : (uint32_t)i;
            open = find_function(w, at[2]);
            if (open) {
                open->start = (uint32_t)i;
                open->result = at[1];
            }
        }
        if (open && op == OP_FUNCTION_PARAMETER) {
            if (open->parameter_count == 4)
                return false;
            open->types[open->parameter_count] = at[1];
            open->parameters[open->parameter_count++] = at[2];
        }
        if (open && op == OP_LABEL && !open->body)
            open->body = (uint32_t)i;
        if (open && op == OP_FUNCTION_END) {
            open->end = (uint32_t)(i + length);
            open = NULL;
        }
    }
    return true;
}

// Takes the types from the parameters, because the functions take values, not pointers.
static bool find_types(struct rewrite *w)
{
    const struct function *value = &w->functions[FUNCTION_VALUE];
    const struct function *transform = &w->functions[SDF_TRANSFORM];
    for (uint32_t f = 0; f <= SDF_OPERATIONS; f++)
        if (!w->functions[f].end)
            return false;
    w->float_type = value->result;
    w->uint_type = value->types[0];
    w->vec3_type = value->types[2];
    w->vec4_type = transform->types[1];
    w->vec2_type = w->functions[FUNCTION_BALL].result;
    return value->parameter_count == 3 && w->rounds && transform->parameter_count == 4 &&
           w->bool_type && transform->types[0] == w->vec3_type &&
           transform->result == w->vec3_type && w->functions[SDF_BOX].types[2] == w->vec4_type &&
           w->functions[SDF_UNION].types[0] == w->float_type &&
           w->functions[FUNCTION_BALL].types[2] == w->vec2_type;
}

// --- writing -------------------------------------------------------------------------------------

static void put(struct words *words, const uint32_t *from, size_t count)
{
    if (words->count + count > words->room && !words->failed) {
        size_t room = 2 * words->room + count + 256;
        uint32_t *grown = realloc(words->at, room * sizeof *grown);
        words->failed = !grown;
        words->at = grown ? grown : words->at;
        words->room = grown ? room : words->room;
    }
    if (words->failed || count == 0)
        return;
    memcpy(words->at + words->count, from, count * sizeof *from);
    words->count += count;
}

// Writes an instruction with `count` operands.
static void put_instruction(struct words *words, uint32_t op, const uint32_t *operands,
                            uint32_t count)
{
    put(words, &(uint32_t){spirv_head(op, count + 1)}, 1);
    put(words, operands, count);
}

static uint32_t constant_bits(struct rewrite *w, uint32_t type, uint32_t bits)
{
    const uint32_t operands[3] = {type, w->bound++, bits};
    put_instruction(&w->constants, OP_CONSTANT, operands, 3);
    return operands[1];
}

static uint32_t constant_float(struct rewrite *w, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return constant_bits(w, w->float_type, bits);
}

static uint32_t constant_vector(struct rewrite *w, const float *values, uint32_t count)
{
    uint32_t operands[6] = {count == 2 ? w->vec2_type : count == 3 ? w->vec3_type : w->vec4_type};
    for (uint32_t i = 0; i < count; i++)
        operands[2 + i] = constant_float(w, values[i]);
    operands[1] = w->bound++;
    put_instruction(&w->constants, OP_CONSTANT_COMPOSITE, operands, 2 + count);
    return operands[1];
}

static uint32_t call(struct rewrite *w, uint32_t function, const uint32_t *arguments,
                     uint32_t count)
{
    uint32_t operands[7] = {w->functions[function].result, w->bound++, w->functions[function].id};
    memcpy(operands + 3, arguments, count * sizeof *arguments);
    put_instruction(&w->body, OP_FUNCTION_CALL, operands, 3 + count);
    return operands[1];
}

static uint32_t metaballs(struct rewrite *w, const struct gpu_sdf_instruction *code, uint32_t point)
{
    const float none[2] = {0, 3e38f}; // SDF_NO_BALLS
    uint32_t sums = constant_vector(w, none, 2);
    for (uint32_t i = 0; i < code->op >> 8; i++) {
        float ball[4];
        memcpy(ball, (const char *)(code + 1) + i * sizeof ball, sizeof ball);
        sums = call(w, FUNCTION_BALL, (uint32_t[]){point, constant_vector(w, ball, 4), sums}, 3);
    }
    return call(w, SDF_METABALLS, (uint32_t[]){sums, constant_vector(w, code->a, 3)}, 2);
}

// The state of the interpreter of shared/sdf.h while a program is translated. Values are SPIR-V
// ids; the factors by which points are scaled are known numbers.
struct machine {
    uint32_t points[SDF_POINTS_MAX + 1], distances[SDF_DISTANCES_MAX];
    float factors[SDF_POINTS_MAX + 1];
    uint32_t depth, count;
};

static bool write_shape(struct rewrite *w, const struct gpu_sdf_instruction *code,
                        struct machine *m)
{
    uint32_t op = code->op & 0xffu, point = m->points[m->depth];
    float factor = m->factors[m->depth];
    if (m->count == SDF_DISTANCES_MAX)
        return false;
    uint32_t distance = op == SDF_METABALLS
                            ? metaballs(w, code, point)
                            : call(w, op,
                                   (uint32_t[]){point, constant_vector(w, code->a, 3),
                                                constant_vector(w, code->b, 4)},
                                   3);
    if (factor != 1.0f) {
        const uint32_t operands[4] = {w->float_type, w->bound++, distance,
                                      constant_float(w, factor)};
        put_instruction(&w->body, OP_F_MUL, operands, 4);
        distance = operands[1];
    }
    m->distances[m->count++] = distance;
    return true;
}

static bool write_change(struct rewrite *w, const struct gpu_sdf_instruction *code,
                         struct machine *m)
{
    uint32_t op = code->op & 0xffu, taken = op <= SDF_DIFFERENCE ? 2 : 1;
    if (m->count < taken)
        return false;
    float number = op == SDF_FACTOR ? code->a[0] : code->a[0] * m->factors[m->depth];
    uint32_t arguments[3];
    m->count -= taken;
    memcpy(arguments, &m->distances[m->count], taken * sizeof *arguments);
    arguments[taken] = constant_float(w, number);
    m->distances[m->count++] = call(w, op, arguments, taken + 1);
    return true;
}

static bool write_move(struct rewrite *w, const struct gpu_sdf_instruction *code, struct machine *m)
{
    uint32_t op = code->op & 0xffu, point = m->points[m->depth];
    float factor = m->factors[m->depth];
    if (op == SDF_RESTORE)
        return m->depth-- > 0;
    if (m->depth == SDF_POINTS_MAX)
        return false;
    m->depth++;
    m->factors[m->depth] = op == SDF_TRANSFORM ? code->a[0] * factor
                           : op == SDF_TWIST   ? code->a[1] * factor
                                               : factor;
    const uint32_t b = constant_vector(w, code->b, 4);
    if (op == SDF_TRANSFORM)
        m->points[m->depth] = call(
            w, op,
            (uint32_t[]){point, b, constant_vector(w, code->c, 4), constant_vector(w, code->d, 4)},
            4);
    else
        m->points[m->depth] =
            call(w, op, (uint32_t[]){point, constant_vector(w, code->a, 3), b}, 3);
    return true;
}

// Writes one program, including the return of its value.
static bool write_program(struct rewrite *w, const struct sdf *sdf)
{
    struct machine m = {.points = {w->functions[FUNCTION_VALUE].parameters[2]}, .factors = {1}};
    for (uint32_t i = 0; i < sdf->count; i++) {
        const struct gpu_sdf_instruction *code = &sdf->code[i];
        uint32_t op = code->op & 0xffu;
        bool ok = op <= SDF_PYRAMID  ? write_shape(w, code, &m)
                  : op <= SDF_FACTOR ? write_change(w, code, &m)
                                     : op < SDF_OPERATIONS && write_move(w, code, &m);
        if (!ok)
            return false;
        i += op == SDF_METABALLS ? SDF_BALL_INSTRUCTIONS(code->op >> 8) : 0;
    }
    if (m.count == 0)
        return false;
    put_instruction(&w->body, OP_RETURN_VALUE, &m.distances[m.count - 1], 1);
    return true;
}

// Adds the loops of all programs to sdf_rounds. lavapipe masks inactive lanes, so each loop counts
// once, whichever program is evaluated.
static void count_loops(struct rewrite *w, const struct scene *scene)
{
    const uint32_t with_loops = SDF_BIT(SDF_MANDELBULB) | SDF_BIT(SDF_MENGER) |
                                SDF_BIT(SDF_APOLLONIAN) | SDF_BIT(SDF_PYRAMID);
    uint32_t loops = 0;
    for (uint32_t i = 0; i < scene->sdf_count; i++)
        for (uint32_t k = 0; k < scene->sdfs[i].count; k++) {
            uint32_t op = scene->sdfs[i].code[k].op;
            loops += with_loops >> (op & 0xffu) & 1u;
            k += (op & 0xffu) == SDF_METABALLS ? SDF_BALL_INSTRUCTIONS(op >> 8) : 0;
        }
    if (loops == 0)
        return;
    uint32_t before = w->bound++, after = w->bound++;
    uint32_t added = constant_bits(w, w->uint_type, loops);
    put_instruction(&w->body, OP_LOAD, (uint32_t[]){w->uint_type, before, w->rounds}, 3);
    put_instruction(&w->body, OP_I_ADD, (uint32_t[]){w->uint_type, after, before, added}, 4);
    put_instruction(&w->body, OP_STORE, (uint32_t[]){w->rounds, after}, 2);
}

// Writes all programs. Each program but the last is guarded by a comparison of the index of its
// first instruction with the argument.
static bool write_body(struct rewrite *w, const struct scene *scene)
{
    uint32_t first = 0;
    put_instruction(&w->body, OP_LABEL, &(uint32_t){w->bound++}, 1);
    count_loops(w, scene);
    for (uint32_t i = 0; i < scene->sdf_count; i++) {
        const struct sdf *sdf = &scene->sdfs[i];
        uint32_t next = w->bound++;
        if (i + 1 < scene->sdf_count) {
            uint32_t then = w->bound++, same = w->bound++;
            uint32_t which = w->functions[FUNCTION_VALUE].parameters[0];
            uint32_t number = constant_bits(w, w->uint_type, first);
            put_instruction(&w->body, OP_I_EQUAL, (uint32_t[]){w->bool_type, same, which, number},
                            4);
            put_instruction(&w->body, OP_SELECTION_MERGE, (uint32_t[]){next, 0}, 2);
            put_instruction(&w->body, OP_BRANCH_CONDITIONAL, (uint32_t[]){same, then, next}, 3);
            put_instruction(&w->body, OP_LABEL, &then, 1);
        }
        if (!write_program(w, sdf))
            return false;
        if (i + 1 < scene->sdf_count)
            put_instruction(&w->body, OP_LABEL, &next, 1);
        first += sdf->count;
    }
    return true;
}

// Copies the module without debug names, because some of them refer to ids of the replaced body.
static void put_without_names(struct words *out, const struct rewrite *w)
{
    put(out, w->code, SPIRV_HEADER_WORDS);
    for (size_t i = SPIRV_HEADER_WORDS, length; i < w->first_function; i += length) {
        uint32_t op = spirv_opcode(w->code + i);
        length = spirv_length(w->code + i);
        if (op != OP_NAME && op != OP_MEMBER_NAME)
            put(out, w->code + i, length);
    }
}

static uint32_t *join(struct rewrite *w, size_t *bytes)
{
    const struct function *value = &w->functions[FUNCTION_VALUE];
    struct words out = {0};
    put_without_names(&out, w);
    put(&out, w->constants.at, w->constants.count);
    put(&out, w->code + w->first_function, value->body - w->first_function);
    put(&out, w->body.at, w->body.count);
    put_instruction(&out, OP_FUNCTION_END, NULL, 0);
    put(&out, w->code + value->end, w->words - value->end);
    if (out.failed || w->constants.failed || w->body.failed) {
        free(out.at);
        return NULL;
    }
    out.at[SPIRV_BOUND] = w->bound;
    *bytes = out.count * sizeof *out.at;
    return out.at;
}

uint32_t *sdf_inline(const uint32_t *code, size_t bytes, const struct scene *scene,
                     size_t *out_bytes)
{
    struct rewrite w = {.code = code, .words = bytes / sizeof *code};
    if (!spirv_is_module(code, bytes) || !sdf_inline_fits(scene))
        return NULL;
    w.bound = code[SPIRV_BOUND];
    bool ok = read_module(&w) && find_types(&w) && write_body(&w, scene);
    uint32_t *out = ok ? join(&w, out_bytes) : NULL;
    free(w.constants.at);
    free(w.body.at);
    return out;
}

// --- selection of programs -----------------------------------------------------------------------

bool sdf_inline_fits(const struct scene *scene)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < scene->sdf_count; i++)
        count += scene->sdfs[i].count;
    return count > 0 && count <= SDF_INLINE_MOST;
}

uint64_t sdf_inline_key(const struct scene *scene)
{
    uint64_t hash = HASH_INIT;
    if (!sdf_inline_fits(scene))
        return 0;
    for (uint32_t i = 0; i < scene->sdf_count; i++) {
        const struct sdf *sdf = &scene->sdfs[i];
        hash = hash_bytes(hash, &sdf->count, sizeof sdf->count);
        hash = hash_bytes(hash, sdf->code, sdf->count * sizeof *sdf->code);
    }
    return hash;
}
