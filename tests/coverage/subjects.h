// The scenes on which error estimates are tested: common ones and difficult ones.
#ifndef LAMPYRIS_TESTS_COVERAGE_SUBJECTS_H
#define LAMPYRIS_TESTS_COVERAGE_SUBJECTS_H

#include "render/render.h"

struct subject {
    const char *name, *path; // `path` is relative to the source root
    const char *key, *value; // an override; NULL: none
};

typedef bool (*subject_fn)(void *context, const struct subject *subject, struct err *err);

// Calls `visit` for each scene of a list that ends with NULL: for names of the table, or for files,
// which are named without folder and extension. If the list is empty, all scenes of the table are
// visited. Returns false as soon as `visit` does.
bool subjects_visit(char **names, subject_fn visit, void *context, struct err *err);

// A renderer for one of the scenes, with everything that it needs. Must not be moved in memory.
struct studio {
    struct gpu gpu;
    struct scene scene;
    struct renderer renderer;
};
// Opens a renderer for a picture of `side` x `side` pixels. Call studio_close() even if this fails.
bool studio_open(const struct subject *subject, uint32_t side, struct studio *out, struct err *err);
void studio_close(struct studio *studio);

#endif
