// Contexts: calls, errors, devices.
#include "library/library.h"

#include "base/memory.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)LAMPYRIS_LOG_ERROR == (int)LOG_ERROR &&
                   (int)LAMPYRIS_LOG_DEBUG == (int)LOG_DEBUG,
               "the levels are the same");

const char *lampyris_version(void)
{
    return LAMPYRIS_VERSION;
}

// --- structs with a size -------------------------------------------------------------------------

bool library_take(void *to, size_t size, const void *from, const char *what, struct err *err)
{
    size_t given = 0;
    memset(to, 0, size);
    if (!from)
        return true;
    memcpy(&given, from, sizeof given);
    if (given < sizeof given)
        return err_set(err, ERR_USAGE, "%s: size is %zu; expected sizeof of the struct", what,
                       given);
    // A caller built for a later version may use its additional members only with the value zero.
    for (size_t i = size; i < given; i++)
        if (((const char *)from)[i] != 0)
            return err_set(err, ERR_USAGE,
                           "%s: size is %zu, with members set that version %s does not have; "
                           "expected at most %zu, or zero for those members",
                           what, given, LAMPYRIS_VERSION, size);
    memcpy(to, from, given < size ? given : size);
    memcpy(to, &size, sizeof size);
    return true;
}

bool library_give(void *to, const void *from, size_t size, struct err *err)
{
    size_t given;
    memcpy(&given, to, sizeof given);
    if (given < sizeof given)
        return err_set(err, ERR_USAGE, "size is %zu; expected sizeof of the struct", given);
    memcpy((char *)to + sizeof given, (const char *)from + sizeof given,
           (given < size ? given : size) - sizeof given);
    return true;
}

// --- calls ---------------------------------------------------------------------------------------

static enum lampyris_status status_of(enum err_code code)
{
    switch (code) {
    case ERR_NONE:
        return LAMPYRIS_OK;
    case ERR_USAGE:
    case ERR_INPUT:
    case ERR_BUDGET:
        return LAMPYRIS_INPUT;
    case ERR_OUTPUT:
        return LAMPYRIS_OUTPUT;
    case ERR_NO_VULKAN:
        return LAMPYRIS_NO_VULKAN;
    case ERR_STOPPED:
        return LAMPYRIS_STOPPED;
    case ERR_SYSTEM:
    case ERR_GPU:
    case ERR_BUG:
        break;
    }
    return LAMPYRIS_DEVICE;
}

bool library_enter(struct lampyris_context *context)
{
    if (context->is_busy)
        return false;
    context->is_busy = true;
    context->former_log = log_redirect(context->params.log ? &context->log : NULL);
    context->number_format = c_locale_begin();
    context->err = (struct err){0};
    return true;
}

enum lampyris_status library_leave(struct lampyris_context *context, bool ok)
{
    if (ok)
        context->err = (struct err){0};
    else if (context->err.code == ERR_NONE)
        err_set(&context->err, ERR_BUG, "the library failed without a reason");
    c_locale_end(context->number_format);
    log_redirect(context->former_log);
    context->is_busy = false;
    context->status = status_of(context->err.code);
    return context->status;
}

static void log_to_user(void *user, enum log_level level, const char *message)
{
    const struct lampyris_context *context = user;
    context->params.log(context->params.user, (enum lampyris_log_level)level, message);
}

// --- life ----------------------------------------------------------------------------------------

enum lampyris_status lampyris_context_create(const struct lampyris_context_params *params,
                                             struct lampyris_context **out)
{
    struct err err = {0};
    *out = NULL;
    struct lampyris_context *context = calloc(1, sizeof *context);
    if (!context)
        return LAMPYRIS_DEVICE;
    context->refs = 1;
    if (!library_take(&context->params, sizeof context->params, params, "lampyris_context_params",
                      &err)) {
        free(context);
        return status_of(err.code);
    }
    const char *device = context->params.device;
    if (device && !(context->device = strdup(device))) {
        free(context);
        return LAMPYRIS_DEVICE;
    }
    context->params.device = context->device;
    mutex_init(&context->log_mutex);
    context->log = (struct log_target){(enum log_level)context->params.log_level, log_to_user,
                                       context, &context->log_mutex};
    if (context->params.memory_bytes > 0)
        memory_set_budget(context->params.memory_bytes);
    *out = context;
    return LAMPYRIS_OK;
}

void library_unref(struct lampyris_context *context)
{
    if (--context->refs > 0)
        return;
    const struct log_target *former = log_redirect(context->params.log ? &context->log : NULL);
    gpu_close(&context->gpu);
    log_redirect(former);
    mutex_finish(&context->log_mutex);
    free(context->device);
    free(context);
}

void lampyris_context_release(struct lampyris_context *context)
{
    if (context)
        library_unref(context);
}

// --- errors --------------------------------------------------------------------------------------

// Finds the part of a message that says what was expected. This is the text between the last
// "expected " and ", not ", or the range in "1.7 is outside [0, 1]".
static void find_expected(const char *message, char out[256])
{
    static const char expected[] = "expected ", outside[] = " is outside ";
    const char *found = NULL;
    for (const char *at = message; (at = strstr(at, expected)); at += strlen(expected))
        found = at + strlen(expected);
    if (!found && (found = strstr(message, outside)))
        found += strlen(outside);
    snprintf(out, 256, "%s", found ? found : "");
    char *end = strstr(out, ", not ");
    if (end)
        *end = '\0';
}

void lampyris_context_error(const struct lampyris_context *context, struct lampyris_error *out)
{
    struct lampyris_context *writable = (struct lampyris_context *)context;
    find_expected(context->err.msg, writable->expected);
    const struct lampyris_error error = {
        .status = context->status,
        .message = context->err.msg,
        .file = context->err.file,
        .place = context->err.place,
        .expected = context->expected,
    };
    library_give(out, &error, sizeof error, NULL);
}

// --- devices -------------------------------------------------------------------------------------

bool library_open_device(struct lampyris_context *context, struct err *err)
{
    if (context->is_open && context->gpu.lost && context->renders == 0) {
        gpu_close(&context->gpu);
        context->is_open = false;
    }
    if (!context->is_open) {
        const struct gpu_params params = {.device = context->device,
                                          .validation = context->params.validation};
        context->is_open = gpu_open(&params, &context->gpu, err);
    }
    return context->is_open;
}

static bool list_devices(struct lampyris_context *context)
{
    return context->device_count > 0 ||
           gpu_list_devices(context->devices, &context->device_count, &context->err);
}

enum lampyris_status lampyris_device_count(struct lampyris_context *context, uint32_t *count)
{
    *count = 0;
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    bool ok = list_devices(context);
    *count = ok ? context->device_count : 0;
    return library_leave(context, ok);
}

static bool device_at(struct lampyris_context *context, uint32_t index, struct lampyris_device *out)
{
    if (!list_devices(context))
        return false;
    if (index >= context->device_count)
        return err_set(&context->err, ERR_USAGE,
                       "there is no device %u; expected an index below %u", index,
                       context->device_count);
    const struct gpu_device_info *info = &context->devices[index];
    const struct lampyris_device device = {
        .name = info->name,
        .driver = info->driver,
        .kind = info->kind,
        .unusable = info->unusable,
        .memory_bytes = info->memory_bytes,
        .is_cpu = info->is_cpu,
    };
    return library_give(out, &device, sizeof device, &context->err);
}

enum lampyris_status lampyris_device_at(struct lampyris_context *context, uint32_t index,
                                        struct lampyris_device *out)
{
    return library_enter(context) ? library_leave(context, device_at(context, index, out))
                                  : LAMPYRIS_INPUT;
}
