// Tests that C and GLSL agree on every record of shared/types.h: names, offsets, sizes and types of
// members, and strides of arrays, as the GLSL compiler has laid them out in SPIR-V.
#include "render/kernels.h"
#include "shared/sdf.h"
#include "shared/types.h"
#include "spirv_layout.h"
#include "test.h"

#include "layout_test.spv.h"

#define TRIANGLE(M) M(v0) M(id) M(v1) M(material) M(v2) M(emitter)
#define HEADER(M)                                                                                  \
    M(textures) M(lights) M(media) M(albedos) M(camera_media) M(camera_ior) M(suns) M(sun_count)
#define TEXTURE(M) M(texels) M(size) M(flags) M(align_texture) M(transform)
#define MEDIUM(M) M(extinction) M(ior) M(priority) M(dispersion) M(align_medium)
#define LIGHT(M)                                                                                   \
    M(position)                                                                                    \
    M(kind)                                                                                        \
    M(direction)                                                                                   \
    M(pick_probability)                                                                            \
    M(radiant)                                                                                     \
    M(inverse_range) M(spot_scale) M(spot_offset) M(reach) M(versine) M(profile_x) M(profile)
#define SUN(M) M(direction) M(versine) M(radiance) M(pick_probability)
#define SHAPE(M) M(center) M(radius) M(axis) M(kind_material) M(emitter) M(other)
#define INSTANCE(M) M(to_object) M(to_world) M(root) M(material) M(id) M(flags)
#define SDF_RECORD(M)                                                                              \
    M(to_object) M(min) M(first) M(max) M(count) M(scale) M(lipschitz) M(magnitude) M(align_sdf)
#define SDF_INSTRUCTION(M) M(op) M(a) M(b) M(c) M(d)
#define MATERIAL(M) M(model_flags) M(first_texture) M(texture_count) M(medium) M(parameter)
#define EMITTER(M) M(threshold) M(primitive) M(alias_primitive) M(align_emitter)
#define LIGHT_TREE(M)                                                                              \
    M(root) M(trails) M(infinite) M(infinite_count) M(infinite_share) M(lamps) M(align_tree)
#define LIGHT_BOUNDS(M) M(center) M(radius) M(axis) M(cosines) M(power) M(child)
#define LIGHT_TRAIL(M) M(low) M(high) M(depth) M(lamp)
#define LAMP(M) M(child) M(depth) M(align_lamp)
#define PATH(M)                                                                                    \
    M(origin)                                                                                      \
    M(ignore) M(direction) M(bsdf_pdf) M(throughput) M(media) M(t) M(u) M(v) M(primitive)
#define SHADOW_RAY(M) M(origin) M(ignore_from) M(direction) M(ignore_to) M(radiance) M(light_pdf)
#define FILM_PIXEL(M) M(samples) M(dropped) M(digits_a) M(digits_b) M(sums_a) M(sums_b)
#define RESOLVED_PIXEL(M) M(mean_a) M(samples) M(mean_b) M(dropped)
#define DISPATCH(M) M(x) M(y) M(z) M(items)
#define QUEUE(M) M(count) M(align_queue)
#define COUNTERS(M)                                                                                \
    M(queue)                                                                                       \
    M(surface_hits)                                                                                \
    M(media_lost)                                                                                  \
    M(clamped)                                                                                     \
    M(clamped_light)                                                                               \
    M(closest_rays)                                                                                \
    M(shadow_rays)                                                                                 \
    M(steps)                                                                                       \
    M(unfinished)                                                                                  \
    M(suspended)                                                                                   \
    M(nonfinite)                                                                                   \
    M(nonfinite_records) M(sparse) M(branches) M(dispatch) M(nonfinite_record) M(align_counters)
#define FRAME(M)                                                                                   \
    M(camera_position)                                                                             \
    M(width)                                                                                       \
    M(camera_forward)                                                                              \
    M(height)                                                                                      \
    M(camera_right)                                                                                \
    M(seed)                                                                                        \
    M(camera_up)                                                                                   \
    M(max_bounces)                                                                                 \
    M(environment)                                                                                 \
    M(environment_size)                                                                            \
    M(environment_cos)                                                                             \
    M(environment_sin)                                                                             \
    M(environment_pick)                                                                            \
    M(emitter_count)                                                                               \
    M(wave_slots)                                                                                  \
    M(samples)                                                                                     \
    M(nee_depth)                                                                                   \
    M(clamp_limit)                                                                                 \
    M(roulette_min_bounces)                                                                        \
    M(roulette_max_bounces)                                                                        \
    M(roulette_survival)                                                                           \
    M(direction_exponent)                                                                          \
    M(lens_radius)                                                                                 \
    M(focus_distance)                                                                              \
    M(lens_rotation)                                                                               \
    M(lens_blades)                                                                                 \
    M(filter_radius)                                                                               \
    M(ao_distance)                                                                                 \
    M(metre)                                                                                       \
    M(environment_reach)                                                                           \
    M(ambient)                                                                                     \
    M(pending_rays)                                                                                \
    M(instances) M(sdfs) M(sdf_code) M(camera_start) M(lens_at_start) M(small_triangles)           \
        M(pixel_strata) M(mis_exponent) M(min_density) M(split_lobes) M(environment_floor)         \
            M(picture_width) M(cells_begin) M(picture_height) M(cells_a_length) M(window_first)    \
                M(scene_center) M(scene_radius)
#define SORT(M) M(count) M(place)
#define PUSH(M)                                                                                    \
    M(bounce)                                                                                      \
    M(first_pixel)                                                                                 \
    M(pixel_count)                                                                                 \
    M(first_sample)                                                                                \
    M(sample_shift)                                                                                \
    M(queue) M(first_item) M(part_items) M(film_first_pixel) M(light_ray) M(align_push)

#define RECORDS(R)                                                                                 \
    R(gpu_triangle, TRIANGLE)                                                                      \
    R(gpu_material_header, HEADER)                                                                 \
    R(gpu_texture, TEXTURE)                                                                        \
    R(gpu_medium, MEDIUM)                                                                          \
    R(gpu_light, LIGHT)                                                                            \
    R(gpu_sun, SUN)                                                                                \
    R(gpu_shape, SHAPE)                                                                            \
    R(gpu_instance, INSTANCE)                                                                      \
    R(gpu_sdf, SDF_RECORD)                                                                         \
    R(gpu_sdf_instruction, SDF_INSTRUCTION)                                                        \
    R(gpu_material, MATERIAL)                                                                      \
    R(gpu_emitter, EMITTER)                                                                        \
    R(gpu_light_tree, LIGHT_TREE)                                                                  \
    R(gpu_light_bounds, LIGHT_BOUNDS)                                                              \
    R(gpu_light_trail, LIGHT_TRAIL)                                                                \
    R(gpu_lamp, LAMP)                                                                              \
    R(gpu_path, PATH)                                                                              \
    R(gpu_shadow_ray, SHADOW_RAY)                                                                  \
    R(gpu_film_pixel, FILM_PIXEL)                                                                  \
    R(gpu_resolved_pixel, RESOLVED_PIXEL)                                                          \
    R(gpu_dispatch, DISPATCH)                                                                      \
    R(gpu_queue, QUEUE)                                                                            \
    R(gpu_counters, COUNTERS)                                                                      \
    R(gpu_sort, SORT)                                                                              \
    R(gpu_frame, FRAME)                                                                            \
    R(gpu_push, PUSH)

struct member {
    const char *name;
    size_t offset, bytes;
    enum spirv_kind kind;
};

struct record {
    const char *name;
    size_t bytes;
    struct member members[SPIRV_MAX_MEMBERS];
};

// Arrays are converted to pointers.
#define KIND(value)                                                                                \
    _Generic((value), float: SPIRV_FLOAT, float *: SPIRV_FLOAT, uint: SPIRV_UINT,                  \
             float(*)[4]: SPIRV_FLOAT, uint(*)[2]: SPIRV_UINT, uint *: SPIRV_UINT, struct gpu_queue *: SPIRV_STRUCT, struct gpu_dispatch *: SPIRV_STRUCT)
#define MEMBER_OF(type, member)                                                                    \
    {#member, offsetof(type, member), sizeof((type *)0)->member, KIND(((type *)0)->member)},

#define M_gpu_triangle(m) MEMBER_OF(struct gpu_triangle, m)
#define M_gpu_material_header(m) MEMBER_OF(struct gpu_material_header, m)
#define M_gpu_texture(m) MEMBER_OF(struct gpu_texture, m)
#define M_gpu_medium(m) MEMBER_OF(struct gpu_medium, m)
#define M_gpu_light(m) MEMBER_OF(struct gpu_light, m)
#define M_gpu_sun(m) MEMBER_OF(struct gpu_sun, m)
#define M_gpu_shape(m) MEMBER_OF(struct gpu_shape, m)
#define M_gpu_instance(m) MEMBER_OF(struct gpu_instance, m)
#define M_gpu_sdf(m) MEMBER_OF(struct gpu_sdf, m)
#define M_gpu_sdf_instruction(m) MEMBER_OF(struct gpu_sdf_instruction, m)
#define M_gpu_material(m) MEMBER_OF(struct gpu_material, m)
#define M_gpu_emitter(m) MEMBER_OF(struct gpu_emitter, m)
#define M_gpu_light_tree(m) MEMBER_OF(struct gpu_light_tree, m)
#define M_gpu_light_bounds(m) MEMBER_OF(struct gpu_light_bounds, m)
#define M_gpu_light_trail(m) MEMBER_OF(struct gpu_light_trail, m)
#define M_gpu_lamp(m) MEMBER_OF(struct gpu_lamp, m)
#define M_gpu_path(m) MEMBER_OF(struct gpu_path, m)
#define M_gpu_shadow_ray(m) MEMBER_OF(struct gpu_shadow_ray, m)
#define M_gpu_film_pixel(m) MEMBER_OF(struct gpu_film_pixel, m)
#define M_gpu_resolved_pixel(m) MEMBER_OF(struct gpu_resolved_pixel, m)
#define M_gpu_dispatch(m) MEMBER_OF(struct gpu_dispatch, m)
#define M_gpu_queue(m) MEMBER_OF(struct gpu_queue, m)
#define M_gpu_counters(m) MEMBER_OF(struct gpu_counters, m)
#define M_gpu_sort(m) MEMBER_OF(struct gpu_sort, m)
#define M_gpu_frame(m) MEMBER_OF(struct gpu_frame, m)
#define M_gpu_push(m) MEMBER_OF(struct gpu_push, m)
#define RECORD_OF(name, members) {#name, sizeof(struct name), {members(M_##name)}},

static const struct record records[] = {RECORDS(RECORD_OF)};
enum { RECORD_COUNT = sizeof records / sizeof records[0] };

static const struct member *find_member(const struct record *record, const char *name)
{
    for (int i = 0; i < SPIRV_MAX_MEMBERS && record->members[i].name; i++)
        if (strcmp(record->members[i].name, name) == 0)
            return &record->members[i];
    return NULL;
}

static uint32_t member_count(const struct record *record)
{
    uint32_t count = 0;
    while (count < SPIRV_MAX_MEMBERS && record->members[count].name)
        count++;
    return count;
}

static void check_members(const char *module, const struct spirv_layout *layout,
                          const struct spirv_id *id, const struct record *record)
{
    CHECK(id->member_count == member_count(record), "%s: %s has %u members in GLSL, %u in the test",
          module, record->name, id->member_count, member_count(record));
    for (uint32_t i = 0; i < id->member_count; i++) {
        const struct spirv_member *glsl = &id->member[i];
        const struct member *c = find_member(record, glsl->name);
        REQUIRE(c, "%s: %s.%s is not in the test", module, record->name, glsl->name);
        CHECK(glsl->offset == c->offset, "%s: %s.%s is at %u in GLSL, at %zu in C", module,
              record->name, glsl->name, glsl->offset, c->offset);
        uint32_t bytes = spirv_type_bytes(layout, glsl->type);
        CHECK(bytes == c->bytes, "%s: %s.%s has %u bytes in GLSL, %zu in C", module, record->name,
              glsl->name, bytes, c->bytes);
        CHECK(spirv_type_kind(layout, glsl->type) == c->kind, "%s: %s.%s: other type", module,
              record->name, glsl->name);
    }
}

// The slot indices follow the counters in the same buffer.
static void check_queues(const char *module, const struct spirv_id *block)
{
    const struct spirv_member *slots = &block->member[block->member_count - 1];
    CHECK(strcmp(slots->name, "queue_slots") == 0 && slots->offset == QUEUES_OFFSET,
          "%s: %s is at %u in GLSL, at %zu in C", module, slots->name, slots->offset,
          QUEUES_OFFSET);
}

// Compares each structure of the module that is one of the records and has a memory layout (copies
// in registers have no offsets). Returns the records that were found, as bits. *strides are those
// of which there is an array.
static uint32_t check_module(const char *module, const uint32_t *words, size_t bytes,
                             uint32_t *strides)
{
    struct spirv_layout layout;
    uint32_t seen = 0;
    *strides = 0;
    bool ok = spirv_layout_read(words, bytes, &layout);
    CHECK(ok, "%s cannot be read", module);
    for (uint32_t i = 0; ok && i < layout.bound; i++) {
        const struct spirv_id *id = &layout.ids[i];
        const struct spirv_id *element = &layout.ids[id->element];
        if (id->member_count && id->name && strcmp(id->name, "queues_block") == 0)
            check_queues(module, id);
        for (int r = 0; r < RECORD_COUNT; r++) {
            if (id->member_count && id->name && strcmp(id->name, records[r].name) == 0 &&
                id->member[0].offset != UINT32_MAX) {
                check_members(module, &layout, id, &records[r]);
                seen |= 1u << r;
            }
            if (id->stride && element->name && strcmp(element->name, records[r].name) == 0) {
                CHECK(id->stride == records[r].bytes, "%s: %s: stride %u in GLSL, %zu bytes in C",
                      module, records[r].name, id->stride, records[r].bytes);
                *strides |= 1u << r;
            }
        }
    }
    spirv_layout_finish(&layout);
    return seen;
}

TEST(every_record)
{
    uint32_t strides, all = (1u << RECORD_COUNT) - 1;
    uint32_t seen = check_module("layout.comp", layout_spirv, sizeof layout_spirv, &strides);
    CHECK(seen == all, "seen 0x%x of 0x%x", seen, all);
    CHECK(strides == all >> 2, "arrays of 0x%x of 0x%x", strides,
          all >> 2); // the frame and the push constants have no array
}

// Also checks the renderer's kernels: all have the push constants, and most have the counters.
TEST(embedded_kernels)
{
    for (int id = 0; id < KERNEL_COUNT; id++) {
        for (int ballot = 0; ballot < 2; ballot++) {
            uint32_t strides;
            struct kernel_code code = kernel_code((enum kernel_id)id, ballot);
            uint32_t seen = check_module(code.name, code.spirv, code.bytes, &strides);
            CHECK(seen >> (RECORD_COUNT - 1) & 1u, "%s: no push block", code.name);
        }
    }
}

// Kernels address these records by words of 16 bytes.
TEST(words_a_record)
{
    CHECK(sizeof(struct gpu_path) == 16 * PATH_WORDS_OF(0u, INTEGRATOR_PATH), "%zu",
          sizeof(struct gpu_path));
    CHECK(offsetof(struct gpu_path, origin) == 16 * PATH_ORIGIN, "origin");
    CHECK(offsetof(struct gpu_path, direction) == 16 * PATH_DIRECTION, "direction");
    CHECK(offsetof(struct gpu_path, throughput) == 16 * PATH_THROUGHPUT, "throughput");
    CHECK(offsetof(struct gpu_path, t) == 16 * PATH_HIT, "hit");
    CHECK(sizeof(struct gpu_shadow_ray) == 16 * SHADOW_WORDS_OF(0u), "%zu",
          sizeof(struct gpu_shadow_ray));
    CHECK(sizeof(struct gpu_film_pixel) == 16 * FILM_WORDS, "%zu", sizeof(struct gpu_film_pixel));
}

TEST_MAIN(TEST_CASE(every_record), TEST_CASE(embedded_kernels), TEST_CASE(words_a_record))
