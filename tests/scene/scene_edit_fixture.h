// Edits everything that scene_write can write at random, and compares scenes completely.
#ifndef LAMPYRIS_TESTS_SCENE_EDIT_FIXTURE_H
#define LAMPYRIS_TESTS_SCENE_EDIT_FIXTURE_H

#include "scene/core/scene.h"

struct random {
    uint64_t state;
};

double random_unit(struct random *random); // [0, 1)
uint32_t random_below(struct random *random, uint32_t count);
void edit_at_random(struct scene *scene, struct random *random);
// Records a failure for each difference in any bit; `what` is the beginning of the message.
void check_same_scene(struct scene *a, struct scene *b, const char *what);

#endif
