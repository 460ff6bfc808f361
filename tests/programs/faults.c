/* Loaded before a program (LD_PRELOAD): the n-th call of a function fails, or kills the program. FAULT is "FUNCTION N" or
 * "FUNCTION N kill"; with FAULT_COUNT naming a file, how many calls of each there were is written there at the end, a line for each. Calls
 * count from main() on: what fails before is not the program's to answer. Its children are spared. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static const char *const names[] = {"open", "read", "fopen", "fread", "fwrite", "write", "fsync", "linkat", "rename", "unlink", "malloc"};
enum { functions = sizeof names / sizeof names[0] };
static long calls[functions];
static char function[16], counts[512];
static long number;
static int kills, is_armed;
static int (*real_main)(int, char **, char **);

/* Whether this call is the one that fails. */
static int fails(const char *name)
{
    if (!__atomic_load_n(&is_armed, __ATOMIC_RELAXED))
        return 0;
    int i = 0;
    while (i + 1 < functions && strcmp(name, names[i]) != 0)
        i++;
    if (__atomic_add_fetch(&calls[i], 1, __ATOMIC_RELAXED) != number || strcmp(name, function) != 0)
        return 0;
    if (kills)
        raise(SIGKILL);
    errno = strcmp(name, "malloc") == 0 ? ENOMEM : EIO;
    return 1;
}

static void *next(const char *name)
{
    return dlsym(RTLD_NEXT, name);
}

#define WRAP(result, failed, name, parameters, ...)                 \
    result name parameters                                          \
    {                                                               \
        static result (*real) parameters;                           \
        if (real == NULL)                                           \
            *(void **)&real = next(#name);                          \
        return fails(#name) ? (failed) : real(__VA_ARGS__);         \
    }

WRAP(ssize_t, -1, write, (int file, const void *bytes, size_t size), file, bytes, size)
WRAP(ssize_t, -1, read, (int file, void *bytes, size_t size), file, bytes, size)
WRAP(int, -1, fsync, (int file), file)
WRAP(int, -1, rename, (const char *from, const char *to), from, to)
WRAP(int, -1, linkat, (int a, const char *from, int b, const char *to, int flags), a, from, b, to, flags)
WRAP(int, -1, unlink, (const char *path), path)
WRAP(FILE *, NULL, fopen, (const char *path, const char *mode), path, mode)
WRAP(size_t, 0, fwrite, (const void *bytes, size_t size, size_t times, FILE *file), bytes, size, times, file)

/* The stream itself must know, as it does of a device that fails. */
size_t fread(void *bytes, size_t size, size_t times, FILE *file)
{
    static size_t (*real)(void *, size_t, size_t, FILE *);
    if (real == NULL)
        *(void **)&real = next("fread");
    if (fails("fread")) {
        const int before = dup(fileno(file)), nothing = open("/", O_RDONLY | O_DIRECTORY);
        dup2(nothing, fileno(file)); /* reading a directory is an error */
        const size_t none = real(bytes, size, times, file);
        dup2(before, fileno(file));
        close(before);
        close(nothing);
        errno = EIO;
        return none;
    }
    return real(bytes, size, times, file);
}

int open(const char *path, int flags, ...)
{
    static int (*real)(const char *, int, ...);
    if (real == NULL)
        *(void **)&real = next("open");
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = va_arg(rest, mode_t);
    va_end(rest);
    return fails("open") ? -1 : real(path, flags, mode);
}

extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t), *__libc_memalign(size_t, size_t);

void *malloc(size_t size)
{
    return fails("malloc") ? NULL : __libc_malloc(size);
}

void *calloc(size_t times, size_t size)
{
    return fails("malloc") ? NULL : __libc_calloc(times, size);
}

void *realloc(void *old, size_t size)
{
    return fails("malloc") ? NULL : __libc_realloc(old, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size)
{
    *memory = fails("malloc") ? NULL : __libc_memalign(alignment, size);
    return *memory == NULL ? ENOMEM : 0;
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return fails("malloc") ? NULL : __libc_memalign(alignment, size);
}

static void report(void)
{
    is_armed = 0;
    if (counts[0] == '\0')
        return;
    FILE *const file = fopen(counts, "w");
    if (file == NULL)
        abort();
    for (int i = 0; i < functions; i++)
        if (fprintf(file, "%s %ld\n", names[i], calls[i]) < 0)
            abort();
    if (fclose(file) != 0)
        abort();
}

static int armed_main(int argc, char **argv, char **environment)
{
    const char *const fault = getenv("FAULT"), *const to = getenv("FAULT_COUNT");
    char word[8] = "";
    if (fault != NULL && sscanf(fault, "%15s %ld %7s", function, &number, word) >= 2)
        kills = strcmp(word, "kill") == 0;
    if (to != NULL)
        strncpy(counts, to, sizeof counts - 1);
    unsetenv("LD_PRELOAD");
    atexit(report);
    is_armed = 1;
    return real_main(argc, argv, environment);
}

int __libc_start_main(int (*main)(int, char **, char **), int argc, char **argv, void (*init)(void), void (*fini)(void),
                      void (*rtld_fini)(void), void *stack_end)
{
    int (*real)(int (*)(int, char **, char **), int, char **, void (*)(void), void (*)(void), void (*)(void), void *);
    *(void **)&real = next("__libc_start_main");
    real_main = main;
    return real(armed_main, argc, argv, init, fini, rtld_fini, stack_end);
}
