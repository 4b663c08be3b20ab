#include "render/film_copy.h"

#include "render/adaptive.h"
#include "render/frame.h"
#include "shared/aov.h"
#include <string.h>

uint64_t film_copy_bytes(const struct renderer *r)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < r->plan.film_chunks; i++)
        bytes += r->film[i].bytes;
    return bytes;
}

struct film_range film_copy_range(const struct renderer *r)
{
    const uint64_t row = 16 * AOV_FILM_WORDS(r->specialization.aovs) * r->frame.width;
    const bool is_all = r->specialization.integrator == INTEGRATOR_BIDIR ||
                        (r->rows.first == 0 && r->rows.end == r->frame.height);
    if (is_all)
        return (struct film_range){0, film_copy_bytes(r)};
    return (struct film_range){r->rows.first * row, (r->rows.end - r->rows.first) * row};
}

struct film_copy film_copy_state(const struct renderer *r)
{
    return (struct film_copy){
        .seed = r->frame.seed,
        .next_sample = r->next_sample,
        .round_target = r->round_target,
        .emptied_at = r->emptied_at,
        .pass = r->pass,
        .stats = r->stats,
    };
}

// Returns the film's buffer that contains byte `*at` of all records, and makes `*at` the offset in
// that buffer.
static struct gpu_buffer *find_buffer(const struct renderer *r, uint64_t *at)
{
    uint32_t i = 0;
    while (*at >= r->film[i].bytes)
        *at -= r->film[i++].bytes;
    return &r->film[i];
}

static uint64_t bytes_in(const struct gpu_buffer *buffer, uint64_t at, uint64_t bytes)
{
    return bytes < buffer->bytes - at ? bytes : buffer->bytes - at;
}

bool film_copy_get_bytes(struct renderer *r, uint64_t at, void *out, uint64_t bytes,
                         struct err *err)
{
    for (uint64_t done = 0, step; done < bytes; done += step) {
        uint64_t from = at + done;
        const struct gpu_buffer *buffer = find_buffer(r, &from);
        step = bytes_in(buffer, from, bytes - done);
        if (!gpu_download(r->gpu, buffer, from, (char *)out + done, step, err))
            return false;
    }
    return true;
}

bool film_copy_put_bytes(struct renderer *r, uint64_t at, const void *data, uint64_t bytes,
                         struct err *err)
{
    for (uint64_t done = 0, step; done < bytes; done += step) {
        uint64_t to = at + done;
        struct gpu_buffer *buffer = find_buffer(r, &to);
        step = bytes_in(buffer, to, bytes - done);
        if (!gpu_upload(r->gpu, buffer, to, (const char *)data + done, step, err))
            return false;
    }
    return true;
}

static bool copy_records(struct renderer *r, struct arena *arena, char **out, struct err *err)
{
    uint64_t bytes = film_copy_bytes(r);
    *out = ARENA_NEW(arena, char, bytes);
    if (!*out)
        return err_memory(err, "a copy of the film", bytes);
    return film_copy_get_bytes(r, 0, *out, bytes, err);
}

bool film_copy_take(struct renderer *r, bool is_empty, struct arena *arena, struct film_copy *out,
                    struct err *err)
{
    const struct tiles *tiles = &r->tiles;
    *out = film_copy_state(r);
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
    r->frame.seed = copy->seed;
    r->next_sample = copy->next_sample;
    r->round_target = copy->round_target;
    r->emptied_at = copy->emptied_at;
    r->pass = copy->pass;
    r->stats = copy->stats;
    r->stats.render_seconds = seconds;
    if (copy->done)
        memcpy(r->tiles.done, copy->done, r->tiles.count * sizeof *copy->done);
    return (!copy->records || film_copy_put_bytes(r, 0, copy->records, film_copy_bytes(r), err)) &&
           frame_upload(r, err);
}
