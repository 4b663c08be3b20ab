#include "render/wave_size.h"

// The number of samples in a stretch. One wave of the largest size has as many, so that stretches
// of all sizes render the same number of samples.
#define STRETCH_SAMPLES WAVE_SIZE_MOST
// The number of samples in the first waves. On two cores, 64k was the best or nearly the best size
// for five scenes (docs/performance.md).
#define USUAL (1u << 16)
// The factor between two sizes. With a smaller factor, noise would hide differences in speed.
#define STEP 4u
// The size on trial replaces the current one if its time per ray is below this fraction of the
// current size's. At equal speed there is no reason to change.
#define GAIN 0.98
// The number of stretches between two trials: at first, and after many trials without success. In
// the latter case one stretch in 51 has the slower size: one of the three stretches of a trial,
// which follow 48 others.
#define FIRST_PAUSE 1u
#define LONGEST_PAUSE 48u

void wave_size_begin(struct wave_size *size, bool is_tuned, uint32_t most)
{
    uint32_t usual = is_tuned && most > USUAL ? USUAL : most;
    *size = (struct wave_size){
        .is_on = is_tuned,
        .now = usual,
        .most = most,
        .grows = true,
        .stretch = FIRST_PAUSE,
        .pause = FIRST_PAUSE,
        .least_used = usual,
        .most_used = usual,
    };
}

uint32_t wave_size_samples(const struct wave_size *size)
{
    return size->other && size->stretch == 1 ? size->other : size->now;
}

static uint32_t next_size(const struct wave_size *size, bool grows)
{
    if (grows)
        return size->now <= size->most / STEP ? size->now * STEP : 0;
    return size->now >= STEP * WAVE_SIZE_LEAST ? size->now / STEP : 0;
}

static void begin_trial(struct wave_size *size)
{
    size->other = next_size(size, size->grows);
    if (!size->other) {
        size->grows = !size->grows;
        size->other = next_size(size, size->grows);
    }
    size->stretch = 0;
}

// After a success the next trial follows soon, in the same direction.
static void end_trial(struct wave_size *size)
{
    const double *ns = size->ns_a_ray;
    if (ns[1] < GAIN * 0.5 * (ns[0] + ns[2])) {
        size->now = size->other;
        size->pause = FIRST_PAUSE;
    } else {
        size->grows = !size->grows;
        size->pause = 2 * size->pause < LONGEST_PAUSE ? 2 * size->pause : LONGEST_PAUSE;
    }
    size->other = 0;
    size->stretch = size->pause;
}

static void end_stretch(struct wave_size *size)
{
    if (!size->other) {
        if (--size->stretch == 0)
            begin_trial(size);
        return;
    }
    size->ns_a_ray[size->stretch] = size->ns / size->rays;
    if (++size->stretch == 3)
        end_trial(size);
}

void wave_size_learn(struct wave_size *size, uint64_t samples, double rays, double ns)
{
    if (!size->is_on || rays <= 0.0)
        return;
    uint32_t used = wave_size_samples(size);
    size->least_used = used < size->least_used ? used : size->least_used;
    size->most_used = used > size->most_used ? used : size->most_used;
    size->samples += samples;
    size->rays += rays;
    size->ns += ns;
    if (size->samples < STRETCH_SAMPLES)
        return;
    end_stretch(size);
    size->samples = 0;
    size->rays = size->ns = 0.0;
}
