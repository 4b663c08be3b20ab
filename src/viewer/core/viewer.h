// The interactive viewer: what its parts share.
//
// One thread runs all of it, frame by frame (viewer/run.c), but for jobs of the worker. A frame
// takes what happened (window, script), changes the scene and the cameras by it, renders for as
// long as a frame may take, and shows what there is.
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
