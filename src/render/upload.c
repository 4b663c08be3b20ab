#include "upload.h"

#include "alias_table.h"
#include "shared/types.h"
#include <math.h>
#include <string.h>

uint32_t encode_normal(const float n[3])
{
    // Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors",
    // listing 1.
    float norm = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]);
    float x = n[0] / norm, y = n[1] / norm;
    if (n[2] < 0.0f) {
        float folded = copysignf(1.0f - fabsf(y), x);
        y = copysignf(1.0f - fabsf(x), y);
        x = folded;
    }
    uint32_t high = (uint16_t)(int16_t)lrintf(y * 32767.0f);
    return high << 16 | (uint16_t)(int16_t)lrintf(x * 32767.0f);
}

// The cross product of the edges; returns the area, half its length.
static double triangle_normal(const struct flat_triangle *triangle, double n[3])
{
    double e[2][3];
    for (int c = 0; c < 3; c++) {
        e[0][c] = (double)triangle->v[1][c] - triangle->v[0][c];
        e[1][c] = (double)triangle->v[2][c] - triangle->v[0][c];
    }
    for (int c = 0; c < 3; c++)
        n[c] = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

// A buffer without records still holds one, zeroed: kernels that are compiled with a feature which
// the scene lacks may read it and multiply it away.
#define SMALLEST_BUFFER 64

static bool create(struct gpu *gpu, const struct upload_params *p, uint32_t binding,
                   struct gpu_buffer *buffers, struct err *err)
{
    uint64_t bytes = p->plan->buffers[binding].bytes;
    if (bytes < SMALLEST_BUFFER)
        bytes = SMALLEST_BUFFER;
    bool texel = p->specialization->features & FEATURE_TEXEL_SCENE;
    return gpu_buffer_create(gpu, binding_name(binding), bytes, GPU_DEVICE, texel,
                             &buffers[binding], err);
}

// Creates a buffer and uploads as many bytes as are planned for it.
static bool create_filled(struct gpu *gpu, const struct upload_params *p, uint32_t binding,
                          const void *data, struct gpu_buffer *buffers, struct err *err)
{
    uint64_t bytes = p->plan->buffers[binding].bytes;
    return create(gpu, p, binding, buffers, err) &&
           (bytes == 0 || gpu_upload(gpu, &buffers[binding], 0, data, bytes, err));
}

static bool upload_triangles(struct gpu *gpu, const struct upload_params *p,
                             struct gpu_buffer *buffers, struct arena *scratch, struct err *err)
{
    uint32_t count = p->flat->triangle_count;
    struct gpu_triangle *records = ARENA_NEW(scratch, struct gpu_triangle, count);
    if (!records)
        return err_memory(err, "triangles", (uint64_t)count * sizeof *records);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t id = p->bvh->triangle_order[i];
        const struct flat_triangle *triangle = &p->flat->triangles[id];
        memcpy(records[i].v0, triangle->v[0], sizeof records[i].v0);
        memcpy(records[i].v1, triangle->v[1], sizeof records[i].v1);
        memcpy(records[i].v2, triangle->v[2], sizeof records[i].v2);
        records[i].id = id;
        records[i].material = triangle->material;
    }
    return create_filled(gpu, p, BINDING_TRIANGLES, records, buffers, err);
}

// The largest error of a decoded normal's component: 16 bits octahedrally.
#define NORMAL_RESOLUTION 6.52e-5

// Whether the shading normals say no more than the geometric one, as far as their code can tell:
// that one is exact then.
static bool is_flat(const struct flat_triangle *triangle, const float normals[3][3])
{
    double n[3];
    double length = 2.0 * triangle_normal(triangle, n);
    for (int corner = 0; corner < 3; corner++)
        for (int c = 0; c < 3; c++)
            if (!(fabs(normals[corner][c] - n[c] / length) <= NORMAL_RESOLUTION))
                return false;
    return true;
}

static bool upload_normals(struct gpu *gpu, const struct upload_params *p,
                           struct gpu_buffer *buffers, struct arena *scratch, struct err *err)
{
    uint32_t count = p->flat->triangle_count;
    struct gpu_normals *records = ARENA_NEW(scratch, struct gpu_normals, count);
    if (!records)
        return err_memory(err, "normals", (uint64_t)count * sizeof *records);
    for (uint32_t i = 0; i < count; i++) {
        records[i].n0 = NORMAL_FLAT;
        if (!p->flat->normals)
            continue;
        uint32_t id = p->bvh->triangle_order[i];
        const float(*normals)[3] = p->flat->normals[id];
        if (is_flat(&p->flat->triangles[id], normals))
            continue;
        records[i] = (struct gpu_normals){.n0 = encode_normal(normals[0]),
                                          .n1 = encode_normal(normals[1]),
                                          .n2 = encode_normal(normals[2])};
    }
    return create_filled(gpu, p, BINDING_NORMALS, records, buffers, err);
}

static bool upload_shapes(struct gpu *gpu, const struct upload_params *p,
                          struct gpu_buffer *buffers, struct arena *scratch, struct err *err)
{
    uint32_t count = p->flat->shape_count;
    struct gpu_shape *records = ARENA_NEW(scratch, struct gpu_shape, count);
    if (!records)
        return err_memory(err, "shapes", (uint64_t)count * sizeof *records);
    for (uint32_t i = 0; i < count; i++) {
        const struct flat_shape *shape = &p->flat->shapes[i];
        uint32_t kind = shape->kind == SHAPE_SPHERE ? SHAPE_KIND_SPHERE : SHAPE_KIND_DISC;
        memcpy(records[i].center, shape->center, sizeof records[i].center);
        memcpy(records[i].normal, shape->normal, sizeof records[i].normal);
        records[i].radius = shape->radius;
        records[i].kind_material = kind << SHAPE_KIND_SHIFT | shape->material;
    }
    return create_filled(gpu, p, BINDING_SHAPES, records, buffers, err);
}

// --- emitters -----------------------------------------------------------------------------------

static double luminance(const float rgb[3])
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; // ITU-R BT.709
}

static double shape_area(const struct flat_shape *shape)
{
    double disc = M_PI * shape->radius * shape->radius;
    return shape->kind == SHAPE_SPHERE ? 4.0 * disc : disc;
}

struct emitter_list {
    uint32_t *primitives;
    double *powers; // luminance times area: what a diffuse emitter sends, but for a constant
    uint32_t count;
    double total;
};

static void add_emitter(struct emitter_list *list, uint32_t primitive, double power)
{
    list->primitives[list->count] = primitive;
    list->powers[list->count++] = power;
    list->total += power;
}

// Every primitive with emission, those of zero area too: they get no weight.
static bool list_emitters(const struct upload_params *p, struct arena *scratch,
                          struct emitter_list *list, struct err *err)
{
    struct emitter_counts counts = emitters_count(p->scene, p->flat);
    uint64_t count = (uint64_t)counts.triangles + counts.spheres + counts.discs;
    *list = (struct emitter_list){.primitives = ARENA_NEW(scratch, uint32_t, count),
                                  .powers = ARENA_NEW(scratch, double, count)};
    if (!list->primitives || !list->powers)
        return err_memory(err, "emitters", count * 12);
    for (uint32_t i = 0; i < p->flat->triangle_count; i++) {
        const struct flat_triangle *triangle = &p->flat->triangles[p->bvh->triangle_order[i]];
        double radiance = luminance(p->scene->materials[triangle->material].emission);
        double normal[3];
        if (radiance > 0.0)
            add_emitter(list, i, radiance * triangle_normal(triangle, normal));
    }
    for (uint32_t i = 0; i < p->flat->shape_count; i++) {
        const struct flat_shape *shape = &p->flat->shapes[i];
        double radiance = luminance(p->scene->materials[shape->material].emission);
        if (radiance > 0.0)
            add_emitter(list, PRIMITIVE_SHAPE | i, radiance * shape_area(shape));
    }
    return true;
}

static bool upload_emitters(struct gpu *gpu, const struct upload_params *p,
                            const struct emitter_list *list, struct gpu_buffer *buffers,
                            struct arena *scratch, struct err *err)
{
    if (list->count == 0 || !(list->total > 0.0))
        return create(gpu, p, BINDING_EMITTERS, buffers, err);
    struct alias_bin *bins = ARENA_NEW(scratch, struct alias_bin, list->count);
    struct gpu_emitter *records = ARENA_NEW(scratch, struct gpu_emitter, list->count);
    if (!bins || !records || !alias_table_build(list->powers, list->count, scratch, bins))
        return err_memory(err, "emitters", (uint64_t)list->count * sizeof *records);
    for (uint32_t i = 0; i < list->count; i++)
        records[i] = (struct gpu_emitter){.threshold = bins[i].threshold,
                                          .primitive = list->primitives[i],
                                          .alias_primitive = list->primitives[bins[i].alias]};
    return create_filled(gpu, p, BINDING_EMITTERS, records, buffers, err);
}

static bool upload_materials(struct gpu *gpu, const struct upload_params *p, double total_power,
                             struct gpu_buffer *buffers, struct arena *scratch, struct err *err)
{
    uint32_t count = p->scene->material_count;
    struct gpu_material *records = ARENA_NEW(scratch, struct gpu_material, count);
    if (!records)
        return err_memory(err, "materials", (uint64_t)count * sizeof *records);
    for (uint32_t i = 0; i < count; i++) {
        const struct material *material = &p->scene->materials[i];
        memcpy(records[i].base_color, material->base_color, sizeof records[i].base_color);
        memcpy(records[i].emission, material->emission, sizeof records[i].emission);
        records[i].kind =
            material->type == MATERIAL_MIRROR ? MATERIAL_KIND_MIRROR : MATERIAL_KIND_DIFFUSE;
        if (total_power > 0.0)
            records[i].pick_density = (float)(luminance(material->emission) / total_power);
    }
    return create_filled(gpu, p, BINDING_MATERIALS, records, buffers, err);
}

static bool upload_environment(struct gpu *gpu, const struct upload_params *p,
                               struct gpu_buffer *buffers, struct arena *scratch, struct err *err)
{
    const struct environment *environment = &p->scene->environment;
    uint64_t count = (uint64_t)environment->width * environment->height;
    if (count == 0) {
        static const float white[4] = {1.0f, 1.0f, 1.0f, 0.0f};
        return create(gpu, p, BINDING_ENVIRONMENT, buffers, err) &&
               gpu_upload(gpu, &buffers[BINDING_ENVIRONMENT], 0, white, sizeof white, err);
    }
    float(*texels)[4] = arena_alloc(scratch, count, sizeof *texels);
    if (!texels)
        return err_memory(err, "environment", count * sizeof *texels);
    for (uint64_t i = 0; i < count; i++)
        memcpy(texels[i], environment->texels[i], sizeof environment->texels[i]);
    return create_filled(gpu, p, BINDING_ENVIRONMENT, texels, buffers, err);
}

bool upload_scene(struct gpu *gpu, const struct upload_params *p, struct gpu_buffer *buffers,
                  uint32_t *emitter_count, struct err *err)
{
    struct arena scratch = {0};
    struct emitter_list emitters = {0};
    const struct planned_buffer *plan = p->plan->buffers;
    bool ok =
        create_filled(gpu, p, BINDING_NODES, p->bvh->nodes, buffers, err) &&
        (!plan[BINDING_TRIANGLES].name || upload_triangles(gpu, p, buffers, &scratch, err)) &&
        (!plan[BINDING_NORMALS].name || upload_normals(gpu, p, buffers, &scratch, err)) &&
        (!plan[BINDING_SHAPES].name || upload_shapes(gpu, p, buffers, &scratch, err)) &&
        list_emitters(p, &scratch, &emitters, err) &&
        (!plan[BINDING_EMITTERS].name ||
         upload_emitters(gpu, p, &emitters, buffers, &scratch, err)) &&
        (!plan[BINDING_MATERIALS].name ||
         upload_materials(gpu, p, emitters.total, buffers, &scratch, err)) &&
        (!plan[BINDING_ENVIRONMENT].name || upload_environment(gpu, p, buffers, &scratch, err));
    *emitter_count = emitters.count;
    arena_finish(&scratch);
    return ok;
}
