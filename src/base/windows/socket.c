#include "base/socket.h"

#include "base/clock.h"
#include <stdio.h>
#include <winsock2.h>

#include <ws2tcpip.h> // needs winsock2.h before it

static bool fail(struct connection *connection, const char *what, int error)
{
    const char *reason = error == WSAETIMEDOUT        ? "timed out"
                         : error == WSAECONNREFUSED   ? "the connection was refused"
                         : error == WSAHOST_NOT_FOUND ? "there is no such host"
                                                      : NULL;
    if (reason)
        snprintf(connection->reason, sizeof connection->reason, "%s%s", what, reason);
    else
        snprintf(connection->reason, sizeof connection->reason, "%sWindows Sockets error %d", what,
                 error);
    return false;
}

// Waits until the socket accepts data, or the connection is established. Returns 0 or an error code
// of Windows' sockets.
static int wait_writable(const struct connection *connection)
{
    const uint64_t start = clock_ns();
    while (clock_seconds_since(start) < connection->patience_seconds &&
           !(connection->is_abandoned && connection->is_abandoned(connection->context))) {
        WSAPOLLFD poll_fd = {.fd = (SOCKET)connection->socket, .events = POLLOUT};
        const int ready = WSAPoll(&poll_fd, 1, 100);
        if (ready < 0)
            return WSAGetLastError();
        if (ready > 0)
            return 0;
    }
    return WSAETIMEDOUT;
}

// Returns 0 or an error code of Windows' sockets.
static int connect_to(struct connection *connection, const struct addrinfo *address)
{
    const SOCKET out = socket(address->ai_family, address->ai_socktype, address->ai_protocol);
    int error = 0, size = sizeof error;
    u_long is_waiting = 1;
    if (out == INVALID_SOCKET)
        return WSAGetLastError();
    connection->socket = (intptr_t)out;
    ioctlsocket(out, (long)FIONBIO, &is_waiting);
    if (connect(out, address->ai_addr, (int)address->ai_addrlen) != 0) {
        error = WSAGetLastError();
        if (error == WSAEWOULDBLOCK)
            error = wait_writable(connection);
        if (error == 0)
            getsockopt(out, SOL_SOCKET, SO_ERROR, (char *)&error, &size);
    }
    if (error != 0)
        connection_close(connection);
    return error;
}

bool connection_open(struct connection *connection, const char *host, const char *port)
{
    const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    struct addrinfo *list = NULL;
    WSADATA data;
    connection->socket = CONNECTION_NONE;
    int error = WSAStartup(MAKEWORD(2, 2), &data); // may be called more than once
    if (error == 0)
        error = getaddrinfo(host, port, &hints, &list);
    connection->has_address = error == 0;
    for (const struct addrinfo *at = list; at && connection->socket == CONNECTION_NONE;
         at = at->ai_next)
        error = connect_to(connection, at);
    if (list)
        freeaddrinfo(list);
    return connection->socket != CONNECTION_NONE || fail(connection, "", error);
}

bool connection_send(struct connection *connection, const void *data, size_t size)
{
    for (const char *at = data; size > 0;) {
        const int most = size < (1 << 20) ? (int)size : 1 << 20;
        const int sent = send((SOCKET)connection->socket, at, most, 0);
        int error = sent < 0 ? WSAGetLastError() : 0;
        if (sent > 0) {
            at += sent;
            size -= (size_t)sent;
            continue;
        }
        if (error != WSAEWOULDBLOCK)
            return fail(connection, "the connection was lost: ", error);
        error = wait_writable(connection);
        char what[64];
        snprintf(what, sizeof what, "accepted no data for %g s: ", connection->patience_seconds);
        if (error != 0)
            return fail(connection, what, error);
    }
    return true;
}

void connection_close(struct connection *connection)
{
    if (connection->socket != CONNECTION_NONE)
        closesocket((SOCKET)connection->socket);
    connection->socket = CONNECTION_NONE;
}
