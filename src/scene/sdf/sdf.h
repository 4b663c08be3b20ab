// Signed distance fields on the host: from the tree of a description to a program (shared/sdf.h).
// docs/distance-fields.md derives what keeps the program's value below the distance.
#ifndef LAMPYRIS_SCENE_SDF_SDF_H
#define LAMPYRIS_SCENE_SDF_SDF_H

#include "json/json_node.h"
#include "scene/core/bounds.h"
#include "scene/core/scene.h"
#include "shared/sdf.h"

// A shape, or an operation on its children. Numbers are those of struct gpu_sdf_instruction, before
// the compiler's own.
struct sdf_node {
    const struct json_node *place; // of the description, for messages
    uint32_t op;                   // SDF_SPHERE … SDF_SHELL, SDF_REPEAT, SDF_TWIST, SDF_MIRROR
    double a[3], b[4];
    struct sdf_node *children; // of an operation
    double (*balls)[4];        // of metaballs
    uint32_t count;            // of either
    bool is_placed;            // rotated, moved or scaled by
    double to_parent[3][4];
    double scale; // of to_parent
};

#define SDF_ENDLESS 1e30 // cells of a repetition on each side: more than coordinates can tell apart

// Where, in its parent's space, the node's field is at most `level` (in the parent's metres; at
// least 0): a box that contains it, without end where nothing is known to end it.
struct bounds sdf_solid(const struct sdf_node *node, double level);
// Returns whether the field is the same on both sides of the plane through the origin across the
// axis.
bool sdf_is_symmetric(const struct sdf_node *node, int axis);

// What depends on where the field is evaluated: fills in the factors of twists and of metaballs.
struct sdf_spread {
    double magnitude; // largest |coordinate|, in metres of the root
    double lipschitz; // most that some shape's field fell in a metre before its factor
    bool grew;        // some factor had to become smaller than it was
};
void sdf_spread_domain(struct sdf_node *node, const struct bounds *domain,
                       struct sdf_spread *spread);

// An upper bound of the gradient's length of the balls' sum.
double sdf_metaballs_gradient(const double (*balls)[4], uint32_t count);

// What makes Mandelbulbs and packings lower bounds of the distance, found by trials.
double sdf_fractal_factor(const struct sdf_node *node);

// The box is the solid's, cut by `clip` if that is not NULL; a field without end needs one.
// ERR_INPUT at the node whose fault it is. Memory comes from the arena; the tree is not needed any
// more. The tree's factors are filled in.
bool sdf_compile(struct sdf_node *root, const struct bounds *clip, struct arena *arena,
                 struct sdf *out, struct err *err);

// Centre and axes of the shape that is the field in its own space.
void sdf_place(const struct sdf *sdf, struct shape *shape);
// Its own space to the world: rotation or reflection, translation, uniform scale.
void sdf_to_world(const struct sdf *sdf, const struct shape *shape, double m[3][4]);

#endif
