// Input that must be refused, by a message that names what is wrong (docs/verification.md, C10,
// C31, C41 and C43).
#ifndef LAMPYRIS_CHECK_REFUSED_H
#define LAMPYRIS_CHECK_REFUSED_H

#include "check/check.h"

struct refusal {
    const char *scene;                  // embedded
    struct scene_override overrides[3]; // to the first without a key
    // Adds what is to be refused, now or when the scene is rendered; NULL: nothing.
    bool (*add)(struct scene *scene, const struct refusal *refusal, struct err *err);
    double value;      // of `add`
    const char *words; // of the message
};

// `run` of a case.
bool refused_run(const struct check *check, const struct check_case *this_case,
                 struct check_result *result, struct err *err);

// `add`: a triangle, one of whose coordinates is `value`; an image that is `value` texels wide.
bool refused_vertex(struct scene *scene, const struct refusal *refusal, struct err *err);
bool refused_image(struct scene *scene, const struct refusal *refusal, struct err *err);

#endif
