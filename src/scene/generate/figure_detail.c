// The detail of a figure's surface: noise (Perlin 2002, "Improving noise"), ridged noise (Musgrave
// 1994, in "Texturing and modeling") in a domain that noise distorts, and cells (Worley 1996, "A
// cellular texture basis function").
#include "scene/generate/figure_field.h"
#include "scene/generate/scatter.h"

#include <math.h>

static uint32_t lattice_bits(const double cell[3], uint32_t n)
{
    uint32_t x = (uint32_t)(int32_t)cell[0], y = (uint32_t)(int32_t)cell[1];
    return scatter_bits(x * 0x9e3779b1u ^ y, (uint32_t)(int32_t)cell[2], n);
}

static double fade(double t)
{
    return t * t * t * (t * (t * 6 - 15) + 10);
}

static double mix(double a, double b, double t)
{
    return a + t * (b - a);
}

// Returns the dot product of (x, y, z) with one of twelve gradients, which point to the midpoints
// of a cube's edges.
static double gradient(uint32_t bits, double x, double y, double z)
{
    uint32_t h = bits & 15;
    double u = h < 8 ? x : y, v = h < 4 ? y : h == 12 || h == 14 ? x : z;
    return (h & 1 ? -u : u) + (h & 2 ? -v : v);
}

// Returns Perlin's noise, in about [-1, 1].
static double noise(const double p[3])
{
    double cell[3], f[3], corner[8];
    for (int i = 0; i < 3; i++) {
        cell[i] = floor(p[i]);
        f[i] = p[i] - cell[i];
    }
    for (int k = 0; k < 8; k++) {
        double dx = k & 1, dy = k >> 1 & 1, dz = k >> 2;
        const double at[3] = {cell[0] + dx, cell[1] + dy, cell[2] + dz};
        corner[k] = gradient(lattice_bits(at, 0), f[0] - dx, f[1] - dy, f[2] - dz);
    }
    double u = fade(f[0]), v = fade(f[1]), w = fade(f[2]);
    return mix(mix(mix(corner[0], corner[1], u), mix(corner[2], corner[3], u), v),
               mix(mix(corner[4], corner[5], u), mix(corner[6], corner[7], u), v), w);
}

static double noise_at(const double p[3], double frequency, double shift)
{
    const double q[3] = {p[0] * frequency + shift, p[1] * frequency - 2 * shift,
                         p[2] * frequency + 3 * shift};
    return noise(q);
}

// Returns the weight of details of this wavelength on a mesh of edge length `finest`: it increases
// from 0 at two edges per wavelength to 1 at four.
static double shown(double wavelength, double finest)
{
    double t = wavelength / (2 * finest) - 1;
    return t < 0 ? 0 : t > 1 ? 1 : t;
}

static void warp(const double p[3], double frequency, double amount, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = p[i] + amount * noise_at(p, frequency, 11.3 + 7.1 * i);
}

// Returns a sum of octaves of noise, or of ridged noise, each with half the height and twice the
// frequency of the previous one.
static double octaves(const double p[3], double frequency, int count, bool ridges, double finest)
{
    double sum = 0, height = 1;
    for (int i = 0; i < count; i++, frequency *= 2, height *= 0.5) {
        double n = noise_at(p, frequency, 3.7 * i);
        sum += height * shown(1 / frequency, finest) * (ridges ? 0.5 - fabs(n) : n);
    }
    return sum;
}

// Computes the distances to the nearest and to the second nearest point of a set with one point in
// each cell.
static void cells(const double p[3], double out[2])
{
    double base[3] = {floor(p[0]), floor(p[1]), floor(p[2])};
    out[0] = out[1] = INFINITY;
    for (int k = 0; k < 27; k++) {
        const double cell[3] = {base[0] + k % 3 - 1, base[1] + k / 3 % 3 - 1, base[2] + k / 9 - 1};
        double square = 0;
        for (uint32_t i = 0; i < 3; i++) {
            double d = cell[i] + lattice_bits(cell, 1 + i) * 0x1p-32 - p[i];
            square += d * d;
        }
        if (square < out[0]) {
            out[1] = out[0];
            out[0] = square;
        } else if (square < out[1]) {
            out[1] = square;
        }
    }
    out[0] = sqrt(out[0]);
    out[1] = sqrt(out[1]);
}

// Returns the height of a reptile's scales: domes with grooves between them.
static double scales(const double p[3], double size, double finest)
{
    double q[3], d[2];
    warp(p, 3, 0.05, q);
    for (int i = 0; i < 3; i++)
        q[i] /= size;
    cells(q, d);
    double groove = fmin(1, 4 * (d[1] - d[0]));
    return size * shown(size, finest) * (0.22 * groove * (2 - groove) - 0.18 * d[0]);
}

// Returns a wave of period 1 between -1 and 1, made of parabolas.
static double wave(double x)
{
    double u = 2 * (x - floor(x)) - 1;
    return 4 * u * (1 - fabs(u));
}

static double bone(const double p[3], double finest)
{
    double q[3];
    warp(p, 2.5, 0.12, q);
    // A suture: a thin groove along the zeros of a low-frequency noise.
    double seam = fabs(noise_at(q, 1.1, 5)) * 9;
    double suture = seam < 1 ? (1 - seam) * (1 - seam) : 0;
    return 0.012 * octaves(q, 2, 3, false, finest) + 0.008 * octaves(q, 6, 4, true, finest) -
           0.016 * suture * shown(0.12, finest);
}

double figure_detail(enum part_skin skin, const double p[3], double finest)
{
    double q[3];
    switch (skin) {
    case SKIN_BONE:
        return bone(p, finest);
    case SKIN_TOOTH:
        return 0.004 * octaves(p, 12, 2, false, finest);
    case SKIN_SCALES:
        return scales(p, 0.075, finest) + 0.35 * scales(p, 0.026, finest) +
               0.02 * octaves(p, 2.2, 2, false, finest);
    case SKIN_HORN:
        warp(p, 6, 0.03, q);
        return 0.007 * wave((q[0] - q[1] + q[2]) * 22) * shown(0.045, finest) +
               0.006 * octaves(p, 18, 3, true, finest);
    case SKIN_WEB:
        warp(p, 1.5, 0.25, q);
        return 0.012 * octaves(q, 3, 4, true, finest);
    case SKIN_FUR:
        warp(p, 4, 0.1, q);
        q[1] *= 0.3; // stretches the noise into strands
        return 0.03 * octaves(p, 2.5, 2, false, finest) + 0.02 * octaves(q, 14, 3, true, finest);
    case SKIN_PLAIN:
        break;
    }
    return 0;
}
