// Synchronous copies between the host and buffers.
#include "gpu_internal.h"
#include <string.h>

// Large enough for full speed over a bus, small enough to be had on any device.
#define STAGING_BYTES (UINT64_C(64) << 20)

static bool range_check(const struct gpu_buffer *buffer, uint64_t offset, uint64_t bytes,
                        struct err *err)
{
    if (offset <= buffer->bytes && bytes <= buffer->bytes - offset)
        return true;
    return err_set(err, ERR_BUG,
                   "buffer %s: a copy of %llu bytes at %llu, expected one inside its %llu bytes",
                   buffer->name, (unsigned long long)bytes, (unsigned long long)offset,
                   (unsigned long long)buffer->bytes);
}

static uint64_t piece_bytes(uint64_t bytes)
{
    return bytes < STAGING_BYTES ? bytes : STAGING_BYTES;
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
    struct gpu_commands commands;
    bool ok = gpu_commands_create(gpu, &commands, err) && gpu_begin(gpu, &commands, err);
    if (ok) {
        gpu_fill(gpu, &commands, buffer, 0, VK_WHOLE_SIZE, 0);
        ok = submit_and_wait(gpu, &commands, err);
    }
    gpu_commands_finish(gpu, &commands);
    return ok || err_prepend(err, "buffer %s", buffer->name);
}

// The two ways through staging memory, piece by piece.
static bool upload_pieces(struct gpu *gpu, struct gpu_commands *commands,
                          const struct gpu_buffer *staging, const struct gpu_buffer *buffer,
                          uint64_t offset, const char *data, uint64_t bytes, struct err *err)
{
    for (uint64_t done = 0; done < bytes;) {
        uint64_t piece = piece_bytes(bytes - done);
        memcpy(staging->mapped, data + done, piece);
        if (!gpu_begin(gpu, commands, err))
            return false;
        gpu_copy(gpu, commands, staging, 0, buffer, offset + done, piece);
        if (!submit_and_wait(gpu, commands, err))
            return false;
        done += piece;
    }
    return true;
}

static bool download_pieces(struct gpu *gpu, struct gpu_commands *commands,
                            const struct gpu_buffer *staging, const struct gpu_buffer *buffer,
                            uint64_t offset, char *data, uint64_t bytes, struct err *err)
{
    for (uint64_t done = 0; done < bytes;) {
        uint64_t piece = piece_bytes(bytes - done);
        if (!gpu_begin(gpu, commands, err))
            return false;
        gpu_copy(gpu, commands, buffer, offset + done, staging, 0, piece);
        if (!submit_and_wait(gpu, commands, err))
            return false;
        memcpy(data + done, staging->mapped, piece);
        done += piece;
    }
    return true;
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
    struct gpu_buffer staging = {0};
    struct gpu_commands commands = {0};
    bool ok = buffer_allocate(gpu, "upload staging", piece_bytes(bytes), GPU_READBACK, false,
                              &staging, err) &&
              gpu_commands_create(gpu, &commands, err) &&
              upload_pieces(gpu, &commands, &staging, buffer, offset, data, bytes, err);
    gpu_commands_finish(gpu, &commands);
    gpu_buffer_finish(gpu, &staging);
    return ok || err_prepend(err, "buffer %s: upload", buffer->name);
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
    struct gpu_buffer staging = {0};
    struct gpu_commands commands = {0};
    bool ok = buffer_allocate(gpu, "download staging", piece_bytes(bytes), GPU_READBACK, false,
                              &staging, err) &&
              gpu_commands_create(gpu, &commands, err) &&
              download_pieces(gpu, &commands, &staging, buffer, offset, data, bytes, err);
    gpu_commands_finish(gpu, &commands);
    gpu_buffer_finish(gpu, &staging);
    return ok || err_prepend(err, "buffer %s: download", buffer->name);
}
