// For fuzz targets: makes bytes in memory available under a path that the loaders can open.
#ifndef LAMPYRIS_TESTS_FUZZ_INPUT_H
#define LAMPYRIS_TESTS_FUZZ_INPUT_H

// Must be included first, so that memfd_create is declared.
#define _GNU_SOURCE

#include "base/log.h"
#include "base/memory.h"
#include "scene/core/scene.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static inline void fuzz_ignore_message(void *context, enum log_level level, const char *message)
{
    (void)context, (void)level, (void)message;
}

typedef bool (*fuzz_load_fn)(struct scene *scene, const char *path, struct err *err);

// Loads the bytes within a memory budget. Aborts if the result is neither meshes with valid indices
// nor an error of input or memory.
static inline int fuzz_load(fuzz_load_fn load, const uint8_t *data, size_t size)
{
    log_configure(LOG_WARN, fuzz_ignore_message, NULL);
    int fd = memfd_create("fuzz", 0);
    if (fd < 0 || write(fd, data, size) != (ssize_t)size)
        abort();
    char path[64];
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    struct scene scene = {0};
    memory_set_budget(256 << 20);
    struct err err = {0};
    if (load(&scene, path, &err)) {
        for (uint32_t m = 0; m < scene.mesh_count; m++) {
            const struct mesh *mesh = &scene.meshes[m];
            for (uint32_t t = 0; t < mesh->triangle_count; t++) {
                for (int c = 0; c < 3; c++) {
                    if (mesh->indices[t][c] >= mesh->vertex_count)
                        abort();
                }
            }
        }
    } else if (err.code != ERR_INPUT && err.code != ERR_BUDGET) {
        abort();
    }
    scene_finish(&scene);
    close(fd);
    return 0;
}

#endif
