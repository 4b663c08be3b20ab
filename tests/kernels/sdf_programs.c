#include "sdf_programs.h"

#define OP(name, ...)                                                                              \
    {                                                                                              \
        .op = SDF_##name, __VA_ARGS__                                                              \
    }
#define A(...) .a = {__VA_ARGS__}
#define B(...) .b = {__VA_ARGS__}
#define COUNTED(...)                                                                               \
    .code = {__VA_ARGS__}, .count = sizeof((struct gpu_sdf_instruction[]){__VA_ARGS__}) /          \
                                    sizeof(struct gpu_sdf_instruction)

// Rotated about y (cosine and sine 0.6 and 0.8) and translated; a metre inside is `1 / s` outside.
#define MOVE(s, x, y, z)                                                                           \
    OP(TRANSFORM, A(1.0f / (s)), B(0.6f * (s), 0, 0.8f * (s), (x)), .c = {0, (s), 0, (y)},         \
       .d = {-0.8f * (s), 0, 0.6f * (s), (z)})

// The bits of a ball's x coordinate, in the place of an operation.
#define BALL(bits, ...)                                                                            \
    {                                                                                              \
        .op = (bits), __VA_ARGS__                                                                  \
    }

const struct sdf_program sdf_programs[] = {
    {"sphere", COUNTED(OP(SPHERE, A(1))), .half = 1.05},
    {"box", COUNTED(OP(BOX, A(0.8f, 0.5f, 0.6f))), .half = 1},
    {"rounded box", COUNTED(OP(BOX, A(0.8f, 0.5f, 0.6f), B(0.2f))), .half = 1},
    {"frame", COUNTED(OP(FRAME, A(0.8f, 0.6f, 0.7f), B(0.07f))), .half = 1},
    {"torus", COUNTED(OP(TORUS, A(0.7f, 0.25f))), .half = 1},
    {"capsule", COUNTED(OP(CAPSULE, A(-0.4f, -0.5f, 0.1f), B(0.5f, 0.3f, -0.2f, 0.3f))), .half = 1},
    {"cone", COUNTED(OP(CONE, A(0.8f, 0.2f, 0.7f))), .half = 1},
    {"pointed cone", COUNTED(OP(CONE, A(0.6f, 0, 0.8f))), .half = 1},
    {"solid angle", COUNTED(OP(SOLID_ANGLE, A(0.9f), B(0.6f, 0.8f))), .half = 1},
    {"wide solid angle", COUNTED(OP(SOLID_ANGLE, A(0.9f), B(0.8f, -0.6f))), .half = 1},
    {"cylinder", COUNTED(OP(CYLINDER, A(0.6f, 0.8f, 0))), .half = 1},
    {"rounded cylinder", COUNTED(OP(CYLINDER, A(0.6f, 0.8f, 0.15f))), .half = 1},
    {"plane", COUNTED(OP(PLANE, A(0.36f, 0.8f, 0.48f), B(0.1f))), .half = 1, .is_cut = true},
    {"gyroid",
     COUNTED(OP(GYROID, A(6, 0.05f), B(1.7320509f)), OP(SPHERE, A(0.9f)), OP(INTERSECTION)),
     .half = 1},
    // Five balls; see BALL for the first word.
    {"metaballs",
     COUNTED({.op = SDF_METABALLS | 5u << 8, .a = {0.3f, 0.09f}},
             BALL(0x3e99999au, A(0, 0.1f, 0.6f), .b = {-0.4f, 0.1f, 0, 0.5f},
                  .c = {0, 0.5f, 0.2f, 0.45f}, .d = {0, -0.3f, -0.3f, 0.55f}),
             BALL(0xbe4ccccdu, A(-0.2f, 0.5f, 0.4f))),
     .half = 1},
    {"mandelbulb", COUNTED(OP(MANDELBULB, A(8, 2, 4), B(0.4f))), .half = 1.2, .is_fractal = true},
    {"menger", COUNTED(OP(MENGER, A(0.8f, 3))), .half = 0.9, .is_fractal = true},
    {"apollonian", COUNTED(OP(APOLLONIAN, A(1.2f, 4), B(0.25f)), OP(ROUND, A(0.02f))), .half = 0.9,
     .magnitude = 4, .is_fractal = true, .is_cut = true},
    {"pyramid", COUNTED(OP(PYRAMID, A(0.9f, 4))), .half = 1, .is_fractal = true},
    {"union", COUNTED(OP(SPHERE, A(0.6f)), OP(BOX, A(0.9f, 0.3f, 0.4f)), OP(UNION)), .half = 1},
    {"smooth union",
     COUNTED(MOVE(1, 0, 0.4f, 0), OP(SPHERE, A(0.4f)), OP(RESTORE), OP(BOX, A(0.7f, 0.2f, 0.5f)),
             OP(UNION, A(0.3f))),
     .half = 1},
    {"intersection", COUNTED(OP(SPHERE, A(0.8f)), OP(BOX, A(0.9f, 0.5f, 0.6f)), OP(INTERSECTION)),
     .half = 1},
    {"smooth intersection",
     COUNTED(OP(SPHERE, A(0.8f)), OP(BOX, A(0.9f, 0.5f, 0.6f)), OP(INTERSECTION, A(0.2f))),
     .half = 1},
    {"difference", COUNTED(OP(BOX, A(0.8f, 0.7f, 0.6f)), OP(SPHERE, A(0.75f)), OP(DIFFERENCE)),
     .half = 1},
    {"smooth difference",
     COUNTED(OP(BOX, A(0.8f, 0.7f, 0.6f)), OP(SPHERE, A(0.75f)), OP(DIFFERENCE, A(0.15f))),
     .half = 1},
    {"round", COUNTED(OP(BOX, A(0.5f, 0.6f, 0.3f)), OP(ROUND, A(0.2f))), .half = 1},
    {"shell",
     COUNTED(OP(SPHERE, A(0.7f)), OP(SHELL, A(0.05f)), OP(PLANE, A(0, 1, 0), B(0.3f)),
             OP(INTERSECTION)),
     .half = 1},
    {"factor", COUNTED(OP(TORUS, A(0.6f, 0.3f)), OP(FACTOR, A(0.5f))), .half = 1},
    {"transform", COUNTED(MOVE(2, 0.3f, -0.2f, 0.1f), OP(CONE, A(1.2f, 0.4f, 0.9f))), .half = 1},
    {"repeat", COUNTED(OP(REPEAT, A(0.4f, 0, 0.5f), B(2, 0, 1)), OP(SPHERE, A(0.17f))), .half = 1},
    {"twist", COUNTED(OP(TWIST, A(1, 0.5f)), OP(TORUS, A(0.6f, 0.2f))), .half = 0.9},
    {"mirror",
     COUNTED(OP(MIRROR, A(1, 0, 1)), MOVE(1, -0.5f, 0, -0.2f), OP(BOX, A(0.2f, 0.6f, 0.15f))),
     .half = 1},
    {"tree",
     COUNTED(MOVE(1.25f, 0, 0.1f, 0), OP(BOX, A(0.9f, 0.15f, 0.9f), B(0.05f)),
             OP(MIRROR, A(1, 0, 1)), MOVE(1, -0.4f, 0, -0.4f), OP(CYLINDER, A(0.1f, 0.7f, 0.02f)),
             OP(RESTORE), OP(RESTORE), OP(UNION, A(0.1f)), OP(TORUS, A(0.5f, 0.1f)),
             OP(DIFFERENCE, A(0.05f)), OP(RESTORE), OP(TWIST, A(1, 0.5f)),
             OP(BOX, A(0.12f, 0.8f, 0.12f)), OP(RESTORE), OP(UNION, A(0.2f)), OP(SPHERE, A(0.3f)),
             OP(UNION, A(0.1f)), OP(REPEAT, A(0.5f, 0.5f, 0.5f), B(1, 1, 1)), OP(SPHERE, A(0.12f)),
             OP(RESTORE), OP(DIFFERENCE), MOVE(1, 0.2f, 0.3f, 0),
             OP(FRAME, A(0.5f, 0.4f, 0.5f), B(0.05f)), OP(RESTORE), OP(UNION),
             OP(CAPSULE, A(-0.8f, -0.8f, 0), B(0.8f, 0.8f, 0.3f, 0.05f)), OP(UNION, A(0.05f)),
             OP(ROUND, A(0.01f)), OP(SPHERE, A(0.95f)), OP(INTERSECTION)),
     .half = 1},
};
const uint32_t sdf_program_count = sizeof sdf_programs / sizeof sdf_programs[0];

uint32_t sdf_program_named(const char *name)
{
    for (uint32_t i = 0; i < sdf_program_count; i++)
        if (strcmp(sdf_programs[i].name, name) == 0)
            return i;
    fprintf(stderr, "no program \"%s\"\n", name);
    exit(1);
}

// Rodrigues' formula about (1, 2, 3).
static void rotation(double turn, double m[3][3])
{
    const double n = sqrt(14), axis[3] = {1 / n, 2 / n, 3 / n};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double skew = i == j ? 0 : axis[3 - i - j] * ((j - i + 3) % 3 == 1 ? -1 : 1);
            m[i][j] =
                (i == j ? cos(turn) : 0) + sin(turn) * skew + (1 - cos(turn)) * axis[i] * axis[j];
        }
}

void add_sdf(struct scene *scene, const struct sdf_program *program, const struct sdf_place *place)
{
    uint32_t index;
    struct sdf *sdf = scene_add_sdf(scene, &index);
    struct gpu_sdf_instruction *code =
        arena_alloc(&scene->arena, program->count, sizeof *program->code);
    add_sphere(scene, place->center, 1, 0);
    if (!sdf || !code) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    memcpy(code, program->code, program->count * sizeof *code);
    *sdf = (struct sdf){.code = code, .count = program->count, .lipschitz = 1};
    sdf->magnitude = program->magnitude > 0 ? program->magnitude : 2 * program->half;
    struct shape *shape = &scene->shapes[scene->shape_count - 1];
    shape->kind = SHAPE_SDF;
    shape->sdf = index;
    shape->radius = 0;
    double m[3][3];
    rotation(place->turn, m);
    for (int j = 0; j < 3; j++) {
        sdf->min[j] = -program->half;
        sdf->max[j] = program->half;
        for (int i = 0; i < 3; i++)
            shape->axes[j][i] = m[i][j] * place->scale * program->half;
    }
}

double sdf_scale(const struct scene *scene, const struct shape *shape)
{
    return vec3_norm(shape->axes[0]) / scene->sdfs[shape->sdf].max[0];
}

void sdf_into(const struct scene *scene, const struct shape *shape, const double point[3],
              double out[3])
{
    double from[3];
    for (int i = 0; i < 3; i++)
        from[i] = point[i] - shape->center[i];
    for (int j = 0; j < 3; j++)
        out[j] = vec3_dot(shape->axes[j], from) / vec3_dot(shape->axes[j], shape->axes[j]) *
                 scene->sdfs[shape->sdf].max[j];
}

void sdf_normal(const struct sdf *sdf, const double point[3], double step, double out[3])
{
    for (int c = 0; c < 3; c++) {
        double above[3] = {point[0], point[1], point[2]};
        double below[3] = {point[0], point[1], point[2]};
        above[c] += step;
        below[c] -= step;
        out[c] = sdf_evaluate(sdf, above) - sdf_evaluate(sdf, below);
    }
    double size = vec3_norm(out);
    for (int c = 0; c < 3; c++)
        out[c] = size > 0 ? out[c] / size : c == 1;
}
