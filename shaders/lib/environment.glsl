// Evaluates and samples the environment, which is constant radiance or a latitude-longitude image.
// Reads the environment's buffer, see render/tables/environment_table.h.
#ifndef ENVIRONMENT_GLSL
#define ENVIRONMENT_GLSL

#include "lib/angle.glsl"
#include "lib/buffers.glsl"

uvec2 environment_size()
{
    return uvec2(frame.environment_size & 0xffffu, frame.environment_size >> 16u);
}

// Returns the index of the texel that contains a unit direction of the image; see
// scene/core/environment.h for the convention. The latitude is the arctangent of the distance from
// the axis, because near a pole the height is inaccurate.
uint environment_texel(vec3 direction, uvec2 size)
{
    float u = 0.5 + atan_turns(direction.z, direction.x);
    float v = 2.0 * atan_turns(length(direction.xz), direction.y);
    uvec2 texel = min(uvec2(vec2(u, v) * vec2(size)), size - 1u);
    return texel.y * size.x + texel.x;
}

// Returns 1 - cos of an angle of at most half a turn, without cancellation.
float versine_turns(float turns)
{
    float s = sin_small(0.5 * turns);
    return 2.0 * s * s;
}

// --- cells between the centres of texels ---------------------------------------------------------

// A position in a cell. Rows of cells are counted from the zenith. node_versine() and cell_part()
// count them from the nearer pole, so that small angles from the pole are accurate.
struct environment_place {
    uvec2 cell;
    vec2 part;  // fraction of the way to the right and to the next row, by angle
    float down; // fraction of the way to the next row, by solid angle
};

// Returns 1 - cos of the angle between the nearer pole and the nodes of a row.
float node_versine(uint row, uint height)
{
    return versine_turns(0.5 * clamp((float(row) - 0.5) / float(height), 0.0, 1.0));
}

// Returns the fraction of the way through a row of cells, from the edge nearer to the pole;
// `texels` is the distance from that pole in texels.
float cell_part(float texels, uint row)
{
    return clamp(row == 0u ? 2.0 * texels : texels + 0.5 - float(row), 0.0, 1.0);
}

// Returns the position in cells of a unit direction of the image.
environment_place environment_place_of(vec3 direction, uvec2 size)
{
    environment_place p;
    float x = (0.5 + atan_turns(direction.z, direction.x)) * float(size.x) - 0.5;
    p.part.x = x - floor(x);
    p.cell.x = x < 0.0 ? size.x - 1u : min(uint(x), size.x - 1u);
    float radius = length(direction.xz);
    float y = 2.0 * atan_turns(radius, abs(direction.y)) * float(size.y);
    uint row = uint(y + 0.5);
    p.part.y = cell_part(y, row);
    float inner = node_versine(row, size.y), outer = node_versine(row + 1u, size.y);
    float versine = radius * radius / (1.0 + abs(direction.y));
    p.down = clamp((versine - inner) / (outer - inner), 0.0, 1.0);
    p.cell.y = row;
    if (direction.y < 0.0) {
        p.cell.y = size.y - row;
        p.part.y = 1.0 - p.part.y;
        p.down = 1.0 - p.down;
    }
    return p;
}

struct environment_cell {
    vec4 upper_left, upper_right, lower_left, lower_right; // see render/tables/environment_table.h
};

environment_cell load_environment_cell(uvec2 cell, uvec2 size)
{
    uint row = cell.y * size.x, right = cell.x + 1u < size.x ? cell.x + 1u : 0u;
    environment_cell c;
    c.upper_left = load_environment_float(row + cell.x);
    c.upper_right = load_environment_float(row + right);
    c.lower_left = load_environment_float(row + size.x + cell.x);
    c.lower_right = load_environment_float(row + size.x + right);
    return c;
}

// Returns the luminances of a cell's corners that exceed frame.environment_floor, by which the cell
// is sampled: upper left, upper right, lower left, lower right.
vec4 cell_luminances(environment_cell c)
{
    vec3 weights = vec3(0.2126, 0.7152, 0.0722) * frame.environment; // BT.709
    vec4 all = vec4(dot(c.upper_left.rgb, weights), dot(c.upper_right.rgb, weights),
                    dot(c.lower_left.rgb, weights), dot(c.lower_right.rgb, weights));
    return max(all - frame.environment_floor, 0.0);
}

vec3 cell_radiance(environment_cell c, vec2 part)
{
    return mix(mix(c.upper_left.rgb, c.upper_right.rgb, part.x),
               mix(c.lower_left.rgb, c.lower_right.rgb, part.x), part.y);
}

// Returns the density per solid angle at a position in a cell.
float cell_density(environment_cell c, vec4 luminances, float right, float down)
{
    vec2 across = mix(luminances.xz, luminances.yw, right);
    float mean = 0.25 * (luminances.x + luminances.y + luminances.z + luminances.w);
    // This order of operations avoids subnormal results, which some devices flush to 0.
    return mean > 0.0 ? c.upper_left.a * (mix(across.x, across.y, down) / mean) : 0.0;
}

// -------------------------------------------------------------------------------------------------

// Returns the radiance that arrives from a unit direction, without the factor of the whole image;
// and in w the density per solid angle with which sample_environment() samples it. The density is
// that of the rounded probability of the texel or cell.
vec4 load_environment_at(vec3 direction)
{
    float c = frame.environment_cos, s = frame.environment_sin;
    vec3 turned = vec3(c * direction.x - s * direction.z, direction.y,
                       s * direction.x + c * direction.z);
    uvec2 size = environment_size();
    if (ENVIRONMENT_FILTER == ENVIRONMENT_FILTER_NEAREST)
        return load_environment_float(environment_texel(turned, size));
    environment_place place = environment_place_of(turned, size);
    environment_cell cell = load_environment_cell(place.cell, size);
    return vec4(cell_radiance(cell, place.part),
                cell_density(cell, cell_luminances(cell), place.part.x, place.down));
}

// Returns the radiance that arrives from a unit direction.
vec3 environment_radiance(vec3 direction)
{
    if (!HAS(FEATURE_ENVIRONMENT_IMAGE))
        return frame.environment;
    return frame.environment * load_environment_at(direction).rgb;
}

// --- sampling ------------------------------------------------------------------------------------

// Returns the number of words in one level of a table of `count` thresholds. The level below has
// one word for each component of a word.
uint table_level_words(uint count, uint level)
{
    uint shift = 2u * level + 2u;
    return ((count - 1u) >> shift) + 1u;
}

uint table_levels(uint count)
{
    return count > 1u ? uint(findMSB(count - 1u)) / 2u + 1u : 1u;
}

uint table_words(uint count)
{
    uint words = 0u;
    for (uint level = 0u; level < table_levels(count); level++)
        words += table_level_words(count, level);
    return words;
}

// Returns the last of `count` bins whose threshold is at most u.x, in the table that begins at word
// `at`. within: position of u in the bin, from 0 to 1. u.y: the 16 bits that follow u.x.
uint search_table(uint at, uint count, uvec2 u, out float within)
{
    uint bin = 0u, low = 0u, high = 0xffffffffu;
    for (uint level = table_levels(count); level-- > 0u;) {
        uvec4 thresholds = load_environment(at + bin);
        at += table_level_words(count, level);
        bvec3 above = greaterThanEqual(u.xxx, thresholds.yzw);
        low = above.z ? thresholds.w : above.y ? thresholds.z : above.x ? thresholds.y
                                                                        : thresholds.x;
        high = above.z ? high : above.y ? thresholds.w : above.x ? thresholds.z : thresholds.y;
        bin = 4u * bin + (above.z ? 3u : above.y ? 2u : above.x ? 1u : 0u);
    }
    within = (float(u.x - low) + (float(u.y) + 0.5) * 1.52587890625e-5) / float(high - low);
    return bin;
}

// Combines a uniform number of 24 bits with another one that supplies further bits, into 32 bits
// and 16 more. The greatest number of 32 bits is not returned, because it marks the end of a table.
uvec2 long_uniform(float u, float extra)
{
    uint more = uint(extra * 16777216.0);
    return uvec2(min(uint(u * 16777216.0) << 8u | more >> 16u, 0xfffffffeu), more & 0xffffu);
}

// Returns a unit direction of the image. versine: 1 - cos of the angle from the upper or the lower
// pole; turns: the longitude.
vec3 environment_direction(bool below, float versine, float turns)
{
    float radius = sqrt(versine * (2.0 - versine));
    vec2 around = radius * cos_sin_turns(turns);
    return vec3(around.x, below ? versine - 1.0 : 1.0 - versine, around.y);
}

// Returns a direction in a texel; `within` are fractions of the way through the texel, uniform by
// solid angle.
vec3 direction_in_texel(uvec2 texel, vec2 within, uvec2 size)
{
    // Angles are measured from the nearer pole, so that small ones are accurate.
    bool below = 2u * texel.y >= size.y;
    uint row = below ? size.y - 1u - texel.y : texel.y;
    float part = below ? 1.0 - within.y : within.y;
    float inner = versine_turns(float(row) / float(2u * size.y));
    float outer = versine_turns(float(row + 1u) / float(2u * size.y));
    return environment_direction(below, mix(inner, outer, part),
                                 (float(texel.x) + within.x) / float(size.x) - 0.5);
}

// Samples the distribution on [0, 1] with linear density, proportional to `first` at 0 and to
// `last` at 1, by inversion: solves first x + (last - first) x^2 / 2 = u (first + last) / 2 without
// cancellation.
float sample_linear(float u, float first, float last)
{
    float total = first + last;
    float a = total > 0.0 ? first / total : 0.5, b = 1.0 - a;
    return min(u / (a + sqrt(mix(a * a, b * b, u))), 1.0);
}

// Samples a direction in a cell in proportion to the cell's density, by two uniforms: first the
// position in the vertical direction, then in the horizontal one. Returns the density.
float sample_environment_cell(uvec2 cell, vec2 within, uvec2 size, out vec3 direction,
                              out vec3 radiance)
{
    environment_cell c = load_environment_cell(cell, size);
    vec4 l = cell_luminances(c);
    float down = sample_linear(within.y, l.x + l.y, l.z + l.w);
    vec2 ends = mix(l.xy, l.zw, down);
    float right = sample_linear(within.x, ends.x, ends.y);
    bool below = 2u * cell.y > size.y;
    uint row = below ? size.y - cell.y : cell.y;
    float versine = mix(node_versine(row, size.y), node_versine(row + 1u, size.y),
                        below ? 1.0 - down : down);
    direction = environment_direction(below, versine,
                                      (float(cell.x) + 0.5 + right) / float(size.x) - 0.5);
    float y = below ? -direction.y : direction.y;
    float part = cell_part(2.0 * atan_turns(length(direction.xz), y) * float(size.y), row);
    radiance = cell_radiance(c, vec2(right, below ? 1.0 - part : part));
    return cell_density(c, l, right, down);
}

// Samples a direction in proportion to the image's luminance, by two uniforms and two more with
// further bits: first a row, then a texel or cell in it, both by inversion, which preserves
// stratification. Returns the density per solid angle; 0 if there is nothing to sample.
float sample_environment(vec2 u, vec2 u_extra, out vec3 direction, out vec3 radiance)
{
    uvec2 size = environment_size(), bin;
    bool bilinear = ENVIRONMENT_FILTER == ENVIRONMENT_FILTER_BILINEAR;
    uint rows = bilinear ? size.y + 1u : size.y;
    vec2 within;
    uint rows_at = size.x * (bilinear ? size.y + 2u : size.y);
    bin.y = search_table(rows_at, rows, long_uniform(u.x, u_extra.x), within.y);
    uint row_at = rows_at + table_words(rows) + bin.y * table_words(size.x);
    bin.x = search_table(row_at, size.x, long_uniform(u.y, u_extra.y), within.x);
    vec3 d;
    float pdf;
    if (bilinear) {
        pdf = sample_environment_cell(bin, within, size, d, radiance);
    } else {
        d = direction_in_texel(bin, within, size);
        vec4 found = load_environment_float(bin.y * size.x + bin.x);
        radiance = found.rgb;
        pdf = found.a;
    }
    radiance *= frame.environment;
    float c = frame.environment_cos, s = frame.environment_sin;
    direction = vec3(c * d.x + s * d.z, d.y, c * d.z - s * d.x);
    return pdf;
}

#endif
