// Compiles a tree to a program: transforms, stacks, factors and the bounding box.
#include "scene/sdf/sdf.h"

#include "scene/core/affine.h"
#include <math.h>
#include <string.h>

// The box is enlarged by this fraction, so that its rounded faces are outside the solid. It is far
// above the rounding errors of single precision, and far below what is visible.
#define BOX_MARGIN 1e-5
#define SPREAD_ROUNDS 16

struct program {
    struct gpu_sdf_instruction code[SDF_CODE_MAX];
    uint32_t count;
    uint32_t points, distances; // heights of the stacks
    struct err *err;
};

static void narrow(const double *from, int count, float *to)
{
    for (int i = 0; i < count; i++)
        to[i] = (float)from[i];
}

// --- stacks --------------------------------------------------------------------------------------

static struct gpu_sdf_instruction *add(struct program *p, const struct sdf_node *n, uint32_t op)
{
    if (p->count >= SDF_CODE_MAX) {
        node_fail(n->place, p->err,
                  "the field has more than %d instructions; expected several shapes of type "
                  "\"sdf\", or fewer copies",
                  SDF_CODE_MAX);
        return NULL;
    }
    struct gpu_sdf_instruction *added = &p->code[p->count++];
    *added = (struct gpu_sdf_instruction){.op = op};
    return added;
}

static bool push_distance(struct program *p, const struct sdf_node *n)
{
    return ++p->distances <= SDF_DISTANCES_MAX ||
           node_fail(n->place, p->err,
                     "this node needs more than %d distances at a time; expected the deepest node "
                     "of each \"of\" first",
                     SDF_DISTANCES_MAX);
}

// Adds an instruction that saves the point.
static struct gpu_sdf_instruction *add_move(struct program *p, const struct sdf_node *n,
                                            uint32_t op)
{
    if (++p->points <= SDF_POINTS_MAX)
        return add(p, n, op);
    node_fail(n->place, p->err,
              "is inside of more than %d transforms, repetitions, twists and mirrors; expected "
              "fewer, or one \"transform\" with several steps",
              SDF_POINTS_MAX);
    return NULL;
}

static bool add_restore(struct program *p, const struct sdf_node *n)
{
    p->points--;
    return add(p, n, SDF_RESTORE) != NULL;
}

static bool add_transform(struct program *p, const struct sdf_node *n, const double m[3][4],
                          double scale)
{
    double inverse[3][4];
    struct gpu_sdf_instruction *move = add_move(p, n, SDF_TRANSFORM);
    if (!move || !affine_inverse(m, inverse))
        return false;
    move->a[0] = (float)scale;
    narrow(inverse[0], 4, move->b);
    narrow(inverse[1], 4, move->c);
    narrow(inverse[2], 4, move->d);
    return true;
}

// --- nodes ---------------------------------------------------------------------------------------

static bool emit(struct program *p, const struct sdf_node *n);

static bool emit_shape(struct program *p, const struct sdf_node *n)
{
    struct gpu_sdf_instruction *shape = add(p, n, n->op);
    if (!shape || !push_distance(p, n))
        return false;
    narrow(n->a, 3, shape->a);
    narrow(n->b, 4, shape->b);
    if (n->op != SDF_METABALLS)
        return true;
    shape->op |= n->count << 8;
    uint32_t first = p->count;
    for (uint32_t k = 0; k < n->count; k += 4)
        if (!add(p, n, 0))
            return false;
    char *balls = (char *)&p->code[first];
    for (uint32_t k = 0; k < n->count; k++) {
        float ball[4];
        narrow(n->balls[k], 4, ball);
        memcpy(balls + k * sizeof ball, ball, sizeof ball);
    }
    return true;
}

static bool emit_joint(struct program *p, const struct sdf_node *n)
{
    for (uint32_t k = 0; k < n->count; k++) {
        if (!emit(p, &n->children[k]))
            return false;
        if (k == 0)
            continue;
        struct gpu_sdf_instruction *joint = add(p, n, n->op);
        if (!joint)
            return false;
        joint->a[0] = (float)n->a[0];
        p->distances--;
    }
    return true;
}

static bool emit_copies(struct program *p, const struct sdf_node *n, const int64_t copies[3])
{
    const int64_t sides[3] = {copies[0] / 2, copies[1] / 2, copies[2] / 2};
    bool first = true;
    for (int64_t z = -sides[2]; z <= sides[2]; z++)
        for (int64_t y = -sides[1]; y <= sides[1]; y++)
            for (int64_t x = -sides[0]; x <= sides[0]; x++) {
                const int64_t cell[3] = {x, y, z};
                double m[3][4];
                bool moved = x || y || z;
                memcpy(m, AFFINE_IDENTITY, sizeof m);
                for (int i = 0; i < 3; i++)
                    m[i][3] = (double)cell[i] * n->a[i];
                if ((moved && !add_transform(p, n, m, 1)) || !emit(p, n->children) ||
                    (moved && !add_restore(p, n)))
                    return false;
                if (!first && !add(p, n, SDF_UNION))
                    return false;
                p->distances -= !first;
                first = false;
            }
    return true;
}

// Emits a repetition. Folding space only evaluates the copy in the point's cell, which is the
// nearest copy if the child is symmetric along the axis. Along other axes the copies are written
// out.
static bool emit_repeat(struct program *p, const struct sdf_node *n)
{
    int64_t copies[3] = {1, 1, 1}, total = 1;
    bool folds = false;
    for (int i = 0; i < 3; i++) {
        if (n->a[i] == 0)
            continue;
        if (sdf_is_symmetric(n->children, i)) {
            folds = true;
            continue;
        }
        if (n->b[i] >= SDF_CODE_MAX)
            return node_fail(n->place, p->err,
                             "repeats along %c, but its child is not symmetric about its centre; "
                             "expected small \"counts\", or a mirrored child",
                             "xyz"[i]);
        copies[i] = 2 * (int64_t)n->b[i] + 1;
        total *= copies[i];
        if (total > SDF_CODE_MAX)
            return node_fail(
                n->place, p->err,
                "repeats along %c, but its child is not symmetric about its centre, so that "
                "%lld copies are needed; expected fewer, or a mirrored child",
                "xyz"[i], (long long)total);
    }
    if (!folds)
        return emit_copies(p, n, copies);
    struct gpu_sdf_instruction *fold = add_move(p, n, SDF_REPEAT);
    if (!fold)
        return false;
    for (int i = 0; i < 3; i++)
        if (copies[i] == 1) {
            fold->a[i] = (float)n->a[i];
            fold->b[i] = (float)n->b[i];
        }
    return emit_copies(p, n, copies) && add_restore(p, n);
}

static bool emit_move(struct program *p, const struct sdf_node *n)
{
    if (n->op == SDF_REPEAT)
        return emit_repeat(p, n);
    struct gpu_sdf_instruction *move = add_move(p, n, n->op);
    if (!move)
        return false;
    narrow(n->a, 3, move->a);
    return emit(p, n->children) && add_restore(p, n);
}

static bool emit_own(struct program *p, const struct sdf_node *n)
{
    struct gpu_sdf_instruction *change;
    switch (n->op) {
    case SDF_UNION:
    case SDF_INTERSECTION:
    case SDF_DIFFERENCE:
        return emit_joint(p, n);
    case SDF_ROUND:
    case SDF_SHELL:
        if (!emit(p, n->children) || !(change = add(p, n, n->op)))
            return false;
        change->a[0] = (float)n->a[0];
        return true;
    case SDF_REPEAT:
    case SDF_TWIST:
    case SDF_MIRROR:
        return emit_move(p, n);
    default:
        return emit_shape(p, n);
    }
}

static bool emit(struct program *p, const struct sdf_node *n)
{
    if (!n->is_placed)
        return emit_own(p, n);
    return add_transform(p, n, n->to_parent, n->scale) && emit_own(p, n) && add_restore(p, n);
}

// --- the whole program ---------------------------------------------------------------------------

static bool is_endless(const struct bounds *box, int axis)
{
    return !(box->min[axis] >= -SCENE_COORDINATE_MAX && box->max[axis] <= SCENE_COORDINATE_MAX);
}

// Computes the solid's box with a margin, clipped to `clip`.
static bool find_box(const struct sdf_node *root, const struct bounds *clip, struct bounds *box,
                     struct err *err)
{
    *box = sdf_solid(root, 0);
    if (bounds_is_empty(box))
        return node_fail(root->place, err, "the field is empty: its parts leave nothing");
    double extent = 0;
    for (int i = 0; i < 3; i++)
        if (!is_endless(box, i))
            extent = fmax(extent, fmax(box->max[i] - box->min[i],
                                       fmax(fabs(box->min[i]), fabs(box->max[i]))));
    for (int i = 0; i < 3; i++) {
        box->min[i] -= BOX_MARGIN * extent;
        box->max[i] += BOX_MARGIN * extent;
        if (clip) {
            box->min[i] = fmax(box->min[i], clip->min[i]);
            box->max[i] = fmin(box->max[i], clip->max[i]);
        }
        if (!(box->min[i] < box->max[i]))
            return node_fail(root->place, err, "no part of the field is within \"bounds\"");
    }
    for (int i = 0; i < 3; i++)
        if (is_endless(box, i))
            return node_fail(root->place, err,
                             "the field is infinite along %c; expected \"bounds\", or an "
                             "intersection with a bounded shape",
                             "xyz"[i]);
    return true;
}

// Finds the box and the factors by iteration. The boxes depend on the stretch of twists if their
// contents are rounded or joined smoothly, and the stretch depends on the box. The iteration starts
// without stretch and increases it until it suffices.
static bool settle(struct sdf_node *root, const struct bounds *clip, struct bounds *box,
                   struct sdf_spread *spread, struct err *err)
{
    for (int round = 0; round < SPREAD_ROUNDS; round++) {
        if (!find_box(root, clip, box, err))
            return false;
        sdf_spread_domain(root, box, spread);
        if (!spread->grew)
            return true;
    }
    return node_fail(root->place, err,
                     "twists a child that is rounded or joined so widely that no bounds are found; "
                     "expected \"bounds\"");
}

bool sdf_compile(struct sdf_node *root, const struct bounds *clip, struct arena *arena,
                 struct sdf *out, struct err *err)
{
    struct arena scratch = {0};
    struct program *p = ARENA_NEW(&scratch, struct program, 1);
    struct sdf_spread spread;
    struct bounds box;
    bool ok = p || err_memory(err, "a field's program", sizeof *p);
    ok = ok && settle(root, clip, &box, &spread, err);
    if (ok)
        p->err = err;
    ok = ok && emit(p, root);
    if (ok) {
        // The point need not be restored after the last instruction.
        while (p->count > 1 && p->code[p->count - 1].op == SDF_RESTORE)
            p->count--;
        *out = (struct sdf){
            .count = p->count, .lipschitz = spread.lipschitz, .magnitude = spread.magnitude};
        memcpy(out->min, box.min, sizeof out->min);
        memcpy(out->max, box.max, sizeof out->max);
        out->code = arena_alloc(arena, p->count, sizeof *out->code);
        ok = out->code || err_memory(err, "a field's program", p->count * sizeof *out->code);
        if (ok)
            memcpy(out->code, p->code, p->count * sizeof *out->code);
    }
    arena_finish(&scratch);
    return ok;
}

void sdf_place(const struct sdf *sdf, struct shape *shape)
{
    for (int i = 0; i < 3; i++) {
        shape->center[i] = sdf->min[i] / 2 + sdf->max[i] / 2;
        for (int j = 0; j < 3; j++)
            shape->axes[i][j] = i == j ? sdf->max[i] / 2 - sdf->min[i] / 2 : 0;
    }
}

void sdf_to_world(const struct sdf *sdf, const struct shape *shape, double m[3][4])
{
    for (int i = 0; i < 3; i++)
        m[i][3] = shape->center[i];
    for (int j = 0; j < 3; j++) {
        double half = sdf->max[j] / 2 - sdf->min[j] / 2;
        double center = sdf->min[j] / 2 + sdf->max[j] / 2;
        for (int i = 0; i < 3; i++) {
            m[i][j] = shape->axes[j][i] / half;
            m[i][3] -= m[i][j] * center;
        }
    }
}
