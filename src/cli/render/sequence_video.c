// Makes videos of a sequence with ffmpeg. They are made from PNG files, either outputs of the run
// or files in a temporary folder. The folder stays until the videos are complete, so that an
// interrupted run can be resumed.
#include "cli/render/sequence.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/file_handle.h"
#include "base/file_inputs.h"
#include "base/file_system.h"
#include "base/process.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>

static bool is_mp4(const char *path)
{
    return path_has_extension(path, "mp4");
}

static bool add_source(struct sequence *s, struct err *err)
{
    struct sequence_video *video = &s->video;
    video->source = 0;
    while (video->source < s->name_count &&
           !path_has_extension(s->names[video->source].path, "png"))
        video->source++;
    if (video->source < s->name_count)
        return true;
    struct arena *arena = &s->run.arena;
    video->folder = arena_printf(arena, "%s.frames", video->paths[0]);
    const char *path = video->folder ? arena_printf(arena, "%s/%%04d.png", video->folder) : NULL;
    if (!path)
        return err_memory(err, "output names", strlen(video->paths[0]) + 32);
    return file_make_folder(video->folder, err) &&
           frame_name_parse(path, &s->names[s->name_count++], err);
}

bool sequence_video_init(struct sequence *s, struct err *err)
{
    const struct sequence_video *video = &s->video;
    if (video->count == 0)
        return true;
    if (!program_is_installed("ffmpeg"))
        return err_set(err, ERR_USAGE,
                       "--output: \"%s\" needs the program ffmpeg, which is not in PATH; expected "
                       "ffmpeg (Debian's package ffmpeg), or numbered pictures only, as in -o "
                       "name_####.png",
                       video->paths[0]);
    for (uint32_t i = 0; i < video->count; i++)
        if (!file_check_writable(video->paths[i], err))
            return false;
    return add_source(s, err);
}

bool sequence_video_check(const struct sequence *s, struct err *err)
{
    const struct settings *settings = &s->run.scene.settings;
    const struct render_window *window = &s->run.window;
    const uint32_t width = window->width > 0 ? window->width : settings->width;
    const uint32_t height = window->width > 0 ? window->height : settings->height;
    for (uint32_t i = 0; i < s->video.count; i++) {
        if (!file_inputs_check(s->video.paths[i], err))
            return false;
        if (is_mp4(s->video.paths[i]) && (width % 2 || height % 2))
            return err_set(
                err, ERR_USAGE,
                "--output: \"%s\": H.264 in MP4 needs an even width and height; expected "
                "%ux%u pixels, or .webm",
                s->video.paths[i], width + width % 2, height + height % 2);
    }
    return true;
}

// Adds "./" to a relative path, so that ffmpeg takes it neither for an option nor for a protocol.
static const char *plain_path(const char *path, struct arena *arena)
{
    return path_is_absolute(path) ? path : arena_printf(arena, "./%s", path);
}

static bool read_words(FILE *file, char *out, size_t size)
{
    rewind(file);
    size_t length = fread(out, 1, size - 1, file);
    while (length > 0 && (out[length - 1] == '\n' || out[length - 1] == '\r'))
        length--;
    out[length] = '\0';
    return length > 0;
}

// Runs ffmpeg and waits for its end. Kills ffmpeg if the progress listener requests a stop.
static bool run(const struct sequence *s, const char *const *arguments, struct err *err)
{
    struct process process;
    bool is_well = false, is_stopped = false;
    FILE *words = file_stream_temporary();
    if (!words)
        return err_set(err, ERR_SYSTEM,
                       "cannot create a temporary file for the output of ffmpeg: %s",
                       strerror(errno));
    const struct process_params params = {
        .arguments = arguments, .out = words, .has_errors_in_out = true};
    bool ok = process_start(&process, &params, err);
    while (ok && !is_stopped && !process_has_ended(&process, &is_well)) {
        is_stopped = progress_should_stop(&s->progress);
        clock_sleep(0.02);
    }
    char said[300];
    if (is_stopped) {
        process_kill(&process);
        ok = err_set(err, ERR_STOPPED, "stopped while ffmpeg made the video; --resume continues");
    } else if (ok && !is_well) {
        ok = err_set(err, ERR_OUTPUT, "ffmpeg failed: %s; the pictures are kept",
                     read_words(words, said, sizeof said) ? said : "it printed nothing");
    }
    fclose(words);
    return ok;
}

// Copies the file `from` to `path`. An existing file at `path` is replaced only when the copy is
// complete on the disk.
static bool copy(const char *from, const char *path, struct err *err)
{
    struct file_writer writer;
    uint8_t block[1 << 16];
    int64_t size = 0;
    int handle = file_handle_open(from);
    if (handle < 0)
        return err_set(err, ERR_OUTPUT, "%s: cannot be read: %s", from, strerror(errno));
    bool ok = file_writer_open(&writer, path, err);
    while (ok && (size = file_handle_read(handle, block, sizeof block)) > 0)
        ok = file_writer_write(&writer, block, (size_t)size, err);
    if (ok && size < 0)
        ok = err_set(err, ERR_OUTPUT, "%s: cannot be read: %s", from, strerror(errno));
    ok = ok && file_writer_commit(&writer, err);
    file_writer_finish(&writer);
    file_handle_close(handle);
    return ok;
}

// Makes one video, in the format that all players support: Rec. 709 with half the chroma resolution
// (4:2:0). ffmpeg neither syncs its file nor replaces another one atomically, so it writes a
// temporary file, which is then copied.
static bool make(const struct sequence *s, const char *path, struct arena *arena, struct err *err)
{
    const struct frame_name *source = &s->names[s->video.source];
    const char *pattern = frame_name_pattern(source, arena);
    const char *in = pattern ? plain_path(pattern, arena) : NULL;
    const char *made = arena_printf(arena, "%s.part", path);
    const char *out = made ? plain_path(made, arena) : NULL;
    const char *rate = arena_printf(arena, "%.9g", s->options.render.sequence.frames_per_s);
    const char *count = arena_printf(arena, "%u", s->count);
    if (!in || !out || !rate || !count)
        return err_memory(err, "the arguments of ffmpeg", 4096);
    const char *const mp4[] = {"libx264", "18", "mp4", "-movflags", "+faststart"};
    const char *const webm[] = {"libvpx-vp9", "20", "webm", "-b:v", "0"};
    const char *const *codec = is_mp4(path) ? mp4 : webm;
    const char *const arguments[] = {"ffmpeg",
                                     "-nostdin",
                                     "-loglevel",
                                     "error",
                                     "-y",
                                     "-f",
                                     "image2",
                                     "-framerate",
                                     rate,
                                     "-start_number",
                                     "1",
                                     "-i",
                                     in,
                                     "-frames:v",
                                     count,
                                     "-vf",
                                     "scale=out_color_matrix=bt709:out_range=tv",
                                     "-pix_fmt",
                                     "yuv420p",
                                     "-colorspace",
                                     "bt709",
                                     "-color_primaries",
                                     "bt709",
                                     "-color_trc",
                                     "iec61966-2-1",
                                     "-color_range",
                                     "tv",
                                     "-c:v",
                                     codec[0],
                                     "-crf",
                                     codec[1],
                                     codec[3],
                                     codec[4],
                                     "-f",
                                     codec[2],
                                     out,
                                     NULL};
    bool ok = (run(s, arguments, err) || err_prepend(err, "%s", path)) && copy(made, path, err);
    file_remove(made);
    return ok;
}

static void remove_source(struct sequence *s, struct arena *arena)
{
    for (uint32_t i = 1; i <= s->count; i++) {
        const char *path = frame_name_make(&s->names[s->video.source], i, arena);
        if (path)
            file_remove(path);
    }
}

bool sequence_video_make(struct sequence *s, struct err *err)
{
    struct arena arena = {0};
    bool ok = true;
    if (s->video.count > 0)
        progress_report(&s->progress, "Encoding", 0.0);
    for (uint32_t i = 0; ok && i < s->video.count; i++)
        ok = make(s, s->video.paths[i], &arena, err);
    if (ok && s->video.folder)
        remove_source(s, &arena);
    arena_finish(&arena);
    return ok;
}
