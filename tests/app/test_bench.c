// Tests the conclusions of `lampyris bench` with invented times and pictures.
#include "cli/bench/bench.h"
#include "test.h"

enum { REPEATS = 7, VARIANTS = 3 };

TEST(every_variant_runs_once_a_round)
{
    for (uint32_t variants = 1; variants <= 8; variants++) {
        uint32_t follows[8][8] = {0}, rounds = 4 * variants;
        for (uint32_t round = 0; round < rounds; round++) {
            uint32_t seen = 0, last = 0;
            for (uint32_t n = 0; n < variants; n++) {
                uint32_t v = bench_turn(round, n, variants);
                CHECK(v < variants && !(seen >> v & 1u), "round %u: %u again", round, v);
                seen |= 1u << v;
                if (n > 0)
                    follows[last][v]++;
                last = v;
            }
        }
        // No variant always follows the same other one.
        for (uint32_t a = 0; variants > 2 && a < variants; a++)
            for (uint32_t b = 0; b < variants; b++)
                CHECK(follows[a][b] < rounds, "%u always follows %u of %u", b, a, variants);
    }
}

struct made_up {
    struct bench b;
    struct options options;
    struct bench_variant variants[VARIANTS];
    struct bench_row rows[VARIANTS][2];
    double ms[VARIANTS][2][REPEATS];
};

static void make_up(struct made_up *m)
{
    static const char *const labels[VARIANTS] = {"wave=1k", "wave=2k", "wave=1k spp=2"};
    *m = (struct made_up){
        .b = {.repeats = REPEATS, .repeats_done = REPEATS, .variant_count = VARIANTS}};
    m->b.variants = m->variants;
    m->b.options = &m->options;
    for (int v = 0; v < VARIANTS; v++) {
        m->variants[v] = (struct bench_variant){
            .variant = {.label = labels[v], .picture = v == 2 ? "spp=2" : ""},
            .scene_data = {.path = "room.json"},
            .rows = m->rows[v],
            .row_count = 2,
            .image_hash = v == 2 ? 7 : 5,
        };
        m->rows[v][0] = (struct bench_row){
            .kind = BENCH_KERNEL, .name = "intersect_closest", .ms = m->ms[v][0]};
        m->rows[v][1] =
            (struct bench_row){.kind = BENCH_WALL, .name = "repetition", .ms = m->ms[v][1]};
        for (int r = 0; r < REPEATS; r++) {
            m->ms[v][0][r] = (2 + v) * (1 + 0.01 * (r * 3 % REPEATS));
            m->ms[v][1][r] = 2 * m->ms[v][0][r];
        }
    }
}

TEST(medians_shares_and_ratios)
{
    struct made_up m;
    struct err err = {0};
    make_up(&m);
    CHECK(bench_conclude(&m.b, &err) && !m.b.differs, "%s", err.msg);
    const struct bench_row *row = &m.rows[1][0];
    CHECK(bench_find(&m.variants[1], "intersect_closest") == row, "not found");
    CHECK(fabs(row->median.value - 3 * 1.03) < 1e-12, "median %g", row->median.value);
    CHECK(row->median.low == 3.0 && fabs(row->median.high - 3 * 1.06) < 1e-12, "its interval");
    CHECK(fabs(row->share - 0.5) < 1e-12, "share %g", row->share);
    CHECK(fabs(row->ratio.value - 2.0 / 3.0) < 1e-12, "speed %g", row->ratio.value);
    CHECK(strcmp(bench_verdict(row->ratio), "slower") == 0, "%s", bench_verdict(row->ratio));
    CHECK(bench_wall(&m.variants[1]) == &m.rows[1][1], "wall");
    CHECK(strcmp(bench_verdict(m.rows[0][0].ratio), "not told apart") == 0, "itself");
}

TEST(pictures_that_differ_are_named)
{
    struct made_up m;
    struct err err = {0};
    make_up(&m);
    m.variants[1].image_hash = 6;
    CHECK(bench_conclude(&m.b, &err) && m.b.differs, "not seen");
    CHECK(strstr(m.b.difference.msg, "the picture of \"wave=2k\" (hash 0000000000000006) differs "
                                     "from that of \"wave=1k\" (hash 0000000000000005)"),
          "%s", m.b.difference.msg);
    make_up(&m);
    m.variants[2].differs = true;
    CHECK(bench_conclude(&m.b, &err) && m.b.differs, "not seen");
    CHECK(strstr(m.b.difference.msg, "wave=1k spp=2: the repetitions have different pictures"),
          "%s", m.b.difference.msg);
}

// Makes a baseline whose times are `factor` times the present ones.
static json_t *make_baseline(struct made_up *m, double factor)
{
    json_t *variants = json_array();
    for (int v = 0; v < VARIANTS; v++) {
        json_t *rows = json_array();
        for (int r = 0; r < 2; r++) {
            json_t *times = json_array();
            for (int i = 0; i < REPEATS; i++)
                json_array_append_new(times, json_real(m->ms[v][r][i] * factor));
            json_array_append_new(
                rows, json_pack("{s:s, s:o}", "name", m->rows[v][r].name, "repeat_ms", times));
        }
        json_array_append_new(
            variants, json_pack("{s:s, s:s, s:s, s:o}", "scene", "room.json", "label",
                                m->variants[v].variant.label, "image_hash",
                                v == 2 ? "0000000000000007" : "0000000000000005", "rows", rows));
    }
    return json_pack("{s:o}", "variants", variants);
}

TEST(changes_since_a_baseline)
{
    static const struct {
        double factor;
        enum curve_verdict verdict;
    } cases[] = {
        {0.5, CURVE_WORSE},
        {2.0, CURVE_BETTER},
        {1.0, CURVE_NOT_TOLD_APART},
        {1 / 1.04, CURVE_NOT_TOLD_APART}, // smaller changes than are
                                          // reported
        {1 / 1.25, CURVE_WORSE},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct made_up m;
        struct err err = {0};
        make_up(&m);
        m.b.baseline = make_baseline(&m, cases[i].factor);
        CHECK(bench_conclude(&m.b, &err) && bench_compare_baseline(&m.b, &err), "%s", err.msg);
        CHECK(m.b.change_count == 2 * VARIANTS, "%u rows", m.b.change_count);
        for (uint32_t c = 0; c < m.b.change_count; c++)
            CHECK(m.b.changes[c].verdict == cases[i].verdict, "x %g, row %u: %s", cases[i].factor,
                  c, bench_change_word(&m.b.changes[c]));
        CHECK(bench_is_slower(&m.b) == (cases[i].verdict == CURVE_WORSE), "slower");
        json_decref(m.b.baseline);
        arena_finish(&m.b.arena);
    }
}

// Times that are not known, or too few to compare, are not reported as changes.
TEST(what_is_not_known_has_not_changed)
{
    struct made_up m;
    struct err err = {0};
    make_up(&m);
    m.b.baseline = make_baseline(&m, 0.5);
    for (int r = 0; r < REPEATS; r++)
        m.ms[0][0][r] = NAN;
    json_t *rows =
        json_object_get(json_array_get(json_object_get(m.b.baseline, "variants"), 1), "rows");
    json_object_set_new(json_array_get(rows, 0), "repeat_ms", json_pack("[n, f]", 1.0));
    json_object_set_new(json_array_get(rows, 1), "repeat_ms", json_string("nonsense"));
    CHECK(bench_conclude(&m.b, &err) && bench_compare_baseline(&m.b, &err), "%s", err.msg);
    CHECK(isnan(m.rows[0][0].median.value), "a median of nothing");
    for (uint32_t c = 0; c < m.b.change_count; c++) {
        const struct bench_change *change = &m.b.changes[c];
        CHECK(change->row != &m.rows[0][0], "compared");
        CHECK((change->verdict == CURVE_WORSE) == (change->variant != &m.variants[1]), "row %u", c);
    }
    json_decref(m.b.baseline);
    arena_finish(&m.b.arena);
}

TEST_MAIN(TEST_CASE(every_variant_runs_once_a_round), TEST_CASE(medians_shares_and_ratios),
          TEST_CASE(pictures_that_differ_are_named), TEST_CASE(changes_since_a_baseline),
          TEST_CASE(what_is_not_known_has_not_changed))
