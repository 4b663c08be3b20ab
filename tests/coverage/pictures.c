#include "pictures.h"

#include "base/clock.h"
#include "render/probe/in_view.h"
#include <errno.h>
#include <string.h>
#include <unistd.h>

static const double progress_seconds = 30;

static uint64_t half_size(const struct pictures *pictures)
{
    return pictures->pixels * 3 * sizeof(float);
}

static uint64_t place(const struct pictures *pictures, uint32_t seed, uint32_t level)
{
    return ((uint64_t)seed * pictures->plan->levels + level) * 2 * half_size(pictures);
}

// The file's name contains everything that affects the pictures, except the program.
static bool open_file(const struct subject *subject, const struct plan *plan, FILE **out,
                      struct err *err)
{
    if (!plan->folder) {
        *out = tmpfile();
        return *out || err_set(err, ERR_OUTPUT, "no temporary file: %s", strerror(errno));
    }
    char levels[LEVELS_MAX * 12] = "", path[4096];
    for (uint32_t i = 0, used = 0; i < plan->levels; i++)
        used += (uint32_t)snprintf(levels + used, sizeof levels - used, "-%u", plan->samples[i]);
    snprintf(path, sizeof path, "%s/%s_%u%s_%u.f32", plan->folder, subject->name, plan->side,
             levels, plan->first_seed);
    *out = fopen(path, "ab+");
    return *out || err_set(err, ERR_OUTPUT, "%s: %s", path, strerror(errno));
}

// Finds the number of complete seeds in the file, and truncates an incomplete one that an
// interrupted run has left.
static bool find_done(struct pictures *pictures, uint32_t *seeds, struct err *err)
{
    uint64_t size = place(pictures, 1, 0);
    off_t end = fseeko(pictures->file, 0, SEEK_END) == 0 ? ftello(pictures->file) : -1;
    if (end < 0)
        return err_set(err, ERR_OUTPUT, "pictures: %s", strerror(errno));
    uint64_t there = (uint64_t)end / size;
    if ((uint64_t)end % size && ftruncate(fileno(pictures->file), (off_t)(there * size)) != 0)
        return err_set(err, ERR_OUTPUT, "pictures: %s", strerror(errno));
    *seeds = there < pictures->plan->seeds ? (uint32_t)there : pictures->plan->seeds;
    return true;
}

static bool write_half(const struct pictures *pictures, float (*half)[3], struct err *err)
{
    return fwrite(half, half_size(pictures), 1, pictures->file) == 1 ||
           err_set(err, ERR_OUTPUT, "pictures: %s", strerror(errno));
}

// Renders a seed once, and writes its picture at each number of samples.
static bool render_seed(struct renderer *r, const struct pictures *pictures, uint32_t seed,
                        struct err *err)
{
    const struct plan *plan = pictures->plan;
    struct arena arena = {0};
    bool ok = renderer_restart(r, plan->first_seed + seed, err);
    for (uint32_t i = 0; ok && i < plan->levels; i++) {
        struct film_image film;
        const struct render_call call = {.samples =
                                             plan->samples[i] - (i ? plan->samples[i - 1] : 0)};
        ok = renderer_render(r, &call, err) && renderer_read(r, &arena, &film, err) &&
             write_half(pictures, film.half_a, err) && write_half(pictures, film.half_b, err);
        arena_finish(&arena);
    }
    arena_finish(&arena);
    return ok;
}

static bool render_seeds(struct renderer *r, const struct subject *subject,
                         const struct pictures *pictures, uint32_t first, struct err *err)
{
    const struct plan *plan = pictures->plan;
    uint64_t start = clock_ns(), told = start;
    for (uint32_t seed = first; seed < plan->seeds; seed++) {
        if (!render_seed(r, pictures, seed, err))
            return err_prepend(err, "%s, seed %u: ", subject->name, plan->first_seed + seed);
        if (clock_seconds_since(told) > progress_seconds) {
            told = clock_ns();
            fprintf(stderr, "%s, %u x %u: %u of %u seeds, %.0f s\n", subject->name, plan->side,
                    plan->side, seed + 1, plan->seeds, clock_seconds_since(start));
        }
    }
    return fflush(pictures->file) == 0 || err_set(err, ERR_OUTPUT, "pictures: %s", strerror(errno));
}

bool pictures_render(const struct subject *subject, const struct plan *plan, struct pictures *out,
                     struct err *err)
{
    struct studio studio;
    uint32_t done = 0;
    *out = (struct pictures){.plan = plan, .pixels = (uint64_t)plan->side * plan->side};
    bool ok = studio_open(subject, plan->side, &studio, err) &&
              open_file(subject, plan, &out->file, err) && find_done(out, &done, err) &&
              render_seeds(&studio.renderer, subject, out, done, err) &&
              renderer_find_unseen(&studio.renderer, &out->arena, &out->unseen, err);
    studio_close(&studio);
    return ok;
}

bool pictures_read(const struct pictures *pictures, uint32_t seed, uint32_t level,
                   float (*half_a)[3], float (*half_b)[3], struct err *err)
{
    uint64_t size = half_size(pictures);
    bool ok = fseeko(pictures->file, (off_t)place(pictures, seed, level), SEEK_SET) == 0 &&
              fread(half_a, size, 1, pictures->file) == 1 &&
              fread(half_b, size, 1, pictures->file) == 1;
    return ok || err_set(err, ERR_INPUT, "pictures cannot be read back: %s", strerror(errno));
}

void pictures_finish(struct pictures *pictures)
{
    if (pictures->file)
        fclose(pictures->file);
    arena_finish(&pictures->arena);
}
