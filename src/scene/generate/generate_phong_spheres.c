// Spheres with Phong's model after D. Kuri 2018, "GPU Path Tracing in Unity", part 2. The image
// there has the seed 1223832719, radii from 5 to 30, 10000 tries and a disc of radius 100. The
// random numbers are those of the Unity engine, which are public knowledge: Marsaglia 2003,
// "Xorshift RNGs" (xor128 of section 4), with a state initialised by a linear congruential
// generator (Knuth's multiplier 1812433253, increment 1). Numbers have 23 bits; angles and squared
// radii are drawn as 1 - u. All arithmetic is in single precision.
#include "scene/generate/phong_spheres.h"

#include <math.h>
#include <string.h>

struct sequence {
    uint32_t state[4];
};

static struct sequence sequence_of(uint32_t seed)
{
    struct sequence sequence = {{seed}};
    for (int i = 1; i < 4; i++)
        sequence.state[i] = 1812433253u * sequence.state[i - 1] + 1;
    return sequence;
}

// Returns a number in [0, 1], both ends included.
static float draw(struct sequence *sequence)
{
    uint32_t *s = sequence->state, t = s[0] ^ s[0] << 11;
    memmove(s, s + 1, 3 * sizeof *s);
    s[3] = s[2] ^ s[2] >> 19 ^ t ^ t >> 8;
    return (float)(s[3] & 0x7fffff) / 8388607.0f;
}

// Returns 1 - u, because the engine draws angles and squared radii that way.
static float draw_down(struct sequence *sequence)
{
    return 1.0f - draw(sequence);
}

static float draw_between(struct sequence *sequence, float low, float high)
{
    return low + draw(sequence) * (high - low);
}

// Draws a point uniformly in the unit disc. The sine and the cosine are rounded from double
// precision, so that they are the same on every machine.
static void draw_in_disc(struct sequence *sequence, float out[2])
{
    float angle = draw_down(sequence) * 6.2831853071795865f;
    float radius = sqrtf(draw_down(sequence));
    out[0] = (float)cos((double)angle) * radius;
    out[1] = (float)sin((double)angle) * radius;
}

// Draws a colour by hue, saturation and value (Smith 1978, "Color gamut transform pairs", the
// hexcone model). A fourth number, the opacity, is drawn and not used.
static void draw_color(struct sequence *sequence, float least_value, float most_value, float out[3])
{
    float hue = 6.0f * draw(sequence), saturation = draw(sequence);
    float value = draw_between(sequence, least_value, most_value);
    draw(sequence);
    float sextant = floorf(hue), f = hue - sextant;
    float p = value * (1.0f - saturation), q = value * (1.0f - saturation * f);
    float t = value * (1.0f - saturation * (1.0f - f));
    const float colors[6][3] = {{value, t, p}, {q, value, p}, {p, value, t},
                                {p, q, value}, {t, p, value}, {value, p, q}};
    memcpy(out, colors[(int)sextant % 6], sizeof *colors);
}

static bool overlaps(const struct phong_sphere *sphere, const struct phong_sphere *others,
                     uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        float reach = sphere->radius + others[i].radius, square = 0.0f;
        for (int c = 0; c < 3; c++) {
            float d = sphere->center[c] - others[i].center[c];
            square += d * d;
        }
        if (square < reach * reach)
            return true;
    }
    return false;
}

// Draws a material: four in ten are metal, four are plastic, and two emit light.
static void draw_material(struct sequence *sequence, struct phong_sphere *sphere)
{
    float color[3];
    draw_color(sequence, 0.0f, 1.0f, color);
    float chance = draw(sequence);
    if (chance >= 0.8f) {
        draw_color(sequence, 3.0f, 8.0f, sphere->emission);
        return;
    }
    bool is_metal = chance < 0.4f;
    for (int c = 0; c < 3; c++) {
        sphere->specular_color[c] = is_metal ? color[c] : 0.04f;
        // Only light that is not reflected specularly is available for diffuse reflection.
        sphere->base_color[c] = is_metal ? 0.0f : fminf(color[c], 1.0f - 0.04f);
    }
    sphere->smoothness = draw(sequence);
}

double phong_exponent(double smoothness)
{
    return pow(1000.0, smoothness * smoothness);
}

bool phong_spheres_place(const struct phong_spheres *params, struct phong_sphere *out,
                         uint32_t *placed, struct err *err)
{
    struct sequence sequence = sequence_of(params->seed);
    *placed = 0;
    for (uint32_t i = 0; i < params->count; i++) {
        struct phong_sphere sphere = {.radius = draw_between(&sequence, (float)params->min_radius,
                                                             (float)params->max_radius)};
        float place[2];
        draw_in_disc(&sequence, place);
        // The sign of z changes, because the engine's coordinates are left-handed.
        sphere.center[0] = place[0] * (float)params->disc_radius;
        sphere.center[1] = sphere.radius;
        sphere.center[2] = -place[1] * (float)params->disc_radius;
        if (i % 256 == 0 && progress_should_stop(params->progress))
            return err_set(err, ERR_STOPPED, "stopped while placing spheres");
        if (overlaps(&sphere, out, *placed))
            continue;
        draw_material(&sequence, &sphere);
        out[(*placed)++] = sphere;
    }
    return true;
}
