// Accesses the device's counters and queues, which share the buffer BINDING_QUEUES.
#ifndef LAMPYRIS_RENDER_COUNTERS_H
#define LAMPYRIS_RENDER_COUNTERS_H

#include "render/render.h"

// Returns the byte offset of a queue's slots in the buffer; queues that are not needed take no
// space. For QUEUE_COUNT, returns the end of the last queue.
uint64_t queue_offset(const struct renderer *renderer, uint32_t queue);

// Creates a copy of the counters in host-visible memory, unless the device's memory is
// host-visible. Reading the copy needs neither staging memory nor a submission of its own.
bool counters_create(struct renderer *renderer, struct err *err);
void counters_finish(struct renderer *renderer);
// Records a barrier and the copy. Call it after the last kernel of a submission.
void counters_record_copy(struct renderer *renderer);
// Reads the counters into renderer->counters. Call it once the submission has ended.
void counters_read(struct renderer *renderer);
// Writes renderer->counters to the device at once.
bool counters_write(struct renderer *renderer, struct err *err);
// Zeroes the counters on the host and on the device, including those of the ray sort.
bool counters_clear(struct renderer *renderer, struct err *err);

#endif
