// Computes a bound of the gradient of the sum of metaballs by branch and bound, over boxes around
// the balls.
#include "scene/sdf/sdf.h"

#include "scene/core/affine.h"
#include <math.h>

#define TOLERANCE 0.03     // relative tolerance of the bound
#define CELLS_MOST 32768u  // maximum number of cells at a time
#define WORK_MOST 30000000 // maximum number of evaluations of balls

// The slope of (1 - q^2)^3, q = d / R, in units of 1 / R. It is greatest at q = 1 / sqrt(5).
static double slope(double q)
{
    double inside = q < 1 ? 1 - q * q : 0;
    return 6 * q * inside * inside;
}
#define STEEPEST 0.4472135954999579

// Returns the maximum second derivative, in units of 1 / R^2, for q in an interval: 6 (1 - q^2)^2
// across the radius and 6 (1 - q^2) (5 q^2 - 1) along it, which peaks at q^2 = 3 / 5. (Where the
// latter is negative, its magnitude is at most the former.)
static double curvature(double nearest, double farthest)
{
    double u = nearest * nearest, v = fmin(farthest * farthest, 1);
    double along =
        u <= 0.6 && v >= 0.6 ? 4.8 : fmax(6 * (1 - u) * (5 * u - 1), 6 * (1 - v) * (5 * v - 1));
    return fmax(6 * (1 - u) * (1 - u), along);
}

struct cell {
    double center[3], half[3], bound;
};

struct search {
    const double (*balls)[4];
    uint32_t count;
    double found; // greatest gradient found so far
    double work;
};

// Computes the gradient at the centre, and a bound of its length in the cell: the lesser of the sum
// of the balls' slopes, and the length at the centre plus the greatest change within the cell.
static double bound_of_cell(struct search *s, const struct cell *cell)
{
    double gradient[3] = {0}, sum = 0, change = 0, radius = vec3_length(cell->half);
    for (uint32_t k = 0; k < s->count; k++) {
        const double *ball = s->balls[k];
        double from[3];
        vec3_subtract(cell->center, ball, from);
        double d = vec3_length(from), q = d / ball[3], reach = radius / ball[3];
        if (q - reach >= 1)
            continue;
        for (int i = 0; i < 3 && d > 0; i++)
            gradient[i] += from[i] / d * slope(q) / ball[3];
        double nearest = fmax(q - reach, 0), farthest = q + reach;
        double steepest = nearest > STEEPEST ? nearest : farthest < STEEPEST ? farthest : STEEPEST;
        sum += slope(steepest) / ball[3];
        change += curvature(nearest, farthest) / (ball[3] * ball[3]) * radius;
    }
    double here = vec3_length(gradient);
    s->work += s->count;
    s->found = fmax(s->found, here);
    return fmin(sum, here + change);
}

// Halves a cell across its longest edge. Stores the halves that can exceed the maximum so far, and
// returns their number.
static uint32_t halve(struct search *s, const struct cell *cell, struct cell *out)
{
    const double *half = cell->half;
    int axis = half[0] >= half[1] && half[0] >= half[2] ? 0 : half[1] >= half[2] ? 1 : 2;
    uint32_t count = 0;
    for (int side = -1; side <= 1; side += 2) {
        struct cell part = *cell;
        part.half[axis] /= 2;
        part.center[axis] += side * part.half[axis];
        part.bound = bound_of_cell(s, &part);
        if (part.bound > s->found * (1 + TOLERANCE))
            out[count++] = part;
    }
    return count;
}

// Halves all cells once. Returns false if memory or the work limit is exceeded.
static bool refine(struct search *s, struct cell *cells, struct cell *next, uint32_t *count)
{
    uint32_t kept = 0;
    for (uint32_t k = 0; k < *count; k++) {
        if (cells[k].bound <= s->found * (1 + TOLERANCE))
            continue;
        if (kept + 2 > CELLS_MOST || s->work > WORK_MOST)
            return false;
        kept += halve(s, &cells[k], next + kept);
    }
    *count = kept;
    return true;
}

double sdf_metaballs_gradient(const double (*balls)[4], uint32_t count)
{
    struct search s = {.balls = balls, .count = count};
    struct arena scratch = {0};
    struct cell *cells[2];
    double most = 0, all = 0;
    for (uint32_t k = 0; k < count; k++)
        all += slope(STEEPEST) / balls[k][3];
    for (int i = 0; i < 2; i++)
        cells[i] = ARENA_NEW(&scratch, struct cell, CELLS_MOST);
    // The gradient is zero outside the balls, and each ball is inside its cube.
    for (uint32_t k = 0; k < count && cells[0] && cells[1]; k++) {
        const double *b = balls[k];
        uint32_t left = 1, from = 0;
        cells[0][0] = (struct cell){{b[0], b[1], b[2]}, {b[3], b[3], b[3]}, all};
        while (left > 0 && refine(&s, cells[from], cells[!from], &left))
            from = !from;
        for (uint32_t i = 0; i < left; i++)
            most = fmax(most, cells[from][i].bound);
    }
    bool ok = cells[0] && cells[1];
    arena_finish(&scratch);
    return ok ? fmax(s.found * (1 + TOLERANCE), most) : all;
}
