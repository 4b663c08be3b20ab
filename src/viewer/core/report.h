// Statistics of the viewer's speed and error, for each frame and at the end.
#ifndef LAMPYRIS_VIEWER_CORE_REPORT_H
#define LAMPYRIS_VIEWER_CORE_REPORT_H

struct frame_times;
struct viewer;

// Prints the summary to stdout at the end, in the form that --json or --quiet require.
void viewer_report(struct viewer *viewer);
void frame_times_add(struct frame_times *times, double ms);
// Returns the quantile `part`, in [0, 1], of the times; NAN if there are none. Sorts the times.
double frame_times_quantile(struct frame_times *times, double part);
void frame_times_finish(struct frame_times *times);
// Formats the line at the top of the panel: the number of frames since the start, the rendering
// time of the selected side's image, and the position of the camera.
#define VIEWER_HEADER_MAX 160
void viewer_header(const struct viewer *viewer, char out[VIEWER_HEADER_MAX]);
void viewer_count_frame(struct viewer *viewer); // adds the frame that has ended to the statistics

#endif
