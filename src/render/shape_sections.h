// Computes the offsets of the sections in the buffer of shapes, instances, distance fields and
// small triangles.
#ifndef LAMPYRIS_RENDER_SHAPE_SECTIONS_H
#define LAMPYRIS_RENDER_SHAPE_SECTIONS_H

#include "flatten/flatten.h"

// The offsets of the sections, and the length `words` of the buffer, in uvec4 words.
struct shape_sections {
    uint32_t instances, sdfs, sdf_code, small_triangles;
    uint64_t words;
};
struct shape_sections shape_sections(const struct scene *scene, const struct flat_scene *flat);

#endif
