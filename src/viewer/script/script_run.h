// The state of a running script, for the files of this folder.
#ifndef LAMPYRIS_VIEWER_SCRIPT_SCRIPT_RUN_H
#define LAMPYRIS_VIEWER_SCRIPT_SCRIPT_RUN_H

#include "viewer/script/script_words.h"
#include "viewer/script/state.h"

struct viewer;

// The result of one frame of a command.
enum step {
    STEP_DONE,  // the next command may begin in the same frame
    STEP_AGAIN, // the command continues in the next frame
    STEP_FAILED
};

// The state of the current command. It is zero when the command begins.
struct progress_of {
    bool has_begun;
    uint32_t phase;
    uint64_t frame; // number of frames since the phase began
    // For the command `check`: the state, and the hash of the image, before the change.
    json_t *before;
    uint64_t picture;
};

struct script {
    struct arena arena;
    const char *path;
    struct command_line *commands;
    uint32_t count, at;
    struct progress_of now;
    double started;         // time of the clock at which the current command began
    double timeout_seconds; // greatest time that a command may take
    double mouse[2];
};

typedef enum step (*step_fn)(struct script *script, struct viewer *viewer,
                             const struct command_line *command, struct err *err);

// --- script_input.c: user input ------------------------------------------------------------------
enum step step_key(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_mouse(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_button(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_click(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_drag(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_scroll(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_text(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_set(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_drop(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_resize(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_minimise(struct script *, struct viewer *, const struct command_line *,
                        struct err *);
enum step step_close(struct script *, struct viewer *, const struct command_line *, struct err *);

// --- script_check.c: tests of the result ---------------------------------------------------------
enum step step_wait(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_hash(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_state(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_check(struct script *, struct viewer *, const struct command_line *, struct err *);
enum step step_expect(struct script *, struct viewer *, const struct command_line *, struct err *);

// Starts the next phase with its frame 0.
enum step next_phase(struct script *script);
// Continues in the next frame until this phase has had the given number of frames; then returns
// STEP_DONE.
enum step rest_frames(struct script *script, uint64_t frames);

// The number of frames from a command to its effect on the image: events that are pushed are read
// in the next frame, at whose end their effect is on the screen.
#define FRAMES_TO_SEE 2u

#endif
