// Input that must be rejected with a message that names the fault (docs/verification.md, C10, C31,
// C41 and C43).
#ifndef LAMPYRIS_CHECK_REFUSED_H
#define LAMPYRIS_CHECK_REFUSED_H

#include "check/check.h"

struct refusal {
    const char *scene;                  // embedded
    struct scene_override overrides[3]; // up to the first without a key
    // Adds the invalid input, which is rejected now or when the scene is rendered; NULL: nothing.
    bool (*add)(struct scene *scene, const struct refusal *refusal, struct err *err);
    double value;      // parameter of `add`
    const char *words; // expected in the message
};

// The `run` of a case.
bool refused_run(const struct check *check, const struct check_case *this_case,
                 struct check_result *result, struct err *err);

// Functions for `add`: a triangle with `value` as a coordinate; an image that is `value` texels
// wide.
bool refused_vertex(struct scene *scene, const struct refusal *refusal, struct err *err);
bool refused_image(struct scene *scene, const struct refusal *refusal, struct err *err);

#endif
