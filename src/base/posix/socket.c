#define _GNU_SOURCE // for SOCK_NONBLOCK
#include "base/socket.h"

#include "base/clock.h"
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#ifndef MSG_NOSIGNAL // macOS has a socket option instead
#define MSG_NOSIGNAL 0
#endif

static bool fail(struct connection *connection, const char *what, const char *reason)
{
    snprintf(connection->reason, sizeof connection->reason, "%s%s", what, reason);
    return false;
}

static bool is_abandoned(const struct connection *connection)
{
    return connection->is_abandoned && connection->is_abandoned(connection->context);
}

// Waits until the socket accepts data, or the connection is established.
static bool wait_writable(const struct connection *connection)
{
    struct pollfd poll_fd = {.fd = (int)connection->socket, .events = POLLOUT};
    const uint64_t start = clock_ns();
    int ready = 0;
    while (ready <= 0 && clock_seconds_since(start) < connection->patience_seconds &&
           !is_abandoned(connection)) {
        ready = poll(&poll_fd, 1, 100);
        if (ready < 0 && errno != EINTR)
            return false;
    }
    if (ready <= 0)
        errno = ETIMEDOUT;
    return ready > 0;
}

static int open_socket(const struct addrinfo *address)
{
    const int out = socket(address->ai_family, address->ai_socktype, address->ai_protocol);
    if (out < 0)
        return -1;
    fcntl(out, F_SETFD, FD_CLOEXEC);
    fcntl(out, F_SETFL, fcntl(out, F_GETFL) | O_NONBLOCK);
#ifdef SO_NOSIGPIPE
    setsockopt(out, SOL_SOCKET, SO_NOSIGPIPE, &(int){1}, sizeof(int));
#endif
    return out;
}

// Returns 0 or a value of errno.
static int connect_to(struct connection *connection, const struct addrinfo *address)
{
    int error = 0;
    socklen_t size = sizeof error;
    const int out = open_socket(address);
    if (out < 0)
        return errno;
    connection->socket = out;
    if (connect(out, address->ai_addr, address->ai_addrlen) != 0) {
        error = errno;
        if (error == EINPROGRESS && wait_writable(connection)) {
            if (getsockopt(out, SOL_SOCKET, SO_ERROR, &error, &size) != 0)
                error = errno;
        } else if (error == EINPROGRESS) {
            error = errno;
        }
    }
    if (error != 0)
        connection_close(connection);
    return error;
}

bool connection_open(struct connection *connection, const char *host, const char *port)
{
    const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    struct addrinfo *list = NULL;
    int status = getaddrinfo(host, port, &hints, &list), error = 0;
    connection->socket = CONNECTION_NONE;
    connection->has_address = status == 0;
    if (status != 0)
        return fail(connection, "", status == EAI_SYSTEM ? strerror(errno) : gai_strerror(status));
    for (const struct addrinfo *at = list; at && connection->socket == CONNECTION_NONE;
         at = at->ai_next)
        error = connect_to(connection, at);
    freeaddrinfo(list);
    return connection->socket != CONNECTION_NONE || fail(connection, "", strerror(error));
}

bool connection_send(struct connection *connection, const void *data, size_t size)
{
    for (const char *at = data; size > 0;) {
        const ssize_t sent = send((int)connection->socket, at, size, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent > 0) {
            at += sent;
            size -= (size_t)sent;
        } else if (sent < 0 && errno == EAGAIN) {
            char what[64];
            snprintf(what, sizeof what,
                     "accepted no data for %g s: ", connection->patience_seconds);
            if (!wait_writable(connection))
                return fail(connection, what, strerror(errno));
        } else if (sent == 0 || errno != EINTR) {
            return fail(connection, "the connection was lost: ", strerror(errno));
        }
    }
    return true;
}

void connection_close(struct connection *connection)
{
    if (connection->socket != CONNECTION_NONE)
        close((int)connection->socket);
    connection->socket = CONNECTION_NONE;
}
