// The fields that figures are made of: of parts, and of the detail on their surfaces.
#ifndef LAMPYRIS_SCENE_GENERATE_FIGURE_FIELD_H
#define LAMPYRIS_SCENE_GENERATE_FIGURE_FIELD_H

#include "scene/generate/figure.h"

enum part_kind {
    PART_CONE,      // from a to b, with a round end of its radius at both
    PART_ELLIPSOID, // about a, with the semi-axes b
    PART_WEB        // the triangle a, b, c, thickened by radii[0]
};
enum part_mirror {
    MIRROR_NONE,
    MIRROR_X, // also at -x
    MIRROR_Z  // also on the other side of z = mirror_at
};
enum part_skin { SKIN_BONE, SKIN_TOOTH, SKIN_SCALES, SKIN_HORN, SKIN_WEB, SKIN_FUR, SKIN_PLAIN };

struct part {
    enum part_kind kind;
    enum part_skin skin;
    double a[3], b[3], c[3], radii[2];
    double blend; // how far off another part joins smoothly
    bool carves;  // takes away instead
    enum part_mirror mirror;
    double mirror_at;
};

#define PARTS_MAX 400

// The parts in the order in which they join, and a box around all of them.
struct figure_field {
    struct part parts[PARTS_MAX];
    double centers[PARTS_MAX][3], reach[PARTS_MAX]; // spheres around the parts
    uint32_t count;
    double low[3], high[3], thinnest;
};

// Webs are at least twice `thinnest` thick, so that a net of wide meshes holds them.
void figure_field_make(enum figure figure, double thinnest, struct figure_field *out);
// Below 0 inside. Near the surface about the distance. *skin, unless NULL, is that of the nearest
// part.
double figure_field_value(const struct figure_field *field, const double p[3],
                          enum part_skin *skin);
// Towards the outside; of unit length.
void figure_field_normal(const struct figure_field *field, const double p[3], double step,
                         double out[3]);
// How far the surface stands out at a point, by detail no finer than `finest`.
double figure_detail(enum part_skin skin, const double p[3], double finest);

#endif
