// What the HTML reports share: one file that needs no network, with plots, tables and pictures.
#ifndef LAMPYRIS_APP_HTML_H
#define LAMPYRIS_APP_HTML_H

#include "arena.h"
#include "curve.h"
#include "gpu.h"
#include "image.h"
#include <stdio.h>

struct html_page {
    struct arena *arena;
    const char *folder; // of what stands beside the page
    FILE *out;
    char *text; // of `out`
    size_t size;
};

// Begins FOLDER/report.html in memory, with its title as a headline.
bool html_begin(struct html_page *page, struct arena *arena, const char *folder, const char *title,
                struct err *err);
// Writes it, or, after a failure, only releases it.
bool html_end(struct html_page *page, bool ok, struct err *err);

void html_text(struct html_page *page, const char *text); // escaped
// A table's cell, by a format of one double.
void html_interval(struct html_page *page, struct interval interval, const char *format);
void html_number(struct html_page *page, double value, const char *format);

// Runs a gnuplot script into FOLDER/NAME.gp and .svg, and takes the plot into the page. Without
// gnuplot a note stands there instead.
bool html_plot(struct html_page *page, const char *name, const char *script, struct err *err);
// Words for such a script, in quotes.
void html_plot_words(FILE *script, const char *text);
// Writes FOLDER/NAME.png and takes it into the page. attributes: of the element, such as a class.
bool html_picture(struct html_page *page, const char *name, const struct image *image,
                  const char *attributes, struct err *err);
// False colours, which are display values, as pictures hold them: linear.
void html_linearize(struct image *image);

// The machine, the device and its driver, our version and the command that was given.
void html_machine(struct html_page *page, const struct gpu *gpu, const char *command);

#endif
