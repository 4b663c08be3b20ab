// Routines of texture.comp and the contents of its items, for C and GLSL.
#ifndef LAMPYRIS_TESTS_TEXTURE_ITEM_H
#define LAMPYRIS_TESTS_TEXTURE_ITEM_H

#define CONSTANT_ROUTINE CONSTANT_COUNT

// in: texture, -, -, -; uv0, uv1. out: the texel.
#define ROUTINE_SAMPLE 0u
// in: material word, scaled group (1 base, 2 metal, 3 emission), -, -; uv0, uv1; shading normal, -;
// tangent. Vertex colour (0.5, 0.25, 0.125, 0.75). out: base, metal, emission; shading normal, -.
#define ROUTINE_APPLY 1u
// in: material word; shading normal, -; geometric normal, -; towards the viewer, the tangent's
// sign; the tangent is (1, 0, 0). out: tangent, -; bitangent, -; shading normal, -.
#define ROUTINE_FRAME 2u
// in: primitive, barycentrics, crossing; point, material word; pixel, sample, 2 bounce + shadow,
// seed. out: opacity, 1 if there, probability, -.
#define ROUTINE_ALPHA 3u
// in: origin, primitive; direction, distance; barycentrics, -, -. out: uv0, uv1; tangent; colour;
// shading normal, front.
#define ROUTINE_SURFACE 4u

#endif
