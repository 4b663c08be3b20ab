// The state of a run that renders several pictures. The files sequence_*.c share it.
#ifndef LAMPYRIS_CLI_RENDER_SEQUENCE_H
#define LAMPYRIS_CLI_RENDER_SEQUENCE_H

#include "cli/render/frame_name.h"
#include "cli/render/render_run.h"
#include "cli/render/sequence_plan.h"
#include "flatten/geometry.h"

// The progress of all pictures that this run renders.
struct sequence_progress {
    const struct progress *whole; // the command's progress
    uint32_t done, count;         // finished and all pictures; count is 0 while none is rendered
    double shown;                 // the greatest fraction so far
};

// The videos that are made of the pictures.
struct sequence_video {
    const char **paths; // names that end in .mp4 or .webm
    uint32_t count;
    uint32_t source;    // index in sequence.names of the PNG files from which videos are made
    const char *folder; // temporary folder of these files; NULL: the files are outputs
};

struct sequence {
    struct options options; // the options for a render of the current picture alone
    struct render_run run;
    struct sequence_progress shown;
    struct progress progress;
    struct frame_name *names; // names of the outputs
    uint32_t name_count;
    struct sequence_video video;
    uint32_t count, index; // number of pictures; the current one, from 0
    bool *is_finished;     // for each picture: whether an earlier run finished it
    uint32_t rendered, skipped;
    const char *identity; // everything that determines the pictures except their times or views
    struct camera camera; // camera of the first picture, which is kept if the program chose it
    double ground[2][3];  // centre and normal of the ground that was added to the first picture
    struct turntable turntable;
    struct geometry geometry;
    struct arena frame_arena;   // memory of the names of the current picture
    uint64_t load_ns, bvh_ns;   // loading time of the current scene; the part of it for the BVH
    struct job_seconds seconds; // sums over all rendered pictures
    double worst_error;         // the greatest local relMSE of a picture; 0: none is known
    uint32_t worst;             // number of that picture, from 1
};

// --- sequence_names.c ---
// Lists the outputs, and finds the placeholders of the numbers in their names.
bool sequence_list_names(struct sequence *sequence, struct err *err);
// Checks that all outputs are different files and none is an input. All inputs must be known.
bool sequence_check_names(struct sequence *sequence, struct err *err);
// Makes picture `index`, from 0, the current one: sets its names, its time or view, and its
// identity.
bool sequence_turn_to(struct sequence *sequence, uint32_t index, struct err *err);

// --- sequence_resume.c ---
// Finds the pictures whose files all exist, are intact and belong to this sequence. Needs
// sequence->identity. Fails with ERR_INPUT if files belong to another sequence.
bool sequence_find_finished(struct sequence *sequence, struct err *err);

// --- sequence_report.c ---
bool sequence_report_frame(struct sequence *sequence, uint64_t start_ns, struct err *err);
bool sequence_report_skipped(const struct sequence *sequence, struct err *err);
bool sequence_report_end(const struct sequence *sequence, struct err *err);

// --- sequence_video.c ---
// Chooses the PNG files from which videos are made. If no output is PNG, adds PNG files in a
// temporary folder. Fails with ERR_USAGE if ffmpeg is not installed.
bool sequence_video_init(struct sequence *sequence, struct err *err);
// Checks that the codecs support the size of the pictures, which must be known.
bool sequence_video_check(const struct sequence *sequence, struct err *err);
// Makes the videos with ffmpeg. All pictures must be finished.
bool sequence_video_make(struct sequence *sequence, struct err *err);

#endif
