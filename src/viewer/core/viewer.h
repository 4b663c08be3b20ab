// The interactive viewer: the state that its parts share.
//
// One thread does all work, frame by frame (viewer/run.c), except for the worker's tasks. A frame
// reads input (from the window or a script), applies it to the scene and the cameras, renders for
// the frame's time, and displays the result.
#ifndef LAMPYRIS_VIEWER_CORE_VIEWER_H
#define LAMPYRIS_VIEWER_CORE_VIEWER_H

#include "viewer/core/document.h"
#include "viewer/core/shell.h"
#include "viewer/core/stage.h"
#include "viewer/core/viewpoint.h"

struct viewer {
    struct document document;
    struct viewpoint view;
    struct stage stage;
    struct shell shell;
};

#endif
