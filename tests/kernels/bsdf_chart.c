// Charts: coordinates of directions that follow the lobes of a BSDF.
#include "bsdf_cells.h"

#include "base/maths.h"

void chart_unit(const float rounded[3], double out[3])
{
    int greatest = 0;
    double square = 1;
    for (int c = 0; c < 3; c++) {
        out[c] = (double)rounded[c];
        square -= out[c] * out[c];
        greatest = fabs(out[c]) > fabs(out[greatest]) ? c : greatest;
    }
    square += out[greatest] * out[greatest];
    out[greatest] = copysign(sqrt(fmax(square, 0)), out[greatest]);
}

// Rotates a vector into the frame of the lobes, or out of it.
static void turn(const struct chart *c, double v[3], double sign)
{
    double x = c->turn[0] * v[0] + sign * c->turn[1] * v[1];
    v[1] = c->turn[0] * v[1] - sign * c->turn[1] * v[0];
    v[0] = x;
}

static struct chart turned(const struct chart *chart)
{
    struct chart c = *chart;
    turn(chart, c.wo, 1);
    return c;
}

// --- rows ----------------------------------------------------------------------------------------
// tau is the squared tangent of the angle (of half of it for CHART_MIRROR) from the lobes' axis.

struct scales {
    double square[CHART_MAX_LOBES + 1]; // each term is 1 - 1 / sqrt(1 + tau / square)
    int count;
};

static double row_of(const struct scales *s, double tau)
{
    double sum = 0;
    for (int i = 0; i < s->count; i++)
        sum += 1 - 1 / sqrt(1 + tau / s->square[i]);
    return sum / s->count;
}

static double row_slope(const struct scales *s, double tau)
{
    double sum = 0;
    for (int i = 0; i < s->count; i++)
        sum += 0.5 / s->square[i] * pow(1 + tau / s->square[i], -1.5);
    return sum / s->count;
}

// Inverts row_of() by bisection of ln(tau), followed by Newton's method.
static double row_inverse(const struct scales *s, double x)
{
    double least = s->square[0], most = s->square[0];
    for (int i = 1; i < s->count; i++) {
        least = fmin(least, s->square[i]);
        most = fmax(most, s->square[i]);
    }
    // Bounds of the solution: each term is between those of the least and the greatest scale.
    double ratio = 1 / ((1 - x) * (1 - x)) - 1;
    double low = log(least * ratio), high = log(most * ratio);
    while (high - low > 0.5) {
        double middle = 0.5 * (low + high);
        *(row_of(s, exp(middle)) < x ? &low : &high) = middle;
    }
    double log_tau = 0.5 * (low + high);
    for (int i = 0; i < 6; i++) {
        double tau = exp(log_tau);
        double next = log_tau - (row_of(s, tau) - x) / (row_slope(s, tau) * tau);
        log_tau = fmin(fmax(next, low), high);
    }
    return exp(log_tau);
}

// --- frames --------------------------------------------------------------------------------------

// Computes the azimuth of a half-vector as a unit vector, its derivative, and the scales there.
static void half_azimuth(const struct chart *c, double phi, double direction[2], double *slope,
                         struct scales *scales)
{
    double ax = c->alpha[0][0], ay = c->alpha[0][1];
    double x = ax * cos(phi), y = ay * sin(phi), square = x * x + y * y;
    direction[0] = x / sqrt(square);
    direction[1] = y / sqrt(square);
    *slope = ax * ay / square;
    scales->count = c->lobes + 1;
    for (int i = 0; i < c->lobes; i++) {
        double bx = direction[0] / c->alpha[i][0], by = direction[1] / c->alpha[i][1];
        scales->square[i] = 1 / (bx * bx + by * by);
    }
    scales->square[c->lobes] = 1;
}

static void mirror_frame(const struct chart *c, double axis[3][3])
{
    double *z = axis[2];
    z[0] = -c->wo[0];
    z[1] = -c->wo[1];
    z[2] = c->wo[2];
    double side[3] = {-z[1], z[0], 0};
    if (side[0] == 0 && side[1] == 0)
        side[0] = 1;
    vec3_normalize(side);
    for (int i = 0; i < 3; i++)
        axis[0][i] = side[i];
    for (int i = 0; i < 3; i++)
        axis[1][i] = z[(i + 1) % 3] * side[(i + 2) % 3] - z[(i + 2) % 3] * side[(i + 1) % 3];
}

static void mirror_scales(const struct chart *c, struct scales *scales)
{
    scales->count = c->lobes + 1;
    for (int i = 0; i < c->lobes; i++)
        scales->square[i] = c->alpha[i][0] * c->alpha[i][0];
    scales->square[c->lobes] = 1;
}

// --- the domain ----------------------------------------------------------------------------------

// wi.z = 2 (wo.h) h.z - wo.z is positive as long as the half-vector's angle a is below the result:
// with s and c the sine and cosine of wo's angle and d the cosine of the azimuth between, s d sin(2
// a) + c cos(2 a) > 0.
static double reflect_end(const struct chart *c, const double direction[2])
{
    double along = c->wo[0] * direction[0] + c->wo[1] * direction[1];
    double angle = (atan2(along, c->wo[2]) + M_PI / 2) / 2;
    return tan(angle) * tan(angle);
}

static double mirror_end(double axis[3][3], double phi)
{
    double side = cos(phi) * axis[0][2] + sin(phi) * axis[1][2];
    double angle = atan2(axis[2][2], -side); // cos(a) z + sin(a) side is 0 at this angle
    return tan(angle / 2) * tan(angle / 2);
}

double chart_end(const struct chart *chart, double phi)
{
    const struct chart c = turned(chart);
    struct scales scales;
    double direction[2], slope, axis[3][3];
    switch (chart->kind) {
    case CHART_REFLECT:
        half_azimuth(&c, phi, direction, &slope, &scales);
        return row_of(&scales, reflect_end(&c, direction));
    case CHART_MIRROR:
        mirror_frame(&c, axis);
        mirror_scales(&c, &scales);
        return row_of(&scales, mirror_end(axis, phi));
    default:
        return 1;
    }
}

// --- directions ----------------------------------------------------------------------------------

static bool sphere_direction(double x, double phi, double wi[3], double *jacobian)
{
    double angle = x * M_PI / 2;
    wi[0] = sin(angle) * cos(phi);
    wi[1] = sin(angle) * sin(phi);
    wi[2] = cos(angle);
    *jacobian = sin(angle) * M_PI / 2;
    return true;
}

static bool mirror_direction(const struct chart *c, double x, double phi, double wi[3],
                             double *jacobian)
{
    struct scales scales;
    double axis[3][3];
    mirror_frame(c, axis);
    mirror_scales(c, &scales);
    double tau = row_inverse(&scales, x);
    double cosine = (1 - tau) / (1 + tau), sine = 2 * sqrt(tau) / (1 + tau);
    for (int i = 0; i < 3; i++)
        wi[i] = sine * (cos(phi) * axis[0][i] + sin(phi) * axis[1][i]) + cosine * axis[2][i];
    *jacobian = 2 / ((1 + tau) * (1 + tau)) / row_slope(&scales, tau);
    return wi[2] > 0;
}

// Also returns the solid angle of h per unit of dx dphi.
static double half_vector(const struct chart *c, double x, double phi, double h[3])
{
    struct scales scales;
    double direction[2], slope;
    half_azimuth(c, phi, direction, &slope, &scales);
    double tau = row_inverse(&scales, x);
    double z = 1 / sqrt(1 + tau), radius = sqrt(tau) * z;
    h[0] = radius * direction[0];
    h[1] = radius * direction[1];
    h[2] = z;
    return 0.5 * z * z * z * slope / row_slope(&scales, tau);
}

double chart_normal(const struct chart *chart, double x, double phi, double h[3])
{
    double solid_angle = half_vector(chart, x, phi, h);
    turn(chart, h, -1);
    return solid_angle;
}

double chart_cosine(const struct chart *chart, double x, double phi)
{
    const struct chart c = turned(chart);
    double h[3];
    if (chart->kind == CHART_SPHERE || chart->kind == CHART_MIRROR)
        return 1;
    half_vector(&c, fmin(fmax(x, 1e-9), 1 - 1e-9), phi, h);
    return vec3_dot(c.wo, h);
}

double chart_fresnel_scale(const struct chart *chart)
{
    return fmin(1, sqrt(fabs(1 - chart->eta * chart->eta)));
}

static bool half_direction(const struct chart *c, double x, double phi, double wi[3],
                           double *jacobian)
{
    double h[3], half_jacobian = half_vector(c, x, phi, h);
    double cosine = vec3_dot(c->wo, h);
    if (!(cosine > 0))
        return false;
    if (c->kind == CHART_NORMALS) {
        for (int i = 0; i < 3; i++)
            wi[i] = h[i];
        *jacobian = half_jacobian;
        return true;
    }
    if (c->kind == CHART_REFLECT) {
        for (int i = 0; i < 3; i++)
            wi[i] = 2 * cosine * h[i] - c->wo[i];
        *jacobian = half_jacobian * 4 * cosine;
        return wi[2] > 0;
    }
    // Walter et al. 2007, eq. 40 and 17.
    double ratio = 1 / c->eta, rest = 1 - ratio * ratio * (1 - cosine * cosine);
    if (!(rest > 0))
        return false;
    double beyond = sqrt(rest);
    for (int i = 0; i < 3; i++)
        wi[i] = (ratio * cosine - beyond) * h[i] - ratio * c->wo[i];
    double sum = cosine - c->eta * beyond;
    *jacobian = half_jacobian * sum * sum / (c->eta * c->eta * beyond);
    return wi[2] < 0;
}

bool chart_direction(const struct chart *chart, double x, double phi, double wi[3],
                     double *jacobian)
{
    const struct chart c = turned(chart);
    bool inside;
    wi[0] = wi[1] = wi[2] = *jacobian = 0;
    switch (chart->kind) {
    case CHART_SPHERE:
        inside = sphere_direction(x, phi, wi, jacobian);
        break;
    case CHART_MIRROR:
        inside = mirror_direction(&c, x, phi, wi, jacobian);
        break;
    default:
        inside = half_direction(&c, x, phi, wi, jacobian);
        break;
    }
    turn(chart, wi, -1);
    if (chart->below && chart->kind != CHART_REFRACT && chart->kind != CHART_NORMALS)
        wi[2] = -wi[2];
    return inside;
}

// --- places --------------------------------------------------------------------------------------

static void place_half(const struct chart *c, const double wi[3], double *x, double *phi)
{
    double h[3];
    for (int i = 0; i < 3; i++)
        h[i] = c->kind == CHART_REFLECT ? c->wo[i] + wi[i] : -(c->wo[i] + c->eta * wi[i]);
    if (h[2] < 0)
        for (int i = 0; i < 3; i++)
            h[i] = -h[i];
    struct scales scales;
    double direction[2], slope;
    *phi = atan2(h[1] / c->alpha[0][1], h[0] / c->alpha[0][0]);
    half_azimuth(c, *phi, direction, &slope, &scales);
    *x = row_of(&scales, (h[0] * h[0] + h[1] * h[1]) / (h[2] * h[2]));
}

void chart_place(const struct chart *chart, const double wi[3], double *x, double *phi)
{
    const struct chart c = turned(chart);
    bool over = chart->below && chart->kind != CHART_REFRACT;
    double d[3] = {wi[0], wi[1], over ? -wi[2] : wi[2]};
    turn(chart, d, 1);
    struct scales scales;
    double axis[3][3];
    switch (chart->kind) {
    case CHART_SPHERE:
        *phi = atan2(d[1], d[0]);
        *x = atan2(sqrt(d[0] * d[0] + d[1] * d[1]), d[2]) / (M_PI / 2);
        return;
    case CHART_MIRROR:
        mirror_frame(&c, axis);
        mirror_scales(&c, &scales);
        double along[3] = {vec3_dot(d, axis[0]), vec3_dot(d, axis[1]), vec3_dot(d, axis[2])};
        double norm = sqrt(vec3_dot(along, along));
        *phi = atan2(along[1], along[0]);
        double sine = sqrt(along[0] * along[0] + along[1] * along[1]);
        double tangent = sine / (norm + along[2]);
        *x = row_of(&scales, tangent * tangent);
        return;
    default:
        place_half(&c, d, x, phi);
        return;
    }
}

uint32_t chart_cell(const struct chart *chart, const double wi[3])
{
    double x, phi;
    chart_place(chart, wi, &x, &phi);
    double part = phi / (2 * M_PI);
    part -= floor(part);
    int row = (int)(x * CHART_ROWS), column = (int)(part * CHART_COLUMNS);
    row = row < 0 ? 0 : row >= CHART_ROWS ? CHART_ROWS - 1 : row;
    column = column >= CHART_COLUMNS ? CHART_COLUMNS - 1 : column;
    return (uint32_t)(row * CHART_COLUMNS + column);
}
