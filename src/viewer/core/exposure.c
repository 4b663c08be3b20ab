// Computes the automatic exposure from the image.
#include "viewer/core/exposure.h"

#include "image/image.h"
#include "viewer/core/viewer.h"

// It is recomputed at doubling numbers of samples until noise no longer matters; then it is kept
// while the camera moves, so that nothing flickers.
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
