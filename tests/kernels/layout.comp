// Declares every record of shared/types.h in a std430 block, for test_layout to read the offsets
// from the compiled module. Never run.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shared/bindings.h"
#include "shared/sdf.h"
#include "shared/types.h"

layout(local_size_x = 1) in;

layout(push_constant) uniform push_block {
    gpu_push push;
};

layout(std140, set = 0, binding = UNIFORM_BINDING_FRAME) uniform frame_block {
    gpu_frame frame;
};

#define BLOCK(name, number)                                                                        \
    layout(std430, set = 0, binding = number) buffer name##_block {                                \
        name name##_items[];                                                                       \
    };

BLOCK(gpu_triangle, 0)
BLOCK(gpu_material_header, 1)
BLOCK(gpu_shape, 2)
BLOCK(gpu_material, 3)
BLOCK(gpu_emitter, 4)
BLOCK(gpu_path, 5)
BLOCK(gpu_shadow_ray, 6)
BLOCK(gpu_film_pixel, 7)
BLOCK(gpu_resolved_pixel, 8)
BLOCK(gpu_dispatch, 9)
BLOCK(gpu_queue, 21)
BLOCK(gpu_counters, 10)
BLOCK(gpu_sort, 22)
BLOCK(gpu_texture, 11)
BLOCK(gpu_medium, 12)
BLOCK(gpu_light, 13)
BLOCK(gpu_sun, 14)
BLOCK(gpu_light_tree, 15)
BLOCK(gpu_light_bounds, 16)
BLOCK(gpu_light_trail, 17)
BLOCK(gpu_lamp, 23)
BLOCK(gpu_instance, 18)
BLOCK(gpu_sdf, 19)
BLOCK(gpu_sdf_instruction, 20)

void main()
{
}
