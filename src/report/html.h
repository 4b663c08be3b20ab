// Writes HTML reports: one file that needs no network, with plots, tables and pictures.
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
    const char *folder;   // folder of the page
    const char *path;     // file of the page; NULL: FOLDER/report.html
    bool keeps_parts;     // plots, their scripts and pictures also stand beside the page, as files
    float exposure_stops; // for the following images, except false colours
    enum tone_curve tone;
    bool has_no_plots; // gnuplot is not there, which the page says
    bool has_plots;
    uint32_t viewers; // html_viewer.h
    struct memory_stream stream;
    FILE *out; // stream of the page
};

// Before the work: checks that neither FOLDER/report.html nor the results.json and results.csv
// beside it are files that this run reads. ERR_USAGE.
bool html_check_files(const char *folder, struct arena *arena, struct err *err);
// Checks the same of a page of another name (NULL: none), which ends in .html or .htm, and that it
// can be written.
bool html_check_file(const char *path, struct err *err);

// Begins FOLDER/report.html in memory, with its title as a headline, without keeping parts.
bool html_begin(struct html_page *page, struct arena *arena, const char *folder, const char *title,
                struct err *err);
// Writes it, or, after a failure, only releases it.
bool html_end(struct html_page *page, bool ok, struct err *err);

void html_text(struct html_page *page, const char *text); // escaped
void html_base64(struct html_page *page, const uint8_t *bytes, size_t count);
// For scripts of our own, which decode it (viewer.js): 1.23 characters a byte where base64
// has 1.33.
void html_base91(struct html_page *page, const uint8_t *bytes, size_t count);
// A table's cell, by a format of one double. Of an interval that is not known, its value alone.
void html_interval(struct html_page *page, struct interval interval, const char *format);
void html_number(struct html_page *page, double value, const char *format);
// Adds a value with its known interval, without a cell.
void html_value(struct html_page *page, struct interval interval, const char *format);

// Runs a gnuplot script and embeds the plot. Without gnuplot the page has one note instead. `name`:
// of the files if parts are kept, NAME.gp and NAME.svg.
bool html_plot(struct html_page *page, const char *name, const char *script, struct err *err);
// Writes words for such a script, in quotes.
void html_plot_words(FILE *script, const char *text);
// Embeds an image. attributes: of the element, such as a class. `name`: of the file if parts are
// kept, NAME.png.
bool html_picture(struct html_page *page, const char *name, const struct image *image,
                  const char *attributes, struct err *err);
// Where parts are kept, writes a picture beside the page, NAME.png; and false colours of relative
// differences, as metrics_difference_picture has them, in fewer colours.
bool html_keep_picture(struct html_page *page, const char *name, const struct image *image,
                       struct err *err);
bool html_keep_difference(struct html_page *page, const char *name, const struct image *image,
                          const struct image *reference, struct err *err);
// The machine, the device and its driver, our version and the command that was given.
void html_machine(struct html_page *page, const struct gpu *gpu, const char *command);

#endif
