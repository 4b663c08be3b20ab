#include "scene/sky/ies.h"

#include "base/hash.h"
#include "base/maths.h"
#include "scene/core/text.h"
#include <math.h>
#include <string.h>

enum { TYPE_C = 1, TYPE_B, TYPE_A };

struct ies_parser {
    struct arena *arena;
    struct text_reader text;
    uint32_t vertical_count, horizontal_count; // as given by the file
    float *vertical, *horizontal, *candela;
    double factor; // factor on the candela values
};

// --- numbers ------------------------------------------------------------------------------------

// Reads a number. After the line TILT, commas separate numbers as blanks do.
static bool take_number(struct ies_parser *p, const char *what, double min, double max, double *out,
                        struct err *err)
{
    float value;
    text_skip_space(&p->text);
    struct text_reader start = p->text;
    if (!text_float(&p->text, what, &value, err))
        return false;
    *out = (double)value;
    if (*out >= min && *out <= max)
        return true;
    return text_fail(&start, err, "%s is %.9g; expected a number in [%g, %g]", what, *out, min,
                     max);
}

static bool take_count(struct ies_parser *p, const char *what, int64_t max, uint32_t *out,
                       struct err *err)
{
    int64_t value;
    text_skip_space(&p->text);
    struct text_reader start = p->text;
    if (!text_integer(&p->text, what, &value, err))
        return false;
    if (value < 1 || value > max)
        return text_fail(&start, err, "%s is %lld; expected 1 to %lld", what, (long long)value,
                         (long long)max);
    *out = (uint32_t)value;
    return true;
}

static bool skip_numbers(struct ies_parser *p, const char *what, uint32_t count, struct err *err)
{
    double unused;
    for (uint32_t i = 0; i < count; i++)
        if (!take_number(p, what, -1e30, 1e30, &unused, err))
            return false;
    return true;
}

// --- the parts of a file ------------------------------------------------------------------------

// Skips keywords up to the line TILT=. The values of TILT=INCLUDE, which are factors for positions
// of the lamp, are read and ignored.
static bool read_tilt(struct ies_parser *p, struct err *err)
{
    for (;; text_next_line(&p->text)) {
        if (text_remaining(&p->text) == 0)
            return text_fail(&p->text, err, "the line \"TILT=\" is missing");
        struct text_span line = text_rest_of_line(&p->text);
        if (line.size >= 5 && memcmp(line.data, "TILT=", 5) == 0)
            break;
    }
    struct text_span line = text_rest_of_line(&p->text);
    struct text_span value = {line.data + 5, line.size - 5};
    bool include = text_equals(value, "INCLUDE");
    if (!include && !text_equals(value, "NONE"))
        return text_unexpected(&p->text, "TILT=NONE or TILT=INCLUDE", err);
    text_next_line(&p->text);
    uint32_t pairs;
    return !include || (skip_numbers(p, "the lamp's geometry", 1, err) &&
                        take_count(p, "the number of tilt angles", IES_ANGLES_MAX, &pairs, err) &&
                        skip_numbers(p, "a tilt angle or multiplier", 2 * pairs, err));
}

static bool read_dimensions(struct ies_parser *p, struct err *err)
{
    double multiplier, ballast, ballast_lamp;
    uint32_t type;
    if (!skip_numbers(p, "the number of lamps, or their lumens", 2, err) ||
        !take_number(p, "the candela multiplier", 0, 1e30, &multiplier, err) ||
        !take_count(p, "the number of vertical angles", IES_ANGLES_MAX, &p->vertical_count, err) ||
        !take_count(p, "the number of horizontal angles", IES_ANGLES_MAX, &p->horizontal_count,
                    err))
        return false;
    text_skip_space(&p->text);
    struct text_reader start = p->text;
    if (!take_count(p, "the photometric type", TYPE_A, &type, err))
        return false;
    if (type != TYPE_C)
        return text_fail(&start, err, "photometric type %u (%s); expected 1 (C)", type,
                         type == TYPE_B ? "B" : "A");
    if ((uint64_t)p->vertical_count * p->horizontal_count > IES_VALUES_MAX)
        return text_fail(&start, err, "%u x %u angles are too many; expected at most %d values",
                         p->vertical_count, p->horizontal_count, IES_VALUES_MAX);
    if (!skip_numbers(p, "the units, or a dimension of the luminaire", 4, err) ||
        !take_number(p, "the ballast factor", 0, 1e6, &ballast, err) ||
        !take_number(p, "the ballast-lamp factor", 0, 1e6, &ballast_lamp, err) ||
        !skip_numbers(p, "the input watts", 1, err))
        return false;
    p->factor = multiplier * ballast * ballast_lamp;
    return true;
}

static bool read_angles(struct ies_parser *p, const char *what, double max, uint32_t count,
                        float **out, struct err *err)
{
    float *angles = *out = ARENA_NEW(p->arena, float, count);
    if (!angles)
        return err_memory(err, "angles", (uint64_t)count * sizeof *angles);
    for (uint32_t i = 0; i < count; i++) {
        double angle;
        text_skip_space(&p->text);
        struct text_reader start = p->text;
        if (!take_number(p, what, 0, max, &angle, err))
            return false;
        angles[i] = (float)angle;
        if (i > 0 && !(angles[i] > angles[i - 1]))
            return text_fail(&start, err, "%s %.9g follows %.9g; expected ascending angles", what,
                             angle, (double)angles[i - 1]);
    }
    return true;
}

static bool read_candela(struct ies_parser *p, struct err *err)
{
    uint64_t count = (uint64_t)p->vertical_count * p->horizontal_count;
    p->candela = ARENA_NEW(p->arena, float, count);
    if (!p->candela)
        return err_memory(err, "candela values", count * sizeof *p->candela);
    for (uint64_t i = 0; i < count; i++) {
        double value;
        if (!take_number(p, "a candela value", 0, 1e30, &value, err))
            return false;
        p->candela[i] = (float)value;
    }
    return true;
}

// --- symmetry -----------------------------------------------------------------------------------

// Appends a plane at `angle`, a copy of plane `plane` of the file.
static void add_plane(const struct ies_parser *p, struct light_profile *out, double angle,
                      uint32_t plane)
{
    uint32_t at = out->horizontal_count++, row = p->vertical_count;
    out->horizontal[at] = (float)angle;
    memcpy(&out->relative[(size_t)at * row], &p->candela[(size_t)plane * row],
           row * sizeof *p->candela);
}

static void mirror_about(const struct ies_parser *p, struct light_profile *out, double angle)
{
    for (uint32_t i = p->horizontal_count; i-- > 0;) {
        double mirrored = 2 * angle - (double)p->horizontal[i];
        if (mirrored > (double)out->horizontal[out->horizontal_count - 1])
            add_plane(p, out, mirrored, i);
    }
}

// Completes a profile given for a quarter circle, which is mirrored twice.
static void add_quarter(const struct ies_parser *p, struct light_profile *out)
{
    mirror_about(p, out, 90);
    for (uint32_t i = 1; i < p->horizontal_count; i++)
        add_plane(p, out, 180 + (double)p->horizontal[i], i);
    mirror_about(p, out, 180);
}

// Completes a profile given from 90 to 270 degrees, which is mirrored about the 90-270 plane.
static void add_side_half(const struct ies_parser *p, struct light_profile *out)
{
    uint32_t count = p->horizontal_count;
    for (uint32_t i = count; i-- > 0;)
        if ((double)p->horizontal[i] <= 180)
            add_plane(p, out, 180 - (double)p->horizontal[i], i);
    for (uint32_t i = 1; i < count; i++)
        add_plane(p, out, (double)p->horizontal[i], i);
    for (uint32_t i = count - 1; i-- > 0;)
        if ((double)p->horizontal[i] >= 180)
            add_plane(p, out, 540 - (double)p->horizontal[i], i);
}

static bool has_plane(const struct ies_parser *p, double angle)
{
    for (uint32_t i = 0; i < p->horizontal_count; i++)
        if ((double)p->horizontal[i] == angle)
            return true;
    return false;
}

static bool expand(struct ies_parser *p, struct light_profile *out, struct err *err)
{
    uint32_t count = p->horizontal_count;
    double first = (double)p->horizontal[0], last = (double)p->horizontal[count - 1];
    uint64_t planes = 4 * (uint64_t)count + 1;
    out->horizontal = ARENA_NEW(p->arena, float, planes);
    out->relative = ARENA_NEW(p->arena, float, planes * p->vertical_count);
    if (!out->horizontal || !out->relative)
        return err_memory(err, "a profile", planes * p->vertical_count * sizeof *out->relative);
    bool side = first == 90 && last == 270 && has_plane(p, 180);
    bool all_round = last > 180 && last <= 360;
    bool known = count == 1 || side || (first == 0 && (last == 90 || last == 180 || all_round));
    if (!known)
        return text_fail(&p->text, err,
                         "horizontal angles from %g to %g; expected 0 alone, 0 to 90, 0 to 180, 90 "
                         "to 270 including 180, or 0 to 360",
                         first, last);
    if (side) {
        add_side_half(p, out);
    } else {
        for (uint32_t i = 0; i < count; i++)
            add_plane(p, out, (double)p->horizontal[i], i);
        if (count > 1 && last == 90)
            add_quarter(p, out);
        else if (count > 1 && last == 180)
            mirror_about(p, out, 180);
    }
    // If the last plane is below 360 degrees, the first plane is repeated at 360 degrees.
    uint32_t n = out->horizontal_count;
    if (n > 1 && out->horizontal[n - 1] < 360) {
        memcpy(&out->relative[(size_t)n * p->vertical_count], out->relative,
               p->vertical_count * sizeof *out->relative);
        out->horizontal[out->horizontal_count++] = 360;
    }
    return true;
}

// --- values -------------------------------------------------------------------------------------

// Returns the exact integral of the profile, which is bilinear in the angles, over the sphere.
static double solid_angle(const struct light_profile *p)
{
    double sum = 0;
    for (uint32_t h = 0; h < p->horizontal_count; h++) {
        const float *row = &p->relative[(size_t)h * p->vertical_count];
        double width = 360, strip = 0;
        if (p->horizontal_count > 1) {
            uint32_t after = h + 1 < p->horizontal_count ? h + 1 : h, before = h > 0 ? h - 1 : 0;
            width = ((double)p->horizontal[after] - (double)p->horizontal[before]) / 2;
        }
        for (uint32_t v = 0; v + 1 < p->vertical_count; v++) {
            double a = (double)p->vertical[v] * DEGREE;
            double b = (double)p->vertical[v + 1] * DEGREE;
            double slope = ((double)row[v + 1] - (double)row[v]) / (b - a);
            strip +=
                (double)row[v] * cos(a) - (double)row[v + 1] * cos(b) + slope * (sin(b) - sin(a));
        }
        sum += width * DEGREE * strip;
    }
    return sum;
}

static bool normalize(struct ies_parser *p, struct light_profile *out, struct err *err)
{
    size_t count = (size_t)out->horizontal_count * out->vertical_count;
    float greatest = 0;
    for (size_t i = 0; i < count; i++)
        greatest = fmaxf(greatest, out->relative[i]);
    out->greatest = (double)greatest * p->factor / LUMENS_A_WATT;
    if (!(out->greatest <= SCENE_RADIANCE_MAX))
        return text_fail(&p->text, err, "makes the intensity %.9g W/sr; expected at most %g",
                         out->greatest, SCENE_RADIANCE_MAX);
    for (size_t i = 0; i < count && greatest > 0; i++)
        out->relative[i] /= greatest;
    out->solid_angle = solid_angle(out);
    return true;
}

// --- loading ------------------------------------------------------------------------------------

static bool parse(struct ies_parser *p, struct light_profile *out, struct err *err)
{
    if (!read_tilt(p, err) || !read_dimensions(p, err) ||
        !read_angles(p, "a vertical angle", 180, p->vertical_count, &p->vertical, err) ||
        !read_angles(p, "a horizontal angle", 360, p->horizontal_count, &p->horizontal, err) ||
        !read_candela(p, err))
        return false;
    out->vertical_count = p->vertical_count;
    out->vertical = p->vertical;
    return expand(p, out, err) && normalize(p, out, err);
}

bool ies_load(struct scene *scene, const char *path, const struct light_profile **out,
              struct err *err)
{
    for (const struct light_profile *known = scene->profiles; known; known = known->next) {
        *out = known;
        if (strcmp(known->path, path) == 0)
            return true;
    }
    struct file_bytes bytes;
    if (!file_read(&scene->arena, path, 0, &bytes, err))
        return false;
    scene->hash = hash_bytes(scene->hash, bytes.data, bytes.size);
    char *text = arena_alloc(&scene->arena, bytes.size + 1, 1);
    struct light_profile *profile = ARENA_NEW(&scene->arena, struct light_profile, 1);
    if (!text || !profile)
        return err_memory(err, "a profile", bytes.size);
    for (size_t i = 0; i < bytes.size; i++)
        text[i] = bytes.data[i] == ',' ? ' ' : (char)bytes.data[i];
    const struct file_bytes spaced = {.data = (const uint8_t *)text, .size = bytes.size};
    struct ies_parser parser = {.arena = &scene->arena, .text = text_open(path, &spaced)};
    profile->path = arena_strdup(&scene->arena, path);
    if (!profile->path)
        return err_memory(err, "a path", strlen(path));
    if (!parse(&parser, profile, err))
        return false;
    profile->next = scene->profiles;
    scene->profiles = *out = profile;
    return true;
}
