// The scenes on which the estimates of errors are tested: everyday ones and hard ones.
#ifndef LAMPYRIS_TESTS_COVERAGE_SUBJECTS_H
#define LAMPYRIS_TESTS_COVERAGE_SUBJECTS_H

#include "render/render.h"

struct subject {
    const char *name, *path; // from the source root
    const char *key, *value; // an override; NULL: none
};

typedef bool (*subject_fn)(void *context, const struct subject *subject, struct err *err);

// Calls for each of the scenes that a list ending with NULL names: one of the table, or a file by
// its path, which is called by what is between its folder and its extension; without names for all
// of the table. False at the first false.
bool subjects_visit(char **names, subject_fn visit, void *context, struct err *err);

// A renderer of one of them, with all that it needs; not to be moved.
struct studio {
    struct gpu gpu;
    struct scene scene;
    struct renderer renderer;
};
// Opens a renderer of a square picture of `side` x `side` pixels. Call studio_close() even if this
// fails.
bool studio_open(const struct subject *subject, uint32_t side, struct studio *out, struct err *err);
void studio_close(struct studio *studio);

#endif
