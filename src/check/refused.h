// Tests that invalid input is rejected with a message that names the fault (docs/verification.md,
// C10, C31, C41 and C43).
#ifndef LAMPYRIS_CHECK_REFUSED_H
#define LAMPYRIS_CHECK_REFUSED_H

#include "check/check.h"

struct refusal {
    const char *scene;                  // name of an embedded scene
    struct scene_override overrides[3]; // ends with the first entry without a key
    // Adds the invalid input, which is rejected by this call or when a renderer is created for the
    // scene. NULL: nothing is added.
    bool (*add)(struct scene *scene, const struct refusal *refusal, struct err *err);
    double value;      // parameter of `add`
    const char *words; // text that the message must contain
};

// The `run` function of a case.
bool refused_run(const struct check *check, const struct check_case *this_case,
                 struct check_result *result, struct err *err);

// Functions for `add`. refused_vertex() adds a triangle with `value` as a coordinate,
// refused_image() an image `value` texels wide.
bool refused_vertex(struct scene *scene, const struct refusal *refusal, struct err *err);
bool refused_image(struct scene *scene, const struct refusal *refusal, struct err *err);

#endif
