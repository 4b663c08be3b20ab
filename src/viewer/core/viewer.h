// The interactive viewer: the state that its parts share.
//
// One thread runs everything, frame by frame (viewer/run.c), except the worker's jobs. A frame
// reads input (window, script), applies it to the scene and the cameras, renders for the frame's
// time, and displays the result.
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
