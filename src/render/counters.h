// The device's counters and queues as the host sees them: one buffer, BINDING_QUEUES.
#ifndef LAMPYRIS_RENDER_COUNTERS_H
#define LAMPYRIS_RENDER_COUNTERS_H

#include "render/render.h"

// Returns the byte offset of a queue's slots in the buffer; queues that are not needed take no
// space. For QUEUE_COUNT it is the end of the last queue.
uint64_t queue_offset(const struct renderer *renderer, uint32_t queue);

// Creates a copy of the counters in memory that the host sees, if it does not see the device's
// memory: reading the copy needs neither staging memory nor a submission of its own.
bool counters_create(struct renderer *renderer, struct err *err);
void counters_finish(struct renderer *renderer);
// Records the copy behind a barrier, after the last kernel of a submission.
void counters_record_copy(struct renderer *renderer);
// Reads renderer->counters once that submission has ended.
void counters_read(struct renderer *renderer);
// Writes renderer->counters to the device at once.
bool counters_write(struct renderer *renderer, struct err *err);
// Sets the counters on the host and on the device to 0, and those of the sort of rays as well.
bool counters_clear(struct renderer *renderer, struct err *err);

#endif
