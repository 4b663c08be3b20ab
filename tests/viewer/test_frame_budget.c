#include "test.h"
#include "viewer/core/frame_budget.h"

static void run(struct frame_budget *pace, double ms_per_sample, double overhead_ms)
{
    for (int i = 0; i < 100; i++) {
        frame_budget_measure(pace, 1000.0, 1000.0 * ms_per_sample, overhead_ms);
        frame_budget_choose(pace, 640, 360);
    }
}

// Simulates frames of a device with this time per sample until the size no longer changes.
static struct frame_budget settled(double ms_per_sample, double overhead_ms)
{
    struct frame_budget pace;
    frame_budget_init(&pace, 33.0);
    run(&pace, ms_per_sample, overhead_ms);
    return pace;
}

// Does the same after samples that took less time.
static struct frame_budget slowed(double ms_per_sample, double overhead_ms)
{
    struct frame_budget pace = settled(1e-9, overhead_ms);
    run(&pace, ms_per_sample, overhead_ms);
    return pace;
}

static double preview_ms(const struct frame_budget *pace, double ms_per_sample)
{
    return (double)frame_budget_shrunk(640, pace->shrink) * frame_budget_shrunk(360, pace->shrink) *
           ms_per_sample;
}

TEST(means_follow_what_is_measured)
{
    struct frame_budget pace;
    frame_budget_init(&pace, 33.0);
    frame_budget_measure(&pace, 100.0, 5.0, 3.0);
    CHECK(pace.ms_per_sample == 0.05, "%g", pace.ms_per_sample);
    CHECK(pace.overhead_ms == 3.0, "%g", pace.overhead_ms);
    for (int i = 0; i < 50; i++)
        frame_budget_measure(&pace, 100.0, 10.0, 6.0);
    CHECK(fabs(pace.ms_per_sample - 0.1) < 1e-4, "%g", pace.ms_per_sample);
    CHECK(fabs(pace.overhead_ms - 6.0) < 1e-2, "%g", pace.overhead_ms);
    frame_budget_measure(&pace, 0.0, 0.0,
                         6.0); // a frame without samples gives no information about rendering
    CHECK(fabs(pace.ms_per_sample - 0.1) < 1e-4, "%g", pace.ms_per_sample);
}

TEST(rendering_keeps_a_quarter_of_the_frame)
{
    struct frame_budget pace = settled(1e-3, 10.0);
    CHECK(fabs(frame_budget_render_ms(&pace) - 23.0) < 1e-6, "%g", frame_budget_render_ms(&pace));
    pace = settled(1e-3, 100.0);
    CHECK(frame_budget_render_ms(&pace) == 33.0 / 4, "%g", frame_budget_render_ms(&pace));
}

TEST(previews_fit_the_frame)
{
    for (double ms = 1e-7; ms < 1e-2; ms *= 1.3) {
        struct frame_budget pace = slowed(ms, 5.0);
        CHECK(pace.shrink == FRAME_BUDGET_SHRINK_MAX ||
                  preview_ms(&pace, ms) <= frame_budget_render_ms(&pace) * 1.0001,
              "%g, slowed: %u", ms, pace.shrink);
        pace = settled(ms, 5.0);
        bool is_smallest = pace.shrink == FRAME_BUDGET_SHRINK_MAX;
        CHECK(pace.shrink >= 1 && pace.shrink <= FRAME_BUDGET_SHRINK_MAX, "%u", pace.shrink);
        CHECK(is_smallest || preview_ms(&pace, ms) <= frame_budget_render_ms(&pace), "%g: %u", ms,
              pace.shrink);
        struct frame_budget finer = pace;
        finer.shrink--;
        CHECK(pace.shrink == 1 || preview_ms(&finer, ms) > 0.8 * frame_budget_render_ms(&pace),
              "%g: %u", ms, pace.shrink);
    }
}

TEST(quick_devices_need_no_preview)
{
    CHECK(settled(1e-5, 5.0).shrink == 1);
    CHECK(settled(1.0, 5.0).shrink == FRAME_BUDGET_SHRINK_MAX);
}

TEST(nothing_is_chosen_before_something_is_known)
{
    struct frame_budget pace;
    frame_budget_init(&pace, 33.0);
    uint32_t first = pace.shrink;
    frame_budget_choose(&pace, 640, 360);
    CHECK(pace.shrink == first && first > 1, "%u", pace.shrink);
}

// The time of a sample varies by a tenth from frame to frame.
TEST(the_choice_does_not_flicker)
{
    for (double ms = 2e-4; ms < 2e-3; ms *= 1.002) {
        struct frame_budget pace = settled(ms, 5.0);
        uint32_t shrink = pace.shrink, changes = 0;
        for (int i = 0; i < 200; i++) {
            frame_budget_measure(&pace, 1000.0, 1000.0 * ms * (i % 2 ? 1.05 : 0.95), 5.0);
            frame_budget_choose(&pace, 640, 360);
            changes += pace.shrink != shrink;
            shrink = pace.shrink;
        }
        CHECK(changes <= 1, "%g: %u changes", ms, changes);
    }
}

TEST(waves_fit_the_frame)
{
    for (double ms = 1e-7; ms < 1e-2; ms *= 1.7) {
        struct frame_budget pace = settled(ms, 5.0);
        uint32_t wave = frame_budget_wave(&pace, frame_budget_render_ms(&pace));
        CHECK((wave & (wave - 1)) == 0 && wave >= FRAME_BUDGET_WAVE_MIN &&
                  wave <= FRAME_BUDGET_WAVE_MAX,
              "%u", wave);
        CHECK(wave == FRAME_BUDGET_WAVE_MIN || wave * ms <= frame_budget_render_ms(&pace), "%g: %u",
              ms, wave);
        CHECK(wave == FRAME_BUDGET_WAVE_MAX || 2 * wave * ms > frame_budget_render_ms(&pace),
              "%g: %u", ms, wave);
    }
}

TEST(calm_frames_are_longer_but_answer)
{
    struct frame_budget pace = settled(1e-3, 20.0);
    CHECK(fabs(frame_budget_calm_render_ms(&pace) - 80.0) < 1e-6, "%g",
          frame_budget_calm_render_ms(&pace));
    pace = settled(1e-3, 60.0);
    CHECK(fabs(frame_budget_calm_render_ms(&pace) - 140.0) < 1e-6, "%g",
          frame_budget_calm_render_ms(&pace));
    for (double overhead = 0.0; overhead < 400.0; overhead += 7.0) {
        pace = settled(1e-3, overhead);
        CHECK(frame_budget_calm_render_ms(&pace) >= frame_budget_render_ms(&pace), "%g", overhead);
    }
}

// Work that is done once per pixel makes previews smaller.
TEST(denoising_is_paced)
{
    struct frame_budget pace = settled(1e-4, 5.0);
    uint32_t without = pace.shrink;
    frame_budget_measure_pixels(&pace, 1000.0, 1.0);
    frame_budget_choose(&pace, 640, 360);
    CHECK(pace.shrink > without, "%u", pace.shrink);
    frame_budget_measure_pixels(&pace, 0.0, 0.0);
    frame_budget_choose(&pace, 640, 360);
    CHECK(pace.shrink == without, "%u", pace.shrink);
}

// Dispatches of small pictures cost more per sample. Their times decide the size of small pictures,
// but not the waves of large ones.
TEST(small_pictures_are_measured_apart)
{
    struct frame_budget pace = settled(1e-4, 5.0);
    uint32_t without = pace.shrink, wave = frame_budget_wave(&pace, 20.0);
    frame_budget_measure_small(&pace, 1000.0, 0.5);
    frame_budget_choose(&pace, 640, 360);
    CHECK(pace.shrink > without, "%u", pace.shrink);
    CHECK(frame_budget_wave(&pace, 20.0) == wave, "%u", frame_budget_wave(&pace, 20.0));
}

TEST_MAIN(TEST_CASE(means_follow_what_is_measured),
          TEST_CASE(rendering_keeps_a_quarter_of_the_frame), TEST_CASE(previews_fit_the_frame),
          TEST_CASE(quick_devices_need_no_preview),
          TEST_CASE(nothing_is_chosen_before_something_is_known),
          TEST_CASE(the_choice_does_not_flicker), TEST_CASE(waves_fit_the_frame),
          TEST_CASE(calm_frames_are_longer_but_answer), TEST_CASE(denoising_is_paced),
          TEST_CASE(small_pictures_are_measured_apart))
