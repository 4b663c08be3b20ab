// Finds the pictures of a sequence that an earlier run has finished.
#include "cli/render/sequence.h"

#include "base/file.h"
#include "base/file_system.h"
#include "base/log.h"
#include "render/checkpoint.h"
#include <stdlib.h>
#include <string.h>

// Returns whether files of this format have metadata that image_decode_attributes() reads.
static bool has_metadata(const char *path)
{
    return path_has_extension(path, "exr") || path_has_extension(path, "png");
}

// Metadata of a file. A member is NULL if the file has no such entry.
struct said {
    const char *identity, *exposure;
};

// Reads a file, and returns whether all of it can be decoded. render replaces files atomically, but
// a faulty disk or an incomplete copy may have damaged them later.
static bool read_picture(const char *path, struct arena *arena, struct said *out, struct err *err)
{
    struct file_bytes file;
    struct image image;
    struct image_attribute *list;
    uint32_t count;
    const struct image_read_params params = {.path = path};
    *out = (struct said){0};
    if (!file_read_own(arena, path, 0, &file, err) ||
        !image_decode(file.data, file.size, &params, arena, &image, err) ||
        !image_decode_attributes(file.data, file.size, path, arena, &list, &count, err))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(list[i].key, SEQUENCE_ATTRIBUTE) == 0)
            out->identity = list[i].value;
        else if (strcmp(list[i].key, "lampyris:exposure") == 0)
            out->exposure = list[i].value;
    }
    return true;
}

// Takes the exposure from the first finished picture, because all pictures have the same exposure.
static void keep_exposure(struct render_run *run, const char *text)
{
    if (!text || run->exposure_is_kept)
        return;
    run->exposure = strtof(text, NULL);
    run->exposure_is_kept = true;
}

static bool check_file(struct sequence *s, const char *path, struct arena *arena, bool *is_whole,
                       struct err *err)
{
    struct said said;
    struct err failure = {0};
    *is_whole = read_picture(path, arena, &said, &failure);
    if (failure.code == ERR_BUDGET || failure.code == ERR_STOPPED) {
        *err = failure;
        return false;
    }
    if (!*is_whole) {
        log_warn("%s; the picture is rendered again", failure.msg);
        return true;
    }
    if (!said.identity)
        return err_set(err, ERR_INPUT,
                       "%s: does not name the sequence to which it belongs; expected a picture of "
                       "this one, or no --resume, which renders all pictures again",
                       path);
    if (!checkpoint_compare(path, said.identity, "this run", s->run.frame.identity, err))
        return err_set(err, err->code, "%s; without --resume all pictures are rendered again",
                       err->msg);
    keep_exposure(&s->run, said.exposure);
    return true;
}

// A picture is finished if all of its files exist and those with metadata belong to this sequence.
// Files with metadata are checked even if others are missing, because the picture that is rendered
// then would replace them.
static bool is_finished(struct sequence *s, bool *out, struct err *err)
{
    struct arena arena = {0};
    bool ok = true;
    *out = true;
    for (uint32_t i = 0; ok && i < s->name_count; i++) {
        const char *path = s->run.outputs[i];
        bool is_whole = file_exists(path);
        if (is_whole && has_metadata(path))
            ok = check_file(s, path, &arena, &is_whole, err);
        *out = *out && is_whole;
        arena_finish(&arena);
    }
    return ok;
}

bool sequence_find_finished(struct sequence *s, struct err *err)
{
    bool is_known = false;
    for (uint32_t i = 0; i < s->name_count; i++)
        is_known |= has_metadata(s->names[i].path);
    if (!is_known)
        return err_set(err, ERR_USAGE,
                       "--resume: JPEG, HDR and PFM files do not say to which sequence they "
                       "belong; expected an output in EXR or PNG, too");
    for (uint32_t i = 0; i < s->count; i++) {
        if (progress_should_stop(&s->progress))
            return err_set(err, ERR_STOPPED, "stopped while looking for finished pictures");
        if (!sequence_turn_to(s, i, err) || !is_finished(s, &s->is_finished[i], err))
            return false;
        s->skipped += s->is_finished[i];
    }
    return true;
}
