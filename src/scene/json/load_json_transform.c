// The "transform" of a shape: a step, or a list of steps in the order in which they apply.
#include "scene/json/load_json.h"

#include "base/maths.h"
#include "scene/core/affine.h"
#include <math.h>
#include <string.h>

static bool read_rotation(const struct json_node *node, double out[3][4], struct err *err)
{
    static const char *const required[] = {"axis", "degrees", NULL};
    static const char *const optional[] = {NULL};
    double axis[3], degrees;
    if (!node_check_object(node, required, optional, err) ||
        !node_read_vector(node, "axis", RANGE_COORDINATE, axis, err) ||
        !node_read_number(node, "degrees", RANGE_COORDINATE, &degrees, err))
        return false;
    // The angle is reduced exactly in degrees, so that multiples of 360 are no rotation.
    const struct json_node axis_node = node_member(node, "axis");
    return affine_rotation(axis, fmod(degrees, 360) * DEGREE, out) ||
           node_fail(&axis_node, err, "is zero; expected a direction");
}

static bool read_scale(const struct json_node *transform, double out[3][4], struct err *err)
{
    double scale[3];
    const struct json_node node = node_member(transform, "scale");
    if (json_is_array(node.value)) {
        if (!node_numbers(&node, 3, RANGE_COORDINATE, scale, err))
            return false;
    } else {
        if (!node_read_number(transform, "scale", RANGE_COORDINATE, &scale[0], err))
            return false;
        scale[1] = scale[2] = scale[0];
    }
    for (int i = 0; i < 3; i++)
        out[i][i] = scale[i];
    return true;
}

static bool read_matrix(const struct json_node *node, double out[3][4], struct err *err)
{
    double elements[16];
    if (!node_numbers(node, 16, RANGE_COORDINATE, elements, err))
        return false;
    memcpy(out, elements, 12 * sizeof elements[0]);
    if (elements[12] == 0 && elements[13] == 0 && elements[14] == 0 && elements[15] == 1)
        return true;
    return node_fail(node, err, "the last row is %.9g %.9g %.9g %.9g; expected 0 0 0 1",
                     elements[12], elements[13], elements[14], elements[15]);
}

// Reads an object with exactly one of the four kinds of steps.
static bool read_transform_step(const struct json_node *node, double out[3][4], struct err *err)
{
    static const char *const required[] = {NULL};
    static const char *const kinds[] = {"translate", "rotate", "scale", "matrix", NULL};
    if (!node_check_object(node, required, kinds, err))
        return false;
    const char *given = NULL;
    for (const char *const *kind = kinds; *kind; kind++) {
        if (!node_member(node, *kind).value)
            continue;
        if (given)
            return node_fail(node, err,
                             "both \"%s\" and \"%s\" are given; put them into a list, in the order "
                             "in which they apply",
                             given, *kind);
        given = *kind;
    }
    if (!given)
        return node_fail(node, err, "expected \"translate\", \"rotate\", \"scale\" or \"matrix\"");
    const struct json_node value = node_member(node, given);
    memcpy(out, AFFINE_IDENTITY, sizeof AFFINE_IDENTITY);
    if (strcmp(given, "rotate") == 0)
        return read_rotation(&value, out, err);
    if (strcmp(given, "scale") == 0)
        return read_scale(node, out, err);
    if (strcmp(given, "matrix") == 0)
        return read_matrix(&value, out, err);
    double offset[3];
    if (!node_numbers(&value, 3, RANGE_COORDINATE, offset, err))
        return false;
    for (int i = 0; i < 3; i++)
        out[i][3] = offset[i];
    return true;
}

bool load_json_transform(const struct json_node *transform, double out[3][4], struct err *err)
{
    if (!json_is_array(transform->value))
        return read_transform_step(transform, out, err);
    memcpy(out, AFFINE_IDENTITY, sizeof AFFINE_IDENTITY);
    for (size_t i = 0; i < json_array_size(transform->value); i++) {
        const struct json_node element = node_element(transform, i);
        double step[3][4];
        if (!read_transform_step(&element, step, err))
            return false;
        affine_multiply(step, out, out);
    }
    return true;
}
