#include "render/probe/replay.h"

#include "cli/exit_code.h"
#include "cli/render/render_run.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include <inttypes.h>
#include <stdio.h>

static void print_vector(const char *name, const float v[3])
{
    printf("    %-12s %.9g %.9g %.9g\n", name, v[0], v[1], v[2]);
}

static const char *light_kind(const struct replay_light *light)
{
    if (light->is_environment)
        return "environment";
    return light->is_point ? "light" : light->is_shape ? "shape" : "triangle";
}

static void print_connection(const struct replay_light *light)
{
    printf("    %-12s %s %u, pdf %.9g per sr, %s\n", "light", light_kind(light), light->primitive,
           light->pdf, light->occluded ? "occluded" : "visible");
    print_vector("to light", light->point);
    print_vector("would bring", light->radiance);
}

static void print_vertex(const struct replay_vertex *v)
{
    printf("bounce %u: queue %s\n", v->bounce, v->queue);
    print_vector("origin", v->origin);
    print_vector("direction", v->direction);
    if (v->bsdf_pdf > 0.0f)
        printf("    %-12s %.9g per sr\n", "pdf", v->bsdf_pdf);
    else
        printf("    %-12s %s\n", "pdf", v->bounce == 0 ? "camera" : "perfectly specular");
    print_vector("throughput", v->throughput);
    if (v->material) {
        printf("    %-12s %s %u", "hit", v->is_shape ? "shape" : "triangle", v->primitive);
        if (v->instance != NO_INSTANCE)
            printf(" of instance %u", v->instance);
        printf(" at t %.9g, position %.9g %.9g %.9g\n", v->t, v->position[0], v->position[1],
               v->position[2]);
        printf("    %-12s \"", "material");
        print_words(v->material->name);
        printf("\" (%s)\n", v->material->model == MATERIAL_MIRROR ? "mirror" : "diffuse");
    }
    print_vector("gained", v->gained);
    for (uint32_t i = 0; i < v->light_count; i++)
        print_connection(&v->lights[i]);
}

static json_t *vector_json(const float v[3])
{
    return json_pack("[o, o, o]", json_number(v[0]), json_number(v[1]), json_number(v[2]));
}

static json_t *lights_json(const struct replay_vertex *v)
{
    json_t *lights = json_array();
    for (uint32_t i = 0; i < v->light_count; i++) {
        const struct replay_light *light = &v->lights[i];
        json_array_append_new(
            lights, json_pack("{s:s, s:i, s:o, s:o, s:o, s:b}", "kind", light_kind(light),
                              "primitive", light->primitive, "pdf", json_number(light->pdf),
                              "to_light", vector_json(light->point), "radiance",
                              vector_json(light->radiance), "occluded", light->occluded));
    }
    return lights;
}

static json_t *vertex_json(const struct replay_vertex *v)
{
    json_t *object =
        json_pack("{s:i, s:s, s:o, s:o, s:o, s:o, s:o}", "bounce", v->bounce, "queue", v->queue,
                  "origin", vector_json(v->origin), "direction", vector_json(v->direction),
                  "bsdf_pdf", json_number(v->bsdf_pdf), "throughput", vector_json(v->throughput),
                  "gained", vector_json(v->gained));
    if (object && v->material)
        json_object_update_new(
            object, json_pack("{s:{s:s, s:i, s:o, s:o, s:[o, o, o]}}", "hit", "kind",
                              v->is_shape ? "shape" : "triangle", "primitive", v->primitive, "t",
                              json_number(v->t), "material", json_words(v->material->name),
                              "position", json_number(v->position[0]), json_number(v->position[1]),
                              json_number(v->position[2])));
    if (object && v->material && v->instance != NO_INSTANCE)
        json_object_set_new(json_object_get(object, "hit"), "instance", json_integer(v->instance));
    if (object && v->light_count > 0)
        json_object_set_new(object, "lights", lights_json(v));
    return object;
}

static void print_json(const struct replay *replay, const uint32_t pixel[2], uint64_t sample)
{
    json_t *vertices = json_array();
    for (uint32_t i = 0; i < replay->vertex_count; i++)
        json_array_append_new(vertices, vertex_json(&replay->vertices[i]));
    command_print(json_pack("{s:[i, i], s:I, s:o, s:b, s:o}", "pixel", pixel[0], pixel[1], "sample",
                            (json_int_t)sample, "radiance", vector_json(replay->radiance),
                            "dropped", replay->dropped, "vertices", vertices));
}

bool render_replay(struct render_run *run, struct err *err)
{
    const struct options *options = run->options;
    const struct settings *settings = &run->scene.settings;
    uint32_t x = options->render.pixel[0], y = options->render.pixel[1];
    if (x >= settings->width || y >= settings->height)
        return err_set(err, ERR_USAGE,
                       "--pixel %u,%u: is outside the picture; expected a pixel of the %u x %u "
                       "pixels, counted from 0",
                       x, y, settings->width, settings->height);
    struct replay replay;
    if (!job_replay(&run->job, x, y, options->render.sample, &run->arena, &replay, err))
        return false;
    progress_end(options->progress);
    if (options->json) {
        print_json(&replay, options->render.pixel, options->render.sample);
        return true;
    }
    printf("pixel %u,%u sample %" PRIu64 ": %u rays\n", x, y, options->render.sample,
           replay.vertex_count);
    for (uint32_t i = 0; i < replay.vertex_count; i++)
        print_vertex(&replay.vertices[i]);
    printf("radiance %.9g %.9g %.9g%s\n", replay.radiance[0], replay.radiance[1],
           replay.radiance[2], replay.dropped ? " (a contribution was not finite)" : "");
    return true;
}
