// A library for LD_PRELOAD that makes allocation number FAIL_AT (counted from 1) of the program and
// of its image and file libraries fail; with FAIL_ON set, all later ones fail, too. Allocations of
// the driver and of the C library itself succeed. COUNT_INTO names a file to which the number of
// allocations is written.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// glibc's own functions need no look-up by dlsym, which would allocate.
extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);

#define RANGES_MAX 64

static struct {
    const char *begin, *end;
} ranges[RANGES_MAX]; // the code whose calls of malloc() are counted
static int range_count;
static atomic_long count;
static long fail_at;
static bool fails_on, is_ready;

static int add_ranges(struct dl_phdr_info *object, size_t size, void *context)
{
    static const char *const libraries[] = {"jansson", "png",     "jpeg", "EXR",
                                            "Imath",   "meshopt", "libz"};
    bool is_wanted = !*object->dlpi_name; // an empty name means the program itself
    (void)size, (void)context;
    for (size_t i = 0; i < sizeof libraries / sizeof libraries[0]; i++)
        is_wanted |= strstr(object->dlpi_name, libraries[i]) != NULL;
    for (int i = 0; is_wanted && i < object->dlpi_phnum && range_count < RANGES_MAX; i++) {
        const ElfW(Phdr) *part = &object->dlpi_phdr[i];
        if (part->p_type != PT_LOAD || !(part->p_flags & PF_X))
            continue;
        ranges[range_count].begin = (const char *)object->dlpi_addr + part->p_vaddr;
        ranges[range_count].end = ranges[range_count].begin + part->p_memsz;
        range_count++;
    }
    return 0;
}

__attribute__((constructor)) static void begin(void)
{
    dl_iterate_phdr(add_ranges, NULL);
    fail_at = getenv("FAIL_AT") ? atol(getenv("FAIL_AT")) : 0;
    fails_on = getenv("FAIL_ON") != NULL;
    is_ready = true;
}

__attribute__((destructor)) static void end(void)
{
    const char *path = getenv("COUNT_INTO");
    char text[32];
    int fd = path ? open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666) : -1;
    if (fd < 0)
        return;
    int length = snprintf(text, sizeof text, "%ld\n", atomic_load(&count));
    if (write(fd, text, (size_t)length) != length)
        _exit(1);
    close(fd);
}

static bool is_due(const void *caller)
{
    const char *place = caller;
    for (int i = 0; is_ready && i < range_count; i++) {
        if (place < ranges[i].begin || place >= ranges[i].end)
            continue;
        long n = atomic_fetch_add(&count, 1) + 1;
        bool fails = n == fail_at || (fails_on && fail_at > 0 && n > fail_at);
        if (fails)
            errno = ENOMEM;
        return fails;
    }
    return false;
}

void *malloc(size_t size)
{
    return is_due(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
}

void *calloc(size_t number, size_t size)
{
    return is_due(__builtin_return_address(0)) ? NULL : __libc_calloc(number, size);
}

void *realloc(void *data, size_t size)
{
    return is_due(__builtin_return_address(0)) ? NULL : __libc_realloc(data, size);
}

char *strdup(const char *text)
{
    size_t size = strlen(text) + 1;
    char *copy = is_due(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
    return copy ? memcpy(copy, text, size) : NULL;
}
