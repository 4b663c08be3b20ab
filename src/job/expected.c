#include "job/expected.h"

#include "base/file_system.h"
#include "base/hash.h"
#include "job/job_internal.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// Returns the lines that all parts of a render have in common. Returns NULL when out of memory.
static const char *common_lines(const char *identity, uint64_t samples, bool with_integrator,
                                struct arena *arena)
{
    static const char *const left_out[] = {JOB_SHARD_LINE, JOB_DEVICE_LINE, JOB_DRIVER_LINE,
                                           JOB_INTEGRATOR_LINE};
    const char *lines =
        identity ? job_identity_without(identity, left_out, with_integrator ? 3 : 4, arena) : NULL;
    return lines ? arena_printf(arena, "%s--spp=%" PRIu64 "\n", lines, samples) : NULL;
}

static const char *lines_of_job(struct job *job, struct arena *arena)
{
    const struct settings *settings = &job->scene->settings;
    return common_lines(job_identity(job), settings->spp, settings->integrator != INTEGRATOR_AUTO,
                        arena);
}

static bool make_hash(const char *lines, char out[EXPECTED_HASH_BYTES], struct err *err)
{
    if (!lines)
        return err_memory(err, "what parts have in common", CHECKPOINT_TEXT_MAX);
    snprintf(out, EXPECTED_HASH_BYTES, "%016" PRIx64, hash_bytes(HASH_INIT, lines, strlen(lines)));
    return true;
}

bool expected_hash(struct job *job, char out[EXPECTED_HASH_BYTES], struct err *err)
{
    struct arena arena = {0};
    bool ok = make_hash(lines_of_job(job, &arena), out, err);
    arena_finish(&arena);
    return ok;
}

static bool compare(struct job *job, const struct checkpoint *c, struct arena *arena,
                    struct err *err)
{
    const bool knows_integrator = job->scene->settings.integrator != INTEGRATOR_AUTO;
    const char *is = lines_of_job(job, arena);
    const char *was = common_lines(c->identity, c->note[JOB_NOTE_SAMPLES], knows_integrator, arena);
    if (!is || !was)
        return err_memory(err, "what parts have in common", CHECKPOINT_TEXT_MAX);
    if (!job_identity_is_part(c->identity))
        return err_set(err, ERR_INPUT, "%s: is the checkpoint of a whole render", c->path);
    return checkpoint_compare(c->path, was, "this render", is, err);
}

bool expected_check_file(struct job *job, const char *path, struct err *err)
{
    struct arena arena = {0};
    struct checkpoint c = {0};
    struct err why = {0};
    if (!file_exists(path))
        return true;
    bool ok = checkpoint_open(path, &arena, &c, &why) && compare(job, &c, &arena, &why);
    checkpoint_close(&c);
    arena_finish(&arena);
    return ok || err_set(err, why.code,
                         "%s; this file has the name of a part, and its shard would refuse to "
                         "continue from it; expected no parts of another render: remove them, or "
                         "submit from another folder",
                         why.msg);
}

bool expected_check_parts(const struct merge *merge, const char *hash, struct err *err)
{
    struct arena arena = {0};
    bool ok = !hash;
    for (int with_integrator = 0; !ok && with_integrator < 2; with_integrator++) {
        char own[EXPECTED_HASH_BYTES];
        if (!make_hash(common_lines(merge->own_identity, merge->planned, with_integrator, &arena),
                       own, err)) {
            arena_finish(&arena);
            return false;
        }
        ok = strcmp(own, hash) == 0;
    }
    arena_finish(&arena);
    return ok || err_set(err, ERR_INPUT,
                         "%s: is a part of another render, or of another number of samples, than "
                         "the one that was submitted, whose hash is %s; expected its parts: the "
                         "messages of its tasks say why they wrote none",
                         merge->parts[0].path, hash);
}
