#include "render/kernels.h"

#include "base/hash.h"

#include "accumulate.spv.h"
#include "accumulate_plain.spv.h"
#include "add_splats.spv.h"
#include "add_splats_plain.spv.h"
#include "generate_light_rays.spv.h"
#include "generate_light_rays_plain.spv.h"
#include "generate_rays.spv.h"
#include "generate_rays_plain.spv.h"
#include "intersect_camera.spv.h"
#include "intersect_camera_plain.spv.h"
#include "intersect_closest.spv.h"
#include "intersect_closest_plain.spv.h"
#include "intersect_shadow.spv.h"
#include "intersect_shadow_plain.spv.h"
#include "prepare_dispatch.spv.h"
#include "prepare_dispatch_plain.spv.h"
#include "resolve.spv.h"
#include "resolve_plain.spv.h"
#include "shade_ao.spv.h"
#include "shade_ao_plain.spv.h"
#include "shade_light.spv.h"
#include "shade_light_plain.spv.h"
#include "shade_miss.spv.h"
#include "shade_miss_plain.spv.h"
#include "shade_surface.spv.h"
#include "shade_surface_plain.spv.h"
#include "shade_whitted.spv.h"
#include "shade_whitted_plain.spv.h"
#include "sort_count.spv.h"
#include "sort_count_plain.spv.h"
#include "sort_scan.spv.h"
#include "sort_scan_plain.spv.h"
#include "sort_scatter.spv.h"
#include "sort_scatter_plain.spv.h"

#define shade_diffuse_spirv shade_surface_spirv
#define shade_diffuse_plain_spirv shade_surface_plain_spirv
#define shade_principled_spirv shade_surface_spirv
#define shade_principled_plain_spirv shade_surface_plain_spirv
#define shade_transmissive_spirv shade_surface_spirv
#define shade_transmissive_plain_spirv shade_surface_plain_spirv
#define shade_classical_spirv shade_surface_spirv
#define shade_classical_plain_spirv shade_surface_plain_spirv

struct kernel_code kernel_code(enum kernel_id id, bool ballot)
{
    static const struct kernel_code codes[KERNEL_COUNT][2] = {
#define X(name)                                                                                    \
    [KERNEL_##name] = {{#name, name##_plain_spirv, sizeof name##_plain_spirv},                     \
                       {#name, name##_spirv, sizeof name##_spirv}},
        KERNEL_LIST(X)
#undef X
    };
    return codes[id][ballot];
}

uint64_t kernels_hash(void)
{
    uint64_t hash = HASH_INIT;
    for (int id = 0; id < KERNEL_COUNT; id++)
        for (int ballot = 0; ballot < 2; ballot++) {
            struct kernel_code code = kernel_code((enum kernel_id)id, ballot);
            struct hash128 own = hash128_bytes(code.spirv, code.bytes);
            hash = hash_bytes(hash, &own, sizeof own);
        }
    return hash;
}
