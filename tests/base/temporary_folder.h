// A new folder for the files of a test, which is the working directory while the test runs.
#ifndef LAMPYRIS_TESTS_TEMPORARY_FOLDER_H
#define LAMPYRIS_TESTS_TEMPORARY_FOLDER_H

#include <dirent.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int temporary_remove(const char *path, const struct stat *status, int kind, struct FTW *ftw)
{
    (void)status, (void)kind, (void)ftw;
    return remove(path);
}

// Creates a folder, enters it and writes its path to the buffer.
static inline int temporary_enter(char *path, size_t size)
{
    const char *parent = getenv("TMPDIR");
    snprintf(path, size, "%s/lampyris-test-XXXXXX", parent ? parent : "/tmp");
    return mkdtemp(path) && chdir(path) == 0;
}

static inline void temporary_leave(const char *path)
{
    if (chdir("/") == 0)
        nftw(path, temporary_remove, 16, FTW_DEPTH | FTW_PHYS);
}

static inline int temporary_write(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    if (!file)
        return 0;
    int ok = fputs(text, file) >= 0;
    return fclose(file) == 0 && ok;
}

// Returns the number of entries without "." and "..".
static inline int temporary_entries(const char *path)
{
    DIR *folder = opendir(path);
    int count = 0;
    while (folder && readdir(folder))
        count++;
    if (folder)
        closedir(folder);
    return count - 2;
}

#endif
