// The interactive viewer, all of it.
#ifndef LAMPYRIS_VIEWER_RUN_H
#define LAMPYRIS_VIEWER_RUN_H

struct options;

// Runs until it is closed, the script ends or a signal comes; returns the exit code.
int viewer_run(const struct options *options);

#endif
