// The device's counters and queues, as the host sees them: one buffer, of BINDING_QUEUES.
#ifndef LAMPYRIS_RENDER_COUNTERS_H
#define LAMPYRIS_RENDER_COUNTERS_H

#include "render/render.h"

// Returns where a queue's slots begin in the buffer, in bytes: queues that are not needed have no
// row. That of QUEUE_COUNT is behind the last one's.
uint64_t queue_offset(const struct renderer *renderer, uint32_t queue);

// Where the host does not see the device's memory, a copy in memory that it does see belongs to
// them: reading that back needs neither staging memory nor a submission of its own.
bool counters_create(struct renderer *renderer, struct err *err);
void counters_finish(struct renderer *renderer);
// Records the copy, behind a barrier after the last kernel of a submission.
void counters_record_copy(struct renderer *renderer);
// Reads renderer->counters after that submission has ended.
void counters_read(struct renderer *renderer);
// Sets the device's to renderer->counters, at once.
bool counters_write(struct renderer *renderer, struct err *err);
// Sets both to 0, and what sorting rays has counted.
bool counters_clear(struct renderer *renderer, struct err *err);

#endif
