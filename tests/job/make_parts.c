// Writes more parts than a test can render: each has the film of one rendered part, of samples 0:2,
// as if it were that of the next two samples.
//
//   make_parts PART COUNT FIRST LAST FOLDER
//
// writes FOLDER/I.part for I from FIRST to LAST, of COUNT parts, counted from 0.
#include "base/err.h"
#include "base/log.h"
#include "job/job_internal.h"
#include "render/checkpoint.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static bool read_film(struct checkpoint *c, struct arena *arena, struct film_copy *out,
                      struct err *err)
{
    *out = checkpoint_film(c);
    out->records = ARENA_NEW(arena, char, c->film_bytes);
    uint64_t at = 0, bytes;
    while (out->records && (bytes = checkpoint_next_bytes(c)) > 0) {
        if (!checkpoint_next_block(c, out->records + at, err))
            return false;
        at += bytes;
    }
    return out->records || err_memory(err, "a film", c->film_bytes);
}

static bool write_part(const struct checkpoint *c, struct film_copy *film, uint64_t index,
                       uint64_t count, const char *folder, struct err *err)
{
    static const char *const names[] = {JOB_SHARD_LINE};
    struct arena arena = {0};
    uint64_t note[CHECKPOINT_NOTE_WORDS] = {
        [JOB_NOTE_SAMPLES] = 2 * count, [JOB_NOTE_AOVS] = c->note[JOB_NOTE_AOVS]};
    const char *common = job_identity_without(c->identity, names, 1, &arena);
    const struct checkpoint_text text = {
        arena_printf(&arena, "%s" JOB_SHARD_LINE "%" PRIu64 ":%" PRIu64 "\n", common, 2 * index,
                     2 * index + 2),
        c->command};
    const char *path = arena_printf(&arena, "%s/%" PRIu64 ".part", folder, index);
    film->emptied_at = 2 * index;
    film->next_sample = 2 * index + 2;
    bool ok = common && text.identity && path &&
              checkpoint_write_copy(film, c->film_bytes, (uint32_t)c->note[JOB_NOTE_AOVS], NULL,
                                    path, &text, note, err);
    arena_finish(&arena);
    return ok;
}

int main(int argc, char **argv)
{
    struct arena arena = {0};
    struct checkpoint c = {0};
    struct film_copy film;
    struct err err = {0};
    if (argc != 6)
        return 2;
    const uint64_t count = strtoull(argv[2], NULL, 10), last = strtoull(argv[4], NULL, 10);
    bool ok = checkpoint_open(argv[1], &arena, &c, &err) && read_film(&c, &arena, &film, &err);
    for (uint64_t i = strtoull(argv[3], NULL, 10); ok && i <= last; i++)
        ok = write_part(&c, &film, i, count, argv[5], &err);
    checkpoint_close(&c);
    arena_finish(&arena);
    if (!ok)
        log_message(LOG_ERROR, "%s", err.msg);
    return ok ? 0 : 1;
}
