// The interactive viewer as a whole.
#ifndef LAMPYRIS_VIEWER_RUN_H
#define LAMPYRIS_VIEWER_RUN_H

struct options;

// Runs the viewer until it is closed, its script ends or a signal arrives. Returns the exit code.
int viewer_run(const struct options *options);

#endif
