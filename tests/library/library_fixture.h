// Functions that the tests of the library share.
#ifndef LAMPYRIS_TESTS_LIBRARY_FIXTURE_H
#define LAMPYRIS_TESTS_LIBRARY_FIXTURE_H

#include "test.h"

#include <lampyris/lampyris.h>
#include <unistd.h>

#define SMALL "{\"width\": 32, \"height\": 24, \"spp\": 8}"

struct told {
    int count;
    char last[400];
};

static inline void tell(void *user, enum lampyris_log_level level, const char *message)
{
    struct told *told = user;
    (void)level;
    told->count++;
    snprintf(told->last, sizeof told->last, "%s", message);
}

static inline const char *path_of(const char *name)
{
    static char paths[4][1024];
    static int next;
    char *path = paths[next++ % 4];
    const char *root = getenv("LAMPYRIS_SOURCE_ROOT");
    snprintf(path, sizeof paths[0], "%s/%s", root ? root : ".", name);
    return path;
}

// Messages of the validation layers fail the test; other messages are printed.
static inline void watch_validation(void *user, enum lampyris_log_level level, const char *message)
{
    (void)user, (void)level;
    fprintf(stderr, "%s\n", message);
    CHECK(!strstr(message, "Vulkan validation"), "%s", message);
}

static inline struct lampyris_context *open_context(void)
{
    const struct lampyris_context_params params = {.size = sizeof params,
                                                   .log = watch_validation,
                                                   .log_level = LAMPYRIS_LOG_WARNING,
                                                   .validation = true};
    struct lampyris_context *context;
    CHECK(lampyris_context_create(&params, &context) == LAMPYRIS_OK);
    return context;
}

static inline struct lampyris_error error_of(const struct lampyris_context *context)
{
    struct lampyris_error error = {.size = sizeof error};
    lampyris_context_error(context, &error);
    return error;
}

#define OK(context, call)                                                                          \
    do {                                                                                           \
        enum lampyris_status ok_status = (call);                                                   \
        if (ok_status == LAMPYRIS_NO_VULKAN)                                                       \
            SKIP("%s", error_of(context).message);                                                 \
        REQUIRE(ok_status == LAMPYRIS_OK, "%s", error_of(context).message);                        \
    } while (0)

static inline struct lampyris_state state_of(struct lampyris_render *render)
{
    struct lampyris_state state = {.size = sizeof state};
    CHECK(lampyris_render_state(render, &state) == LAMPYRIS_OK);
    return state;
}

// Returns the hash that the program prints; 0 if it fails. Each process has files of its own,
// because tests run at the same time.
static inline uint64_t hash_of_program(const char *arguments)
{
    char command[2048], line[512], output[64];
    unsigned long long hash = 0;
    const char *program = getenv("LAMPYRIS_PROGRAM");
    snprintf(output, sizeof output, "library_program_%ld.exr", (long)getpid());
    snprintf(command, sizeof command, "%s render %s --json -o %s", program ? program : "lampyris",
             arguments, output);
    FILE *out = popen(command, "r");
    while (out && fgets(line, sizeof line, out)) {
        const char *found = strstr(line, "\"image_hash\": \"");
        if (found)
            hash = strtoull(found + strlen("\"image_hash\": \""), NULL, 16);
    }
    if (!out || pclose(out) != 0)
        hash = 0;
    remove(output);
    return hash;
}

// Renders a small picture and returns its hash.
static inline uint64_t render_hash(struct lampyris_context *context, struct lampyris_scene *scene)
{
    struct lampyris_render *render;
    struct lampyris_state state = {.size = sizeof state};
    if (lampyris_render_begin(scene, SMALL, NULL, &render) ||
        lampyris_render_step(render, NULL, NULL) || lampyris_render_state(render, &state))
        fprintf(stderr, "%s\n", error_of(context).message);
    lampyris_render_release(render);
    return state.hash;
}

#endif
