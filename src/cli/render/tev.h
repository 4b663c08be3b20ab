// Sends images to the viewer tev over TCP.
//
// The protocol (tev, include/tev/Ipc.h and src/Ipc.cpp, as of version 1.29): a packet begins with
// its length in bytes, including this field (uint32), and a type (one byte). Integers are
// little-endian, texts end with a NUL.
//
//   CreateImage, 4:    bool take the focus; text name; int32 width, height, channels; texts: names
//                      of channels
//   UpdateImage v2, 5: bool take the focus; text name; int32 channels; texts: their names;
//                      int32 x, y, width, height; floats, one channel after the other
//
// A separate thread sends the images. It holds one image at a time, so the caller asks with
// tev_is_ready() whether the last image was sent before it makes the next one. Only tev_wait() and
// tev_close() wait for the viewer, for a limited time.
#ifndef LAMPYRIS_CLI_RENDER_TEV_H
#define LAMPYRIS_CLI_RENDER_TEV_H

#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>

#define TEV_PORT "14158"
#define TEV_HOST_MAX 255   // bytes of a host name (RFC 1035, section 2.3.4)
#define TEV_CHANNEL_MAX 64 // bytes of a channel's name, with the NUL
#define TEV_CHANNELS_MAX 64
#define TEV_PATIENCE_SECONDS 3.0  // the connection ends if the viewer accepts no byte for this time
#define TEV_FAREWELL_SECONDS 10.0 // longest time to wait at the end until the image is sent

struct tev_address {
    char host[TEV_HOST_MAX + 1];
    char port[6];
};

// Parses "HOST", "HOST:PORT", ":PORT", "PORT" or "[V6]:PORT"; the defaults are 127.0.0.1 and
// TEV_PORT. Fails with ERR_USAGE. Names are resolved when the connection is made.
bool tev_parse_address(const char *text, struct tev_address *out, struct err *err);

// Both arrays are allocated with malloc.
struct tev_picture {
    uint32_t width, height;
    uint32_t channel_count;            // at most TEV_CHANNELS_MAX
    char (*channels)[TEV_CHANNEL_MAX]; // names; all images of a connection have the same
    float *values;                     // all values of a channel, then the next; rows from the top
};

struct tev;

// Starts to connect. `name` is the image's name in the viewer. Returns NULL when out of memory or
// threads, with *err set.
struct tev *tev_open(const struct tev_address *address, const char *name, struct err *err);
// Returns whether tev_send() can be called: false while an image is being sent, and after a
// failure, which was reported by a warning.
bool tev_is_ready(struct tev *tev);
// Takes ownership of the image; call it only when ready.
void tev_send(struct tev *tev, struct tev_picture *picture);
// Frees an image that was not passed to tev_send().
void tev_free_picture(struct tev_picture *picture);
// Waits until nothing is being sent, for at most TEV_FAREWELL_SECONDS.
void tev_wait(struct tev *tev);
// Waits as tev_wait() does, and ends the thread. A thread that takes too long to resolve a name is
// left running until the program ends. Accepts NULL.
void tev_close(struct tev *tev);

#endif
