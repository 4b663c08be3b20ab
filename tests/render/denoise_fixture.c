#include "denoise_fixture.h"

#include "film_reference.h"
#include "shared/aov.h"

bool film_open(struct gpu *gpu, uint32_t width, uint32_t height, struct made_film *out,
               struct err *err)
{
    char across[16], down[16];
    snprintf(across, sizeof across, "%u", width);
    snprintf(down, sizeof down, "%u", height);
    const struct scene_override overrides[] = {
        {"film.width", across}, {"film.height", down}, {"plate", "{}"}, {0}};
    *out = (struct made_film){.gpu = gpu, .width = width, .height = height};
    if (!load_scene("src/check/scenes/plate.json", overrides, &out->scene, err))
        return false;
    const struct renderer_params params = {
        .gpu = gpu, .scene = &out->scene, .aovs = DENOISE_AOVS, .wave = 1024};
    out->picture = calloc((size_t)width * height, sizeof *out->picture);
    if (out->picture && renderer_create(&params, &out->renderer, err))
        return true;
    film_close(out);
    return false;
}

void film_close(struct made_film *film)
{
    renderer_finish(&film->renderer);
    scene_finish(&film->scene);
    free(film->picture);
}

// Writes sums of the layers in the form of the film.
static void put_sums(uint32_t *words, uint32_t at, const float *mean, uint32_t components, float n)
{
    const uint32_t aovs = film_aovs_of_device(DENOISE_AOVS);
    for (uint32_t i = at; i < at + components; i++)
        film_reference_add(&words[4 * (FILM_WORDS + i)],
                           &words[4 * AOV_FILM_DIGITS_AT(aovs) + i / 4], i % 4, mean[i - at] * n);
}

static void put_pixel(uint32_t *words, const struct made_pixel *p)
{
    const uint32_t aovs = film_aovs_of_device(DENOISE_AOVS);
    uint32_t first = p->samples - p->samples / 2, second = p->samples / 2;
    float n = (float)p->samples;
    struct gpu_film_pixel pixel = {.samples = p->samples};
    for (uint32_t c = 0; c < 3; c++) {
        float light_a = p->albedo[c] * (p->light[c] + p->apart[c]) + p->emission[c];
        float light_b = p->albedo[c] * (p->light[c] - p->apart[c]) + p->emission[c];
        film_reference_add(&pixel.sums_a[4 * c], &pixel.digits_a, c, (float)first * light_a);
        film_reference_add(&pixel.sums_b[4 * c], &pixel.digits_b, c, (float)second * light_b);
    }
    memcpy(words, &pixel, sizeof pixel);
    put_sums(words, AOV_VECTOR_AT(aovs, AOV_ALBEDO), p->albedo, 3, n);
    put_sums(words, AOV_VECTOR_AT(aovs, AOV_NORMAL), p->normal, 3, n);
    put_sums(words, AOV_VECTOR_AT(aovs, AOV_EMISSION), p->emission, 3, n);
    float depth = p->depth * p->alpha;
    put_sums(words, AOV_SCALAR_AT(aovs, AOV_DEPTH), &depth, 1, n);
    put_sums(words, AOV_SCALAR_AT(aovs, AOV_ALPHA), &p->alpha, 1, n);
    memcpy(&words[4 * (AOV_FILM_WORDS(aovs) - 1)], &p->primitive, sizeof p->primitive);
}

bool film_make(struct made_film *film, make_pixel *make, const void *context, struct err *err)
{
    const uint32_t words = 4 * AOV_FILM_WORDS(film_aovs_of_device(DENOISE_AOVS));
    const uint64_t chunk = film->renderer.plan.film_chunk_pixels;
    uint64_t pixels = (uint64_t)film->width * film->height;
    uint32_t *data = calloc(pixels, words * sizeof *data);
    if (!data)
        return err_memory(err, "film", pixels * words * sizeof *data);
    for (uint64_t i = 0; i < pixels; i++) {
        struct made_pixel p =
            make(context, (uint32_t)(i % film->width), (uint32_t)(i / film->width));
        if (p.samples > 0)
            put_pixel(&data[i * words], &p);
    }
    bool ok = true;
    for (uint64_t first = 0, i = 0; first < pixels && ok; first += chunk, i++) {
        uint64_t count = pixels - first < chunk ? pixels - first : chunk;
        ok = gpu_upload(film->gpu, &film->renderer.film[i], 0, &data[first * words],
                        count * words * sizeof *data, err);
    }
    free(data);
    return ok;
}

bool film_denoise(struct made_film *film, struct denoiser *denoiser,
                  const struct denoise_call *call, struct err *err)
{
    return denoiser_run(denoiser, call, err) &&
           gpu_download(film->gpu, &denoiser->picture, 0, film->picture,
                        (uint64_t)film->width * film->height * sizeof *film->picture, err);
}
