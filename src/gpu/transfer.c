// Copies between the host and buffers, and waits for the end of each copy.
#include "gpu/gpu_internal.h"
#include <stdlib.h>
#include <string.h>

// Staging memory of this size reaches the full speed of a bus, and every device can allocate it.
#define STAGING_BYTES (UINT64_C(64) << 20)

static bool range_check(const struct gpu_buffer *buffer, uint64_t offset, uint64_t bytes,
                        struct err *err)
{
    if (offset <= buffer->bytes && bytes <= buffer->bytes - offset)
        return true;
    return err_set(err, ERR_BUG,
                   "buffer %s: a copy of %llu bytes at offset %llu exceeds its %llu bytes",
                   buffer->name, (unsigned long long)bytes, (unsigned long long)offset,
                   (unsigned long long)buffer->bytes);
}

static uint64_t piece_bytes(uint64_t bytes)
{
    return bytes < STAGING_BYTES ? bytes : STAGING_BYTES;
}

// Begins recording a copy. All copies are sequential and share one set of commands, so that a
// command pool and a fence are created only once.
static struct gpu_commands *begin_copying(struct gpu *gpu, struct err *err)
{
    if (!gpu->copying) {
        struct gpu_commands *commands = calloc(1, sizeof *commands);
        if (!commands) {
            err_memory(err, "commands", sizeof *commands);
            return NULL;
        }
        if (!commands_create_for_copies(gpu, commands, err)) {
            free(commands);
            return NULL;
        }
        gpu->copying = commands;
    }
    return gpu_begin(gpu, gpu->copying, err) ? gpu->copying : NULL;
}

void transfers_destroy(struct gpu *gpu)
{
    gpu_commands_finish(gpu, gpu->copying);
    free(gpu->copying);
    gpu->copying = NULL;
}

static bool submit_and_wait(struct gpu *gpu, struct gpu_commands *commands, struct err *err)
{
    return gpu_submit(gpu, commands, err) && gpu_wait(gpu, commands, err);
}

bool buffer_zero(struct gpu *gpu, struct gpu_buffer *buffer, struct err *err)
{
    if (buffer->mapped) {
        memset(buffer->mapped, 0, buffer->bytes);
        return true;
    }
    struct gpu_commands *commands = begin_copying(gpu, err);
    if (commands)
        gpu_fill(gpu, commands, buffer, 0, VK_WHOLE_SIZE, 0);
    return (commands && submit_and_wait(gpu, commands, err)) ||
           err_prepend(err, "buffer %s", buffer->name);
}

// A copy between the host and a buffer.
struct transfer {
    const struct gpu_buffer *buffer;
    uint64_t offset, bytes;
    const char *from; // source of an upload, else NULL
    char *to;         // destination of a download, else NULL
};

static bool copy_piece(struct gpu *gpu, const struct gpu_buffer *staging,
                       const struct transfer *transfer, uint64_t done, struct err *err)
{
    uint64_t bytes = piece_bytes(transfer->bytes - done), at = transfer->offset + done;
    struct gpu_commands *commands = begin_copying(gpu, err);
    if (!commands)
        return false;
    if (transfer->from) {
        memcpy(staging->mapped, transfer->from + done, bytes);
        gpu_copy(gpu, commands, staging, 0, transfer->buffer, at, bytes);
    } else {
        gpu_copy(gpu, commands, transfer->buffer, at, staging, 0, bytes);
    }
    if (!submit_and_wait(gpu, commands, err))
        return false;
    if (transfer->to)
        memcpy(transfer->to + done, staging->mapped, bytes);
    return true;
}

// Copies through staging memory, one piece after the other.
static bool transfer_staged(struct gpu *gpu, const struct transfer *transfer, struct err *err)
{
    const char *name = transfer->from ? "upload staging" : "download staging";
    struct gpu_buffer staging = {0};
    bool ok = buffer_allocate(gpu, name, piece_bytes(transfer->bytes), GPU_READBACK, false,
                              &staging, err);
    for (uint64_t done = 0; ok && done < transfer->bytes; done += STAGING_BYTES)
        ok = copy_piece(gpu, &staging, transfer, done, err);
    gpu_buffer_finish(gpu, &staging);
    return ok || err_prepend(err, "buffer %s: %s", transfer->buffer->name,
                             transfer->from ? "upload" : "download");
}

bool gpu_upload(struct gpu *gpu, struct gpu_buffer *buffer, uint64_t offset, const void *data,
                uint64_t bytes, struct err *err)
{
    if (!range_check(buffer, offset, bytes, err))
        return false;
    if (bytes == 0)
        return true;
    if (buffer->mapped) {
        memcpy((char *)buffer->mapped + offset, data, bytes);
        return true;
    }
    const struct transfer transfer = {buffer, offset, bytes, .from = data};
    return transfer_staged(gpu, &transfer, err);
}

bool gpu_download(struct gpu *gpu, const struct gpu_buffer *buffer, uint64_t offset, void *data,
                  uint64_t bytes, struct err *err)
{
    if (!range_check(buffer, offset, bytes, err))
        return false;
    if (bytes == 0)
        return true;
    if (buffer->mapped) {
        memcpy(data, (const char *)buffer->mapped + offset, bytes);
        return true;
    }
    const struct transfer transfer = {buffer, offset, bytes, .to = data};
    return transfer_staged(gpu, &transfer, err);
}
