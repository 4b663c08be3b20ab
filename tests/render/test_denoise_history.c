// Tests where the denoiser finds a place in the history before the camera or an object moved,
// against rays traced here.
#include "denoise_fixture.h"
#include "scene/core/affine.h"
#include "shared/bindings.h"
#include "shared/methods.h"

// --- a world, and cameras in it ------------------------------------------------------------------

enum world { WORLD_BALL, WORLD_WALL_AND_POST, WORLD_WALL_AND_CARD };
enum surface { NOTHING, BALL, WALL, POST, CARD };

struct seen {
    enum surface surface;
    double t, point[3], normal[3];
};

struct view {
    struct camera camera;
    uint32_t width, height;
    double card[3], card_angle, card_scale; // its centre, its rotation about +Y, and its scale
};

static void scale(double v[3], double factor)
{
    for (int i = 0; i < 3; i++)
        v[i] *= factor;
}

// Computes unit vectors to the right and upwards, and half of the visible width and height at
// distance 1.
static void axes(const struct view *v, double right[3], double up[3], double half[2])
{
    vec3_cross(v->camera.direction, v->camera.up, right);
    scale(right, 1 / sqrt(vec3_dot(right, right)));
    vec3_cross(right, v->camera.direction, up);
    half[1] =
        v->camera.kind == CAMERA_ORTHOGRAPHIC ? v->camera.height / 2 : tan(v->camera.fov_y / 2);
    half[0] = half[1] * v->width / v->height;
}

static void ray(const struct view *v, double x, double y, double origin[3], double direction[3])
{
    double right[3], up[3], half[2];
    axes(v, right, up, half);
    double a = 2 * x / v->width - 1, b = 1 - 2 * y / v->height;
    double forward = 1;
    double shift[2] = {0, 0}, slope[2] = {a * half[0], b * half[1]};
    if (v->camera.kind == CAMERA_ORTHOGRAPHIC) {
        memcpy(shift, slope, sizeof shift);
        slope[0] = slope[1] = 0;
    }
    if (v->camera.kind == CAMERA_PANORAMIC) {
        forward = cos(M_PI * a) * cos(M_PI / 2 * b);
        slope[0] = sin(M_PI * a) * cos(M_PI / 2 * b);
        slope[1] = sin(M_PI / 2 * b);
    }
    for (int i = 0; i < 3; i++) {
        origin[i] = v->camera.position[i] + shift[0] * right[i] + shift[1] * up[i];
        direction[i] = forward * v->camera.direction[i] + slope[0] * right[i] + slope[1] * up[i];
    }
    scale(direction, 1 / sqrt(vec3_dot(direction, direction)));
}

// Computes the place of a point in the picture, in pixels. Returns false if it is behind the
// camera.
static bool find(const struct view *v, const double point[3], double at[2])
{
    double right[3], up[3], half[2], to[3];
    axes(v, right, up, half);
    for (int i = 0; i < 3; i++)
        to[i] = point[i] - v->camera.position[i];
    double x = vec3_dot(to, right), y = vec3_dot(to, up), z = vec3_dot(to, v->camera.direction);
    double place[2] = {x / half[0], y / half[1]};
    if (v->camera.kind == CAMERA_PERSPECTIVE)
        for (int i = 0; i < 2; i++)
            place[i] /= z;
    if (v->camera.kind == CAMERA_PANORAMIC) {
        place[0] = atan2(x, z) / M_PI;
        place[1] = asin(y / sqrt(vec3_dot(to, to))) / (M_PI / 2);
    }
    at[0] = (place[0] + 1) * v->width / 2;
    at[1] = (1 - place[1]) * v->height / 2;
    return v->camera.kind != CAMERA_PERSPECTIVE || z > 0;
}

// A ball around the cameras, whose centre is far enough from them that no camera looks straight at
// its surface: there the filter's weights, which depend on slopes, are not symmetric.
static const double ball_centre[3] = {7, 3, 1};
#define BALL_RADIUS 14.0

static struct seen see_ball(const double origin[3], const double direction[3])
{
    struct seen s = {.surface = BALL};
    double to[3];
    for (int i = 0; i < 3; i++)
        to[i] = origin[i] - ball_centre[i];
    double along = vec3_dot(to, direction);
    s.t = -along + sqrt(along * along - vec3_dot(to, to) + BALL_RADIUS * BALL_RADIUS);
    for (int i = 0; i < 3; i++)
        s.normal[i] = -(to[i] + s.t * direction[i]) / BALL_RADIUS;
    return s;
}

// A wall at z = -6, and a post at z = -2 in front of it.
static struct seen see_wall(const double origin[3], const double direction[3])
{
    struct seen s = {.surface = WALL, .normal = {0, 0, 1}};
    double t = (-2 - origin[2]) / direction[2];
    s.t = (-6 - origin[2]) / direction[2];
    if (fabs(origin[0] + t * direction[0]) < 0.3) {
        s.surface = POST;
        s.t = t;
    }
    return s;
}

// A card of 2 x 1.4 in front of that wall. This is the map from its own space to world space.
static void card_map(const struct view *v, double map[3][4])
{
    double c = v->card_scale * cos(v->card_angle), s = v->card_scale * sin(v->card_angle);
    const double rows[3][4] = {
        {c, 0, s, v->card[0]}, {0, v->card_scale, 0, v->card[1]}, {-s, 0, c, v->card[2]}};
    memcpy(map, rows, sizeof rows);
}

static struct seen see_card(const struct view *v, const double origin[3], const double direction[3])
{
    struct seen s = see_wall(origin, direction);
    double map[3][4], back[3][4], from[3], to[3];
    card_map(v, map);
    CHECK(affine_inverse(map, back), "the card has no extent");
    affine_point(back, origin, from);
    affine_vector(back, direction, to);
    double t = -from[2] / to[2];
    s.surface = WALL;
    s.t = (-6 - origin[2]) / direction[2];
    if (t > 0 && fabs(from[0] + t * to[0]) < 1 && fabs(from[1] + t * to[1]) < 0.7) {
        s.surface = CARD;
        s.t = t;
        for (int i = 0; i < 3; i++)
            s.normal[i] = map[i][2] / v->card_scale;
    }
    return s;
}

static struct seen see(enum world world, const struct view *v, double x, double y)
{
    double origin[3], direction[3];
    ray(v, x, y, origin, direction);
    struct seen s = world == WORLD_BALL            ? see_ball(origin, direction)
                    : world == WORLD_WALL_AND_CARD ? see_card(v, origin, direction)
                                                   : see_wall(origin, direction);
    for (int i = 0; i < 3; i++)
        s.point[i] = origin[i] + s.t * direction[i];
    return s;
}

// --- films of it ---------------------------------------------------------------------------------

// The history's light encodes the place in its picture by colours of equal luminance. The film's
// light does not, and varies strongly between its halves: if all its weights are used, the filter
// preserves a slope.
#define CARD_PRIMITIVE 7u
struct painting {
    enum world world;
    const struct view *view;
    int axis; // 0: x, 1: y, -1: none
};

static struct made_pixel paint(const void *context, uint32_t x, uint32_t y)
{
    const struct painting *p = context;
    struct seen s = see(p->world, p->view, x + 0.5, y + 0.5);
    double place = (p->axis == 0 ? (x + 0.5) / p->view->width : (y + 0.5) / p->view->height) + 0.5;
    double code = p->axis < 0 ? 0 : place;
    return (struct made_pixel){
        .samples = p->axis < 0 ? 2 : 1000,
        .light = {(float)(1 + 0.7152 * code), (float)(1 - 0.2126 * code), 1},
        .apart = {p->axis < 0 ? 0.5f : 0, p->axis < 0 ? 0.5f : 0, p->axis < 0 ? 0.5f : 0},
        .albedo = {0.5f, 0.5f, 0.5f},
        .normal = {(float)s.normal[0], (float)s.normal[1], (float)s.normal[2]},
        .depth = (float)s.t,
        .alpha = 1,
        .primitive = s.surface == CARD ? CARD_PRIMITIVE + 1 : 0,
    };
}

struct move {
    const char *name;
    enum world world;
    struct view from, to;
};

struct trip {
    struct gpu gpu;
    struct made_film from, to;
    struct denoiser denoiser;
    struct err err;
};

static bool trip_open(struct trip *t, const struct move *m)
{
    return film_open(&t->gpu, m->from.width, m->from.height, &t->from, &t->err) &&
           film_open(&t->gpu, m->to.width, m->to.height, &t->to, &t->err) &&
           denoiser_create(&t->gpu, &t->denoiser, &t->err);
}

static void trip_close(struct trip *t)
{
    denoiser_finish(&t->denoiser);
    film_close(&t->from);
    film_close(&t->to);
    gpu_close(&t->gpu);
    CHECK(t->gpu.validation_messages == 0, "%u validation messages", t->gpu.validation_messages);
}

// Returns how the card moved, for a film in which the card is a set of primitives in world space.
static struct denoise_motion card_motion(const struct move *m)
{
    struct denoise_motion motion = {CARD_PRIMITIVE, 1, NO_INSTANCE};
    double past[3][4], now[3][4], back[3][4];
    card_map(&m->from, past);
    card_map(&m->to, now);
    CHECK(affine_inverse(now, back), "the card has no extent");
    affine_multiply(past, back, motion.to_past);
    return motion;
}

static bool trip_run(struct trip *t, const struct move *m, int axis)
{
    const struct painting before = {m->world, &m->from, axis}, after = {m->world, &m->to, -1};
    const struct denoise_call keep = {.renderer = &t->from.renderer, .camera = &m->from.camera};
    struct denoise_call run = {
        .renderer = &t->to.renderer, .camera = &m->to.camera, .iterations = 1, .temporal = true};
    struct denoise_motion motion;
    if (m->world == WORLD_WALL_AND_CARD) {
        motion = card_motion(m);
        run.has_changed = true;
        run.motions = &motion;
        run.motion_count = 1;
    }
    return film_make(&t->from, paint, &before, &t->err) &&
           denoiser_keep(&t->denoiser, &keep, &t->err) &&
           film_make(&t->to, paint, &after, &t->err) &&
           film_denoise(&t->to, &t->denoiser, &run, &t->err);
}

// Returns the position in the history's picture, in pixels, that the pixel's value encodes; NAN if
// no history was used. The history counts as 32 samples, minus the part that fades with the film's
// two samples, of 64.
static double told(const struct trip *t, const struct move *m, uint32_t x, uint32_t y, int axis)
{
    const double worth = 32 * (1 - 2.0 / 64), share = worth / (worth + 2);
    double code = ((double)t->to.picture[y * m->to.width + x][0] / 0.5 - 1) / 0.7152 / share;
    return code < 0.25 ? NAN : (code - 0.5) * (axis == 0 ? m->from.width : m->from.height);
}

// --- the place -----------------------------------------------------------------------------------

static double radians(double degrees)
{
    return degrees * M_PI / 180;
}

// Rotates the view about +Y to the right, from -Z.
static struct view look(uint32_t kind, double degrees, double x, double y, double z)
{
    double a = radians(degrees);
    return (struct view){
        .camera = {.position = {x, y, z},
                   .direction = {sin(a), 0, -cos(a)},
                   .up = {0.02, 1, 0.05},
                   .kind = kind,
                   .fov_y = radians(40),
                   .height = 6},
        .width = 96,
        .height = 64,
    };
}

static struct view with_card(struct view v, double x, double y, double z, double degrees,
                             double card_scale)
{
    const double card[3] = {x, y, z};
    memcpy(v.card, card, sizeof card);
    v.card_angle = radians(degrees);
    v.card_scale = card_scale;
    return v;
}

static struct view sized(struct view v, uint32_t width, uint32_t height)
{
    v.width = width;
    v.height = height;
    return v;
}

// For panoramas: returns whether the direction to a point is within acos(0.9) of that to the ball's
// centre, or of the opposite one.
static bool is_straight(const struct view *v, const double point[3])
{
    double to[3], centre[3];
    for (int i = 0; i < 3; i++) {
        to[i] = point[i] - v->camera.position[i];
        centre[i] = ball_centre[i] - v->camera.position[i];
    }
    return fabs(vec3_dot(to, centre)) > 0.9 * sqrt(vec3_dot(to, to) * vec3_dot(centre, centre));
}

static void check_places(const struct trip *t, const struct move *m, int axis)
{
    double worst = 0;
    uint32_t found = 0, outside = 0;
    double size = axis == 0 ? m->from.width : m->from.height;
    // At the border the filter has only one side.
    for (uint32_t y = 2; y < m->to.height - 2; y++)
        for (uint32_t x = 2; x < m->to.width - 2; x++) {
            double at[2];
            struct seen s = see(m->world, &m->to, x + 0.5, y + 0.5);
            bool ahead = find(&m->from, s.point, at);
            bool around = m->from.camera.kind == CAMERA_PANORAMIC;
            double place = told(t, m, x, y, axis), margin = 8;
            bool in_x = at[0] > margin && at[0] < m->from.width - margin;
            bool in_y = at[1] > margin && at[1] < m->from.height - margin;
            bool straight = is_straight(&m->from, s.point) || is_straight(&m->to, s.point);
            if (ahead && !straight && in_y && (in_x || (around && axis == 1))) {
                CHECK(!isnan(place), "%s: pixel %u %u: no history, expected that of %g %g", m->name,
                      x, y, at[0], at[1]);
                worst = fmax(worst, isnan(place) ? 0 : fabs(place - at[axis]));
                found++;
            }
            bool away = at[0] < -margin || at[0] > m->from.width + margin || at[1] < -margin ||
                        at[1] > m->from.height + margin;
            outside += away;
            CHECK(!away || isnan(place), "%s: pixel %u %u: history of %g, expected none", m->name,
                  x, y, place);
        }
    printf("  %s, %c: %u pixels within %.4f of one; %u come into view\n", m->name, "xy"[axis],
           found, worst, outside);
    CHECK(worst <= 0.1 && found > 500, "%s: %g of %g pixels off, %u found", m->name, worst, size,
          found);
}

TEST(history_is_where_it_was)
{
    const uint32_t P = CAMERA_PERSPECTIVE, O = CAMERA_ORTHOGRAPHIC, A = CAMERA_PANORAMIC;
    const struct move moves[] = {
        {"turned by 7 degrees", WORLD_BALL, look(P, 0, 0, 0, 0), look(P, 7, 0, 0, 0)},
        {"moved", WORLD_BALL, look(P, 20, 0, 0, 0), look(P, 17, 0.4, -0.2, 1)},
        {"from fewer pixels", WORLD_BALL, sized(look(P, 0, 0, 0, 0), 48, 32),
         look(P, 3, 0.1, 0, 0)},
        {"from more pixels", WORLD_BALL, sized(look(P, 0, 0, 0, 0), 201, 134),
         look(P, 3, 0.1, 0, 0)},
        {"parallel", WORLD_BALL, look(O, 0, 0, 0, 0), look(O, 4, 0.7, 0.3, 0)},
        {"all around", WORLD_BALL, look(A, 0, 0, 0, 0), look(A, 100, 0.5, 0.2, 0)},
        {"parallel to perspective", WORLD_BALL, look(O, 0, 0, 0, 0), look(P, 2, 0, 0, 4)},
    };
    for (size_t i = 0; i < sizeof moves / sizeof *moves; i++) {
        struct trip t = {0};
        OPEN_GPU(&t.gpu, .validation = true);
        REQUIRE(trip_open(&t, &moves[i]), "%s", t.err.msg);
        for (int axis = 0; axis < 2; axis++) {
            REQUIRE(trip_run(&t, &moves[i], axis), "%s", t.err.msg);
            check_places(&t, &moves[i], axis);
            denoiser_forget(&t.denoiser);
        }
        trip_close(&t);
    }
}

// --- what was hidden -----------------------------------------------------------------------------

enum past_view { PAST_SEEN, PAST_HIDDEN, PAST_OUTSIDE };

static enum past_view past_of(const struct move *m, double x, double y, enum surface *surface)
{
    double at[2];
    struct seen now = see(m->world, &m->to, x, y);
    *surface = now.surface;
    if (!find(&m->from, now.point, at) || at[0] < 4 || at[0] > m->from.width - 4 || at[1] < 4 ||
        at[1] > m->from.height - 4)
        return PAST_OUTSIDE;
    return see(m->world, &m->from, at[0], at[1]).surface == now.surface ? PAST_SEEN : PAST_HIDDEN;
}

// Next to edges, the filter's 5 x 5 pixels contain both surfaces.
static bool is_clear(const struct move *m, uint32_t x, uint32_t y, enum past_view expected)
{
    enum surface middle, beside;
    past_of(m, x + 0.5, y + 0.5, &middle);
    for (int dx = -4; dx <= 4; dx++)
        if (past_of(m, x + 0.5 + dx, y + 0.5, &beside) != expected || beside != middle)
            return false;
    return true;
}

TEST(what_was_hidden_has_no_history)
{
    const struct move move = {"past a post", WORLD_WALL_AND_POST,
                              look(CAMERA_PERSPECTIVE, 0, 0, 0, 0),
                              look(CAMERA_PERSPECTIVE, 0, 0.6, 0, 0)};
    struct trip t = {0};
    uint32_t seen = 0, hidden = 0;
    OPEN_GPU(&t.gpu, .validation = true);
    REQUIRE(trip_open(&t, &move), "%s", t.err.msg);
    REQUIRE(trip_run(&t, &move, 0), "%s", t.err.msg);
    for (uint32_t y = 6; y < 58; y++)
        for (uint32_t x = 6; x < 90; x++) {
            enum surface surface;
            enum past_view past = past_of(&move, x + 0.5, y + 0.5, &surface);
            if (past == PAST_OUTSIDE || !is_clear(&move, x, y, past))
                continue;
            double place = told(&t, &move, x, y, 0);
            CHECK(isnan(place) == (past == PAST_HIDDEN), "pixel %u %u of %s: history of %g", x, y,
                  surface == POST ? "the post" : "the wall", place);
            seen += past == PAST_SEEN;
            hidden += past == PAST_HIDDEN;
        }
    printf("  %u pixels were seen, %u were hidden\n", seen, hidden);
    CHECK(seen > 500 && hidden > 200, "%u and %u pixels", seen, hidden);
    trip_close(&t);
}

// --- what is not taken ---------------------------------------------------------------------------

static struct made_pixel with_samples(const void *context, uint32_t x, uint32_t y)
{
    static const struct view front = {
        {.direction = {0, 0, -1}, .up = {0, 1, 0}, .kind = CAMERA_ORTHOGRAPHIC, .height = 2},
        96,
        64};
    const struct painting p = {WORLD_WALL_AND_POST, &front, 0};
    struct made_pixel pixel = paint(&p, x, y);
    pixel.samples = *(const uint32_t *)context;
    pixel.light[0] += 0.1f * (float)(x * 7 + y * 13 % 5);
    pixel.apart[0] = 0.05f;
    return pixel;
}

// Runs with and without the history. Returns whether the results differ.
static bool differs(struct trip *t, const struct move *m, uint32_t samples, bool *differs_out)
{
    size_t bytes = (size_t)m->to.width * m->to.height * sizeof *t->to.picture;
    float(*without)[4] = malloc(bytes);
    struct denoise_call call = {.renderer = &t->to.renderer, .camera = &m->to.camera};
    bool ok = without && film_make(&t->to, with_samples, &samples, &t->err) &&
              film_denoise(&t->to, &t->denoiser, &call, &t->err);
    if (ok) {
        memcpy(without, t->to.picture, bytes);
        call.temporal = true;
        ok = film_denoise(&t->to, &t->denoiser, &call, &t->err);
        *differs_out = memcmp(without, t->to.picture, bytes) != 0;
    }
    free(without);
    return ok;
}

// A film of 64 samples uses no history, one without samples leaves none, and a discarded history is
// not used.
TEST(history_ends)
{
    const struct view front = look(CAMERA_ORTHOGRAPHIC, 0, 0, 0, 0);
    const struct move move = {"at rest", WORLD_WALL_AND_POST, front, front};
    const struct denoise_call *keep;
    struct trip t = {0};
    bool with_63, with_64, with_empty, when_forgotten;
    OPEN_GPU(&t.gpu, .validation = true);
    REQUIRE(trip_open(&t, &move), "%s", t.err.msg);
    REQUIRE(trip_run(&t, &move, 0), "%s", t.err.msg);
    REQUIRE(differs(&t, &move, 63, &with_63) && differs(&t, &move, 64, &with_64), "%s", t.err.msg);
    CHECK(with_63 && !with_64, "the history counts with 63 samples: %d, with 64: %d", with_63,
          with_64);
    keep = &(const struct denoise_call){.renderer = &t.to.renderer, .camera = &move.to.camera};
    REQUIRE(renderer_clear(&t.to.renderer, &t.err) && denoiser_keep(&t.denoiser, keep, &t.err),
            "%s", t.err.msg);
    REQUIRE(differs(&t, &move, 4, &with_empty), "%s", t.err.msg);
    CHECK(with_empty, "an empty film took the place of the history");
    denoiser_forget(&t.denoiser);
    REQUIRE(differs(&t, &move, 4, &when_forgotten), "%s", t.err.msg);
    CHECK(!when_forgotten, "what was forgotten still counts");
    trip_close(&t);
}

// --- what moved ----------------------------------------------------------------------------------

// Computes where a place of the picture was in the history's picture, and whether it was visible
// there. Returns false if it is outside, or next to an edge, now or then, where the filter's pixels
// contain both surfaces.
static bool past_of_card(const struct move *m, double x, double y, double at[2], bool *was_seen)
{
    if (x < 2 || x > m->to.width - 2 || y < 2 || y > m->to.height - 2)
        return false;
    struct seen now = see(m->world, &m->to, x, y);
    double past[3];
    const struct denoise_motion motion = card_motion(m);
    memcpy(past, now.point, sizeof past);
    if (now.surface == CARD)
        affine_point(motion.to_past, now.point, past);
    if (!find(&m->from, past, at) || at[0] < 6 || at[0] > m->from.width - 6 || at[1] < 6 ||
        at[1] > m->from.height - 6)
        return false;
    *was_seen = see(m->world, &m->from, at[0], at[1]).surface == now.surface;
    for (int dy = -4; dy <= 4; dy++)
        for (int dx = -4; dx <= 4; dx++) {
            bool beside = see(m->world, &m->from, at[0] + dx, at[1] + dy).surface == now.surface;
            if (see(m->world, &m->to, x + dx, y + dy).surface != now.surface || beside != *was_seen)
                return false;
        }
    return true;
}

// Moved objects use the history at their former position, others that at their own, and surfaces
// that have become visible have none.
TEST(what_moved_is_followed)
{
    const struct view front = look(CAMERA_PERSPECTIVE, 0, 0, 0, 0);
    const struct move moves[] = {
        {"moved", WORLD_WALL_AND_CARD, with_card(front, -0.3, 0, -3, 0, 1),
         with_card(front, 0.213, 0.1, -3, 0, 1)},
        {"turned", WORLD_WALL_AND_CARD, with_card(front, 0, 0, -3, -10, 1),
         with_card(front, 0, 0, -3, 23, 1)},
        {"scaled", WORLD_WALL_AND_CARD, with_card(front, 0, 0, -3, 10, 1),
         with_card(front, 0, 0, -3, 10, 0.7)},
        {"nearer, and the camera moved", WORLD_WALL_AND_CARD, with_card(front, 0, 0, -3.5, 5, 1),
         with_card(look(CAMERA_PERSPECTIVE, 2, 0.2, 0.1, 0), 0.3, 0, -3, 0, 1)},
        {"parallel", WORLD_WALL_AND_CARD,
         with_card(look(CAMERA_ORTHOGRAPHIC, 0, 0, 0, 0), -0.5, 0, -3, 0, 1.8),
         with_card(look(CAMERA_ORTHOGRAPHIC, 0, 0, 0, 0), 0.5, 0.2, -3, 15, 1.8)},
    };
    for (size_t i = 0; i < sizeof moves / sizeof *moves; i++) {
        const struct move *m = &moves[i];
        struct trip t = {0};
        double worst = 0;
        uint32_t found[2] = {0}, uncovered = 0;
        OPEN_GPU(&t.gpu, .validation = true);
        REQUIRE(trip_open(&t, m), "%s", t.err.msg);
        for (int axis = 0; axis < 2; axis++) {
            denoiser_forget(&t.denoiser);
            REQUIRE(trip_run(&t, m, axis), "%s", t.err.msg);
            for (uint32_t p = 0; p < m->to.width * m->to.height; p++) {
                uint32_t x = p % m->to.width, y = p / m->to.width;
                double at[2], place = told(&t, m, x, y, axis);
                bool was_seen, is_card;
                if (!past_of_card(m, x + 0.5, y + 0.5, at, &was_seen))
                    continue;
                is_card = see(m->world, &m->to, x + 0.5, y + 0.5).surface == CARD;
                CHECK(isnan(place) != was_seen, "%s: pixel %u %u: history of %g, expected %g",
                      m->name, x, y, place, was_seen ? at[axis] : NAN);
                worst = fmax(worst, isnan(place) || !was_seen ? 0 : fabs(place - at[axis]));
                found[is_card] += was_seen;
                uncovered += !was_seen;
            }
        }
        printf("  %s: %u pixels of the card and %u of the wall within %.4f of one; %u uncovered\n",
               m->name, found[1], found[0], worst, uncovered);
        CHECK(worst <= 0.1 && found[0] > 300 && found[1] > 300,
              "%s: %g pixels off, %u and %u found", m->name, worst, found[0], found[1]);
        trip_close(&t);
    }
}

// --- what it says of the variance ----------------------------------------------------------------

// A wall in front of an orthographic camera has light 1. The present film has one sample per pixel,
// 1.5 or 0.5; the history has 64, and halves that give the same variance. Every fourth pixel of
// every fourth row is different.
struct noisy {
    bool is_past;
    float past_normal[3]; // normal of the pixels that are different
    uint32_t past_samples;
};

static bool is_different(uint32_t x, uint32_t y)
{
    return x % 4 == 1 && y % 4 == 1;
}

static struct made_pixel noise(const void *context, uint32_t x, uint32_t y)
{
    const struct noisy *n = context;
    uint32_t hash = (x * 73856093u) ^ (y * 19349663u);
    float sign = (hash * 2654435761u) >> 31 ? 0.5f : -0.5f;
    float light = n->is_past ? 1.0f : 1.0f + sign, apart = n->is_past ? sign / 8 : 0.0f;
    struct made_pixel pixel = {
        .samples = n->is_past ? 64 : 1,
        .light = {light, light, light},
        .apart = {apart, apart, apart},
        .albedo = {0.5f, 0.5f, 0.5f},
        .normal = {0, 0, 1},
        .depth = 6,
        .alpha = 1,
    };
    if (n->is_past && is_different(x, y)) {
        memcpy(pixel.normal, n->past_normal, sizeof pixel.normal);
        pixel.samples = n->past_samples;
    }
    return pixel;
}

// Returns the mean square of the remaining noise, initially 0.25, in the pixels that are different.
static double left_over(const struct trip *t)
{
    double sum = 0;
    uint32_t count = 0;
    for (uint32_t y = 0; y < t->to.height; y++)
        for (uint32_t x = 0; x < t->to.width; x++)
            if (is_different(x, y)) {
                double error = (double)t->to.picture[y * t->to.width + x][0] / 0.5 - 1;
                sum += error * error;
                count++;
            }
    return sum / count;
}

// A pixel whose history hardly fits, as where two surfaces meet, or that has none, is filtered as
// without any history: its variance is not that of its neighbours, which have one.
TEST(a_poor_history_leaves_no_noise)
{
    const struct view front = look(CAMERA_ORTHOGRAPHIC, 0, 0, 0, 0);
    const struct move move = {"at rest", WORLD_WALL_AND_POST, front, front};
    const struct noisy now = {.is_past = false};
    // The weight of normals is their cosine^128: 0.37 and 0.0014.
    const struct {
        const char *name;
        struct noisy past;
    } cases[] = {
        {"turned by 7 degrees", {true, {0.122f, 0, 0.99255f}, 64}},
        {"turned by 18 degrees", {true, {0.312f, 0, 0.9501f}, 64}},
        {"none", {true, {0, 0, 1}, 0}},
    };
    struct trip t = {0};
    OPEN_GPU(&t.gpu, .validation = true);
    REQUIRE(trip_open(&t, &move), "%s", t.err.msg);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct denoise_call keep = {.renderer = &t.from.renderer,
                                          .camera = &move.from.camera};
        struct denoise_call run = {.renderer = &t.to.renderer, .camera = &move.to.camera};
        REQUIRE(film_make(&t.from, noise, &cases[i].past, &t.err) &&
                    denoiser_keep(&t.denoiser, &keep, &t.err) &&
                    film_make(&t.to, noise, &now, &t.err) &&
                    film_denoise(&t.to, &t.denoiser, &run, &t.err),
                "%s", t.err.msg);
        double without = left_over(&t);
        run.temporal = true;
        REQUIRE(film_denoise(&t.to, &t.denoiser, &run, &t.err), "%s", t.err.msg);
        double with = left_over(&t);
        printf("  %s: %.5f of 0.25 is left, without history %.5f\n", cases[i].name, with, without);
        CHECK(with <= without, "%s: %g, without history %g", cases[i].name, with, without);
        denoiser_forget(&t.denoiser);
    }
    trip_close(&t);
}

TEST_MAIN(TEST_CASE(history_is_where_it_was), TEST_CASE(what_was_hidden_has_no_history),
          TEST_CASE(history_ends), TEST_CASE(what_moved_is_followed),
          TEST_CASE(a_poor_history_leaves_no_noise))
