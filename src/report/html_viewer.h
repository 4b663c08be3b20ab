// The viewer of HTML reports: pictures of one size that are looked at beside each other, with their
// errors against a reference. Its code in the page is viewer.js; the pictures stand in the page as
// they were measured, in high dynamic range.
#ifndef LAMPYRIS_REPORT_HTML_VIEWER_H
#define LAMPYRIS_REPORT_HTML_VIEWER_H

#include "report/html.h"
#include <jansson.h>

struct html_viewer_params {
    uint32_t width, height; // size of every picture
    uint32_t count;         // pictures, the reference among them
    float exposure_stops;   // at the beginning
    enum tone_curve tone;   // the same; the page has TONE_NONE and TONE_ACES, and takes the former
                            // for others
};

struct html_viewer_picture {
    const char *label, *title; // short, and the whole name
    const float (*pixels)[3];
    bool is_reference;            // errors are measured against it; true for at most one picture
    const float *flip, *hdr_flip; // maps of FLIP; both, or both NULL
};

struct html_viewer {
    struct html_page *page;
    json_t *spec, *pictures; // what viewer.js reads; the pictures' entries in it
    uint32_t width, height;  // size of the pictures as the page shows them
    uint32_t reduction;      // pixels a side of which each pixel in the page is the mean; 1: none
    uint32_t bits;           // a component in the page: 16 (halves) or 32 (floats)
    uint32_t digits;         // decimal ones that a component has in the page: 9, 4 or 3
    uint32_t source_width;
    uint32_t number; // the viewer's number in the page
};

// Pictures stand in the page as 32-bit floats where all of them together are small, as halves
// otherwise, with 9 of their 11 bits where they are many, and averaged over squares of pixels where
// even these would be too many, which the page says. html_viewer_end() is to be called in any case.
bool html_viewer_begin(struct html_page *page, const struct html_viewer_params *params,
                       struct html_viewer *out, struct err *err);
bool html_viewer_add(struct html_viewer *viewer, const struct html_viewer_picture *picture,
                     struct err *err);
// A number about the picture that was added last, with its interval or without: for the captions
// of insets and for the plot of errors.
void html_viewer_figure(struct html_viewer *viewer, const char *name, struct interval value);
// Writes the description and ends the viewer, or, after a failure, only releases it. False where
// that or what came before fails.
bool html_viewer_end(struct html_viewer *viewer, bool ok, struct err *err);
// Bytes that the page takes at most for these pictures, while it is put together.
uint64_t html_viewer_bytes(const struct html_viewer_params *params);

#endif
