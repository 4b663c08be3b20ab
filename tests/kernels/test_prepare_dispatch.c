// Tests prepare_dispatch, which computes the arguments of indirect dispatches from the counts of
// queues.
#include "kernel_fixture.h"

enum { SLOTS = 4096 };

static const uint32_t rubbish = 0x5a5a5a5au;

static void add_64(uint32_t words[2], uint32_t value)
{
    uint64_t sum = ((uint64_t)words[1] << 32 | words[0]) + value;
    words[0] = (uint32_t)sum;
    words[1] = (uint32_t)(sum >> 32);
}

// Changes the counters as the kernel should.
static void expect(struct gpu_counters *counters, uint32_t mask, uint32_t workgroup,
                   uint32_t part_items, uint32_t slots)
{
    for (uint32_t queue = 0; queue < QUEUE_COUNT; queue++) {
        if (!(mask >> queue & 1u))
            continue;
        uint32_t count = counters->queue[queue].count;
        bool rays = queue <= QUEUE_RAYS + 1;
        counters->queue[queue].count = 0;
        for (uint32_t part = 0; part < DISPATCH_PARTS && part * part_items < slots; part++) {
            uint32_t first = part * part_items, items = count > first ? count - first : 0;
            if (items > part_items)
                items = part_items;
            struct gpu_dispatch dispatch = {(items + workgroup - 1) / workgroup, 1, 1, count};
            counters->dispatch[queue * DISPATCH_PARTS + part] = dispatch;
            // Queues of hits for each class, and the queue of misses.
            for (uint32_t hits = QUEUE_SURFACE; hits <= QUEUE_MISS && rays; hits++)
                counters->dispatch[hits * DISPATCH_PARTS + part] = dispatch;
        }
        uint32_t *total = rays                    ? counters->closest_rays
                          : queue == QUEUE_SHADOW ? counters->shadow_rays
                                                  : NULL;
        if (total)
            add_64(total, count);
        for (uint32_t hits = QUEUE_SURFACE; hits <= QUEUE_MISS && rays; hits++) {
            if (hits < QUEUE_MISS)
                add_64(counters->surface_hits[hits - QUEUE_SURFACE], counters->queue[hits].count);
            counters->queue[hits].count = 0;
        }
        if (queue >= QUEUE_SUSPENDED)
            counters->suspended += count;
    }
}

static void check(struct renderer *r, uint32_t mask, uint32_t count, uint32_t part_items)
{
    struct gpu_counters expected;
    struct err err = {0};
    memset(&expected, 0x5a, sizeof expected);
    for (uint32_t queue = 0; queue < QUEUE_COUNT; queue++)
        expected.queue[queue].count = count;
    // The previous bounce had another number of hits of each class.
    for (uint32_t c = 0; c < CLASS_COUNT; c++)
        expected.queue[QUEUE_SURFACE + c].count = count / (c + 1);
    // The next ray carries into the high word.
    expected.closest_rays[0] = expected.shadow_rays[0] = 0xffffffffu;
    expected.surface_hits[1][0] = 0xffffffffu;
    expected.suspended = 7;
    r->push.queue = mask;
    r->push.part_items = part_items;
    bool ok =
        gpu_upload(r->gpu, &r->buffers[BINDING_QUEUES], 0, &expected, sizeof expected, &err) &&
        run_kernel(r, &r->kernels[KERNEL_prepare_dispatch], QUEUE_COUNT, &err) &&
        gpu_download(r->gpu, &r->buffers[BINDING_QUEUES], 0, r->counters, sizeof *r->counters,
                     &err);
    REQUIRE(ok, "%s", err.msg);
    expect(&expected, mask, r->specialization.workgroup, part_items, r->frame.wave_slots);
    CHECK(memcmp(&expected, r->counters, sizeof expected) == 0,
          "queues 0x%x with %u items in parts of %u", mask, count, part_items);
    CHECK(r->counters->sparse == rubbish, "what is not the kernel's was written");
}

TEST(prepare_dispatch)
{
    struct setup setup;
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, SLOTS);
    uint32_t workgroup = setup.r.specialization.workgroup, slots = setup.r.frame.wave_slots;
    const uint32_t counts[] = {
        0,         1,    workgroup - 1, workgroup, workgroup + 1, 3 * workgroup, slots / 2 + 1,
        slots - 1, slots};
    const uint32_t parts[] = {
        slots, slots / 2, slots / 3, slots / DISPATCH_PARTS, slots / DISPATCH_PARTS / 2, 2 * slots};
    const uint32_t masks[] = {1u << QUEUE_RAYS | 1u << QUEUE_SHADOW,
                              1u << (QUEUE_RAYS + 1) | 1u << QUEUE_SHADOW, 1u << QUEUE_SUSPENDED,
                              1u << (QUEUE_SUSPENDED + 1), 0};
    for (size_t m = 0; m < sizeof masks / sizeof masks[0]; m++)
        for (size_t p = 0; p < sizeof parts / sizeof parts[0]; p++)
            for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++)
                check(&setup.r, masks[m], counts[c], parts[p]);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(prepare_dispatch))
