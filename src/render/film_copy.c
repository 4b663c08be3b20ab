#include "render/film_copy.h"

#include "render/adaptive.h"
#include "render/frame.h"
#include <string.h>

uint64_t film_copy_bytes(const struct renderer *r)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < r->plan.film_chunks; i++)
        bytes += r->film[i].bytes;
    return bytes;
}

static bool copy_records(struct renderer *r, struct arena *arena, char **out, struct err *err)
{
    uint64_t bytes = film_copy_bytes(r), at = 0;
    *out = ARENA_NEW(arena, char, bytes);
    if (!*out)
        return err_memory(err, "a copy of the film", bytes);
    for (uint32_t i = 0; i < r->plan.film_chunks; at += r->film[i++].bytes)
        if (!gpu_download(r->gpu, &r->film[i], 0, *out + at, r->film[i].bytes, err))
            return false;
    return true;
}

bool film_copy_take(struct renderer *r, bool is_empty, struct arena *arena, struct film_copy *out,
                    struct err *err)
{
    const struct tiles *tiles = &r->tiles;
    *out = (struct film_copy){
        .seed = r->frame.seed,
        .next_sample = r->next_sample,
        .round_target = r->round_target,
        .emptied_at = r->emptied_at,
        .pass = r->pass,
        .stats = r->stats,
    };
    if (tiles->done) {
        out->done = ARENA_NEW(arena, uint32_t, tiles->count);
        if (!out->done)
            return err_memory(err, "a copy of the tiles", tiles->count * sizeof *out->done);
        memcpy(out->done, tiles->done, tiles->count * sizeof *out->done);
    }
    return is_empty || copy_records(r, arena, &out->records, err);
}

bool film_copy_put(const struct film_copy *copy, struct renderer *r, struct err *err)
{
    double seconds = r->stats.render_seconds;
    uint64_t at = 0;
    r->frame.seed = copy->seed;
    r->next_sample = copy->next_sample;
    r->round_target = copy->round_target;
    r->emptied_at = copy->emptied_at;
    r->pass = copy->pass;
    r->stats = copy->stats;
    r->stats.render_seconds = seconds;
    if (copy->done)
        memcpy(r->tiles.done, copy->done, r->tiles.count * sizeof *copy->done);
    for (uint32_t i = 0; copy->records && i < r->plan.film_chunks; at += r->film[i++].bytes)
        if (!gpu_upload(r->gpu, &r->film[i], 0, copy->records + at, r->film[i].bytes, err))
            return false;
    return frame_upload(r, err);
}
