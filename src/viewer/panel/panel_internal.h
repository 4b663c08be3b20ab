// Declarations that the files of the panel share.
#ifndef LAMPYRIS_VIEWER_PANEL_PANEL_INTERNAL_H
#define LAMPYRIS_VIEWER_PANEL_PANEL_INTERNAL_H

#include "scene/core/bounds.h"
#include "viewer/core/document.h"
#include "viewer/core/recent.h"
#include "viewer/core/shell.h"
#include "viewer/core/stage.h"
#include "viewer/core/viewpoint.h"

#define PANEL_FILTER_MAX 64

// The rows of a list whose names contain a text.
struct panel_filter {
    char text[PANEL_FILTER_MAX];
    char done[PANEL_FILTER_MAX]; // the text for which `rows` was computed
    const void *of;              // the scene for which `rows` was computed
    uint32_t of_count;
    uint32_t *rows; // NULL: all rows
    uint32_t count;
};

// The centre of rotation of an object that was computed last.
struct panel_middle {
    uint64_t hash; // hash of the scene for which it was computed; 0: none
    uint32_t object;
    double transform[3][4], middle[3];
};

// The bounds of a mesh that were computed last.
struct panel_bounds {
    uint64_t hash; // hash of the scene for which they were computed; 0: none
    uint32_t mesh, deformations;
    struct bounds bounds;
};

// The state of the panel. Its files receive the state that they show, and request changes through
// `viewer`, an opaque type here.
struct panel {
    struct viewer *viewer;
    struct gui *gui;
    struct window *window;
    struct arena *frame_arena; // emptied at each frame

    struct panel_filter materials, lights, objects;
    char scene_path[SURROUNDINGS_PATH_MAX]; // path of the scene to which the lists below belong
    struct arena files_arena;
    const char **files; // scenes in the folder of that scene
    uint32_t file_count;
    struct recent recent;
    bool has_begun, keeps_recent; // the list is kept in a file
    char open_path[SURROUNDINGS_PATH_MAX], save_path[SURROUNDINGS_PATH_MAX];
    bool saves_panel, saves_denoised;
    uint32_t slot; // index of the selected saved view
    struct panel_middle middle;
    struct panel_bounds bounds;
    bool outlines; // the selected object is outlined
};

extern const struct gui_range panel_unit, panel_radiance, panel_turn;
// Each of these functions draws one control, and returns true when its value has changed. Dragging
// changes positions in proportion to the size of the scene. Directions are normalised; a zero
// vector is rejected, as is a direction along `up` (unless `up` is NULL).
bool panel_position(struct panel *panel, const struct document *document, const char *id,
                    const char *help, double position[3]);
bool panel_direction(struct panel *panel, const char *id, const char *help, const double *up,
                     double direction[3]);

#define PANEL_NAME_MAX 160

// A list with a filter.
struct panel_list {
    const char *id; // id of the list, such as "materials"; its rows have the ids "materials.0" …
    const char *help; // help text of every row
    uint32_t count, height;
    void (*name)(void *context, uint32_t row, char out[PANEL_NAME_MAX]);
    // Draws an element in front of the name of a row; may be NULL.
    void (*before)(void *context, uint32_t row);
    void *context;
    const void *of; // owner of the rows; if it changes, the filter is applied again
};
// Draws a list. Returns true when *chosen has changed.
bool panel_list(struct panel *panel, struct panel_filter *filter, const struct panel_list *list,
                uint32_t *chosen);

// Draws a control for each setting that has a label.
void panel_settings(struct panel *panel, const struct document *document, struct settings *to);

void panel_overlay(struct panel *panel, const struct document *document, const struct stage *stage,
                   const struct viewpoint *view, const struct shell *shell); // draws over the image
void panel_statistics(struct panel *panel, const struct document *document,
                      const struct stage *stage);
// Draws the sources of the error among the statistics.
void panel_error_by(struct panel *panel, const struct stage *stage);
void panel_renderer(struct panel *panel, const struct document *document, struct stage *stage);
void panel_view(struct panel *panel, struct stage *stage, struct viewpoint *view);
void panel_camera(struct panel *panel, const struct document *document, struct viewpoint *view);
void panel_recent_read(struct panel *panel);
void panel_scene(struct panel *panel, struct document *document);
// Draws the surface that was clicked, the objects and the materials.
void panel_objects(struct panel *panel, struct document *document);
void panel_surroundings(struct panel *panel, const struct document *document);
void panel_lights(struct panel *panel, struct document *document);
void panel_materials(struct panel *panel, struct document *document);
void panel_place(struct panel *panel,
                 const struct document *document); // placement of the selected object

#endif
