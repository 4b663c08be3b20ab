// The viewer of HTML reports. It shows images of equal size for comparison, with their errors
// against a reference. Its code in the page is viewer.js. The page contains the images in high
// dynamic range, as they were measured.
#ifndef LAMPYRIS_REPORT_HTML_VIEWER_H
#define LAMPYRIS_REPORT_HTML_VIEWER_H

#include "report/html.h"
#include <jansson.h>

struct html_viewer_params {
    uint32_t width, height; // size of every image
    uint32_t count;         // number of images, including the reference
    float exposure_stops;   // initial exposure
    // Initial tone curve. The page supports TONE_NONE and TONE_ACES and replaces others by
    // TONE_NONE.
    enum tone_curve tone;
};

struct html_viewer_picture {
    const char *label, *title; // the short and the full name
    const float (*pixels)[3];
    bool is_reference; // errors are measured against this image; true for at most one image
    const float *flip, *hdr_flip; // maps of FLIP and HDR-FLIP; both are NULL or neither is
};

struct html_viewer {
    struct html_page *page;
    // The JSON that viewer.js reads; `pictures` is the list of images in it.
    json_t *spec, *pictures;
    uint32_t width, height; // size of the images in the page
    uint32_t reduction;     // each pixel in the page is the mean of reduction x reduction pixels
    uint32_t bits;          // bits per component in the page: 16 (halves) or 32 (floats)
    uint32_t digits;        // decimal digits of a component in the page: 9, 4 or 3
    uint32_t source_width;
    uint32_t number; // number of this viewer in the page
};

// Begins a viewer. Images are stored as 32-bit floats if all of them together are small, otherwise
// as halves. If they are large, halves keep 9 of their 11 bits of precision; if that is still too
// much, squares of pixels are averaged, and the page says so. Call html_viewer_end() in any case.
bool html_viewer_begin(struct html_page *page, const struct html_viewer_params *params,
                       struct html_viewer *out, struct err *err);
bool html_viewer_add(struct html_viewer *viewer, const struct html_viewer_picture *picture,
                     struct err *err);
// Adds a number, with or without an interval, to the image that was added last. It is shown in
// captions of insets and in the plot of errors.
void html_viewer_figure(struct html_viewer *viewer, const char *name, struct interval value);
// Writes the description and ends the viewer if `ok` is set. Frees it in any case. Returns false if
// this or an earlier step has failed.
bool html_viewer_end(struct html_viewer *viewer, bool ok, struct err *err);
// Returns the greatest number of bytes that the page takes for these images while it is being
// assembled.
uint64_t html_viewer_bytes(const struct html_viewer_params *params);

#endif
