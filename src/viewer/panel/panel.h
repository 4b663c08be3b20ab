// The panel: groups of controls for all that the viewer holds. Changes go through edit.h.
#ifndef LAMPYRIS_VIEWER_PANEL_PANEL_H
#define LAMPYRIS_VIEWER_PANEL_PANEL_H

#include "base/err.h"
#include <stdbool.h>

struct viewer;
struct panel; // what people typed into it, and its lists' filters

bool panel_create(struct panel **out, struct err *err);
void panel_destroy(struct panel *panel); // accepts NULL
// Between gui_begin and gui_end, in every frame, hidden or not.
void panel_draw(struct viewer *viewer);

#endif
