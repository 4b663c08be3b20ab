// Statistics of speed and error: of a frame, and at the end.
#ifndef LAMPYRIS_VIEWER_CORE_REPORT_H
#define LAMPYRIS_VIEWER_CORE_REPORT_H

struct frame_times;
struct viewer;

// Prints the summary at the end to stdout, as --json or --quiet say.
void viewer_report(struct viewer *viewer);
void frame_times_add(struct frame_times *times, double ms);
// Returns the quantile `part`, in [0, 1], of the times; NAN if there are none. Sorts them.
double frame_times_quantile(struct frame_times *times, double part);
void frame_times_finish(struct frame_times *times);
// Formats the line at the top of the panel: frames since the start, render time of the selected
// side's image, position of the camera.
#define VIEWER_HEADER_MAX 160
void viewer_header(const struct viewer *viewer, char out[VIEWER_HEADER_MAX]);
void viewer_count_frame(struct viewer *viewer); // adds the frame that ends to the statistics

#endif
