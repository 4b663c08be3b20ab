// TCP connections to other programs. No call waits longer than patience_seconds for the other side.
#ifndef LAMPYRIS_BASE_SOCKET_H
#define LAMPYRIS_BASE_SOCKET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SOCKET_REASON_BYTES 192

struct connection {
    intptr_t socket; // CONNECTION_NONE if not connected
    // The longest time, in seconds, to wait while the other side accepts no data, and a function,
    // polled ten times a second, that returns true to stop waiting.
    double patience_seconds;
    bool (*is_abandoned)(void *context);
    void *context;
    bool has_address;                 // whether the host's name was resolved
    char reason[SOCKET_REASON_BYTES]; // why the last call failed
};

#define CONNECTION_NONE ((intptr_t)-1)

// Connects to the first of the host's addresses that answers. Returns false, with the reason, if
// none does.
bool connection_open(struct connection *connection, const char *host, const char *port);
// Sends all of the data, or returns false with the reason.
bool connection_send(struct connection *connection, const void *data, size_t size);
void connection_close(struct connection *connection); // accepts CONNECTION_NONE

#endif
