#include "cli/render/tev.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/socket.h"
#include "base/thread.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CREATE_IMAGE 4
#define UPDATE_IMAGE 5 // with several channels
#define NAME_MAX_BYTES 1024
// Greatest number of bytes of the values in a packet, unless one row of the image has more. The
// viewer displays each packet when it arrives.
#define BAND_BYTES ((size_t)4 << 20)

struct tev {
    struct tev_address address;
    char name[NAME_MAX_BYTES];
    struct thread thread;
    struct mutex mutex;
    struct condition changed;
    // The mutex protects the members from here to `picture`.
    bool has_picture; // an image is waiting or being sent
    bool is_closing, is_abandoned, is_failed, is_done;
    struct tev_picture picture; // owns its arrays
    // Only the thread uses the members below.
    struct connection connection;
    bool is_created; // the image was created in the viewer
};

// --- addresses -----------------------------------------------------------------------------------

static bool parse_port(const char *text, char out[6])
{
    size_t length = strlen(text);
    if (length == 0 || length > 5 || text[strspn(text, "0123456789")] != '\0')
        return false;
    long port = strtol(text, NULL, 10);
    if (port < 1 || port > 65535)
        return false;
    snprintf(out, 6, "%ld", port);
    return true;
}

static bool is_host_text(const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)text[i] <= ' ' || strchr("/[]@?#\"'\x7f", text[i]))
            return false;
    return length > 0 && length <= TEV_HOST_MAX;
}

// Sets the host and its length. Returns the start of the port, or NULL if there is no port.
static const char *split(const char *text, const char **host, size_t *length)
{
    const char *end = strchr(text, ']'), *colon = strchr(text, ':');
    *host = text;
    *length = strlen(text);
    if (text[0] == '[' && end && (end[1] == ':' || end[1] == '\0')) {
        *host = text + 1;
        *length = (size_t)(end - text) - 1;
        return end[1] ? end + 2 : NULL;
    }
    if (!colon || strchr(colon + 1, ':')) // no port, or an address of IPv6
        return NULL;
    *length = (size_t)(colon - text);
    return colon + 1;
}

bool tev_parse_address(const char *text, struct tev_address *out, struct err *err)
{
    const char *host;
    size_t length;
    const char *port = split(text, &host, &length);
    *out = (struct tev_address){"127.0.0.1", TEV_PORT};
    if (!port && parse_port(text, out->port))
        return true;
    if ((port && !parse_port(port, out->port)) ||
        !(is_host_text(host, length) || (length == 0 && port == text + 1)))
        return err_set(err, ERR_USAGE,
                       "--tev: \"%s\": expected HOST:PORT, HOST, PORT or [ADDRESS]:PORT with a "
                       "port from 1 to 65535",
                       text);
    if (length > 0) {
        memcpy(out->host, host, length);
        out->host[length] = '\0';
    }
    return true;
}

// --- connection ----------------------------------------------------------------------------------

static bool is_abandoned(void *context)
{
    struct tev *tev = context;
    mutex_lock(&tev->mutex);
    bool abandoned = tev->is_abandoned;
    mutex_unlock(&tev->mutex);
    return abandoned;
}

static bool fail(struct tev *tev, const char *reason)
{
    if (is_abandoned(tev)) // the render no longer waits for the viewer
        return false;
    log_warn("--tev: %s port %s: %s; the render goes on without tev", tev->address.host,
             tev->address.port, reason);
    return false;
}

static bool connect_to(struct tev *tev)
{
    tev->connection = (struct connection){
        .patience_seconds = TEV_PATIENCE_SECONDS, .is_abandoned = is_abandoned, .context = tev};
    if (connection_open(&tev->connection, tev->address.host, tev->address.port))
        return true;
    char reason[SOCKET_REASON_BYTES + 32];
    snprintf(reason, sizeof reason, "%s%s", tev->connection.reason,
             tev->connection.has_address ? " (is tev running?)" : "");
    return fail(tev, reason);
}

static bool send_bytes(struct tev *tev, const void *data, size_t size)
{
    return connection_send(&tev->connection, data, size) || fail(tev, tev->connection.reason);
}

// --- packets -------------------------------------------------------------------------------------

// The beginning of a packet, up to the values.
struct head {
    char bytes[NAME_MAX_BYTES + TEV_CHANNELS_MAX * TEV_CHANNEL_MAX + 64];
    size_t size;
};

static void put_bytes(struct head *head, const void *data, size_t size)
{
    memcpy(head->bytes + head->size, data, size);
    head->size += size;
}

// Returns the value with its bytes in the order of tev, which is little-endian.
static uint32_t little_endian(uint32_t value)
{
    const uint8_t bytes[] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16),
                             (uint8_t)(value >> 24)};
    memcpy(&value, bytes, sizeof value);
    return value;
}

static void put_int(struct head *head, uint32_t value)
{
    value = little_endian(value);
    put_bytes(head, &value, sizeof value);
}

static void put_text(struct head *head, const char *text)
{
    put_bytes(head, text, strlen(text) + 1);
}

static void begin(struct head *head, char type, const struct tev *tev)
{
    static const char keep_focus = 0;
    head->size = 0;
    put_int(head, 0); // placeholder of the length
    put_bytes(head, &type, 1);
    put_bytes(head, &keep_focus, 1);
    put_text(head, tev->name);
}

static void put_channels(struct head *head, const struct tev_picture *picture)
{
    put_int(head, picture->channel_count);
    for (uint32_t i = 0; i < picture->channel_count; i++)
        put_text(head, picture->channels[i]);
}

static bool send_head(struct tev *tev, struct head *head, size_t following)
{
    uint32_t length = little_endian((uint32_t)(head->size + following));
    memcpy(head->bytes, &length, sizeof length);
    return send_bytes(tev, head->bytes, head->size);
}

static bool create_image(struct tev *tev, struct head *head)
{
    const struct tev_picture *picture = &tev->picture;
    begin(head, CREATE_IMAGE, tev);
    put_int(head, picture->width);
    put_int(head, picture->height);
    put_channels(head, picture);
    tev->is_created = send_head(tev, head, 0);
    return tev->is_created;
}

static bool send_band(struct tev *tev, struct head *head, uint32_t from, uint32_t rows)
{
    const struct tev_picture *picture = &tev->picture;
    size_t values = (size_t)rows * picture->width;
    size_t all = (size_t)picture->width * picture->height;
    begin(head, UPDATE_IMAGE, tev);
    put_channels(head, picture);
    put_int(head, 0);
    put_int(head, from);
    put_int(head, picture->width);
    put_int(head, rows);
    if (!send_head(tev, head, values * picture->channel_count * sizeof(float)))
        return false;
    for (uint32_t i = 0; i < picture->channel_count; i++) {
        const float *band = picture->values + i * all + (size_t)from * picture->width;
        if (!send_bytes(tev, band, values * sizeof *band))
            return false;
    }
    return true;
}

// Sends the image in bands of rows, from the top.
static bool send_picture(struct tev *tev, struct head *head)
{
    const struct tev_picture *picture = &tev->picture;
    size_t row_bytes = (size_t)picture->width * picture->channel_count * sizeof(float);
    uint32_t rows = row_bytes < BAND_BYTES ? (uint32_t)(BAND_BYTES / row_bytes) : 1;
    if (!tev->is_created && !create_image(tev, head))
        return false;
    for (uint32_t from = 0; from < picture->height; from += rows) {
        uint32_t left = picture->height - from;
        if (!send_band(tev, head, from, left < rows ? left : rows))
            return false;
    }
    return true;
}

// --- the thread ----------------------------------------------------------------------------------

void tev_free_picture(struct tev_picture *picture)
{
    free(picture->values);
    free(picture->channels);
    *picture = (struct tev_picture){0};
}

// Waits for an image, or for the end of the connection. Returns whether there is an image.
static bool await_picture(struct tev *tev)
{
    mutex_lock(&tev->mutex);
    while (!tev->has_picture && !tev->is_closing)
        condition_wait(&tev->changed, &tev->mutex);
    bool has_picture = tev->has_picture;
    mutex_unlock(&tev->mutex);
    return has_picture;
}

static void picture_is_gone(struct tev *tev, bool is_sent)
{
    mutex_lock(&tev->mutex);
    tev_free_picture(&tev->picture);
    tev->has_picture = false;
    tev->is_failed = tev->is_failed || !is_sent;
    condition_wake_all(&tev->changed);
    mutex_unlock(&tev->mutex);
}

static void run(void *context)
{
    struct tev *tev = context;
    struct head *head = malloc(sizeof *head);
    bool ok = head && connect_to(tev);
    if (!head)
        fail(tev, "out of memory");
    if (!ok)
        picture_is_gone(tev, false);
    while (ok && await_picture(tev)) {
        ok = send_picture(tev, head);
        picture_is_gone(tev, ok);
    }
    free(head);
    connection_close(&tev->connection);
    mutex_lock(&tev->mutex);
    tev->is_done = true;
    condition_wake_all(&tev->changed);
    mutex_unlock(&tev->mutex);
}

static void destroy(struct tev *tev)
{
    tev_free_picture(&tev->picture);
    condition_finish(&tev->changed);
    mutex_finish(&tev->mutex);
    free(tev);
}

struct tev *tev_open(const struct tev_address *address, const char *name, struct err *err)
{
    struct tev *tev = calloc(1, sizeof *tev);
    if (!tev) {
        err_memory(err, "a connection", sizeof *tev);
        return NULL;
    }
    tev->address = *address;
    tev->connection.socket = CONNECTION_NONE;
    snprintf(tev->name, sizeof tev->name, "%s", name);
    mutex_init(&tev->mutex);
    condition_init(&tev->changed);
    int status = thread_start(&tev->thread, run, tev);
    if (status == 0)
        return tev;
    err_set(err, ERR_SYSTEM, "--tev: cannot start a thread: %s", strerror(status));
    destroy(tev);
    return NULL;
}

bool tev_is_ready(struct tev *tev)
{
    mutex_lock(&tev->mutex);
    bool is_ready = !tev->has_picture && !tev->is_failed;
    mutex_unlock(&tev->mutex);
    return is_ready;
}

void tev_send(struct tev *tev, struct tev_picture *picture)
{
    size_t count = (size_t)picture->width * picture->height * picture->channel_count;
    // Converts to little-endian on big-endian hosts.
    for (size_t i = 0; i < count && little_endian(1) != 1; i++) {
        uint32_t bits;
        memcpy(&bits, &picture->values[i], sizeof bits);
        bits = little_endian(bits);
        memcpy(&picture->values[i], &bits, sizeof bits);
    }
    mutex_lock(&tev->mutex);
    tev->picture = *picture;
    tev->has_picture = true;
    condition_wake_all(&tev->changed);
    mutex_unlock(&tev->mutex);
    *picture = (struct tev_picture){0};
}

static uint64_t later(double seconds)
{
    return clock_ns() + (uint64_t)(seconds * 1e9);
}

void tev_wait(struct tev *tev)
{
    const uint64_t deadline_ns = later(TEV_FAREWELL_SECONDS);
    bool is_in_time = true;
    mutex_lock(&tev->mutex);
    while (tev->has_picture && !tev->is_failed && is_in_time)
        is_in_time = condition_wait_until(&tev->changed, &tev->mutex, deadline_ns);
    bool is_late = tev->has_picture && !tev->is_failed;
    tev->is_abandoned = tev->is_failed = tev->is_failed || is_late;
    mutex_unlock(&tev->mutex);
    if (is_late)
        log_warn("--tev: %s port %s: did not take all of the picture within %g s",
                 tev->address.host, tev->address.port, TEV_FAREWELL_SECONDS);
}

void tev_close(struct tev *tev)
{
    if (!tev)
        return;
    tev_wait(tev);
    const uint64_t deadline_ns = later(1);
    bool is_in_time = true;
    mutex_lock(&tev->mutex);
    tev->is_closing = tev->is_abandoned = true;
    condition_wake_all(&tev->changed);
    while (!tev->is_done && is_in_time)
        is_in_time = condition_wait_until(&tev->changed, &tev->mutex, deadline_ns);
    bool is_done = tev->is_done;
    mutex_unlock(&tev->mutex);
    if (!is_done) {
        thread_detach(&tev->thread);
        return;
    }
    thread_join(&tev->thread);
    destroy(tev);
}
