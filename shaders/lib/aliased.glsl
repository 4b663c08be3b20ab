// Defines ALIASED, the decoration Aliased of SPIR-V (3.20, number 20). A buffer and its texel view
// are the same memory; without the decoration a compiler may assume that no two variables share
// memory (2.18.2). An invocation never reads through the view what it has written to the buffer,
// because only a later dispatch is certain to see it.
#ifndef ALIASED_GLSL
#define ALIASED_GLSL

#extension GL_EXT_spirv_intrinsics : require
#define ALIASED spirv_decorate(20)

#endif
