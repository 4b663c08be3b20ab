// Computes the tables of directional albedos and prints them as C. It runs on the machine that
// builds the program, not at start-up, because it takes seconds:
//
// albedo_generate > albedo_data.h
//
// All values are numerical quadratures of the formulas of docs/materials.md in double precision.
// The tables are interpolated linearly. If the interpolation is below the true value between nodes,
// the nodes are raised, so that the base below a layer never receives light that the layer has
// already reflected.
#include "base/maths.h"
#include "render/tables/albedo_integrals.h"
#include "shared/albedo.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t words[ALBEDO_WORDS][4];

static uint32_t float_bits(double value)
{
    float rounded = (float)value;
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    return bits;
}

// Packs a cell's words: the values at (0, 0), (1, 0), (0, 1), (1, 1).
static void fill_quads(uint32_t first, uint32_t width, uint32_t height,
                       double (*albedo)(double, double))
{
    // The values are computed at twice the resolution, so that those halfway between nodes are
    // known, too.
    uint32_t w = 2 * width + 1, h = 2 * height + 1;
    double *fine = calloc((size_t)w * h, sizeof *fine);
    double *raise = calloc((size_t)w * h, sizeof *raise);
    if (!fine || !raise)
        exit(1);
    for (uint32_t j = 0; j < h; j++)
        for (uint32_t i = 0; i < w; i++)
            fine[j * w + i] = albedo(0.5 * i / width, 0.5 * j / height);
    for (uint32_t j = 0; j < h; j++)
        for (uint32_t i = 0; i < w; i++) {
            uint32_t left = i & ~1u, right = (i + 1) & ~1u, low = j & ~1u, high = (j + 1) & ~1u;
            uint32_t corner[4] = {low * w + left, low * w + right, high * w + left,
                                  high * w + right};
            double mean =
                0.25 * (fine[corner[0]] + fine[corner[1]] + fine[corner[2]] + fine[corner[3]]);
            for (int c = 0; c < 4; c++)
                raise[corner[c]] = fmax(raise[corner[c]], fine[j * w + i] - mean);
        }
    for (uint32_t j = 0; j < height; j++)
        for (uint32_t i = 0; i < width; i++)
            for (uint32_t c = 0; c < 4; c++) {
                uint32_t at = 2 * (j + (c >> 1)) * w + 2 * (i + (c & 1));
                words[first + j * width + i][c] = float_bits(fine[at] + raise[at]);
            }
    free(fine);
    free(raise);
}

static void fill_diffuse(void)
{
    for (uint32_t i = 0; i <= ALBEDO_DIFFUSE_MU; i++) {
        double e[4];
        albedo_diffuse((double)i / ALBEDO_DIFFUSE_MU, e);
        // The values at roughnesses 0, 1/2 and 1 determine a polynomial of degree 2.
        words[ALBEDO_DIFFUSE + i][0] = float_bits(e[0]);
        words[ALBEDO_DIFFUSE + i][1] = float_bits(-3.0 * e[0] + 4.0 * e[1] - e[2]);
        words[ALBEDO_DIFFUSE + i][2] = float_bits(2.0 * e[0] - 4.0 * e[1] + 2.0 * e[2]);
        words[ALBEDO_DIFFUSE + i][3] = float_bits(e[3]);
    }
}

// A table whose cells have eight values of 16 bits; the first axis varies fastest. Each node of a
// fourth axis has a table of its own; these tables are interpolated if `blended` is set, and
// independent otherwise.
struct cubes {
    uint32_t first;
    uint32_t size[3];
    uint32_t slices; // nodes along the fourth axis
    bool blended;
    double (*albedo)(double x, double y, double z, double w);
};

static uint32_t cube_node(const struct cubes *c, uint32_t i, uint32_t j, uint32_t k, uint32_t l)
{
    return ((l * (c->size[2] + 1) + k) * (c->size[1] + 1) + j) * (c->size[0] + 1) + i;
}

// Raises the corners of cell (i, j, k, l) if the value interpolated at position `at` of the cell is
// below the true one.
static void raise_cube(const struct cubes *c, const uint32_t cell[4], const double at[4],
                       const double *node, double *raise)
{
    double p[4];
    for (int a = 0; a < 3; a++)
        p[a] = (cell[a] + at[a]) / c->size[a];
    p[3] = c->slices > 1 ? (cell[3] + at[3]) / (c->slices - 1) : 0.0;
    double deficit = c->albedo(p[0], p[1], p[2], p[3]);
    uint32_t corner[16];
    double weight[16];
    for (uint32_t b = 0; b < 16; b++) {
        weight[b] = 1.0;
        uint32_t n[4];
        for (uint32_t a = 0; a < 4; a++) {
            n[a] = cell[a] + (b >> a & 1);
            weight[b] *= b >> a & 1 ? at[a] : 1.0 - at[a];
        }
        corner[b] = cube_node(c, n[0], n[1], n[2], n[3]);
        if (weight[b] > 0.0)
            deficit -= weight[b] * node[corner[b]];
    }
    for (uint32_t b = 0; b < 16; b++)
        if (weight[b] > 0.0)
            raise[corner[b]] = fmax(raise[corner[b]], deficit);
}

static void store_cube(const struct cubes *c, const uint32_t cell[4], const double *node,
                       const double *raise)
{
    uint32_t *word =
        words[c->first + ((cell[3] * c->size[2] + cell[2]) * c->size[1] + cell[1]) * c->size[0] +
              cell[0]];
    for (uint32_t b = 0; b < 8; b++) {
        uint32_t n =
            cube_node(c, cell[0] + (b & 1), cell[1] + (b >> 1 & 1), cell[2] + (b >> 2), cell[3]);
        word[b / 2] |= (uint32_t)ceil(clamp01((node[n] + raise[n]) / ALBEDO_HIGHEST) * 65535.0)
                       << (16 * (b & 1));
    }
}

static void fill_cubes(const struct cubes *c)
{
    const uint32_t *size = c->size;
    uint32_t nodes = cube_node(c, size[0], size[1], size[2], c->slices - 1) + 1;
    double *node = calloc(nodes, sizeof *node);
    double *raise = calloc(nodes, sizeof *raise);
    if (!node || !raise)
        exit(1);
    for (uint32_t n = 0; n < nodes; n++) {
        uint32_t i = n % (size[0] + 1), rest = n / (size[0] + 1);
        uint32_t j = rest % (size[1] + 1), k = rest / (size[1] + 1) % (size[2] + 1);
        uint32_t l = rest / (size[1] + 1) / (size[2] + 1);
        node[n] = c->albedo((double)i / size[0], (double)j / size[1], (double)k / size[2],
                            c->slices > 1 ? (double)l / (c->slices - 1) : 0.0);
    }
    static const double middles[2][4] = {{0.5, 0.5, 0.5, 0.0}, {0.5, 0.5, 0.5, 0.5}};
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t n = 0; n < size[0] * size[1] * size[2] * c->slices; n++) {
            const uint32_t cell[4] = {n % size[0], n / size[0] % size[1],
                                      n / size[0] / size[1] % size[2],
                                      n / size[0] / size[1] / size[2]};
            if (pass == 1) {
                store_cube(c, cell, node, raise);
                continue;
            }
            raise_cube(c, cell, middles[0], node, raise);
            if (c->blended && cell[3] + 1 < c->slices)
                raise_cube(c, cell, middles[1], node, raise);
        }
    free(node);
    free(raise);
}

// A table of runs along the first axis, each with eight values of 16 bits. Results are divided by
// its values, which should therefore be right on average, because a path inside a ball meets its
// surface a dozen times. So nodes are moved against the error of linear interpolation, which is an
// eighth of the second difference halfway between two nodes, and a twelfth of it on average.
struct runs {
    uint32_t first;
    uint32_t size[3]; // cells
    double (*albedo)(double x, double y, double z, double w);
    double w;
};

static double fitted_node(const struct runs *r, const uint32_t at[3], const double *node)
{
    const uint32_t *size = r->size;
    const uint32_t stride[3] = {1, size[0] + 1, (size[0] + 1) * (size[1] + 1)};
    uint32_t n = at[2] * stride[2] + at[1] * stride[1] + at[0];
    double value = node[n];
    for (int axis = 0; axis < 3; axis++) {
        if (at[axis] == 0 || at[axis] == size[axis])
            continue;
        double bend = node[n - stride[axis]] - 2.0 * node[n] + node[n + stride[axis]];
        // A surface is seen at every mu, but a material has a single alpha and eta. So along alpha
        // and eta the greatest errors at the nodes and halfway between them are made equal.
        if (at[0] > ALBEDO_RUN)
            value -= bend / (axis == 0 ? 12.0 : 16.0);
        else if (axis > 0) // at grazing angles never below the true value, see fit_row()
            value -= fmin(0.0, bend / 8.0);
    }
    return value;
}

// Fits the nodes along mu at one node of each other axis. At grazing angles, where energies change
// by factors from cell to cell, the nodes of the first run are raised as by raise_cube(): little
// light leaves at these angles, and no energy must be gained.
static void fit_row(const struct runs *r, uint32_t j, uint32_t k, const double *node, double *row)
{
    double raise[ALBEDO_RUN + 1] = {0};
    for (uint32_t i = 0; i <= r->size[0]; i++) {
        const uint32_t at[3] = {i, j, k};
        row[i] = fitted_node(r, at, node);
    }
    for (uint32_t i = 0; i < 2 * ALBEDO_RUN; i++) {
        double w = i & 1 ? 0.5 : 0.2;
        double truth = r->albedo((i / 2 + w) / r->size[0], (double)j / r->size[1],
                                 (double)k / r->size[2], r->w);
        double deficit = truth - (1.0 - w) * row[i / 2] - w * row[i / 2 + 1];
        for (uint32_t end = i / 2; end <= i / 2 + 1; end++)
            raise[end] = fmax(raise[end], deficit);
    }
    for (uint32_t i = 0; i <= ALBEDO_RUN; i++)
        row[i] += raise[i];
}

static void fill_runs(const struct runs *r)
{
    const uint32_t *size = r->size;
    uint32_t width = size[0] + 1, height = size[1] + 1, depth = size[2] + 1;
    double *node = calloc((size_t)width * height * depth, sizeof *node);
    double *row = calloc(width, sizeof *row);
    if (!node || !row)
        exit(1);
    for (uint32_t n = 0; n < width * height * depth; n++)
        node[n] = r->albedo((double)(n % width) / size[0], (double)(n / width % height) / size[1],
                            (double)(n / width / height) / size[2], r->w);
    for (uint32_t n = 0; n < height * depth; n++) {
        fit_row(r, n % height, n / height, node, row);
        for (uint32_t i = 0; i < size[0] / ALBEDO_RUN * 8; i++) {
            uint32_t word = r->first + n * (size[0] / ALBEDO_RUN) + i / 8;
            double value = clamp01(row[i / 8 * ALBEDO_RUN + i % 8] / ALBEDO_HIGHEST);
            words[word][i % 8 / 2] |= (uint32_t)(value * 65535.0 + 0.5) << (16 * (i & 1));
        }
    }
    free(node);
    free(row);
}

// --- five axes -----------------------------------------------------------------------------------

static const uint32_t turned_cells[5] = {ALBEDO_TURNED_GLASS_MU, ALBEDO_TURNED_GLASS_ROUGHNESS,
                                         ALBEDO_TURNED_GLASS_ASPECT, ALBEDO_TURNED_GLASS_AZIMUTH,
                                         ALBEDO_TURNED_GLASS_ETA};

static uint32_t turned_node(const uint32_t at[5])
{
    uint32_t n = 0;
    for (int axis = 4; axis >= 0; axis--)
        n = n * (turned_cells[axis] + 1) + at[axis];
    return n;
}

// Fits a node to be right on average along all axes, as fitted_node() does. Nodes beyond the ends
// of the azimuth axis are mirror images.
static double fitted_turned(const uint32_t at[5], const double *node)
{
    double here = node[turned_node(at)], value = here;
    for (int axis = 0; axis < 5; axis++) {
        uint32_t low[5], high[5], last = turned_cells[axis];
        if (axis != 3 && (at[axis] == 0 || at[axis] == last))
            continue;
        memcpy(low, at, sizeof low);
        memcpy(high, at, sizeof high);
        low[axis] = at[axis] > 0 ? at[axis] - 1 : 1;
        high[axis] = at[axis] < last ? at[axis] + 1 : last - 1;
        value -= (node[turned_node(low)] - 2.0 * here + node[turned_node(high)]) / 12.0;
    }
    return value;
}

static void store_turned(uint32_t first, const uint32_t at[5], double value)
{
    uint32_t row = turned_cells[0] / ALBEDO_RUN, word = at[4];
    for (int axis = 3; axis > 0; axis--)
        word = word * (turned_cells[axis] + 1) + at[axis];
    uint32_t bits =
        (uint32_t)(clamp01(0.5 + 0.5 * value / ALBEDO_TURNED_GLASS_LOG) * 65535.0 + 0.5);
    // Neighbouring runs share the node where they meet.
    for (uint32_t run = 0; run < row; run++) {
        uint32_t place = at[0] - run * ALBEDO_RUN;
        if (place <= ALBEDO_RUN)
            words[first + word * row + run][place / 2] |= bits << (16 * (place & 1));
    }
}

static void fill_turned_glass(uint32_t first, int inside)
{
    uint32_t at[5] = {0}, nodes = turned_node(turned_cells) + 1;
    double *node = calloc(nodes, sizeof *node);
    if (!node)
        exit(1);
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t n = 0; n < nodes; n++) {
            double place[5];
            for (uint32_t axis = 0, rest = n; axis < 5; axis++) {
                at[axis] = rest % (turned_cells[axis] + 1);
                rest /= turned_cells[axis] + 1;
                place[axis] = (double)at[axis] / turned_cells[axis];
            }
            if (pass == 0)
                node[n] = turned_glass(place, inside);
            else
                store_turned(first, at, fitted_turned(at, node));
        }
    free(node);
}

int main(void)
{
    fill_quads(ALBEDO_GGX, ALBEDO_GGX_MU, ALBEDO_GGX_ALPHA, albedo_ggx);
    fill_quads(ALBEDO_SCHLICK, ALBEDO_SCHLICK_MU, ALBEDO_SCHLICK_ALPHA, albedo_schlick);
    fill_quads(ALBEDO_CHARLIE, ALBEDO_CHARLIE_MU, ALBEDO_CHARLIE_ROUGHNESS, albedo_charlie);
    fill_quads(ALBEDO_COAT, ALBEDO_COAT_MU, ALBEDO_COAT_GLOSS, albedo_coat);
    fill_quads(ALBEDO_COAT_EXACT, ALBEDO_COAT_MU, ALBEDO_COAT_GLOSS, albedo_coat_exact);
    fill_diffuse();
    static const struct cubes cubes[] = {
        {.first = ALBEDO_FRESNEL,
         .size = {ALBEDO_FRESNEL_MU, ALBEDO_FRESNEL_ALPHA, ALBEDO_FRESNEL_ETA},
         .slices = 2,
         .albedo = albedo_fresnel},
        {.first = ALBEDO_TURNED,
         .size = {ALBEDO_TURNED_MU, ALBEDO_TURNED_ROUGHNESS, ALBEDO_TURNED_ASPECT},
         .slices = ALBEDO_TURNED_AZIMUTH + 1u,
         .blended = true,
         .albedo = albedo_anisotropic},
        {.first = ALBEDO_SINE,
         .size = {ALBEDO_SINE_MU, ALBEDO_SINE_ROUGHNESS, ALBEDO_SINE_ASPECT},
         .slices = ALBEDO_SINE_AZIMUTH + 1u,
         .blended = true,
         .albedo = albedo_anisotropic_sine},
    };
    for (uint32_t i = 0; i < sizeof cubes / sizeof *cubes; i++)
        fill_cubes(&cubes[i]);
    static const struct runs runs[] = {
        {.first = ALBEDO_GLASS,
         .size = {ALBEDO_GLASS_MU, ALBEDO_GLASS_ALPHA, ALBEDO_GLASS_ETA},
         .albedo = glass_outside},
        {.first = ALBEDO_GLASS_INSIDE,
         .size = {ALBEDO_GLASS_INSIDE_MU, ALBEDO_GLASS_INSIDE_ALPHA, ALBEDO_GLASS_INSIDE_ETA},
         .albedo = glass_inside},
        {.first = ALBEDO_CLEAR,
         .size = {ALBEDO_CLEAR_MU, ALBEDO_CLEAR_ALPHA, ALBEDO_CLEAR_ETA},
         .albedo = clear_glass},
        {.first = ALBEDO_CLEAR + ALBEDO_CLEAR_SIDE,
         .size = {ALBEDO_CLEAR_MU, ALBEDO_CLEAR_ALPHA, ALBEDO_CLEAR_ETA},
         .albedo = clear_glass,
         .w = 1.0},
    };
    for (uint32_t i = 0; i < sizeof runs / sizeof *runs; i++)
        fill_runs(&runs[i]);
    fill_turned_glass(ALBEDO_TURNED_GLASS, 0);
    fill_turned_glass(ALBEDO_TURNED_GLASS + ALBEDO_TURNED_GLASS_SIDE, 1);
    for (uint32_t i = 0; i < ALBEDO_FRESNEL; i++)
        for (int c = 0; c < 4; c++)
            if ((words[i][c] & 0x7f800000u) == 0x7f800000u)
                return 1; // a value is not finite
    for (uint32_t i = 0; i < ALBEDO_WORDS; i++)
        if (printf("{0x%x,0x%x,0x%x,0x%x},\n", words[i][0], words[i][1], words[i][2], words[i][3]) <
            0)
            return 1;
    return fflush(stdout) == 0 ? 0 : 1;
}
