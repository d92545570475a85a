/* Lets the n-th call that changes a file fail, or kills the process there: FAULT_AT=n, FAULT=kill|torn|enospc|eio.
   torn: half of what the call was to write is written before the kill. FAULT_COUNT=file: the number of calls goes there. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static long calls, at = -1;
static int lasting;
static const char *kind = "";

static void init(void) {
    static int done;
    if (done) return;
    done = 1;
    const char *n = getenv("FAULT_AT"), *k = getenv("FAULT");
    if (n) at = atol(n);
    if (k) kind = k;
    lasting = getenv("FAULT_LASTS") != NULL;
}

__attribute__((destructor)) static void tell(void) {
    const char *name = getenv("FAULT_COUNT");
    FILE *file = name ? fopen(name, "w") : NULL;
    if (file) { fprintf(file, "%ld\n", calls); fclose(file); }
}

static void die(void) { kill(getpid(), SIGKILL); for (;;) pause(); }

/* Whether this call is to fail; errno says how. */
static int fails(void) {
    init();
    long n = __atomic_add_fetch(&calls, 1, __ATOMIC_SEQ_CST);
    if (at < 0 || n < at || (n > at && !lasting)) return 0;
    if (strcmp(kind, "kill") == 0 || strcmp(kind, "torn") == 0) die();
    errno = strcmp(kind, "enospc") == 0 ? ENOSPC : EIO;
    return 1;
}

#define REAL(type, name, ...) static type (*real)(__VA_ARGS__); if (!real) real = dlsym(RTLD_NEXT, name)

ssize_t write(int fd, const void *bytes, size_t length) {
    REAL(ssize_t, "write", int, const void *, size_t);
    if (fd <= 2) return real(fd, bytes, length);
    init();
    if (strcmp(kind, "torn") == 0 && calls + 1 == at) real(fd, bytes, length / 2);
    return fails() ? -1 : real(fd, bytes, length);
}

static int opens_to_write(int flags) { return (flags & O_ACCMODE) != O_RDONLY; }

int openat(int folder, const char *name, int flags, ...) {
    REAL(int, "openat", int, const char *, int, mode_t);
    va_list more; va_start(more, flags); mode_t mode = va_arg(more, mode_t); va_end(more);
    return opens_to_write(flags) && fails() ? -1 : real(folder, name, flags, mode);
}
int openat64(int folder, const char *name, int flags, ...) {
    va_list more; va_start(more, flags); mode_t mode = va_arg(more, mode_t); va_end(more);
    return openat(folder, name, flags, mode);
}
int open64(const char *name, int flags, ...) {
    REAL(int, "open64", const char *, int, mode_t);
    va_list more; va_start(more, flags); mode_t mode = va_arg(more, mode_t); va_end(more);
    return opens_to_write(flags) && fails() ? -1 : real(name, flags, mode);
}
int renameat(int a, const char *from, int b, const char *to) {
    REAL(int, "renameat", int, const char *, int, const char *);
    return fails() ? -1 : real(a, from, b, to);
}
int unlinkat(int folder, const char *name, int flags) {
    REAL(int, "unlinkat", int, const char *, int);
    return fails() ? -1 : real(folder, name, flags);
}
int fsync(int fd) { REAL(int, "fsync", int); return fails() ? -1 : real(fd); }
int fdatasync(int fd) { REAL(int, "fdatasync", int); return fails() ? -1 : real(fd); }
int ftruncate64(int fd, off_t length) { REAL(int, "ftruncate64", int, off_t); return fails() ? -1 : real(fd, length); }
int flock(int fd, int operation) { REAL(int, "flock", int, int); return fails() ? -1 : real(fd, operation); }
int mkdir(const char *name, mode_t mode) { REAL(int, "mkdir", const char *, mode_t); return fails() ? -1 : real(name, mode); }
