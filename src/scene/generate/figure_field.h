// The fields that define figures: the field of the parts, and the detail on their surfaces.
#ifndef LAMPYRIS_SCENE_GENERATE_FIGURE_FIELD_H
#define LAMPYRIS_SCENE_GENERATE_FIGURE_FIELD_H

#include "scene/generate/figure.h"

enum part_kind {
    PART_CONE,      // from a to b, with spherical ends; one radius for each end
    PART_ELLIPSOID, // centre a, semi-axes b
    PART_WEB        // the triangle a, b, c, thickened by radii[0]
};
enum part_mirror {
    MIRROR_NONE,
    MIRROR_X, // also mirrored at x = 0
    MIRROR_Z  // also mirrored at z = mirror_at
};
enum part_skin { SKIN_BONE, SKIN_TOOTH, SKIN_SCALES, SKIN_HORN, SKIN_WEB, SKIN_FUR, SKIN_PLAIN };

struct part {
    enum part_kind kind;
    enum part_skin skin;
    double a[3], b[3], c[3], radii[2];
    double blend; // distance within which the part joins smoothly with others
    bool carves;  // the part is subtracted
    enum part_mirror mirror;
    double mirror_at;
};

#define PARTS_MAX 400

// The parts in the order in which they are joined, and a box around all of them.
struct figure_field {
    struct part parts[PARTS_MAX];
    double centers[PARTS_MAX][3], reach[PARTS_MAX]; // bounding spheres of the parts
    uint32_t count;
    double low[3], high[3], thinnest;
};

// Makes the field of a figure. Webs are at least twice `thinnest` thick, so that a coarse grid does
// not miss them.
void figure_field_make(enum figure figure, double thinnest, struct figure_field *out);
// Returns the value of the field. It is negative inside, and near the surface it approximates the
// signed distance. *skin becomes the skin of the nearest part, unless `skin` is NULL.
double figure_field_value(const struct figure_field *field, const double p[3],
                          enum part_skin *skin);
// Computes the outward unit normal by differences over `step`.
void figure_field_normal(const struct figure_field *field, const double p[3], double step,
                         double out[3]);
// Returns the displacement of the surface at a point by details that are no finer than `finest`.
double figure_detail(enum part_skin skin, const double p[3], double finest);

#endif
