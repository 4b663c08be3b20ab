// Computes the automatic exposure from the image.
#include "viewer/core/exposure.h"

#include "image/image.h"
#include "viewer/core/viewer.h"

// The number of samples after which the exposure is no longer updated. Until then it is computed at
// doubling numbers of samples, when noise still matters. Afterwards it is kept, even while the
// camera moves, so that the image does not flicker.
#define SAMPLES_LAST 64

void viewer_begin_exposure(struct viewer *viewer)
{
    viewer->stage.exposure_samples = viewer->stage.shown.exposure_is_auto ? 1 : 0;
}

bool viewer_find_exposure(struct viewer *viewer, struct err *err)
{
    struct view *view = &viewer->stage.sides[0];
    struct film_image film;
    if (viewer->stage.exposure_samples == 0 || !viewer->document.has_scene || !view->is_ready ||
        view->is_preview || view_samples(view) < viewer->stage.exposure_samples)
        return true;
    if (!job_copy_film(&view->job, &viewer->shell.frame_arena, &film, err))
        return false;
    const struct image image = {film.width, film.height, film.mean};
    viewer->stage.shown.exposure = image_measure_exposure(&image);
    uint64_t samples = view_samples(view);
    viewer->stage.exposure_samples = samples < SAMPLES_LAST ? 2 * samples : 0;
    return true;
}
