// The parts of each figure, in the order in which they are joined.
#include "scene/generate/figure_field.h"

#include "base/maths.h"
#include <assert.h>
#include <math.h>
#include <string.h>

const char *const figure_names[FIGURE_COUNT + 1] = {"skull", "dragon", "monkey", NULL};
const uint32_t figure_triangles[FIGURE_COUNT] = {10000, 900000, 500};

// --- skull ---------------------------------------------------------------------------------------

#define BONE .skin = SKIN_BONE
#define TWICE .mirror = MIRROR_X
#define CONE(ax, ay, az, bx, by, bz, ra, rb, k)                                                    \
    .kind = PART_CONE, .a = {ax, ay, az}, .b = {bx, by, bz}, .radii = {ra, rb}, .blend = k
#define ELLIPSOID(x, y, z, rx, ry, rz, k)                                                          \
    .kind = PART_ELLIPSOID, .a = {x, y, z}, .b = {rx, ry, rz}, .blend = k

static const struct part skull[] = {
    {ELLIPSOID(0, 0.38, -0.12, 0.61, 0.60, 0.76, 0), BONE},
    {ELLIPSOID(0, 0.12, -0.55, 0.46, 0.40, 0.36, 0.15), BONE}, // back of the head
    {ELLIPSOID(0, 0.36, 0.34, 0.48, 0.38, 0.30, 0.15), BONE},  // forehead
    {ELLIPSOID(0, -0.16, 0.36, 0.34, 0.36, 0.32, 0.12), BONE}, // face
    {ELLIPSOID(0.70, 0.10, 0.28, 0.19, 0.26, 0.24, 0.14), BONE, TWICE, .carves = true}, // temples
    {ELLIPSOID(0.46, -0.50, 0.46, 0.18, 0.24, 0.34, 0.08), BONE, TWICE, .carves = true},
    {CONE(0.06, 0.20, 0.63, 0.42, 0.20, 0.47, 0.085, 0.075, 0.09), BONE, TWICE},  // brows
    {CONE(0.42, 0.18, 0.46, 0.43, -0.10, 0.45, 0.06, 0.07, 0.05), BONE, TWICE},   // beside the eyes
    {CONE(0.26, -0.20, 0.56, 0.45, -0.13, 0.42, 0.07, 0.075, 0.07), BONE, TWICE}, // cheeks
    {CONE(0.45, -0.13, 0.42, 0.60, -0.10, 0.05, 0.065, 0.045, 0.05), BONE, TWICE},
    {CONE(0.60, -0.10, 0.05, 0.57, -0.06, -0.22, 0.045, 0.06, 0.06), BONE, TWICE},
    {CONE(0.47, -0.12, -0.24, 0.43, -0.36, -0.18, 0.12, 0.05, 0.06), BONE,
     TWICE},                                                         // behind the ears
    {CONE(0, 0.14, 0.63, 0, -0.06, 0.75, 0.065, 0.045, 0.06), BONE}, // nose
    {ELLIPSOID(0, -0.40, 0.44, 0.27, 0.15, 0.25, 0.08), BONE},       // upper jaw
    {ELLIPSOID(0.225, 0.02, 0.66, 0.155, 0.14, 0.30, 0.05), BONE, TWICE, .carves = true}, // eyes
    {ELLIPSOID(0.055, -0.20, 0.76, 0.06, 0.11, 0.20, 0.03), BONE, TWICE, .carves = true},
    {ELLIPSOID(0, -0.10, 0.80, 0.04, 0.10, 0.16, 0.02), BONE, .carves = true},
    {ELLIPSOID(0, -0.62, 0.22, 0.26, 0.22, 0.30, 0.03), BONE, .carves = true}, // mouth, from inside
    {ELLIPSOID(0, -0.87, 0.54, 0.15, 0.11, 0.11, 0.03), BONE},                 // chin
    {CONE(0.08, -0.80, 0.52, 0.34, -0.76, 0.30, 0.10, 0.10, 0.08), BONE, TWICE},
    {CONE(0.34, -0.76, 0.30, 0.49, -0.66, -0.02, 0.10, 0.08, 0.06), BONE, TWICE},
    {CONE(0.49, -0.66, -0.02, 0.53, -0.20, -0.12, 0.08, 0.055, 0.06), BONE, TWICE},
    {CONE(0.46, -0.60, 0.10, 0.54, -0.16, 0.10, 0.035, 0.03, 0.06), BONE, TWICE},
    {CONE(0.0, -0.75, 0.60, 0.22, -0.74, 0.47, 0.055, 0.055, 0.05), BONE, TWICE},
    {CONE(0.22, -0.74, 0.47, 0.30, -0.73, 0.30, 0.055, 0.055, 0.05), BONE,
     TWICE}, // below the teeth
};

static const struct part monkey[] = {
    {ELLIPSOID(0, 0.12, -0.12, 0.72, 0.66, 0.62, 0), .skin = SKIN_FUR},
    {ELLIPSOID(0, 0.42, 0.02, 0.52, 0.42, 0.48, 0.2), .skin = SKIN_FUR},
    {ELLIPSOID(0.36, -0.16, 0.30, 0.30, 0.28, 0.28, 0.18), .skin = SKIN_FUR, TWICE},
    {ELLIPSOID(0, -0.42, 0.42, 0.40, 0.34, 0.38, 0.16), .skin = SKIN_PLAIN}, // muzzle
    {CONE(0.05, 0.27, 0.56, 0.40, 0.25, 0.46, 0.13, 0.12, 0.14), .skin = SKIN_FUR, TWICE},
    {ELLIPSOID(0.92, 0.10, -0.10, 0.30, 0.36, 0.10, 0.08), .skin = SKIN_PLAIN, TWICE},
    {ELLIPSOID(0.95, 0.08, 0.03, 0.19, 0.24, 0.09, 0.05), .skin = SKIN_PLAIN, TWICE,
     .carves = true},
    {ELLIPSOID(0.25, 0.07, 0.62, 0.17, 0.14, 0.16, 0.06), .skin = SKIN_PLAIN, TWICE,
     .carves = true},
    {ELLIPSOID(0.25, 0.07, 0.47, 0.14, 0.14, 0.14, 0.01), .skin = SKIN_PLAIN, TWICE}, // eyeballs
    {ELLIPSOID(0, -0.22, 0.76, 0.13, 0.085, 0.08, 0.06), .skin = SKIN_PLAIN},
    {ELLIPSOID(0.055, -0.25, 0.84, 0.04, 0.03, 0.06, 0.02), .skin = SKIN_PLAIN, TWICE,
     .carves = true},
    {CONE(0, -0.53, 0.80, 0.30, -0.44, 0.62, 0.035, 0.03, 0.05), .skin = SKIN_PLAIN, TWICE,
     .carves = true}, // mouth
    {CONE(0, 0.80, 0.15, 0.06, 0.98, -0.02, 0.10, 0.03, 0.08), .skin = SKIN_FUR},
    {CONE(0, 0.80, 0.0, -0.08, 0.96, -0.16, 0.10, 0.03, 0.08), .skin = SKIN_FUR},
};

// --- dragon --------------------------------------------------------------------------------------

#define SCALES .skin = SKIN_SCALES
#define SIDES .mirror = MIRROR_Z

static const struct part dragon[] = {
    // Hips and shoulders, legs, feet.
    {ELLIPSOID(-0.42, 0.66, 0.27, 0.34, 0.36, 0.22, 0.12), SCALES, SIDES},
    {CONE(-0.38, 0.58, 0.36, -0.10, 0.34, 0.56, 0.21, 0.13, 0.10), SCALES, SIDES},
    {CONE(-0.10, 0.34, 0.56, -0.44, 0.17, 0.58, 0.12, 0.08, 0.07), SCALES, SIDES},
    {CONE(-0.44, 0.12, 0.58, -0.18, 0.07, 0.60, 0.09, 0.08, 0.06), SCALES, SIDES},
    {ELLIPSOID(0.56, 0.72, 0.24, 0.26, 0.30, 0.18, 0.12), SCALES, SIDES},
    {CONE(0.56, 0.66, 0.32, 0.42, 0.36, 0.50, 0.17, 0.11, 0.09), SCALES, SIDES},
    {CONE(0.42, 0.36, 0.50, 0.66, 0.12, 0.52, 0.10, 0.075, 0.06), SCALES, SIDES},
    {CONE(0.66, 0.09, 0.52, 0.80, 0.07, 0.53, 0.085, 0.075, 0.05), SCALES, SIDES},
    {CONE(-0.16, 0.06, 0.54, 0.02, 0.035, 0.50, 0.05, 0.012, 0.03), .skin = SKIN_HORN, SIDES},
    {CONE(-0.14, 0.06, 0.60, 0.06, 0.035, 0.61, 0.05, 0.012, 0.03), .skin = SKIN_HORN, SIDES},
    {CONE(-0.16, 0.06, 0.66, 0.02, 0.035, 0.71, 0.05, 0.012, 0.03), .skin = SKIN_HORN, SIDES},
    {CONE(0.80, 0.06, 0.48, 0.97, 0.035, 0.44, 0.045, 0.012, 0.03), .skin = SKIN_HORN, SIDES},
    {CONE(0.82, 0.06, 0.53, 1.01, 0.035, 0.54, 0.045, 0.012, 0.03), .skin = SKIN_HORN, SIDES},
    {CONE(0.80, 0.06, 0.58, 0.97, 0.035, 0.63, 0.045, 0.012, 0.03), .skin = SKIN_HORN, SIDES},
    // Head: brain case, snout, lower jaw, brows, nostrils, eyes.
    {ELLIPSOID(1.40, 2.00, 0, 0.24, 0.19, 0.19, 0.08), SCALES},
    {CONE(1.50, 1.99, 0, 1.90, 1.88, 0, 0.15, 0.10, 0.08), SCALES},
    {CONE(1.42, 1.84, 0, 1.80, 1.68, 0, 0.11, 0.055, 0.05), SCALES},
    {CONE(1.46, 1.86, 0.14, 1.30, 1.90, 0.17, 0.09, 0.08, 0.06), SCALES, SIDES},
    {CONE(1.40, 2.13, 0.13, 1.62, 2.06, 0.11, 0.05, 0.04, 0.05), SCALES, SIDES},
    {ELLIPSOID(1.54, 2.04, 0.155, 0.055, 0.05, 0.035, 0.01), .skin = SKIN_PLAIN, SIDES},
    {ELLIPSOID(1.88, 1.94, 0.06, 0.06, 0.045, 0.04, 0.04), SCALES, SIDES},
    {ELLIPSOID(1.94, 1.96, 0.075, 0.03, 0.018, 0.02, 0.015), SCALES, SIDES, .carves = true},
    // Horns, frill and chin.
    {CONE(1.28, 2.12, 0.11, 1.08, 2.30, 0.19, 0.065, 0.05, 0.04), .skin = SKIN_HORN, SIDES},
    {CONE(1.08, 2.30, 0.19, 0.86, 2.36, 0.25, 0.05, 0.032, 0.02), .skin = SKIN_HORN, SIDES},
    {CONE(0.86, 2.36, 0.25, 0.68, 2.30, 0.28, 0.032, 0.008, 0.01), .skin = SKIN_HORN, SIDES},
    {CONE(1.26, 1.98, 0.18, 1.06, 2.04, 0.33, 0.045, 0.01, 0.03), .skin = SKIN_HORN, SIDES},
    {CONE(1.26, 1.88, 0.18, 1.08, 1.86, 0.34, 0.045, 0.01, 0.03), .skin = SKIN_HORN, SIDES},
    {CONE(1.70, 1.66, 0, 1.64, 1.54, 0, 0.035, 0.008, 0.03), .skin = SKIN_HORN},
    // Wings: an arm, three fingers, a web between them.
    {CONE(0.36, 1.00, 0.24, 0.10, 1.58, 0.62, 0.11, 0.065, 0.10), SCALES, SIDES},
    {CONE(0.10, 1.58, 0.62, 0.36, 2.12, 1.10, 0.06, 0.045, 0.04), SCALES, SIDES},
    {CONE(0.36, 2.12, 1.10, 0.52, 2.26, 1.16, 0.035, 0.008, 0.02), .skin = SKIN_HORN, SIDES},
    {CONE(0.36, 2.12, 1.10, -0.85, 2.22, 2.05, 0.042, 0.014, 0.03), SCALES, SIDES},
    {CONE(0.36, 2.12, 1.10, -1.20, 1.62, 1.62, 0.038, 0.014, 0.03), SCALES, SIDES},
    {CONE(0.36, 2.12, 1.10, -1.25, 1.12, 1.02, 0.038, 0.014, 0.03), SCALES, SIDES},
    {.kind = PART_WEB,
     .skin = SKIN_WEB,
     .a = {0.36, 2.12, 1.10},
     .b = {-0.85, 2.22, 2.05},
     .c = {-1.20, 1.62, 1.62},
     .radii = {0.02},
     .blend = 0.03,
     SIDES},
    {.kind = PART_WEB,
     .skin = SKIN_WEB,
     .a = {0.36, 2.12, 1.10},
     .b = {-1.20, 1.62, 1.62},
     .c = {-1.25, 1.12, 1.02},
     .radii = {0.02},
     .blend = 0.03,
     SIDES},
    {.kind = PART_WEB,
     .skin = SKIN_WEB,
     .a = {0.36, 2.12, 1.10},
     .b = {-1.25, 1.12, 1.02},
     .c = {-0.55, 0.92, 0.22},
     .radii = {0.02},
     .blend = 0.04,
     SIDES},
    {.kind = PART_WEB,
     .skin = SKIN_WEB,
     .a = {0.36, 2.12, 1.10},
     .b = {-0.55, 0.92, 0.22},
     .c = {0.20, 1.04, 0.24},
     .radii = {0.02},
     .blend = 0.04,
     SIDES},
};

// The spine from the tip of the tail to the head: position and radius.
static const double spine[][4] = {
    {-1.05, 0.05, 1.42, 0.015}, {-1.45, 0.06, 1.36, 0.045}, {-1.85, 0.08, 1.05, 0.075},
    {-2.02, 0.11, 0.55, 0.105}, {-1.88, 0.17, 0.12, 0.14},  {-1.45, 0.30, -0.06, 0.19},
    {-0.95, 0.52, -0.04, 0.26}, {-0.45, 0.70, 0, 0.35},     {0.05, 0.72, 0, 0.40},
    {0.50, 0.78, 0, 0.37},      {0.82, 1.02, 0, 0.28},      {0.98, 1.35, 0, 0.215},
    {1.06, 1.66, 0, 0.18},      {1.20, 1.90, 0, 0.17},      {1.40, 1.98, 0, 0.16},
};
enum { SPINE_POINTS = sizeof spine / sizeof *spine, SPINE_STEPS = 5 };

// Computes a point of the spline through the points of the spine (Catmull and Rom 1974).
static void spine_at(uint32_t segment, double t, double out[4])
{
    uint32_t last = SPINE_POINTS - 1;
    const double *p[4] = {spine[segment > 0 ? segment - 1 : 0], spine[segment], spine[segment + 1],
                          spine[segment + 2 <= last ? segment + 2 : last]};
    for (int i = 0; i < 4; i++)
        out[i] = 0.5 * (2 * p[1][i] + (p[2][i] - p[0][i]) * t +
                        (2 * p[0][i] - 5 * p[1][i] + 4 * p[2][i] - p[3][i]) * t * t +
                        (3 * p[1][i] - p[0][i] - 3 * p[2][i] + p[3][i]) * t * t * t);
}

// --- construction --------------------------------------------------------------------------------

static void add(struct figure_field *field, const struct part *original)
{
    struct part *part = &field->parts[field->count];
    assert(field->count < PARTS_MAX);
    *part = *original;
    if (part->kind == PART_WEB)
        part->radii[0] = fmax(part->radii[0], field->thinnest);
    double *center = field->centers[field->count], square = 0;
    for (int i = 0; i < 3; i++) {
        bool is_ellipsoid = part->kind == PART_ELLIPSOID;
        center[i] = is_ellipsoid ? part->a[i] : 0.5 * (part->a[i] + part->b[i]);
        double half = is_ellipsoid ? 0 : 0.5 * (part->b[i] - part->a[i]);
        square += half * half;
    }
    double reach = sqrt(square) + fmax(part->radii[0], part->radii[1]);
    if (part->kind == PART_ELLIPSOID)
        reach = fmax(part->b[0], fmax(part->b[1], part->b[2]));
    if (part->kind == PART_WEB) {
        square = 0;
        for (int i = 0; i < 3; i++)
            square += (part->c[i] - center[i]) * (part->c[i] - center[i]);
        reach = fmax(reach, sqrt(square) + part->radii[0]);
    }
    field->reach[field->count] = reach;
    field->count++;
    for (int i = 0; i < 3 && !part->carves; i++) {
        double low = center[i] - reach, high = center[i] + reach;
        if (part->mirror == MIRROR_X && i == 0)
            low = fmin(low, -high);
        if (part->mirror == MIRROR_Z && i == 2)
            low = fmin(low, 2 * part->mirror_at - high);
        field->low[i] = fmin(field->low[i], low);
        field->high[i] = fmax(field->high[i], high);
    }
}

static void add_all(struct figure_field *field, const struct part *parts, size_t count)
{
    for (size_t i = 0; i < count; i++)
        add(field, &parts[i]);
}

// Adds two rows of teeth along a parabola.
static void add_teeth(struct figure_field *field)
{
    for (int row = 0; row < 2; row++)
        for (int i = 0; i < 5; i++) {
            double x = 0.034 + 0.054 * i, z = 0.665 - 2.4 * x * x - 0.02 * row;
            double root = row ? -0.71 : -0.47, tip = row ? -0.645 : -0.575;
            const struct part tooth = {CONE(x, root, z - 0.02, x, tip, z, 0.027, 0.033, 0.012),
                                       .skin = SKIN_TOOTH, TWICE};
            add(field, &tooth);
        }
}

// Adds the body around the spine and the plates on its back.
static void add_spine(struct figure_field *field)
{
    double from[4], to[4];
    spine_at(0, 0, from);
    for (uint32_t i = 1; i <= (SPINE_POINTS - 1) * SPINE_STEPS; i++) {
        uint32_t segment = (i - 1) / SPINE_STEPS;
        spine_at(segment, (double)(i - segment * SPINE_STEPS) / SPINE_STEPS, to);
        const struct part body = {
            CONE(from[0], from[1], from[2], to[0], to[1], to[2], from[3], to[3], 0.03), SCALES};
        add(field, &body);
        memcpy(from, to, sizeof from);
    }
    for (uint32_t i = 2; i < (SPINE_POINTS - 2) * SPINE_STEPS; i++) {
        uint32_t segment = i / SPINE_STEPS;
        double at[4], ahead[4], back[3], up[3], length = 0, height;
        spine_at(segment, (double)(i % SPINE_STEPS) / SPINE_STEPS, at);
        spine_at(segment, (double)(i % SPINE_STEPS) / SPINE_STEPS + 0.1, ahead);
        for (int c = 0; c < 3; c++) {
            back[c] = at[c] - ahead[c];
            length += back[c] * back[c];
        }
        length = sqrt(length);
        // `up` is the y axis without its component along the spine.
        for (int c = 0; c < 3; c++)
            up[c] = (c == 1) - back[1] / length * back[c] / length;
        double size = vec3_norm(up);
        height = 0.05 + 0.35 * at[3];
        struct part plate = {.kind = PART_CONE,
                             .skin = SKIN_HORN,
                             .blend = 0.03,
                             .radii = {0.02 + 0.10 * at[3], 0.006}};
        for (int c = 0; c < 3; c++) {
            plate.a[c] = at[c] + 0.92 * at[3] * up[c] / size;
            plate.b[c] = plate.a[c] + height * (up[c] / size + 0.6 * back[c] / length);
        }
        add(field, &plate);
    }
}

// Adds teeth along the upper and the lower jaw.
static void add_fangs(struct figure_field *field)
{
    for (int i = 0; i < 6; i++) {
        double t = i / 5.0, x = 1.58 + 0.28 * t, z = 0.115 - 0.035 * t;
        const struct part upper = {
            CONE(x, 1.86 - 0.04 * t, z, x + 0.01, 1.79 - 0.05 * t, z, 0.022, 0.005, 0.01),
            .skin = SKIN_TOOTH, SIDES};
        const struct part lower = {CONE(x - 0.03, 1.77 - 0.09 * t, 0.07 - 0.02 * t, x - 0.02,
                                        1.84 - 0.09 * t, 0.075 - 0.02 * t, 0.018, 0.005, 0.01),
                                   .skin = SKIN_TOOTH, SIDES};
        add(field, &upper);
        add(field, &lower);
    }
}

void figure_field_make(enum figure figure, double thinnest, struct figure_field *out)
{
    out->thinnest = thinnest;
    out->count = 0;
    for (int i = 0; i < 3; i++) {
        out->low[i] = INFINITY;
        out->high[i] = -INFINITY;
    }
    switch (figure) {
    case FIGURE_SKULL:
        add_all(out, skull, sizeof skull / sizeof *skull);
        add_teeth(out);
        break;
    case FIGURE_DRAGON:
        add_spine(out);
        add_all(out, dragon, sizeof dragon / sizeof *dragon);
        add_fangs(out);
        break;
    case FIGURE_MONKEY:
        add_all(out, monkey, sizeof monkey / sizeof *monkey);
        break;
    case FIGURE_COUNT:
        break;
    }
}
