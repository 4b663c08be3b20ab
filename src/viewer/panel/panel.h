// The panel: groups of controls for all of the viewer's state. Changes go through edit.h.
#ifndef LAMPYRIS_VIEWER_PANEL_PANEL_H
#define LAMPYRIS_VIEWER_PANEL_PANEL_H

#include "base/err.h"
#include <stdbool.h>

struct viewer;
struct panel; // typed texts, and the filters of lists

bool panel_create(struct panel **out, struct err *err);
void panel_destroy(struct panel *panel); // accepts NULL
// Between gui_begin and gui_end, in every frame, hidden or not.
void panel_draw(struct viewer *viewer);

#endif
