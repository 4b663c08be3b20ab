// Writes HTML reports. Each is a single file with plots, tables and images that needs no network.
#ifndef LAMPYRIS_REPORT_HTML_H
#define LAMPYRIS_REPORT_HTML_H

#include "base/arena.h"
#include "base/memory_stream.h"
#include "gpu/gpu.h"
#include "image/image.h"
#include "metrics/curve.h"
#include <stdio.h>

struct html_page {
    struct arena *arena;
    const char *folder; // folder of the page
    const char *path;   // file of the page; NULL means FOLDER/report.html
    bool keeps_parts;   // plots, their scripts and images are also written as files beside the page
    float exposure_stops; // exposure, in stops, of the images that follow, except for false colours
    enum tone_curve tone;
    bool has_no_plots; // gnuplot is not available; the page has a note about that
    bool has_plots;
    uint32_t viewers; // number of viewers in the page, see html_viewer.h
    struct memory_stream stream;
    FILE *out; // stream of the page
};

// Checks that this run does not read FOLDER/report.html or the files results.json and results.csv
// beside it, which are about to be written. Fails with ERR_USAGE.
bool html_check_files(const char *folder, struct arena *arena, struct err *err);
// Does the same for a page with another name, which must end in .html or .htm, and checks that the
// page can be written. Does nothing if `path` is NULL.
bool html_check_file(const char *path, struct err *err);

// Begins the page FOLDER/report.html in memory, with its title as headline. keeps_parts is false.
bool html_begin(struct html_page *page, struct arena *arena, const char *folder, const char *title,
                struct err *err);
// Writes the page to its file if `ok` is set. Frees the page in any case.
bool html_end(struct html_page *page, bool ok, struct err *err);

void html_text(struct html_page *page, const char *text); // writes text and escapes it
void html_base64(struct html_page *page, const uint8_t *bytes, size_t count);
// Writes bytes in base 91, which viewer.js decodes. It takes 1.23 characters per byte, base64 takes
// 1.33.
void html_base91(struct html_page *page, const uint8_t *bytes, size_t count);
// Writes a table cell with a value and its interval. `format` has one double. An unknown value is
// written as "not known"; an unknown interval is omitted.
void html_interval(struct html_page *page, struct interval interval, const char *format);
void html_number(struct html_page *page, double value, const char *format);
// Writes a known value and its interval, if that is known, without a table cell.
void html_value(struct html_page *page, struct interval interval, const char *format);

// Runs a gnuplot script and embeds the plot. If gnuplot is not available, the page gets a single
// note instead. If parts are kept, they are NAME.gp and NAME.svg.
bool html_plot(struct html_page *page, const char *name, const char *script, struct err *err);
// Writes a text in quotes to a gnuplot script.
void html_plot_words(FILE *script, const char *text);
// Embeds an image. `attributes` are HTML attributes of the element, such as a class. If parts are
// kept, the file is NAME.png.
bool html_picture(struct html_page *page, const char *name, const struct image *image,
                  const char *attributes, struct err *err);
// If parts are kept, writes an image beside the page as NAME.png. The second function writes the
// false colours of metrics_difference_picture(), with fewer colours.
bool html_keep_picture(struct html_page *page, const char *name, const struct image *image,
                       struct err *err);
bool html_keep_difference(struct html_page *page, const char *name, const struct image *image,
                          const struct image *reference, struct err *err);
// Writes a description of the machine, the device, its driver, the version of this program, and the
// command.
void html_machine(struct html_page *page, const struct gpu *gpu, const char *command);

#endif
