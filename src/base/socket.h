// TCP connections to other programs. No call blocks longer than its patience.
#ifndef LAMPYRIS_BASE_SOCKET_H
#define LAMPYRIS_BASE_SOCKET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SOCKET_REASON_BYTES 192

struct connection {
    intptr_t socket; // CONNECTION_NONE where there is none
    // How long the other side may accept nothing, and a function, polled ten times a second, that
    // requests the end of waiting.
    double patience_seconds;
    bool (*is_abandoned)(void *context);
    void *context;
    bool has_address;                 // the host's name is known
    char reason[SOCKET_REASON_BYTES]; // reason of the last failure
};

#define CONNECTION_NONE ((intptr_t)-1)

// Connects to the first of the host's addresses that answers. Returns false, with the reason, if
// none does.
bool connection_open(struct connection *connection, const char *host, const char *port);
// Sends all of the data, or returns false with the reason.
bool connection_send(struct connection *connection, const void *data, size_t size);
void connection_close(struct connection *connection); // accepts CONNECTION_NONE

#endif
