#include "cli/progress_bar.h"

#include "base/clock.h"
#include "base/signals.h"
#include "base/terminal.h"
#include <stdlib.h>
#include <string.h>

#define SECOND_NS UINT64_C(1000000000)

// A bar is redrawn often enough to move visibly, and seldom enough to cost hardly any time. In a
// log file, lines are printed less often.
#define REDRAW_NS (SECOND_NS / 10)
#define LINE_NS (SECOND_NS * 5)

void progress_bar_init(struct progress_bar *bar, FILE *stream)
{
    *bar = (struct progress_bar){.stream = stream};
    bar->is_terminal = terminal_is_smart(stream);
    mutex_init(&bar->mutex);
}

static void format_seconds(double seconds, char *out, size_t size)
{
    if (seconds < 60)
        snprintf(out, size, "%.1f s", seconds);
    else if (seconds < 3600)
        snprintf(out, size, "%d min %02d s", (int)seconds / 60, (int)seconds % 60);
    else if (seconds < 1e6 * 3600)
        snprintf(out, size, "%d h %02d min", (int)(seconds / 3600),
                 (int)(seconds / 60 - 60 * (int)(seconds / 3600)));
    else
        snprintf(out, size, "very long");
}

// Moves to the start of the line, and clears it (ECMA-48, EL).
static void clear_line(struct progress_bar *bar)
{
    if (bar->line_open)
        fputs("\r\x1b[K", bar->stream);
    bar->line_open = false;
}

static void draw_bar(struct progress_bar *bar, double fraction, const char *times)
{
    enum { MOST_CELLS = 40 };
    char cells[MOST_CELLS + 1];
    // "PHASE: [" … "] 100% (TIMES)", and one free column, since some terminals wrap at the last
    // column.
    int fixed = (int)(strlen(bar->phase) + strlen(times)) + 13;
    int width = terminal_columns(bar->stream) - fixed;
    width = width > MOST_CELLS ? MOST_CELLS : width;
    clear_line(bar);
    if (width >= 5) {
        memset(cells, ' ', (size_t)width);
        memset(cells, '+', (size_t)(fraction * width));
        cells[width] = '\0';
        fprintf(bar->stream, "%s: [%s] %3d%% (%s)", bar->phase, cells, (int)(fraction * 100),
                times);
    } else {
        fprintf(bar->stream, "%3d%%", (int)(fraction * 100));
    }
    bar->line_open = true;
    fflush(bar->stream);
}

static void show(struct progress_bar *bar, double fraction, uint64_t now_ns)
{
    double elapsed = (double)(now_ns - bar->phase_start_ns) * 1e-9;
    double since = (double)(now_ns - bar->from_ns) * 1e-9, way = fraction - bar->from_fraction;
    char passed[32], left[32] = "?";
    format_seconds(elapsed, passed, sizeof passed);
    if (way > 0)
        format_seconds(since * (1 - fraction) / way, left, sizeof left);
    if (bar->is_terminal) {
        char times[80];
        snprintf(times, sizeof times, "%s | %s", passed, left);
        draw_bar(bar, fraction, times);
    } else {
        fprintf(bar->stream, "%s: %d%% (%s elapsed, %s remaining)\n", bar->phase,
                (int)(fraction * 100), passed, left);
    }
    bar->shown = true;
    bar->shown_ns = now_ns;
}

// Prints the time of a phase that was shown.
static void end_phase(struct progress_bar *bar, uint64_t now_ns)
{
    uint64_t taken_ns = now_ns - bar->phase_start_ns;
    clear_line(bar);
    if (bar->shown && taken_ns >= SECOND_NS) {
        char passed[32];
        format_seconds((double)taken_ns * 1e-9, passed, sizeof passed);
        fprintf(bar->stream, "%s: %s\n", bar->phase, passed);
    }
    bar->shown = false;
    bar->phase[0] = '\0';
}

static void start_phase(struct progress_bar *bar, const char *phase, double fraction,
                        uint64_t now_ns)
{
    bool names_at_once = bar->is_terminal && bar->shown;
    end_phase(bar, now_ns);
    snprintf(bar->phase, sizeof bar->phase, "%s", phase);
    bar->phase_start_ns = bar->from_ns = now_ns;
    bar->from_fraction = fraction;
    if (names_at_once)
        show(bar, fraction, now_ns);
}

void progress_bar_update(struct progress_bar *bar, const char *phase, double fraction,
                         uint64_t now_ns)
{
    if (bar->is_quiet)
        return;
    fraction = fraction > 0 ? fraction < 1 ? fraction : 1 : 0; // NaN counts as 0
    mutex_lock(&bar->mutex);
    if (strncmp(bar->phase, phase, sizeof bar->phase - 1) != 0)
        start_phase(bar, phase, fraction, now_ns);
    if (fraction < bar->from_fraction) {
        bar->from_fraction = fraction;
        bar->from_ns = now_ns;
    }
    uint64_t since_ns = now_ns - (bar->shown ? bar->shown_ns : bar->phase_start_ns);
    uint64_t pause_ns = !bar->shown ? SECOND_NS : bar->is_terminal ? REDRAW_NS : LINE_NS;
    if (since_ns >= pause_ns)
        show(bar, fraction, now_ns);
    mutex_unlock(&bar->mutex);
}

void progress_bar_finish(struct progress_bar *bar)
{
    mutex_lock(&bar->mutex);
    end_phase(bar, clock_ns());
    fflush(bar->stream);
    mutex_unlock(&bar->mutex);
}

static void report(void *context, const char *phase, double fraction)
{
    progress_bar_update(context, phase, fraction, clock_ns());
}

static bool should_stop(void *context)
{
    (void)context;
    return signals_received() != 0;
}

static void end(void *context)
{
    progress_bar_finish(context);
}

static void pause_bar(void *context)
{
    struct progress_bar *bar = context;
    mutex_lock(&bar->mutex);
    clear_line(bar);
    fflush(bar->stream);
    mutex_unlock(&bar->mutex);
}

struct progress progress_bar_listener(struct progress_bar *bar)
{
    return (struct progress){.report = report,
                             .should_stop = should_stop,
                             .context = bar,
                             .end = end,
                             .pause = pause_bar};
}

void progress_bar_log(void *context, enum log_level level, const char *message)
{
    static const char *const names[] = {"error", "warning", "note", "debug"};
    struct progress_bar *bar = context;
    mutex_lock(&bar->mutex);
    if (level == LOG_ERROR)
        end_phase(bar, clock_ns());
    clear_line(bar);
    fprintf(bar->stream, "lampyris: %s: %s\n", names[level], message);
    mutex_unlock(&bar->mutex);
}
