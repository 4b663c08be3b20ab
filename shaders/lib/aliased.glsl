// SPIR-V's decoration Aliased (3.20, number 20): a buffer and its texel view are the same memory,
// and without it a compiler may assume that no two variables are (2.18.2). Nothing is read through
// the view after the same invocation has written it: only a later dispatch sees that for certain.
#ifndef ALIASED_GLSL
#define ALIASED_GLSL

#extension GL_EXT_spirv_intrinsics : require
#define ALIASED spirv_decorate(20)

#endif
