/* Refuses memory: the n-th request, or all from the n-th on, counted over all threads and all libraries of the process.
 *
 * FAULT_AT=n chooses n, from 1; FAULT_ON=1 all that follow, too. FAULT_COUNT=FILE writes how many requests there were when the process
 * ends. What glibc asks for inside of itself is not seen: nobody can refuse that but the system. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);

static atomic_long requests, first = -1;
static int later, told = -1;

static long number(const char *text)
{
    long value = 0;
    for (; text && *text >= '0' && *text <= '9'; text++)
        value = 10 * value + (*text - '0');
    return value;
}

static int refused(void)
{
    long n = atomic_fetch_add(&requests, 1) + 1;
    if (atomic_load(&first) < 0) {
        /* The variables are there before the first library is started. */
        if (!environ)
            return 0;
        later = getenv("FAULT_ON") != NULL;
        atomic_store(&first, number(getenv("FAULT_AT")));
    }
    long at = atomic_load(&first);
    if (!at || (later ? n < at : n != at))
        return 0;
    errno = ENOMEM;
    return 1;
}

void *malloc(size_t size) { return refused() ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return refused() ? NULL : __libc_calloc(count, size); }
void *realloc(void *block, size_t size) { return refused() ? NULL : __libc_realloc(block, size); }
void *memalign(size_t align, size_t size) { return refused() ? NULL : __libc_memalign(align, size); }
void *aligned_alloc(size_t align, size_t size) { return refused() ? NULL : __libc_memalign(align, size); }

int posix_memalign(void **block, size_t align, size_t size)
{
    void *found = refused() ? NULL : __libc_memalign(align, size);
    if (!found)
        return ENOMEM;
    *block = found;
    return 0;
}

void *mmap(void *at, size_t size, int protection, int flags, int file, off_t offset)
{
    /* What is read from a file is no request for memory. */
    if ((flags & MAP_ANONYMOUS) && refused())
        return MAP_FAILED;
    return (void *)syscall(SYS_mmap, at, size, protection, flags, file, offset);
}

void *mmap64(void *at, size_t size, int protection, int flags, int file, off_t offset)
{
    return mmap(at, size, protection, flags, file, offset);
}

__attribute__((destructor)) static void tell(void)
{
    const char *file = getenv("FAULT_COUNT");
    char text[32];
    if (!file)
        return;
    told = open(file, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    int length = snprintf(text, sizeof text, "%ld\n", atomic_load(&requests));
    if (told < 0 || write(told, text, (size_t)length) != length)
        _exit(99);
    close(told);
}
