// Defines signed distance fields as programs for a stack machine, for C and GLSL.
//
// The machine has a point p (in metres, in the field's own space), a factor s (distances in the
// space of p times s are distances in the field's space), a stack of saved (p, s), and a stack of
// distances. Fields are negative inside. Each program leaves one distance, which nowhere changes by
// more than 1 per metre (the compiler of programs scales operations that would exceed this), so
// |distance| is a safe step (Hart 1996).
#ifndef LAMPYRIS_SHARED_SDF_H
#define LAMPYRIS_SHARED_SDF_H

#include "types.h"

#define SDF_POINTS_MAX 8    // maximum number of saved points
#define SDF_DISTANCES_MAX 8 // maximum number of distances on the stack
#define SDF_CODE_MAX 1024   // maximum number of instructions of a program

// The record of a shape that is a field; other[0] of its gpu_shape has the record's index. Shapes
// may share a program.
struct gpu_sdf {
    float to_object[3][4]; // world to the field's space: a rotation or reflection with a uniform
                           // scale; the last column is the field's origin in the world, which is
                           // subtracted first
    float min[3];          // box of the field in its own space; the field is empty outside
    uint first;            // first instruction
    float max[3];
    uint count;      // number of instructions
    float scale;     // world lengths per metre of the field
    float lipschitz; // maximum change of the program's distance per metre
    float magnitude; // largest |coordinate| in the program's arithmetic for points in the box, in
                     // metres of the field (coordinates in each space times its s); bounds rounding
                     // errors
    uint align_sdf;
};
SHARED_STATIC_ASSERT_SIZE(gpu_sdf, 96);
#define SDF_WORDS 6

// Four uvec4 words: op and a; b; c; d. `op` has the operation in bits 0-7, a count in 8-31.
struct gpu_sdf_instruction {
    uint op;
    float a[3];
    float b[4], c[4], d[4];
};
SHARED_STATIC_ASSERT_SIZE(gpu_sdf_instruction, 64);
#define SDF_INSTRUCTION_WORDS 4

// Operations; bit n of SDF_* constants stands for operation n. Shapes push s times their distance.
#define SDF_SPHERE 0u  // a.x: radius
#define SDF_BOX 1u     // a: half edges; b.x: radius of the rounded edges, inside the box
#define SDF_FRAME 2u   // bars along the edges of a box; a: half edges; b.x: half of a bar's width
#define SDF_TORUS 3u   // about y; a.x: radius of the ring, a.y: of the tube
#define SDF_CAPSULE 4u // from a to b.xyz; b.w: radius
#define SDF_CONE 5u    // along y, flat ends; a.x: radius below, a.y: above, a.z: half the height
// Sector of a ball about +y; a.x: radius; b.x, b.y: sine and cosine of the angle, up to pi, between
// +y and the sector's side.
#define SDF_SOLID_ANGLE 6u
#define SDF_CYLINDER 7u // along y; a.x: radius, a.y: half the height, a.z: radius of rounded edges
#define SDF_PLANE 8u    // half-space below a plane; a: unit normal; b.x: height along the normal
// A sheet; a.x: k, in radians per metre; a.y: half its thickness in metres. (|sin kx cos ky + sin
// ky cos kz + sin kz cos kx|) / (k b.x) - a.y, where b.x bounds the gradient in units of k.
#define SDF_GYROID 9u
// Metaballs (Wyvill, McPheeters and Wyvill 1986): `count` balls in the following instructions, four
// in each (op, a; b; c; d: centre, radius of influence R). (a.x - sum of (1 - d^2 / R^2)^3 over the
// balls with d < R) a.y, where 1 / a.y bounds the sum's gradient. Beyond all radii of influence,
// the distance to the nearest ball is added.
#define SDF_METABALLS 10u
#define SDF_BALL_INSTRUCTIONS(balls) (((balls) + 3u) / 4u)
// z -> z^power + p (White and Nylander 2009) with the pole along y: b.x log|z| |z| / (2 |dz|),
// where |dz| is the largest stretch of the map; the surface is where |z| finally is 1 (Hart, Sandin
// and Kauffman 1989).
#define SDF_MANDELBULB 11u // a.x: power, a.y: iterations, a.z: bailout radius; b.x: factor
#define SDF_MENGER 12u     // a.x: half the edge, a.y: iterations
// A packing in a cell of edge 2, which is repeated; a.x: scale of the inversion, a.y: iterations;
// b.x: factor. The distance is never negative: the surface is a sheet without thickness, which
// SDF_ROUND thickens.
#define SDF_APOLLONIAN 13u
// Sierpinski's tetrahedra; a.x: half the size, a.y: iterations. The corners are (1, 1, 1), (1, -1,
// -1), (-1, 1, -1), (-1, -1, 1) times a.x.
#define SDF_PYRAMID 14u
// The following operations pop two distances, y and then x, and push one. s a.x is the width w of a
// smooth joint, min(x, y) - h^2 w / 4 with h = max(w - |x - y|, 0) / w (Quilez 2013); 0: no smooth
// joint.
#define SDF_UNION 15u
#define SDF_INTERSECTION 16u
#define SDF_DIFFERENCE 17u // x without y
// The following operations change the last distance.
#define SDF_ROUND 18u  // subtracts s a.x
#define SDF_SHELL 19u  // takes the absolute value, then subtracts s a.x
#define SDF_FACTOR 20u // multiplies by a.x, in (0, 1]
// The following operations save (p, s) and replace it, except SDF_RESTORE.
#define SDF_TRANSFORM 21u // p' = rows b, c, d of (p, 1); s' = a.x s
#define SDF_REPEAT 22u    // along axes whose a is not 0: p' = p - a clamp(round(p / a), -b, b)
#define SDF_TWIST 23u     // about y by a.x radians per metre of height, x towards z; s' = a.y s
#define SDF_MIRROR 24u    // p' = |p| along axes whose a is not 0
#define SDF_RESTORE 25u   // restores the last saved (p, s)
#define SDF_OPERATIONS 26u
#define SDF_BIT(op) (1u << (op))

#endif
