#include "job/merge.h"

#include "base/file_inputs.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/printable.h"
#include "job/job_internal.h"
#include "shared/aov.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// --- a part --------------------------------------------------------------------------------------

// Returns the value of the line of an identity that begins with `name`; the value ends at a
// newline. Returns NULL if there is no such line.
static const char *find_value(const char *identity, const char *name)
{
    size_t length = strlen(name);
    for (const char *line = identity; *line; line += strcspn(line, "\n"), line += *line == '\n')
        if (strncmp(line, name, length) == 0)
            return line + length;
    return NULL;
}

static int value_length(const char *value)
{
    return (int)strcspn(value, "\n");
}

static bool is_within(const struct sample_range *range, const struct sample_ranges *all)
{
    for (uint32_t i = 0; i < all->count; i++)
        if (range->first >= all->list[i].first && range->end <= all->list[i].end)
            return true;
    return false;
}

static bool check_is_part(const struct checkpoint *c, struct err *err)
{
    const char *text = find_value(c->identity, JOB_SHARD_LINE);
    return (text && strncmp(text, "none\n", 5) != 0) ||
           err_set(err, ERR_INPUT,
                   "%s: is the checkpoint of a whole render; expected a part of one, which "
                   "render --shard writes",
                   c->path);
}

static bool is_finished(const struct film_copy *film, uint64_t steps)
{
    return film->next_sample == steps && film->pass.position == 0;
}

// Finds the samples that a part holds. A finished shard has all samples that were planned for it.
// An unfinished part by tiles counts as empty.
static bool find_samples(const struct checkpoint *c, const struct merge *merge, struct arena *arena,
                         struct merge_part *part, struct err *err)
{
    const char *text = find_value(c->identity, JOB_SHARD_LINE);
    const struct film_copy film = checkpoint_film(c);
    if (!samples_parse(text, (size_t)value_length(text), arena, &part->wanted))
        return err_set(err, ERR_INPUT, "%s: its list of samples is not readable: \"%.*s\"", c->path,
                       value_length(text), text);
    part->samples = part->wanted;
    if (merge->by_tiles) {
        part->samples.count = is_finished(&film, merge->rounds) ? part->wanted.count : 0;
        return part->wanted.list[part->wanted.count - 1].end <= merge->height ||
               err_set(err, ERR_INPUT, "%s: holds rows that the picture does not have", c->path);
    }
    if (part->wanted.count > 1)
        return true;
    struct sample_range *has = ARENA_NEW(arena, struct sample_range, 1);
    if (!has)
        return err_memory(err, "samples of a part", sizeof *has);
    *has = (struct sample_range){film.emptied_at, film.next_sample};
    part->samples = (struct sample_ranges){has, has->first < has->end};
    return has->first <= has->end && is_within(has, &part->wanted)
               ? true
               : err_set(err, ERR_INPUT, "%s: holds samples of another shard", c->path);
}

const char *merge_resuming_command(const struct merge *merge, const struct merge_part *part,
                                   struct arena *arena)
{
    const struct sample_range *range = &part->wanted.list[0];
    char *path = ARENA_NEW(arena, char, 4 * strlen(part->path) + 3);
    if (!path)
        return NULL;
    printable_quote(part->path, path);
    return arena_printf(arena, "%s%s --shard %" PRIu64 ":%" PRIu64 " --checkpoint %s --resume",
                        part->command, merge->by_tiles ? " --shard-by tiles" : "", range->first,
                        range->end, path);
}

// Refuses a part whose pixels or halves have different numbers of samples: only its shard can
// complete it.
static bool check_even(const struct merge *merge, const struct checkpoint *c,
                       const struct merge_part *part, struct arena *arena, struct err *err)
{
    const struct film_copy film = checkpoint_film(c);
    const uint64_t end = part->wanted.list[part->wanted.count - 1].end;
    if (merge->by_tiles
            ? part->samples.count > 0
            : film.pass.position == 0 && (film.next_sample % 2 == 0 || film.next_sample == end))
        return true;
    const char *command = merge_resuming_command(merge, part, arena);
    return command ? err_set(err, ERR_INPUT, "%s: is not finished: %s; first run: %s", c->path,
                             merge->by_tiles ? "its rows lack samples"
                                             : "some pixels have more samples than others, or one "
                                               "half has more than the other",
                             command)
                   : err_memory(err, "a command", strlen(c->command));
}

// With `partial` or `only_look_at`, leaves out a part that check_even() refuses.
static bool accept_unfinished(const struct merge *merge, const struct merge_params *params,
                              const struct checkpoint *c, struct merge_part *part,
                              struct arena *scratch, struct err *err)
{
    struct err why = {0};
    if (check_even(merge, c, part, scratch, &why))
        return true;
    if (!(params->partial || params->only_look_at) || why.code != ERR_INPUT) {
        *err = why;
        return false;
    }
    if (!params->only_look_at)
        log_warn("%s; it is left out", why.msg);
    part->samples.count = 0;
    part->is_left_out = true;
    return true;
}

static bool check_film(const struct checkpoint *c, const struct merge *merge, struct err *err)
{
    uint64_t aovs = c->note[JOB_NOTE_AOVS];
    uint64_t record = 16 * AOV_FILM_WORDS((uint32_t)aovs);
    return (aovs <= UINT32_MAX && (merge->by_tiles || c->tile_count == 0) &&
            c->film_bytes % record == 0 && c->block_bytes % record == 0) ||
           err_set(err, ERR_INPUT, "%s: its film is not a sum of samples of all pixels", c->path);
}

// Finds the place of the part's film in the whole film. The film of a part by tiles contains only
// the rows from its first to its last one, unless it has light paths.
static bool find_film(struct merge *merge, const struct checkpoint *c, struct merge_part *part,
                      struct err *err)
{
    const uint64_t row = 16 * AOV_FILM_WORDS(merge->aovs) * merge->width;
    const struct sample_range hull = {part->wanted.list[0].first,
                                      part->wanted.list[part->wanted.count - 1].end};
    const bool is_whole = c->film_bytes == merge->film_bytes;
    if (!is_whole && merge->by_tiles && c->film_bytes == (hull.end - hull.first) * row) {
        part->film_at = hull.first * row;
        return true;
    }
    merge->has_whole_films |= is_whole && hull.end - hull.first < merge->height;
    return is_whole ||
           err_set(err, ERR_INPUT,
                   "%s: its film has %s instead of %s; expected parts of the same --size "
                   "and --aov",
                   c->path, memory_print(c->film_bytes).text, memory_print(merge->film_bytes).text);
}

// All parts of an adaptive render must have the same plan, which each computed by its own pilot.
static bool check_plan(const struct merge *merge, const struct checkpoint *c, struct err *err)
{
    return (c->tile_count == merge->tile_count &&
            (c->tile_count == 0 ||
             memcmp(c->counts, merge->counts, c->tile_count * sizeof *c->counts) == 0)) ||
           err_set(err, ERR_INPUT,
                   "%s: its pilot chose other numbers of samples for the tiles than the pilot of "
                   "%s; expected parts of devices of one kind with one driver",
                   c->path, merge->parts[0].path);
}

// --- parts that belong together ------------------------------------------------------------------

static const char *const own_lines[] = {JOB_SHARD_LINE, JOB_DEVICE_LINE, JOB_DRIVER_LINE};

// Returns the lines of an identity that all parts must have in common.
static const char *common_identity(const char *identity, bool mixed, struct arena *arena)
{
    return job_identity_without(identity, own_lines, mixed ? 3 : 1, arena);
}

// Returns whether a part has samples of devices or drivers that differ.
static bool is_of_several(const char *device)
{
    return strncmp(device, JOB_SEVERAL_DEVICES, strlen(JOB_SEVERAL_DEVICES)) == 0;
}

static bool check_device(const struct checkpoint *c, bool mixed, struct err *err)
{
    const char *device = find_value(c->identity, JOB_DEVICE_LINE);
    if (!device || !find_value(c->identity, JOB_DRIVER_LINE))
        return err_set(err, ERR_INPUT,
                       "%s: does not name its device; expected a part of this build", c->path);
    return mixed || !is_of_several(device) ||
           err_set(err, ERR_INPUT, "%s: has samples of several devices; expected --mixed", c->path);
}

static bool find_device(struct merge *merge, const struct checkpoint *c, uint32_t *index,
                        uint32_t *capacity, struct err *err)
{
    const char *device = find_value(c->identity, JOB_DEVICE_LINE);
    const char *driver = find_value(c->identity, JOB_DRIVER_LINE);
    const char *name = is_of_several(device)
                           ? arena_printf(&merge->arena, "%.*s", value_length(device), device)
                           : arena_printf(&merge->arena, "%.*s (%.*s)", value_length(device),
                                          device, value_length(driver), driver);
    if (!name)
        return err_memory(err, "names of devices", 64);
    for (*index = 0; *index < merge->device_count; ++*index)
        if (strcmp(merge->devices[*index].name, name) == 0)
            return true;
    struct merge_device *added = arena_append(&merge->arena, &merge->devices, &merge->device_count,
                                              capacity, sizeof *added, NULL);
    if (!added)
        return err_memory(err, "names of devices", sizeof *added);
    added->name = name;
    return true;
}

static bool check_overlaps(struct merge *merge, const struct merge_part *part, uint32_t before,
                           struct err *err)
{
    struct sample_range range;
    if (!samples_overlap(&merge->samples, &part->samples, &range))
        return true;
    const struct merge_part *other = merge->parts;
    for (uint32_t i = 0; i < before; i++)
        if (samples_overlap(&merge->parts[i].samples, &part->samples, &range)) {
            other = &merge->parts[i];
            break;
        }
    const char *what = merge->by_tiles ? "row" : "sample";
    return err_set(err, ERR_INPUT,
                   "%s: has %ss %" PRIu64 ":%" PRIu64 ", which %s has, too; expected every %s once",
                   part->path, what, range.first, range.end, other->path, what);
}

// Reads from the first part what all parts must have in common.
static bool begin_merge(struct merge *merge, const struct checkpoint *c, const char *identity,
                        struct err *err)
{
    const char *size = find_value(identity, JOB_SIZE_LINE);
    const char *by = find_value(identity, JOB_SHARD_BY_LINE);
    const char *round = find_value(identity, JOB_ROUND_LINE);
    uint32_t round_samples = 1;
    if (!size || sscanf(size, "%ux%u", &merge->width, &merge->height) != 2 ||
        (round && (sscanf(round, "%u", &round_samples) != 1 || round_samples == 0)))
        return err_set(err, ERR_INPUT,
                       "%s: its identity lacks the size of the picture, or has an invalid size or "
                       "round; expected a part that this build has written",
                       c->path);
    merge->merged.identity = identity;
    merge->own_identity = common_identity(c->identity, false, &merge->arena);
    if (!merge->own_identity)
        return err_memory(err, "a part", strlen(c->identity));
    merge->by_tiles = by && strncmp(by, JOB_BY_TILES, strlen(JOB_BY_TILES)) == 0;
    merge->aovs = (uint32_t)c->note[JOB_NOTE_AOVS];
    merge->film_bytes = 16 * AOV_FILM_WORDS(merge->aovs) * (uint64_t)merge->width * merge->height;
    merge->rounds = c->note[JOB_NOTE_SAMPLES] / round_samples;
    merge->tile_count = c->tile_count;
    if (c->tile_count == 0)
        return true;
    merge->counts = ARENA_NEW(&merge->arena, uint32_t, c->tile_count);
    if (!merge->counts)
        return err_memory(err, "tiles", c->tile_count * sizeof *c->counts);
    memcpy(merge->counts, c->counts, c->tile_count * sizeof *c->counts);
    return true;
}

static bool add_part(struct merge *merge, const struct checkpoint *c, uint32_t index,
                     const struct merge_params *params, uint32_t *device_capacity,
                     struct arena *scratch, struct err *err)
{
    const bool mixed = params->mixed;
    struct merge_part *part = &merge->parts[index];
    const char *before = index > 0 ? part[-1].command : "";
    *part = (struct merge_part){
        .path = c->path,
        .command =
            strcmp(before, c->command) == 0 ? before : arena_strdup(&merge->arena, c->command),
        .planned = c->note[JOB_NOTE_SAMPLES],
        .head_hash = c->head_hash,
    };
    const char *identity =
        common_identity(c->identity, mixed, index == 0 ? &merge->arena : scratch);
    if (!identity || !part->command)
        return err_memory(err, "a part", strlen(c->identity));
    if (!check_is_part(c, err) || !check_device(c, mixed, err))
        return false;
    if (index > 0 &&
        !checkpoint_compare(c->path, identity, merge->parts[0].path, merge->merged.identity, err))
        return false;
    if ((index == 0 && !begin_merge(merge, c, identity, err)) ||
        !find_samples(c, merge, &merge->arena, part, err) || !check_film(c, merge, err))
        return false;
    struct sample_ranges joined;
    if (!accept_unfinished(merge, params, c, part, scratch, err) || !check_plan(merge, c, err) ||
        !check_overlaps(merge, part, index, err) ||
        !(part->is_left_out || find_device(merge, c, &part->device, device_capacity, err)) ||
        !samples_join(&merge->samples, &part->samples, &merge->arena, &joined, err))
        return false;
    if (c->note[JOB_NOTE_AOVS] != merge->aovs)
        return err_set(err, ERR_INPUT,
                       "%s: its layers are not those of %s; expected parts with the same --aov",
                       c->path, merge->parts[0].path);
    if (!find_film(merge, c, part, err))
        return false;
    if (!part->is_left_out)
        merge->devices[part->device].part_count++;
    merge->samples = joined;
    if (part->planned > merge->planned) {
        merge->planned = part->planned;
        merge->command = part->command;
    }
    merge->all = merge->by_tiles ? merge->height : merge->planned;
    return true;
}

// Returns whether a list of names, separated by JOB_DEVICE_SEPARATOR, has this one.
static bool has_name(const char *names, const char *name, size_t length)
{
    while (true) {
        const char *end = strstr(names, JOB_DEVICE_SEPARATOR);
        const size_t own = end ? (size_t)(end - names) : strlen(names);
        if (own == length && strncmp(names, name, length) == 0)
            return true;
        if (!end)
            return false;
        names = end + strlen(JOB_DEVICE_SEPARATOR);
    }
}

// Lists the names of all devices, also those in sums of parts. Leaves merged.devices NULL if there
// is only one device.
static bool list_devices(struct merge *merge, struct err *err)
{
    const char *list = "";
    merge->name_count = 0;
    for (uint32_t i = 0; list && i < merge->device_count; i++) {
        const char *name = merge->devices[i].name;
        name += is_of_several(name) ? strlen(JOB_SEVERAL_DEVICES) : 0;
        while (list && *name) {
            const char *end = strstr(name, JOB_DEVICE_SEPARATOR);
            const size_t length = end ? (size_t)(end - name) : strlen(name);
            if (!has_name(list, name, length)) {
                list = arena_printf(&merge->arena, "%s%s%.*s", list,
                                    *list ? JOB_DEVICE_SEPARATOR : "", (int)length, name);
                merge->name_count++;
            }
            name += end ? length + strlen(JOB_DEVICE_SEPARATOR) : length;
        }
    }
    if (list && merge->name_count > 1)
        list = merge->merged.devices = arena_printf(&merge->arena, JOB_SEVERAL_DEVICES "%s", list);
    return list || err_memory(err, "names of devices", 64);
}

// Completes the identity of the sum with its device, or with the names of all devices.
static bool end_identity(struct merge *merge, struct err *err)
{
    struct job_merged *merged = &merge->merged;
    if (!list_devices(merge, err))
        return false;
    if (merge->device_count == 1)
        merged->identity = merge->own_identity;
    else if (merge->device_count > 1)
        merged->identity =
            arena_printf(&merge->arena, "%s" JOB_DEVICE_LINE "%s\n" JOB_DRIVER_LINE "several\n",
                         merged->identity, merged->devices);
    return merged->identity || err_memory(err, "a sum of parts", CHECKPOINT_TEXT_MAX);
}

bool merge_open(const struct merge_params *params, struct merge *out, struct err *err)
{
    *out = (struct merge){.count = params->count};
    uint32_t device_capacity = 0;
    out->parts = ARENA_NEW(&out->arena, struct merge_part, params->count);
    if (!out->parts)
        return err_memory(err, "parts", params->count * sizeof *out->parts);
    for (uint32_t i = 0; i < params->count; i++) {
        struct arena scratch = {0};
        struct checkpoint c = {0};
        bool ok = file_inputs_add(params->paths[i], err) &&
                  checkpoint_open(params->paths[i], &scratch, &c, err) &&
                  add_part(out, &c, i, params, &device_capacity, &scratch, err);
        checkpoint_close(&c);
        arena_finish(&scratch);
        if (!ok)
            return false;
    }
    if (!end_identity(out, err))
        return false;
    return out->samples.count > 0 || params->only_look_at ||
           err_set(err, ERR_INPUT, "%s: no part has a sample yet", params->paths[0]);
}

// --- films ---------------------------------------------------------------------------------------

// Adds the film of a part. The file is read once: each block is added as soon as its hash has been
// verified.
static bool add_film(const struct merge *merge, const struct merge_part *part, char *block,
                     struct film_copy *to, struct err *err)
{
    const uint64_t record = 16 * AOV_FILM_WORDS(merge->aovs);
    struct arena scratch = {0};
    struct checkpoint c;
    if (!checkpoint_open(part->path, &scratch, &c, err)) {
        arena_finish(&scratch);
        return false;
    }
    const struct film_copy film = checkpoint_film(&c);
    const bool precedes = film.emptied_at < to->emptied_at;
    bool ok = c.head_hash == part->head_hash ||
              err_set(err, ERR_INPUT,
                      "%s: was replaced while it was merged; expected a file that "
                      "no program writes meanwhile",
                      part->path);
    uint64_t at = 0, bytes;
    while (ok && (bytes = checkpoint_next_bytes(&c)) > 0) {
        ok = checkpoint_next_block(&c, block, err);
        if (ok)
            film_records_add(merge->aovs, block, to->records + part->film_at + at, bytes / record,
                             precedes);
        at += bytes;
    }
    if (precedes)
        to->emptied_at = film.emptied_at;
    if (film.next_sample > to->next_sample)
        to->next_sample = film.next_sample;
    if (ok)
        job_add_stats(&film.stats, &to->stats);
    checkpoint_close(&c);
    arena_finish(&scratch);
    return ok;
}

static bool create_film(const struct merge *merge, struct arena *arena, struct film_copy *out,
                        struct err *err)
{
    *out = (struct film_copy){.records = ARENA_NEW(arena, char, merge->film_bytes),
                              .emptied_at = UINT64_MAX};
    return out->records || err_memory(err, "the film", merge->film_bytes);
}

// Adds the films of the parts of `device`, or of all parts if it is UINT32_MAX.
static bool add_films_of(const struct merge *merge, uint32_t device,
                         const struct progress *progress, char *block, struct film_copy *to,
                         uint32_t *done, struct err *err)
{
    struct err first = {0};
    for (uint32_t i = 0; i < merge->count; i++) {
        const struct merge_part *part = &merge->parts[i];
        struct err failure = {0};
        if (part->is_left_out || (device != UINT32_MAX && part->device != device))
            continue;
        progress_report(progress, "Merging", (double)(*done)++ / merge->count);
        if (progress_should_stop(progress))
            return err_set(err, ERR_STOPPED, "stopped by a signal; nothing was written");
        if (add_film(merge, part, block, to, &failure))
            continue;
        if (first.code != ERR_NONE) // the caller reports the last failure
            log_message(LOG_ERROR, "%s", first.msg);
        first = failure;
        if (failure.code != ERR_INPUT)
            break;
    }
    if (first.code == ERR_NONE)
        return true;
    if (err)
        *err = first;
    return false;
}

// --- devices against each other ------------------------------------------------------------------

// Returns the mean of one half of a pixel's channel (shared/film_sums.h), to double precision.
static double half_mean(const uint32_t *record, uint32_t half, uint32_t channel, uint32_t samples)
{
    const uint32_t *sum = &record[4 * (1 + FILM_HALF_WORDS * half + channel)];
    uint32_t digits = record[2 + half] >> FILM_DIGIT_BITS * channel & FILM_DIGITS_MASK;
    int top = digits ? 32 - __builtin_clz(digits) : 0;
    int64_t bins[2];
    memcpy(bins, sum, sizeof bins);
    double units = (double)bins[top & 1] * 0x1p32 + (double)bins[(top + 1) & 1];
    return ldexp(units, 32 * (top - 1) + FILM_LEAST_EXPONENT) / samples;
}

static double half_luminance(const uint32_t *record, uint32_t half)
{
    uint32_t samples = half == 0 ? record[0] - record[0] / 2 : record[0] / 2;
    return 0.2126 * half_mean(record, half, 0, samples) +
           0.7152 * half_mean(record, half, 1, samples) +
           0.0722 * half_mean(record, half, 2, samples);
}

// A quarter of the squared difference of two independent halves estimates the variance of their
// mean without bias. Pixels are independent of each other, so their variances add up.
static void measure_device(const struct merge *merge, const struct film_copy *film,
                           struct merge_device *device)
{
    const uint64_t record = 16 * AOV_FILM_WORDS(merge->aovs), pixels = merge->film_bytes / record;
    double sum = 0.0, variance = 0.0;
    for (uint64_t i = 0; i < pixels; i++) {
        uint32_t words[4 * FILM_WORDS];
        memcpy(words, film->records + i * record, sizeof words);
        if (words[0] < 2) // a half is empty
            return;
        double a = half_luminance(words, 0), b = half_luminance(words, 1);
        sum += 0.5 * (a + b);
        variance += 0.25 * (a - b) * (a - b);
    }
    device->mean = sum / (double)pixels;
    device->standard_error = sqrt(variance) / (double)pixels;
    device->has_mean = true;
}

static bool add_devices(struct merge *merge, const struct progress *progress, char *block,
                        struct err *err)
{
    const uint64_t record = 16 * AOV_FILM_WORDS(merge->aovs);
    struct film_copy *sum = &merge->merged.film;
    uint32_t done = 0;
    bool ok = true;
    for (uint32_t i = 0; i < merge->device_count; i++) {
        struct arena arena = {0};
        struct film_copy film;
        struct err failure = {0};
        bool is_whole = create_film(merge, &arena, &film, &failure) &&
                        add_films_of(merge, i, progress, block, &film, &done, &failure);
        if (is_whole) {
            if (!merge->by_tiles)
                measure_device(merge, &film, &merge->devices[i]);
            film_records_add(merge->aovs, film.records, sum->records, merge->film_bytes / record,
                             film.emptied_at < sum->emptied_at);
            sum->emptied_at = film.emptied_at < sum->emptied_at ? film.emptied_at : sum->emptied_at;
            sum->next_sample =
                film.next_sample > sum->next_sample ? film.next_sample : sum->next_sample;
            job_add_stats(&film.stats, &sum->stats);
        } else if (ok && err) {
            *err = failure;
        } else {
            log_message(LOG_ERROR, "%s", failure.msg);
        }
        ok = ok && is_whole;
        arena_finish(&arena);
    }
    return ok;
}

// Returns the number of samples of each tile in the whole render; NULL if the render is not
// adaptive, or when out of memory.
static uint32_t *find_done(const struct merge *merge, struct arena *arena)
{
    uint32_t *done = merge->counts ? ARENA_NEW(arena, uint32_t, merge->tile_count) : NULL;
    for (uint32_t i = 0; done && i < merge->tile_count; i++)
        done[i] = (uint32_t)(merge->counts[i] * merge->rounds);
    return done;
}

bool merge_add_films(struct merge *merge, const struct progress *progress, struct err *err)
{
    // Blocks of files have at most this many bytes, or the file is refused when it is opened.
    char *block = memory_alloc(CHECKPOINT_BLOCK_BYTES);
    uint32_t done = 0;
    bool ok = block || err_memory(err, "a block of a part", CHECKPOINT_BLOCK_BYTES);
    ok = ok && create_film(merge, &merge->merged.arena, &merge->merged.film, err) &&
         (merge->device_count > 1
              ? add_devices(merge, progress, block, err)
              : add_films_of(merge, UINT32_MAX, progress, block, &merge->merged.film, &done, err));
    memory_free(block);
    if (ok && merge->counts) {
        merge->merged.counts = merge->counts;
        merge->merged.film.done = find_done(merge, &merge->arena);
        ok = merge->merged.film.done ||
             err_memory(err, "tiles", merge->tile_count * sizeof(uint32_t));
    }
    return ok;
}

// --- the sum -------------------------------------------------------------------------------------

// Cuts the film to the rows that a sum of parts by tiles has. Returns its number of bytes.
static uint64_t cut_film(const struct merge *merge, struct film_copy *film)
{
    const struct sample_range hull = {merge->samples.list[0].first,
                                      merge->samples.list[merge->samples.count - 1].end};
    const uint64_t row = 16 * AOV_FILM_WORDS(merge->aovs) * merge->width;
    if (!merge->by_tiles) {
        film->emptied_at = hull.first;
        film->next_sample = hull.end;
        return merge->film_bytes;
    }
    film->next_sample = film->round_target = merge->rounds;
    if (merge->has_whole_films)
        return merge->film_bytes;
    film->records += hull.first * row;
    return (hull.end - hull.first) * row;
}

bool merge_write(const struct merge *merge, const char *path, struct err *err)
{
    struct arena arena = {0};
    struct film_copy film = merge->merged.film;
    const uint64_t bytes = cut_film(merge, &film);
    struct tiles tiles = {.count = merge->tile_count, .counts = merge->counts};
    tiles.done = find_done(merge, &arena);
    const char *samples = samples_text(&merge->samples, &arena);
    const char *identity =
        samples ? arena_printf(&arena, "%s" JOB_SHARD_LINE "%s\n", merge->merged.identity, samples)
                : NULL;
    const struct checkpoint_text text = {identity, merge->command};
    const uint64_t note[CHECKPOINT_NOTE_WORDS] = {
        [JOB_NOTE_SAMPLES] = merge->planned, [JOB_NOTE_AOVS] = merge->aovs};
    const bool has_memory = identity && (tiles.done || !merge->counts);
    bool ok = has_memory
                  ? checkpoint_write_copy(&film, bytes, merge->aovs, &tiles, path, &text, note, err)
                  : err_memory(err, "a part", 64);
    arena_finish(&arena);
    return ok;
}

void merge_finish(struct merge *merge)
{
    if (!merge)
        return;
    arena_finish(&merge->merged.arena);
    arena_finish(&merge->arena);
    *merge = (struct merge){0};
}
