#include "render/parts.h"

#include "gpu/spirv_trim.h"
#include "render/wave.h"

// --- listing of the parts ------------------------------------------------------------------------

const char *part_kind_name(enum part_kind kind)
{
    static const char *const names[] = {
        [PART_FEATURE] = "feature", [PART_GEOMETRY] = "feature", [PART_SPLIT_BUFFERS] = "feature",
        [PART_LOBE] = "lobe",       [PART_EMITTER] = "emitter",  [PART_KERNEL] = "kernel",
        [PART_BUFFER] = "buffer",
    };
    return names[kind];
}

static void visit_bits(enum part_kind kind, uint32_t kept, const char *(*name_of)(uint32_t bit),
                       part_fn fn, void *context)
{
    for (uint32_t bit = 1; bit; bit <<= 1) {
        const char *name = name_of(bit);
        if (name)
            fn(context, &(struct part){kind, bit, name, kept & bit, 0});
    }
}

void parts_visit(const struct renderer *r, part_fn fn, void *context)
{
    const struct specialization *s = &r->specialization;
    visit_bits(PART_FEATURE, s->features, feature_name, fn, context);
    visit_bits(PART_GEOMETRY, s->geometry, geometry_name, fn, context);
    fn(context, &(struct part){PART_SPLIT_BUFFERS, 1, "split buffers", s->parts, 0});
    visit_bits(PART_LOBE, s->lobes, lobe_name, fn, context);
    visit_bits(PART_EMITTER, s->emitters, emitter_name, fn, context);
    for (uint32_t id = 0; id < KERNEL_COUNT; id++) {
        const char *name = kernel_code((enum kernel_id)id, r->gpu->has_ballot).name;
        bool is_kept = r->kernels[id].pipeline != VK_NULL_HANDLE;
        fn(context, &(struct part){PART_KERNEL, id, name, is_kept, 0});
    }
    for (uint32_t b = 0; b < BINDING_COUNT; b++) {
        const struct planned_buffer *plan = &r->plan.buffers[b];
        uint64_t bytes = plan->name ? plan->bytes * plan->copies : plan->unneeded_bytes;
        fn(context, &(struct part){PART_BUFFER, b, binding_name(b), plan->name, bytes});
    }
}

// --- savings by leaving parts out ----------------------------------------------------------------

static uint64_t instructions_of(const struct renderer *r, const struct specialization *s)
{
    uint64_t count = 0;
    for (int id = 0; id < KERNEL_COUNT; id++)
        if (specialization_needs_kernel(s, (enum kernel_id)id))
            count += wave_kernel_instructions(r, s, (enum kernel_id)id);
    return count;
}

static uint64_t bytes_of(const struct renderer *r, const struct specialization *s)
{
    const struct memory_plan_params params = {
        .scene = r->scene,
        .flat = &r->flat,
        .bvh = &r->bvh,
        .specialization = s,
        .tables = &r->tables,
        .gpu = r->gpu,
    };
    return memory_plan_bytes(&params, r->plan.wave_slots);
}

static struct part_cost cost_of_bit(const struct renderer *r, uint32_t constant, uint32_t bit)
{
    const struct specialization *without = &r->specialization;
    struct specialization with = specialization_with(without, constant, bit);
    return (struct part_cost){
        .bytes = (int64_t)(bytes_of(r, &with) - bytes_of(r, without)),
        .instructions = (int64_t)(instructions_of(r, &with) - instructions_of(r, without)),
    };
}

struct part_cost part_find_cost(const struct renderer *r, const struct part *part)
{
    const struct specialization *s = &r->specialization;
    switch (part->kind) {
    case PART_FEATURE:
        return cost_of_bit(r, CONSTANT_FEATURES, part->id);
    case PART_GEOMETRY:
        return cost_of_bit(r, CONSTANT_GEOMETRY, part->id);
    case PART_SPLIT_BUFFERS:
        return cost_of_bit(r, CONSTANT_PARTS, part->id);
    case PART_LOBE:
        return cost_of_bit(r, CONSTANT_LOBES, part->id);
    case PART_EMITTER:
        return cost_of_bit(r, CONSTANT_EMITTERS, part->id);
    case PART_KERNEL:
        return (struct part_cost){
            .instructions = wave_kernel_instructions(r, s, (enum kernel_id)part->id),
        };
    default:
        return (struct part_cost){.bytes = (int64_t)part->bytes};
    }
}

struct part_totals parts_count_instructions(const struct renderer *r)
{
    struct part_totals totals = {.instructions = instructions_of(r, &r->specialization)};
    for (int id = 0; id < KERNEL_COUNT; id++) {
        struct kernel_code code = kernel_code((enum kernel_id)id, r->gpu->has_ballot);
        totals.all_instructions += spirv_instructions(code.spirv, code.bytes);
    }
    return totals;
}
