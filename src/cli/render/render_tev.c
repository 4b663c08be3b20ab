// --tev: shows a render in the viewer tev while it accumulates.
#include "base/clock.h"
#include "base/log.h"
#include "cli/render/render_run.h"
#include "cli/render/tev.h"
#include "output/layers.h"
#include <stdlib.h>
#include <string.h>

// No image is sent if reading and packing images have taken more than this share of the time.
#define COST_MAX 0.03
#define SECONDS_BETWEEN 2.0

static const char *const color[] = {"R", "G", "B", NULL};

static void name_channel(struct tev_picture *picture, const char *layer, const char *channel)
{
    char *out = picture->channels[picture->channel_count++];
    snprintf(out, TEV_CHANNEL_MAX, "%s%s%s", layer, *layer ? "." : "", channel);
}

static uint32_t count_channels(const struct image_layer *layer)
{
    const char *const *names = layer->channels ? layer->channels : color;
    uint32_t count = 0;
    while (count < 3 && names[count])
        count++;
    return count;
}

// Appends a layer's channels as floats. Numbers of objects and samples are exact up to 2^24.
static void pack_layer(struct tev_picture *picture, const struct image_layer *layer)
{
    const char *const *names = layer->channels ? layer->channels : color;
    const float *floats = layer->values;
    const uint32_t *numbers = layer->values;
    uint32_t count = count_channels(layer);
    size_t pixels = (size_t)picture->width * picture->height;
    for (uint32_t c = 0; c < count; c++) {
        float *out = picture->values + picture->channel_count * pixels;
        for (size_t i = 0; i < pixels; i++)
            out[i] = layer->type == IMAGE_LAYER_UINT ? (float)numbers[i * count + c]
                                                     : floats[i * count + c];
        name_channel(picture, layer->name, names[c]);
    }
}

// Packs the film with the requested layers. Returns false when out of memory.
static bool pack_picture(const struct film_image *film, uint32_t aovs, struct tev_picture *out)
{
    const struct image_layer picture = {"", film->mean, NULL, IMAGE_LAYER_FLOAT};
    struct layers layers;
    uint32_t count = 3;
    layers_list(film, aovs, &layers);
    for (uint32_t i = 0; i < layers.count; i++)
        count += count_channels(&layers.list[i]);
    *out = (struct tev_picture){
        .width = film->width,
        .height = film->height,
        .channels = malloc(count * sizeof *out->channels),
        .values = malloc((size_t)film->width * film->height * count * sizeof(float)),
    };
    if (!out->channels || !out->values) {
        tev_free_picture(out);
        return false;
    }
    pack_layer(out, &picture);
    for (uint32_t i = 0; i < layers.count; i++)
        pack_layer(out, &layers.list[i]);
    return true;
}

static void give_up(struct render_run *run)
{
    log_warn("--tev: out of memory for a copy of the picture; the render goes on without tev");
    tev_close(run->tev.viewer);
    run->tev.viewer = NULL;
}

static void send_film(struct render_run *run, const struct film_image *film)
{
    struct tev_picture picture;
    if (pack_picture(film, run->options->render.aovs, &picture))
        tev_send(run->tev.viewer, &picture);
    else
        give_up(run);
}

static bool send_now(struct render_run *run, struct err *err)
{
    uint64_t start = clock_ns();
    struct film_image film;
    struct arena arena = {0};
    bool ok = job_copy_film(&run->job, &arena, &film, err);
    if (ok)
        send_film(run, &film);
    arena_finish(&arena);
    run->tev.sent_ns = clock_ns();
    run->tev.seconds += clock_seconds_since(start);
    return ok;
}

bool render_tev_open(struct render_run *run, struct err *err)
{
    struct tev_address address;
    if (!run->options->render.tev)
        return true;
    if (!tev_parse_address(run->options->render.tev, &address, err) ||
        !(run->tev.viewer = tev_open(&address, run->outputs[0], err)))
        return false;
    return true;
}

bool render_tev_begin(struct render_run *run, struct err *err)
{
    run->tev.begin_ns = clock_ns();
    run->tev.next_sample = 1;
    return !run->tev.viewer || !tev_is_ready(run->tev.viewer) || send_now(run, err);
}

bool render_tev_when_due(struct render_run *run, struct err *err)
{
    struct render_tev *tev = &run->tev;
    if (!tev->viewer)
        return true;
    bool is_doubled = run->job.renderer.next_sample >= tev->next_sample;
    if (!is_doubled && clock_seconds_since(tev->sent_ns) < SECONDS_BETWEEN)
        return true;
    if (tev->seconds > COST_MAX * clock_seconds_since(tev->begin_ns) || !tev_is_ready(tev->viewer))
        return true;
    while (tev->next_sample <= run->job.renderer.next_sample)
        tev->next_sample *= 2;
    return send_now(run, err);
}

void render_tev_end(struct render_run *run)
{
    if (!run->tev.viewer)
        return;
    tev_wait(run->tev.viewer);
    if (run->job.film.mean && tev_is_ready(run->tev.viewer))
        send_film(run, &run->job.film);
    tev_close(run->tev.viewer);
    run->tev.viewer = NULL;
}
