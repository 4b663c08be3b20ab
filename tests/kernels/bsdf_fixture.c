#include "bsdf_fixture.h"

#include "check_bsdf.spv.h"

// The number of paths in flight, and so of items that run at the same time.
#define SLOTS (1u << 17)

_Static_assert(sizeof(union bsdf_item) == sizeof(struct gpu_path), "they share a buffer");

static bool create_kernel(struct renderer *r, uint32_t routine, uint32_t lobes,
                          struct gpu_kernel *kernel, struct err *err)
{
    uint32_t constants[CONSTANT_CHECK_ROUTINE + 1];
    memcpy(constants, &r->specialization, 4 * CONSTANT_COUNT);
    constants[CONSTANT_FEATURES] &= ~FEATURE_TEXEL_STATE; // the test writes to buffers that the
                                                          // kernel reads
    constants[CONSTANT_LOBES] = lobes;
    constants[CONSTANT_CHECK_ROUTINE] = routine;
    const struct gpu_kernel_params params = {
        .name = "bsdf",
        .spirv = check_bsdf_spirv,
        .spirv_bytes = sizeof check_bsdf_spirv,
        .constants = constants,
        .constant_count = CONSTANT_CHECK_ROUTINE + 1,
    };
    return gpu_kernel_create(r->gpu, &params, kernel, err);
}

static void open_setup(struct bsdf_device *device)
{
    OPEN_SETUP(&device->setup, SLOTS);
}

bool bsdf_device_open(struct bsdf_device *device, const struct material *materials, uint32_t count)
{
    return bsdf_device_open_with(device, materials, count, (struct bsdf_choices){0});
}

bool bsdf_device_open_with(struct bsdf_device *device, const struct material *materials,
                           uint32_t count, struct bsdf_choices choices)
{
    struct scene *scene = &device->setup.scene;
    *device = (struct bsdf_device){0};
    scene_start(scene, 8, 8);
    scene->settings.normals = choices.normals;
    scene->settings.radiance_scaling = !choices.unscaled;
    for (uint32_t i = 0; i < count; i++)
        add_sphere(scene, (double[3]){3.0 * i, 0, -3}, 1, add_material(scene, &materials[i]));
    open_setup(device);
    struct renderer *r = &device->setup.r;
    if (!r->gpu)
        return false;
    const struct specialize_params params = {.scene = scene,
                                             .flat = &r->flat,
                                             .bvh = &r->bvh,
                                             .gpu = r->gpu,
                                             .camera = &scene->cameras[0],
                                             .compile_all = true};
    device->all_lobes = specialize(&params).lobes;
    return true;
}

void bsdf_device_close(struct bsdf_device *device)
{
    for (int lobes = 0; lobes < BSDF_LOBES_CHOICES; lobes++)
        for (uint32_t class = 0; class < CLASS_COUNT; class ++)
            for (int routine = 0; routine < BSDF_ROUTINES; routine++)
                gpu_kernel_finish(&device->setup.gpu, &device->kernels[lobes][class][routine]);
    setup_close(&device->setup);
}

static bool run_part(struct renderer *r, const struct gpu_kernel *kernel, union bsdf_item *items,
                     uint32_t count, struct err *err)
{
    struct gpu_buffer *buffer = &r->buffers[BINDING_PATHS];
    r->push.first_item = 0;
    r->push.part_items = count;
    return gpu_upload(r->gpu, buffer, 0, items, count * sizeof *items, err) &&
           run_kernel(r, kernel, count, err) &&
           gpu_download(r->gpu, buffer, 0, items, count * sizeof *items, err);
}

static bool run_all(struct renderer *r, const struct gpu_kernel *kernel, union bsdf_item *items,
                    uint32_t count, struct err *err)
{
    bool ok = true;
    for (uint32_t first = 0; first < count && ok; first += r->plan.wave_slots) {
        uint32_t left = count - first;
        uint32_t part = left < r->plan.wave_slots ? left : r->plan.wave_slots;
        ok = run_part(r, kernel, items + first, part, err);
    }
    return ok;
}

bool bsdf_run(struct bsdf_device *device, uint32_t routine, int lobes,
              const struct material *material, union bsdf_item *items, uint32_t count)
{
    struct renderer *r = &device->setup.r;
    struct err err = {0};
    uint32_t class = material_class(material);
    struct gpu_kernel *kernel = &device->kernels[lobes][class][routine];
    uint32_t set =
        lobes == BSDF_LOBES_ALL ? device->all_lobes : r->specialization.class_lobes[class];
    bool ok = kernel->pipeline || create_kernel(r, routine, set, kernel, &err);
    ok = ok && run_all(r, kernel, items, count, &err);
    CHECK(ok, "%s", err.msg);
    return ok;
}
