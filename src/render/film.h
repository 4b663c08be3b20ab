// Creates the film in device memory, in one or several buffers, each for a range of pixels, and
// reads it back.
#ifndef LAMPYRIS_RENDER_FILM_H
#define LAMPYRIS_RENDER_FILM_H

#include "render/render.h"

bool film_create(struct renderer *renderer, struct err *err);
void film_finish(struct renderer *renderer);

#endif
