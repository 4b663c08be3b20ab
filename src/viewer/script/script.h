// A script: a file of commands that simulate user input frame by frame.
#ifndef LAMPYRIS_VIEWER_SCRIPT_SCRIPT_H
#define LAMPYRIS_VIEWER_SCRIPT_SCRIPT_H

#include "base/err.h"

struct script;
struct viewer;

bool script_open(const char *path, struct script **out, struct err *err);
void script_close(struct script *script); // accepts NULL
// Runs the script for one frame: pushes the events that are due. Call it before the frame's events
// are read. Returns false if a command failed (err has file, line and what was expected), or if the
// script has ended (viewer->shell.wants_quit is then set and err is empty).
bool script_step(struct script *script, struct viewer *viewer, struct err *err);

#endif
