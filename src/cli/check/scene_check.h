// `lampyris check SCENE`: the findings, and their output.
#ifndef LAMPYRIS_CLI_CHECK_SCENE_CHECK_H
#define LAMPYRIS_CLI_CHECK_SCENE_CHECK_H

#include "base/arena.h"
#include "check/check_scene.h"
#include "gpu/gpu.h"
#include "scene/core/scene.h"
#include <stdio.h>

struct options;

struct scene_check {
    const struct options *options;
    struct gpu gpu;
    struct scene scene;
    struct arena arena;
    struct scene_findings findings;
    bool is_outside; // the file of --fix refers to files outside of its folder
};

// Prints a line such as "local relMSE 0.001 takes about 410 spp, 130 s of rendering and 35.2 MiB on
// the device", or "at most" with the reason why only a bound is known.
void scene_check_print_outlook(const struct scene_outlook *outlook, FILE *out);
// Prints ", 12 % of the picture", or nothing if the share is not known.
void scene_check_print_share(double share, FILE *out);

// check_scene_html.c: writes the page of --report.
bool scene_check_report(struct scene_check *check, struct err *err);

#endif
