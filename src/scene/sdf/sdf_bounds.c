// Bounds of distance fields: boxes of sublevel sets, computed from the leaves to the root; domains,
// computed from the root to the leaves; and the factors that depend on these.
#include "scene/sdf/sdf.h"

#include "scene/core/affine.h"
#include <math.h>
#include <string.h>

static const struct bounds EVERYWHERE = {{-INFINITY, -INFINITY, -INFINITY},
                                         {INFINITY, INFINITY, INFINITY}};

static struct bounds box_of_halves(double x, double y, double z, double level)
{
    return (struct bounds){{-x - level, -y - level, -z - level}, {x + level, y + level, z + level}};
}

// Transforms a box, which may be infinite. A matrix element that is 0 up to rounding counts as 0.
static struct bounds move_box(const double m[3][4], double scale, const struct bounds *box)
{
    struct bounds out;
    if (bounds_is_empty(box))
        return BOUNDS_EMPTY;
    for (int i = 0; i < 3; i++) {
        out.min[i] = out.max[i] = m[i][3];
        for (int j = 0; j < 3; j++) {
            bool is_endless = isinf(box->min[j]) || isinf(box->max[j]);
            if (m[i][j] == 0 || (is_endless && fabs(m[i][j]) < 1e-12 * scale))
                continue;
            double a = m[i][j] * box->min[j], b = m[i][j] * box->max[j];
            out.min[i] += fmin(a, b);
            out.max[i] += fmax(a, b);
        }
    }
    return out;
}

static struct bounds intersect(const struct bounds *a, const struct bounds *b)
{
    struct bounds out;
    for (int i = 0; i < 3; i++) {
        out.min[i] = fmax(a->min[i], b->min[i]);
        out.max[i] = fmin(a->max[i], b->max[i]);
        if (!(out.min[i] <= out.max[i]))
            return BOUNDS_EMPTY;
    }
    return out;
}

// --- boxes of shapes -----------------------------------------------------------------------------

// Returns the box of a capsule's sublevel set. The distance is exact, so the set consists of the
// solid and all points within `level` of it.
static struct bounds capsule_box(const struct sdf_node *n, double level)
{
    struct bounds box = BOUNDS_EMPTY;
    bounds_add_point(&box, n->a);
    bounds_add_point(&box, n->b);
    for (int i = 0; i < 3; i++) {
        box.min[i] -= n->b[3] + level;
        box.max[i] += n->b[3] + level;
    }
    return box;
}

static struct bounds solid_angle_box(const struct sdf_node *n, double level)
{
    double side = n->b[1] > 0 ? n->a[0] * n->b[0] : n->a[0];
    struct bounds box = box_of_halves(side, n->a[0], side, level);
    box.min[1] = fmin(0, n->a[0] * n->b[1]) - level;
    return box;
}

// Returns the box of the half-space below the height along the normal, which is only bounded if the
// normal is an axis.
static struct bounds plane_box(const struct sdf_node *n, double level)
{
    struct bounds box = EVERYWHERE;
    for (int i = 0; i < 3; i++) {
        if (fabs(n->a[i]) < 1 - 1e-15)
            continue;
        if (n->a[i] > 0)
            box.max[i] = n->b[0] + level;
        else
            box.min[i] = -n->b[0] - level;
    }
    return box;
}

// Returns the box of metaballs. The set lies within the balls, enlarged by `level`.
static struct bounds metaballs_box(const struct sdf_node *n, double level)
{
    struct bounds box = BOUNDS_EMPTY;
    for (uint32_t k = 0; k < n->count; k++)
        for (int i = 0; i < 3; i++) {
            box.min[i] = fmin(box.min[i], n->balls[k][i] - n->balls[k][3] - level);
            box.max[i] = fmax(box.max[i], n->balls[k][i] + n->balls[k][3] + level);
        }
    return box;
}

// Returns the radius of a ball that contains the set. Points of the set have not escaped after the
// iterations. Points beyond this radius have, because |z'| >= |z|^power - |c|.
static double mandelbulb_radius(const struct sdf_node *n)
{
    double low = 1, high = n->a[2];
    for (int step = 0; step < 60; step++) {
        double c = (low + high) / 2, z = c;
        for (int i = 0; i < (int)n->a[1] && z <= n->a[2]; i++)
            z = pow(z, n->a[0]) - c;
        if (z > n->a[2])
            high = c;
        else
            low = c;
    }
    return high;
}

static struct bounds shape_box(const struct sdf_node *n, double level)
{
    const double *a = n->a;
    double radius;
    switch (n->op) {
    case SDF_SPHERE:
        return box_of_halves(a[0], a[0], a[0], level);
    case SDF_BOX:
    case SDF_FRAME:
        return box_of_halves(a[0], a[1], a[2], level);
    case SDF_TORUS:
        return box_of_halves(a[0] + a[1], a[1], a[0] + a[1], level);
    case SDF_CAPSULE:
        return capsule_box(n, level);
    case SDF_CONE:
        radius = fmax(a[0], a[1]);
        return box_of_halves(radius, a[2], radius, level);
    case SDF_CYLINDER:
        return box_of_halves(a[0], a[1], a[0], level);
    case SDF_SOLID_ANGLE:
        return solid_angle_box(n, level);
    case SDF_PLANE:
        return plane_box(n, level);
    case SDF_METABALLS:
        return metaballs_box(n, level);
    case SDF_MENGER:
        return box_of_halves(a[0], a[0], a[0], level);
    case SDF_PYRAMID: // a shift of its oblique planes by d moves the corners by sqrt(3) d per axis
        radius = a[0] + sqrt(3) * level;
        return box_of_halves(radius, radius, radius, 0);
    case SDF_MANDELBULB:
        // The value is less than the distance by an unknown amount, so sets at levels above 0 are
        // not bounded.
        if (level > 0)
            return EVERYWHERE;
        radius = mandelbulb_radius(n);
        return box_of_halves(radius, radius, radius, 0);
    default: // gyroid and packing fill space
        return EVERYWHERE;
    }
}

// --- boxes of operations -------------------------------------------------------------------------

static struct bounds joint_box(const struct sdf_node *n, double level)
{
    // Each joint of a smooth union is at most a quarter of its width below the lesser of the two
    // values.
    double joints = n->count > 1 ? (double)(n->count - 1) : 0;
    struct bounds out = n->op == SDF_UNION ? BOUNDS_EMPTY : EVERYWHERE;
    for (uint32_t k = 0; k < n->count; k++) {
        const struct sdf_node *child = &n->children[k];
        if (n->op == SDF_UNION) {
            struct bounds box = sdf_solid(child, level + joints * n->a[0] / 4);
            if (bounds_is_empty(&box))
                continue;
            bounds_add_point(&out, box.min);
            bounds_add_point(&out, box.max);
        } else {
            struct bounds box = sdf_solid(child, level);
            out = intersect(&out, &box);
        }
        if (n->op == SDF_DIFFERENCE)
            break;
    }
    return out;
}

static struct bounds repeated_box(const struct sdf_node *n, const struct bounds *child)
{
    struct bounds box = *child;
    for (int i = 0; i < 3; i++) {
        double reach = n->a[i] * n->b[i];
        if (n->a[i] != 0 && n->b[i] >= SDF_ENDLESS)
            reach = INFINITY;
        if (reach > 0) {
            box.min[i] -= reach;
            box.max[i] += reach;
        }
    }
    return box;
}

static struct bounds twisted_box(const struct bounds *child)
{
    double x = fmax(fabs(child->min[0]), fabs(child->max[0]));
    double z = fmax(fabs(child->min[2]), fabs(child->max[2]));
    struct bounds box = *child;
    box.max[0] = box.max[2] = hypot(x, z);
    box.min[0] = box.min[2] = -box.max[0];
    return box;
}

static struct bounds mirrored_box(const struct sdf_node *n, const struct bounds *child)
{
    struct bounds half = EVERYWHERE;
    for (int i = 0; i < 3; i++)
        half.min[i] = n->a[i] != 0 ? 0 : -INFINITY;
    struct bounds box = intersect(child, &half);
    if (!bounds_is_empty(&box))
        for (int i = 0; i < 3; i++)
            if (n->a[i] != 0)
                box.min[i] = -box.max[i];
    return box;
}

static struct bounds own_box(const struct sdf_node *n, double level)
{
    struct bounds child;
    switch (n->op) {
    case SDF_UNION:
    case SDF_INTERSECTION:
    case SDF_DIFFERENCE:
        return joint_box(n, level);
    case SDF_ROUND:
    case SDF_SHELL:
        return sdf_solid(n->children, level + n->a[0]);
    case SDF_REPEAT:
    case SDF_MIRROR:
    case SDF_TWIST:
        child = sdf_solid(n->children, n->op == SDF_TWIST ? level / n->a[1] : level);
        if (bounds_is_empty(&child))
            return child;
        return n->op == SDF_REPEAT   ? repeated_box(n, &child)
               : n->op == SDF_MIRROR ? mirrored_box(n, &child)
                                     : twisted_box(&child);
    default:
        return shape_box(n, level);
    }
}

struct bounds sdf_solid(const struct sdf_node *node, double level)
{
    if (!node->is_placed)
        return own_box(node, level);
    struct bounds box = own_box(node, level / node->scale);
    return move_box(node->to_parent, node->scale, &box);
}

// --- symmetry ------------------------------------------------------------------------------------

static bool capsule_is_symmetric(const struct sdf_node *n, int axis)
{
    bool in_plane = n->a[axis] == 0 && n->b[axis] == 0, turns = n->a[axis] == -n->b[axis];
    for (int i = 0; i < 3; i++)
        turns = turns && (i == axis || n->a[i] == n->b[i]);
    return in_plane || turns;
}

static bool metaballs_are_symmetric(const struct sdf_node *n, int axis)
{
    for (uint32_t k = 0; k < n->count; k++) {
        bool found = false;
        for (uint32_t other = 0; other < n->count && !found; other++) {
            found = true;
            for (int i = 0; i < 4; i++)
                found = found && n->balls[other][i] == (i == axis ? -1 : 1) * n->balls[k][i];
        }
        if (!found)
            return false;
    }
    return true;
}

static bool own_symmetry(const struct sdf_node *n, int axis)
{
    switch (n->op) {
    case SDF_SPHERE:
    case SDF_BOX:
    case SDF_FRAME:
    case SDF_TORUS:
    case SDF_CYLINDER:
    case SDF_MENGER:
        return true;
    case SDF_CAPSULE:
        return capsule_is_symmetric(n, axis);
    case SDF_CONE:
        return axis != 1 || n->a[0] == n->a[1];
    case SDF_SOLID_ANGLE:
        return axis != 1;
    case SDF_PLANE:
        return n->a[axis] == 0;
    case SDF_MANDELBULB:
        return axis == 0;
    case SDF_METABALLS:
        return n->count <= 64 && metaballs_are_symmetric(n, axis);
    case SDF_UNION:
    case SDF_INTERSECTION:
    case SDF_DIFFERENCE:
        for (uint32_t k = 0; k < n->count; k++)
            if (!sdf_is_symmetric(&n->children[k], axis))
                return false;
        return true;
    case SDF_ROUND:
    case SDF_SHELL:
    case SDF_REPEAT:
        return sdf_is_symmetric(n->children, axis);
    case SDF_MIRROR:
        return n->a[axis] != 0 || sdf_is_symmetric(n->children, axis);
    default: // gyroid, packing, pyramid and twist: not known to be symmetric
        return false;
    }
}

bool sdf_is_symmetric(const struct sdf_node *node, int axis)
{
    if (!node->is_placed)
        return own_symmetry(node, axis);
    // The axis must be an axis of the node, and the plane must pass through both origins.
    const double tolerance = 1e-12 * node->scale;
    int own = -1;
    for (int j = 0; j < 3; j++)
        if (fabs(fabs(node->to_parent[axis][j]) - node->scale) <= tolerance)
            own = j;
    return own >= 0 && node->to_parent[axis][3] == 0 && own_symmetry(node, own);
}

// --- domains -------------------------------------------------------------------------------------

// Returns the greatest singular value of the twist's map. Its Jacobian is a rotation times a shear
// by a = |radians per metre| times the distance from the axis, and a singular value s satisfies s -
// 1 / s = a.
static double twist_stretch(const struct sdf_node *n, const struct bounds *domain)
{
    double x = fmax(fabs(domain->min[0]), fabs(domain->max[0]));
    double z = fmax(fabs(domain->min[2]), fabs(domain->max[2]));
    double a = fabs(n->a[0]) * hypot(x, z);
    return (a + sqrt(a * a + 4)) / 2;
}

static struct bounds repeated_domain(const struct sdf_node *n, const struct bounds *domain)
{
    struct bounds out = *domain;
    for (int i = 0; i < 3; i++) {
        if (n->a[i] == 0)
            continue;
        double reach = n->a[i] * n->b[i], half = n->a[i] / 2;
        if (sdf_is_symmetric(n->children, i)) {
            out.min[i] = fmin(domain->min[i] + reach, -half);
            out.max[i] = fmax(domain->max[i] - reach, half);
        } else { // each copy is emitted, with a translation
            out.min[i] -= reach;
            out.max[i] += reach;
        }
    }
    return out;
}

static struct bounds child_domain(const struct sdf_node *n, const struct bounds *domain)
{
    struct bounds out = *domain;
    switch (n->op) {
    case SDF_REPEAT:
        return repeated_domain(n, domain);
    case SDF_TWIST:
        return twisted_box(domain);
    case SDF_MIRROR:
        for (int i = 0; i < 3; i++)
            if (n->a[i] != 0) {
                out.max[i] = fmax(fabs(domain->min[i]), fabs(domain->max[i]));
                out.min[i] = 0;
            }
        return out;
    default:
        return out;
    }
}

struct spread_state {
    struct sdf_spread *out;
    double scale;   // metres of the root per metre in this space
    double stretch; // factor by which twists increase the gradient, relative to the root
};

static void add_magnitude(const struct bounds *domain, double scale, double *magnitude)
{
    for (int i = 0; i < 3; i++)
        *magnitude = fmax(*magnitude, scale * fmax(fabs(domain->min[i]), fabs(domain->max[i])));
}

// Includes the lengths of a shape in the maximum coordinate. If the box cuts the shape, they may be
// larger than the box.
static void add_lengths(const struct sdf_node *n, double scale, double *magnitude)
{
    for (int i = 0; i < 3 && n->op <= SDF_PLANE; i++)
        *magnitude = fmax(*magnitude, scale * fabs(n->a[i]));
    for (int i = 0; i < 4 && (n->op == SDF_CAPSULE || n->op == SDF_PLANE); i++)
        *magnitude = fmax(*magnitude, scale * fabs(n->b[i]));
    for (uint32_t k = 0; k < n->count && n->op == SDF_METABALLS; k++)
        for (int i = 0; i < 4; i++)
            *magnitude = fmax(*magnitude, scale * fabs(n->balls[k][i]));
}

static void spread_node(struct sdf_node *n, const struct bounds *domain, struct spread_state s)
{
    struct bounds own = *domain;
    double factor = 1;
    add_magnitude(domain, s.scale, &s.out->magnitude);
    if (n->is_placed) {
        double inverse[3][4];
        affine_inverse(n->to_parent, inverse);
        own = move_box(inverse, 1 / n->scale, domain);
        s.scale *= n->scale;
    }
    add_magnitude(&own, s.scale, &s.out->magnitude);
    add_lengths(n, s.scale, &s.out->magnitude);
    if (n->op == SDF_TWIST) {
        double inverse_stretch = 1 / twist_stretch(n, &own);
        s.out->grew = s.out->grew || inverse_stretch < n->a[1] * (1 - 1e-12);
        n->a[1] = fmin(n->a[1], inverse_stretch);
        s.stretch /= n->a[1];
    } else if (n->op == SDF_MANDELBULB || n->op == SDF_APOLLONIAN) {
        factor = 1 / n->b[0];
    }
    s.out->lipschitz = fmax(s.out->lipschitz, s.stretch * factor);
    if (n->op == SDF_METABALLS)
        return;
    own = child_domain(n, &own);
    for (uint32_t k = 0; k < n->count; k++)
        spread_node(&n->children[k], &own, s);
}

void sdf_spread_domain(struct sdf_node *node, const struct bounds *domain,
                       struct sdf_spread *spread)
{
    *spread = (struct sdf_spread){.lipschitz = 1};
    spread_node(node, domain, (struct spread_state){spread, 1, 1});
}
