// Declarations that the files of the panel share.
#ifndef LAMPYRIS_VIEWER_PANEL_PANEL_INTERNAL_H
#define LAMPYRIS_VIEWER_PANEL_PANEL_INTERNAL_H

#include "viewer/core/document.h"
#include "viewer/core/shell.h"
#include "viewer/core/stage.h"
#include "viewer/core/viewpoint.h"

#define PANEL_RECENT 8u
#define PANEL_FILTER_MAX 64

// The rows of a list whose names contain the filter's text.
struct panel_filter {
    char text[PANEL_FILTER_MAX];
    char done[PANEL_FILTER_MAX]; // the text for which `rows` was computed
    const void *of;              // and the scene
    uint32_t of_count;
    uint32_t *rows; // NULL: all of them
    uint32_t count;
};

// The point about which an object rotates, as computed last.
struct panel_middle {
    uint64_t hash; // hash of the scene; 0: not computed
    uint32_t object;
    double transform[3][4], middle[3];
};

// The panel's files receive the state that they show, and request changes from the viewer, which is
// an opaque type here.
struct panel {
    struct viewer *viewer;
    struct gui *gui;
    struct window *window;
    struct arena *frame_arena; // emptied in every frame

    struct panel_filter materials, lights, objects;
    char scene_path[SURROUNDINGS_PATH_MAX]; // scene of the lists below
    struct arena files_arena;
    const char **files; // scenes in its folder
    uint32_t file_count;
    char recent[PANEL_RECENT][SURROUNDINGS_PATH_MAX];
    uint32_t recent_count;
    char open_path[SURROUNDINGS_PATH_MAX], save_path[SURROUNDINGS_PATH_MAX];
    bool saves_panel, saves_denoised;
    uint32_t slot; // index of a saved view
    struct panel_middle middle;
};

extern const struct gui_range panel_unit, panel_radiance, panel_turn;
// One control each; they return true when it changed. Positions are dragged in proportion to the
// size of the scene. Directions are normalized; zero, and directions along `up` unless that is
// NULL, are rejected.
bool panel_position(struct panel *panel, const struct document *document, const char *id,
                    const char *help, double position[3]);
bool panel_direction(struct panel *panel, const char *id, const char *help, const double *up,
                     double direction[3]);

#define PANEL_NAME_MAX 160

// A list with a filter.
struct panel_list {
    const char *id;   // "materials": rows are "materials.0" …
    const char *help; // help of a row
    uint32_t count, height;
    void (*name)(void *context, uint32_t row, char out[PANEL_NAME_MAX]);
    // Draws an element in front of a row's name; or NULL.
    void (*before)(void *context, uint32_t row);
    void *context;
    const void *of; // owner of the rows: the filter is applied again when it changes
};
// Returns true when *chosen has changed.
bool panel_list(struct panel *panel, struct panel_filter *filter, const struct panel_list *list,
                uint32_t *chosen);

// Draws the controls of all settings that have a label.
void panel_settings(struct panel *panel, const struct document *document, struct settings *to);

void panel_overlay(struct panel *panel, const struct document *document, const struct stage *stage,
                   const struct viewpoint *view, const struct shell *shell); // over the image
void panel_statistics(struct panel *panel, const struct document *document,
                      const struct stage *stage);
void panel_error_by(struct panel *panel, const struct stage *stage); // inside the statistics
void panel_renderer(struct panel *panel, const struct document *document, struct stage *stage);
void panel_view(struct panel *panel, struct stage *stage, struct viewpoint *view);
void panel_camera(struct panel *panel, const struct document *document, struct viewpoint *view);
void panel_scene(struct panel *panel, struct document *document);
void panel_surroundings(struct panel *panel, const struct document *document);
void panel_lights(struct panel *panel, struct document *document);
void panel_materials(struct panel *panel, struct document *document);
void panel_place(struct panel *panel,
                 const struct document *document); // place of the chosen object

#endif
