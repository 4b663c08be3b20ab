// What library.comp can run: read by C and by GLSL.
#ifndef LAMPYRIS_TESTS_ROUTINES_H
#define LAMPYRIS_TESTS_ROUTINES_H

#define CONSTANT_ROUTINE 7 // after those of shared/bindings.h

#define ROUTINE_COSINE_HEMISPHERE 0u
#define ROUTINE_SPHERE 1u
#define ROUTINE_DISC 2u
#define ROUTINE_TRIANGLE 3u
#define ROUTINE_BASIS 4u
#define ROUTINE_OFFSET 5u
#define ROUTINE_LEAVE_TRIANGLE 6u
#define ROUTINE_DECODE_NORMAL 7u
#define ROUTINE_IS_FINITE 8u
#define ROUTINE_PICK_LIGHT 9u

#endif
