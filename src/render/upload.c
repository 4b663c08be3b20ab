#include "render/upload.h"

#include "base/parallel.h"
#include "image/image.h"
#include "render/attributes.h"
#include "render/tables/environment_table.h"
#include "render/tables/octahedral.h"
#include "render/upload_parts.h"
#include "scene/core/affine.h"
#include "shared/types.h"
#include <math.h>
#include <string.h>

// Sets the emitter number of all entries of a triangle in leaf order. A triangle with several
// entries is listed as an emitter with only one of them.
static bool number_all_places(const struct upload_params *p, uint32_t *numbers,
                              struct arena *scratch)
{
    const struct bvh *bvh = p->bvh;
    if (bvh->reference_count == bvh->triangle_count)
        return true;
    uint32_t *of_triangle = ARENA_NEW(scratch, uint32_t, p->flat->triangle_count);
    for (uint32_t i = 0; of_triangle && i < p->flat->triangle_count; i++)
        of_triangle[i] = NO_EMITTER;
    for (uint32_t i = 0; of_triangle && i < bvh->reference_count; i++)
        if (numbers[i] != NO_EMITTER)
            of_triangle[bvh->triangle_order[i]] = numbers[i];
    for (uint32_t i = 0; of_triangle && i < bvh->reference_count; i++)
        numbers[i] = of_triangle[bvh->triangle_order[i]];
    return of_triangle != NULL;
}

// --- records of triangles ------------------------------------------------------------------------

// All threads fill records, in pieces of this many bytes, so that large arrays do not exist twice
// in host memory.
#define PIECE_BYTES (16u << 20)

struct records {
    const struct upload_params *p;
    // Writes the record of the triangle at a position of the leaf order; the caller has zeroed the
    // record.
    void (*fill)(const struct records *records, uint32_t place, void *out);
    uint32_t bytes;           // size of a record
    const uint32_t *emitters; // emitter number of each position
    char *piece;
    uint32_t first; // first position of the piece
};

static void fill_piece(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct records *records = context;
    memset(records->piece + begin * records->bytes, 0, (end - begin) * records->bytes);
    for (size_t i = begin; i < end; i++)
        records->fill(records, records->first + (uint32_t)i, records->piece + i * records->bytes);
}

static bool upload_records(struct gpu *gpu, struct records *records, uint32_t binding,
                           struct gpu_buffer *buffers, struct arena *scratch, struct err *err)
{
    const struct upload_params *p = records->p;
    uint32_t count = p->bvh->reference_count, most = PIECE_BYTES / records->bytes;
    most = count < most ? count : most;
    records->piece = arena_alloc(scratch, most, records->bytes);
    if (!records->piece)
        return err_memory(err, binding_name(binding), (uint64_t)most * records->bytes);
    if (!upload_create(gpu, p, binding, buffers, err))
        return false;
    for (uint32_t left; records->first < count; records->first += left) {
        left = count - records->first < most ? count - records->first : most;
        parallel_for(left, 1024, 0, fill_piece, records);
        if (!gpu_upload(gpu, &buffers[binding], (uint64_t)records->first * records->bytes,
                        records->piece, (uint64_t)left * records->bytes, err))
            return false;
        if (left == count)
            break;
        progress_report(p->progress, "Uploading", (double)records->first / count);
        if (progress_should_stop(p->progress))
            return err_set(err, ERR_STOPPED, "stopped while uploading the scene");
    }
    return true;
}

static void fill_triangle(const struct records *records, uint32_t place, void *out)
{
    const struct upload_params *p = records->p;
    uint32_t id = p->bvh->triangle_order[place];
    const struct flat_triangle *triangle = &p->flat->triangles[id];
    struct gpu_triangle *record = out;
    const struct flat_small_triangle *small = flat_find_small(p->flat, id);
    memcpy(record->v0, triangle->v[0], sizeof record->v0);
    memcpy(record->v1, small ? small->edges[0] : triangle->v[1], sizeof record->v1);
    memcpy(record->v2, small ? small->edges[1] : triangle->v[2], sizeof record->v2);
    record->id = id;
    record->emitter = small ? small->place : records->emitters[place];
    record->material =
        upload_material_word(p, triangle->material) | (small ? MATERIAL_WORD_EDGES : 0u);
}

static bool upload_triangles(struct gpu *gpu, const struct upload_params *p,
                             struct gpu_buffer *buffers, struct arena *scratch, struct err *err)
{
    uint32_t count = p->bvh->reference_count;
    uint32_t *emitters = upload_emitter_numbers(p, 0, count, scratch);
    if (!emitters || !number_all_places(p, emitters, scratch))
        return err_memory(err, "triangles' emitters", (uint64_t)count * sizeof *emitters);
    struct records records = {
        .p = p,
        .fill = fill_triangle,
        .bytes = sizeof(struct gpu_triangle),
        .emitters = emitters,
    };
    return upload_records(gpu, &records, BINDING_TRIANGLES, buffers, scratch, err);
}

// The maximum error of a component of a decoded normal, whose octahedral code has two components of
// 16 bits.
#define NORMAL_RESOLUTION 6.52e-5

// Returns whether a triangle's shading normals equal its geometric normal, within the precision of
// their code. The geometric normal, which is exact, is used then.
static bool is_flat(const struct flat_scene *flat, uint32_t id)
{
    double e[2][3], n[3];
    flat_triangle_edges(flat, id, e);
    vec3_cross(e[0], e[1], n);
    double length = sqrt(vec3_dot(n, n));
    for (int corner = 0; corner < 3; corner++)
        for (int c = 0; c < 3; c++)
            if (!(fabs((double)flat->normals[id][corner][c] - n[c] / length) <= NORMAL_RESOLUTION))
                return false;
    return true;
}

static void fill_normals(const struct flat_scene *flat, uint32_t id, uint32_t word[4])
{
    word[0] = NORMAL_FLAT;
    if (!flat->normals || is_flat(flat, id))
        return;
    for (int corner = 0; corner < 3; corner++)
        word[corner] = encode_normal(flat->normals[id][corner]);
}

static void fill_tangents(const struct flat_scene *flat, uint32_t id, uint32_t word[4])
{
    for (int corner = 0; corner < 3 && flat->tangents; corner++) {
        word[corner] = encode_normal(flat->tangents[id][corner]);
        word[3] |= flat->tangents[id][corner][3] < 0.0f ? 1u << corner : 0u;
    }
}

static void fill_uvs(const struct flat_scene *flat, int set, uint32_t id, uint32_t (*word)[4])
{
    if (flat->uvs[set])
        memcpy(word, flat->uvs[set][id], sizeof flat->uvs[set][id]);
}

// Fills the colours of one triangle. A 32-bit component holds two half floats, the first in the low
// bits.
static void fill_colors(const struct flat_scene *flat, uint32_t id, uint32_t (*word)[4])
{
    for (int i = 0; i < 12; i++) {
        float value = flat->colors ? flat->colors[id][i / 4][i % 4] : 1.0f;
        word[i / 8][i / 2 % 4] |= (uint32_t)half_from_float(value) << i % 2 * 16;
    }
}

// Fills the attributes of one triangle, in the order of shared/types.h; the caller has zeroed them.
static void fill_attributes(const struct upload_params *p, uint32_t id, uint32_t (*word)[4])
{
    uint32_t features = p->specialization->features;
    if (features & FEATURE_NORMALS)
        fill_normals(p->flat, id, *word++);
    if (features & FEATURE_TANGENTS)
        fill_tangents(p->flat, id, *word++);
    for (int set = 0; set < 2; set++) {
        if (!(features & (set ? FEATURE_UV1 : FEATURE_UV0)))
            continue;
        fill_uvs(p->flat, set, id, word);
        word += 2;
    }
    if (features & FEATURE_COLORS)
        fill_colors(p->flat, id, word);
}

static void fill_attributes_of(const struct records *records, uint32_t place, void *out)
{
    fill_attributes(records->p, records->p->bvh->triangle_order[place], out);
}

static bool upload_attributes(struct gpu *gpu, const struct upload_params *p,
                              struct gpu_buffer *buffers, struct arena *scratch, struct err *err)
{
    struct records records = {
        .p = p,
        .fill = fill_attributes_of,
        .bytes = attribute_words(p->specialization->features) * 16,
    };
    return upload_records(gpu, &records, BINDING_ATTRIBUTES, buffers, scratch, err);
}

static bool upload_environment(struct gpu *gpu, const struct upload_params *p,
                               struct gpu_buffer *buffers, struct err *err)
{
    const struct environment_table table = {
        .environment = &p->scene->environment,
        .filter = p->specialization->environment_filter,
        .is_sampled = p->specialization->emitters & EMITTER_ENVIRONMENT,
        .floor = p->tables->emitters.environment_floor,
    };
    return upload_create(gpu, p, BINDING_ENVIRONMENT, buffers, err) &&
           environment_table_upload(gpu, &table, &buffers[BINDING_ENVIRONMENT], err);
}

bool upload_scene(struct gpu *gpu, const struct upload_params *p, struct gpu_buffer *buffers,
                  struct err *err)
{
    struct arena scratch = {0};
    const struct planned_buffer *plan = p->plan->buffers;
    const struct shading_tables *tables = p->tables;
    bool ok =
        upload_filled(gpu, p, BINDING_NODES, bvh_nodes_data(p->bvh), buffers, err) &&
        (!plan[BINDING_TRIANGLES].name || upload_triangles(gpu, p, buffers, &scratch, err)) &&
        (!plan[BINDING_ATTRIBUTES].name || upload_attributes(gpu, p, buffers, &scratch, err)) &&
        (!plan[BINDING_SHAPES].name || upload_shapes(gpu, p, buffers, &scratch, err)) &&
        (!plan[BINDING_EMITTERS].name ||
         upload_filled(gpu, p, BINDING_EMITTERS, tables->emitters.data, buffers, err)) &&
        (!plan[BINDING_MATERIALS].name ||
         upload_filled(gpu, p, BINDING_MATERIALS, tables->materials, buffers, err)) &&
        (!plan[BINDING_TEXELS].name ||
         (upload_create(gpu, p, BINDING_TEXELS, buffers, err) &&
          texture_set_upload(gpu, p->scene, &tables->textures, &buffers[BINDING_TEXELS], err))) &&
        (!plan[BINDING_ENVIRONMENT].name || upload_environment(gpu, p, buffers, err));
    arena_finish(&scratch);
    return ok;
}
