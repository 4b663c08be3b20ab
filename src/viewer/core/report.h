// How fast it was, and how good: of a frame, and at the end.
#ifndef LAMPYRIS_VIEWER_CORE_REPORT_H
#define LAMPYRIS_VIEWER_CORE_REPORT_H

struct frame_times;
struct viewer;

// When it ends: how fast, and how good. To stdout, as --json or --quiet say.
void viewer_report(struct viewer *viewer);
void frame_times_add(struct frame_times *times, double ms);
// The value below which that part of them is, in [0, 1]; NAN without any. Puts them in order.
double frame_times_quantile(struct frame_times *times, double part);
void frame_times_finish(struct frame_times *times);
// The line at the head of the panel: frames since the start, for how long the chosen side's picture
// has been rendered, where the camera is.
#define VIEWER_HEADER_MAX 160
void viewer_header(const struct viewer *viewer, char out[VIEWER_HEADER_MAX]);
void viewer_count_frame(struct viewer *viewer); // statistics of the frame that ends

#endif
