/* Calls that change a disk, counted below one folder: the one with a given number fails or ends the process.

   Built as a shared library and put before the C library (LD_PRELOAD); `fault_arm` is called from the process itself.
   With a log, every call that succeeded is written down with its number, and with the data of writes, so that they can
   be played again. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

enum { NOTHING, FAIL, KILL, KILL_ON };

/* What the disk itself cannot. */
enum { NO_EXCHANGE = 1, CLOSED_ABOVE = 2, MOUNTED = 4 };

static char root[4096];
static long at = -1, count = 0;
static int action = NOTHING, number = 0, disk = 0, journal = -1, full = 0;
static char last[64];

#define REAL(name) __typeof__(&name) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)

void fault_arm(const char *folder, long call, int what, int code, int cannot, int log) {
    strncpy(root, folder, sizeof root - 1);
    at = call, action = what, number = code, disk = cannot, journal = log;
    count = 0, full = 0;
}

long fault_count(void) { return count; }

const char *fault_last(void) { return last; }

static void of_handle(int handle, char *path) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", handle);
    ssize_t length = readlink(link, path, 4095);
    path[length < 0 ? 0 : length] = 0;
}

static void of_name(int folder, const char *name, char *path) {
    char base[4096];
    if (name[0] == '/') {
        snprintf(path, 4096, "%s", name);
        return;
    }
    if (folder == AT_FDCWD) {
        if (!getcwd(base, sizeof base)) base[0] = 0;
    } else {
        of_handle(folder, base);
    }
    size_t length = strlen(base);
    snprintf(path, 4096, "%.*s/%s", (int)(length < 3000 ? length : 3000), base, name);
}

static int is_in_root(const char *path) {
    size_t length = strlen(root);
    return root[0] && !strncmp(path, root, length) && path[length] == '/' && !strchr(path + length + 1, '/');
}

/* -1, and errno, if the disk cannot do this to a name in the folder: nothing may be made there, or nothing moved. */
static int refused(const char *path, int moves) {
    if (!disk || !is_in_root(path)) return 0;
    if (disk & CLOSED_ABOVE) {
        errno = EACCES;
        return -1;
    }
    if (moves && disk & MOUNTED) {
        errno = EBUSY;
        return -1;
    }
    return 0;
}

/* -1, and errno, if the call is to fail. */
static int decide(const char *call, const char *path, int takes_room) {
    if (!root[0] || strncmp(path, root, strlen(root))) return 0;
    count++;
    if (full && takes_room) {
        errno = ENOSPC;
        return -1;
    }
    if (action == KILL_ON && at > 0 && count > at) kill(getpid(), number);
    if (count != at) return 0;
    snprintf(last, sizeof last, "%s", call);
    if (action == KILL || action == KILL_ON) {
        kill(getpid(), number);
        return 0;
    }
    if (action == FAIL) {
        if (number == ENOSPC) full = 1;
        errno = number;
        return -1;
    }
    return 0;
}

static void record(const char *call, const char *one, const char *other, const void *data, size_t size) {
    if (journal < 0 || !root[0] || strncmp(one, root, strlen(root))) return;
    REAL(write);
    char line[9000];
    int length = snprintf(line, sizeof line, "%s\t%s\t%s\t%ld\t%zu\n", call, one, other, count, size);
    real(journal, line, length);
    if (size) real(journal, data, size);
}

ssize_t write(int handle, const void *data, size_t size) {
    REAL(write);
    char path[4096];
    of_handle(handle, path);
    if (decide("write", path, 1)) {
        if (errno != ENOSPC || size < 2 || count != at) return -1;
        size /= 2; /* what still fits */
    }
    ssize_t done = real(handle, data, size);
    if (done > 0) record("write", path, "", data, done);
    return done;
}

#define SENDFILE(name, offset_type)                                             \
    ssize_t name(int to, int from, offset_type *offset, size_t size) {          \
        REAL(name);                                                             \
        char path[4096];                                                        \
        of_handle(to, path);                                                    \
        return decide("write", path, 1) ? -1 : real(to, from, offset, size);    \
    }
SENDFILE(sendfile, off_t)
SENDFILE(sendfile64, off64_t)

int fchmod(int handle, mode_t mode) {
    REAL(fchmod);
    char path[4096];
    of_handle(handle, path);
    return decide("chmod", path, 0) ? -1 : real(handle, mode);
}

int chmod(const char *name, mode_t mode) {
    REAL(chmod);
    char path[4096];
    of_name(AT_FDCWD, name, path);
    return decide("chmod", path, 0) ? -1 : real(name, mode);
}

int utimensat(int folder, const char *name, const struct timespec times[2], int flags) {
    REAL(utimensat);
    char path[4096];
    of_name(folder, name, path);
    return decide("utime", path, 0) ? -1 : real(folder, name, times, flags);
}

int fsync(int handle) {
    REAL(fsync);
    char path[4096];
    of_handle(handle, path);
    if (decide("fsync", path, 1)) return -1;
    record("fsync", path, "", 0, 0);
    return root[0] ? 0 : real(handle); /* nobody pulls a plug here */
}

int close(int handle) {
    REAL(close);
    char path[4096];
    of_handle(handle, path);
    int wrong = decide("close", path, 0), code = errno, done = real(handle);
    if (wrong) errno = code;
    return wrong ? -1 : done;
}

static int opened(int done, int flags, const char *path) {
    if (done >= 0 && (flags & O_CREAT)) record("create", path, "", 0, 0);
    return done;
}

#define MODE                      \
    mode_t mode = 0;              \
    if (flags & O_CREAT) {        \
        va_list rest;             \
        va_start(rest, flags);    \
        mode = va_arg(rest, int); \
        va_end(rest);             \
    }

#define OPEN(name)                                                      \
    int name(const char *file, int flags, ...) {                        \
        REAL(name);                                                     \
        MODE char path[4096];                                           \
        of_name(AT_FDCWD, file, path);                                  \
        if (decide("open", path, flags & O_CREAT)) return -1;           \
        if (flags & O_CREAT && refused(path, 0)) return -1;             \
        return opened(real(file, flags, mode), flags, path);            \
    }
OPEN(open)
OPEN(open64)

#define OPENAT(name)                                                    \
    int name(int folder, const char *file, int flags, ...) {            \
        REAL(name);                                                     \
        MODE char path[4096];                                           \
        of_name(folder, file, path);                                    \
        if (decide("open", path, flags & O_CREAT)) return -1;           \
        if (flags & O_CREAT && refused(path, 0)) return -1;             \
        return opened(real(folder, file, flags, mode), flags, path);    \
    }
OPENAT(openat)
OPENAT(openat64)

int mkdir(const char *name, mode_t mode) {
    REAL(mkdir);
    char path[4096];
    of_name(AT_FDCWD, name, path);
    if (decide("mkdir", path, 1) || refused(path, 0)) return -1;
    int done = real(name, mode);
    if (!done) record("mkdir", path, "", 0, 0);
    return done;
}

int rmdir(const char *name) {
    REAL(rmdir);
    char path[4096];
    of_name(AT_FDCWD, name, path);
    if (decide("rmdir", path, 0)) return -1;
    int done = real(name);
    if (!done) record("rmdir", path, "", 0, 0);
    return done;
}

int unlink(const char *name) {
    REAL(unlink);
    char path[4096];
    of_name(AT_FDCWD, name, path);
    if (decide("unlink", path, 0)) return -1;
    int done = real(name);
    if (!done) record("unlink", path, "", 0, 0);
    return done;
}

int unlinkat(int folder, const char *name, int flags) {
    REAL(unlinkat);
    char path[4096];
    of_name(folder, name, path);
    if (decide(flags & AT_REMOVEDIR ? "rmdir" : "unlink", path, 0)) return -1;
    int done = real(folder, name, flags);
    if (!done) record(flags & AT_REMOVEDIR ? "rmdir" : "unlink", path, "", 0, 0);
    return done;
}

int rename(const char *from, const char *to) {
    REAL(rename);
    char one[4096], other[4096];
    of_name(AT_FDCWD, from, one), of_name(AT_FDCWD, to, other);
    if (decide("rename", one, 0) || refused(one, 1) || refused(other, 1)) return -1;
    int done = real(from, to);
    if (!done) record("rename", one, other, 0, 0);
    return done;
}

int renameat2(int from_folder, const char *from, int to_folder, const char *to, unsigned flags) {
    REAL(renameat2);
    char one[4096], other[4096];
    of_name(from_folder, from, one), of_name(to_folder, to, other);
    if (disk & NO_EXCHANGE) {
        errno = ENOSYS;
        return -1;
    }
    if (decide("exchange", one, 0) || refused(one, 1) || refused(other, 1)) return -1;
    int done = real(from_folder, from, to_folder, to, flags);
    if (!done) record("exchange", one, other, 0, 0);
    return done;
}
