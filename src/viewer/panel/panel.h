// The panel: groups of controls for the whole state of the viewer. All changes are made through
// edit.h.
#ifndef LAMPYRIS_VIEWER_PANEL_PANEL_H
#define LAMPYRIS_VIEWER_PANEL_PANEL_H

#include "base/err.h"
#include <stdbool.h>

struct viewer;
struct panel; // texts being typed, and the filters of lists

bool panel_create(struct panel **out, struct err *err);
void panel_destroy(struct panel *panel); // accepts NULL
// Call this between gui_begin and gui_end in every frame, even if the panel is hidden.
void panel_draw(struct viewer *viewer);

#endif
