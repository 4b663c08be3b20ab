// Signed distance fields on the host: compiles the tree of a description to a program
// (shared/sdf.h). docs/distance-fields.md derives why the program's value is a lower bound of the
// distance.
#ifndef LAMPYRIS_SCENE_SDF_SDF_H
#define LAMPYRIS_SCENE_SDF_SDF_H

#include "json/json_node.h"
#include "scene/core/bounds.h"
#include "scene/core/scene.h"
#include "shared/sdf.h"

// A node of the tree: a shape, or an operation on its children. Before compilation it has the
// operands of struct gpu_sdf_instruction.
struct sdf_node {
    const struct json_node *place; // the node's place in the scene file, for messages
    uint32_t op;                   // SDF_SPHERE … SDF_SHELL, SDF_REPEAT, SDF_TWIST, SDF_MIRROR
    double a[3], b[4];
    struct sdf_node *children; // children of an operation
    double (*balls)[4];        // centres and radii of metaballs
    uint32_t count;            // number of children or of balls
    bool is_placed;            // `to_parent` is not the identity
    double to_parent[3][4];
    double scale; // scale factor of to_parent
};

// The number of cells on each side that stands for infinite repetition. Coordinates cannot resolve
// more cells.
#define SDF_ENDLESS 1e30

// Returns a box in the parent's space that contains all points at which the node's field is at most
// `level` (in the parent's metres; at least 0). The box is infinite where no bound is known.
struct bounds sdf_solid(const struct sdf_node *node, double level);
// Returns whether the field is symmetric about the plane through the origin perpendicular to the
// axis.
bool sdf_is_symmetric(const struct sdf_node *node, int axis);

// Properties that depend on the domain in which the field is evaluated. sdf_spread_domain() also
// sets the factors of twists and metaballs.
struct sdf_spread {
    double magnitude; // maximum |coordinate|, in metres of the root
    double lipschitz; // upper bound of the gradient of all shapes' fields before their factors
    bool grew;        // whether some factor had to be decreased
};
void sdf_spread_domain(struct sdf_node *node, const struct bounds *domain,
                       struct sdf_spread *spread);

// Returns an upper bound of the length of the gradient of the sum of the balls.
double sdf_metaballs_gradient(const double (*balls)[4], uint32_t count);

// Returns the factor, found by experiments, that makes the distance estimates of Mandelbulbs and
// packings lower bounds.
double sdf_fractal_factor(const struct sdf_node *node);

// Compiles a tree. The box of the result is that of the solid, clipped to `clip` unless `clip` is
// NULL; an infinite field needs `clip`. Fails with ERR_INPUT, naming the node that causes the
// error. Memory comes from the arena; the tree is not needed afterwards. Sets the factors in the
// tree.
bool sdf_compile(struct sdf_node *root, const struct bounds *clip, struct arena *arena,
                 struct sdf *out, struct err *err);

// Sets the centre and axes of a shape to the field's box, so that sdf_to_world() is the identity.
void sdf_place(const struct sdf *sdf, struct shape *shape);
// Computes the map from the field's space to the world: a rotation or reflection, a translation and
// a uniform scale.
void sdf_to_world(const struct sdf *sdf, const struct shape *shape, double m[3][4]);

#endif
