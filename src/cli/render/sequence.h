// The state of a render of several pictures, which its parts share.
#ifndef LAMPYRIS_CLI_RENDER_SEQUENCE_H
#define LAMPYRIS_CLI_RENDER_SEQUENCE_H

#include "cli/render/frame_name.h"
#include "cli/render/render_run.h"
#include "cli/render/sequence_plan.h"
#include "flatten/geometry.h"

// One progress for all pictures that are to be rendered.
struct sequence_progress {
    const struct progress *whole; // of the command
    uint32_t done, count;         // pictures; count 0: none is being rendered yet
    double shown;                 // the greatest fraction so far
};

// Makes a video of the pictures.
struct sequence_video {
    const char **paths; // .mp4 and .webm
    uint32_t count;
    uint32_t source;    // index of the names of the PNG files that it is made from
    const char *folder; // that is made for these files and removed in the end; NULL: they are kept
};

struct sequence {
    struct options options; // as they would be for one picture of this sequence
    struct render_run run;
    struct sequence_progress shown;
    struct progress progress;
    struct frame_name *names; // of the outputs
    uint32_t name_count;
    struct sequence_video video;
    uint32_t count, index; // pictures, and the one in work, from 0
    bool *is_finished;     // by a run before this one
    uint32_t rendered, skipped;
    const char *identity; // of all pictures: what decides them besides their place
    struct camera camera; // the first picture's, at which a framed camera stays
    double ground[2][3];  // centre and normal of the ground that was added to the first one
    struct turntable turntable;
    struct geometry geometry;
    struct arena frame_arena;   // names of the picture in work
    uint64_t load_ns, bvh_ns;   // of loading for the next picture, and of these for its hierarchy
    struct job_seconds seconds; // of all rendered pictures
    double worst_error;         // the greatest local relMSE of a picture; 0: none is known
    uint32_t worst;             // the picture that has it, from 1
};

// --- sequence_names.c ---
// Finds the places of the numbers in the names of all outputs.
bool sequence_list_names(struct sequence *sequence, struct err *err);
// When all inputs are known: checks that no two of the pictures are one file, and none an input.
bool sequence_check_names(struct sequence *sequence, struct err *err);
// Names the files of a picture, from 0, and says what it shows.
bool sequence_turn_to(struct sequence *sequence, uint32_t index, struct err *err);

// --- sequence_resume.c ---
// Finds the pictures whose files are all there, whole and of this sequence. Needs the identity.
// ERR_INPUT for files of another sequence.
bool sequence_find_finished(struct sequence *sequence, struct err *err);

// --- sequence_report.c ---
bool sequence_report_frame(struct sequence *sequence, uint64_t start_ns, struct err *err);
bool sequence_report_skipped(const struct sequence *sequence, struct err *err);
bool sequence_report_end(const struct sequence *sequence, struct err *err);

// --- sequence_video.c ---
// Chooses from which pictures the videos are made, and adds PNG files to the outputs where there
// are none. ERR_USAGE without ffmpeg.
bool sequence_video_init(struct sequence *sequence, struct err *err);
// When the size is known: checks that the codecs have it.
bool sequence_video_check(const struct sequence *sequence, struct err *err);
// Runs ffmpeg when all pictures are there.
bool sequence_video_make(struct sequence *sequence, struct err *err);

#endif
