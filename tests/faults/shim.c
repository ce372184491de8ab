/* Counts the file-system calls of a process below chosen folders, and lets one of them fail.
 *
 * Loaded before libc (LD_PRELOAD), it sees the calls of Python and of every C library alike. Its
 * orders and its reports are in one file that all processes of a run share, named by
 * LOADSHARE_FAULTS; `shim.py` writes and reads the same fields.
 */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#define ROOM 1024
#define FILES 65536
#define SHORT -1
#define KILL -2

struct control {
    int64_t armed;   /* whether calls are counted */
    int64_t count;   /* calls so far */
    int64_t target;  /* call that fails, from 1; 0 for none */
    int64_t error;   /* errno, SHORT or KILL */
    int64_t lasting; /* whether all calls from there on fail that need room on the disk */
    int64_t hit;     /* calls that failed */
    char root[ROOM]; /* folder that is watched */
    char name[64];   /* of the first call that failed */
    char path[ROOM]; /* what it was about */
    char log[ROOM];  /* file to which each call is written; empty for none */
};

static struct control *control;
static char watched[FILES];
static __thread int inside;

__attribute__((constructor)) static void begin(void) {
    const char *file = getenv("LOADSHARE_FAULTS");
    if (file == NULL) return;
    int (*own_open)(const char *, int, ...) = dlsym(RTLD_NEXT, "open");
    int (*own_close)(int) = dlsym(RTLD_NEXT, "close");
    int fd = own_open(file, O_RDWR | O_CLOEXEC);
    if (fd < 0) return;
    void *at = mmap(NULL, sizeof(struct control), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    own_close(fd);
    if (at != MAP_FAILED) control = at;
}

static void name_of(int fd, char *path) {
    char link[64];
    ssize_t (*own)(const char *, char *, size_t) = dlsym(RTLD_NEXT, "readlink");
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t size = own(link, path, ROOM - 1);
    path[size > 0 ? size : 0] = 0;
}

/* Whether a path lies in the folder; its full name. */
static int below(int folder, const char *path, char *full) {
    if (control == NULL || !control->armed || path == NULL || inside) return 0;
    if (path[0] == '/') {
        snprintf(full, ROOM, "%s", path);
    } else {
        char at[ROOM];
        if (folder == AT_FDCWD) {
            if (getcwd(at, sizeof at) == NULL) return 0;
        } else {
            name_of(folder, at);
        }
        if (snprintf(full, ROOM, "%s/%s", at, path) >= ROOM) return 0;
    }
    size_t size = strlen(control->root);
    return size && strncmp(full, control->root, size) == 0 && (full[size] == '/' || !full[size]);
}

static void tell(int64_t number, const char *name, const char *path) {
    if (!control->log[0]) return;
    inside = 1;
    int (*own_open)(const char *, int, ...) = dlsym(RTLD_NEXT, "open");
    int (*own_close)(int) = dlsym(RTLD_NEXT, "close");
    ssize_t (*own_write)(int, const void *, size_t) = dlsym(RTLD_NEXT, "write");
    int fd = own_open(control->log, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
    if (fd >= 0) {
        char line[2 * ROOM];
        int size = snprintf(line, sizeof line, "%ld\t%s\t%s\n", (long)number, name, path);
        if (own_write(fd, line, size) != size) abort();
        own_close(fd);
    }
    inside = 0;
}

static void die(void) {
    kill(getpid(), SIGKILL);
    for (;;) pause();
}

/* Count a call; 0 where it goes on, else what becomes of it. `room`: whether it needs room on the
 * disk; `part`: whether it may be done in part, and is, before the process dies in it. */
static int64_t look(const char *name, const char *path, int room, int part) {
    int64_t number = __atomic_add_fetch(&control->count, 1, __ATOMIC_SEQ_CST);
    tell(number, name, path);
    int here = number == control->target;
    if (control->lasting) here = control->target && number >= control->target && room;
    if (!here) return 0;
    if (control->error == SHORT && !part) return 0;
    if (__atomic_add_fetch(&control->hit, 1, __ATOMIC_SEQ_CST) == 1) {
        snprintf(control->name, sizeof control->name, "%s", name);
        snprintf(control->path, sizeof control->path, "%s", path);
    }
    if (control->error == KILL && !part) die();
    return control->error;
}

static int64_t look_at(const char *name, int fd, int room, int part) {
    char path[ROOM];
    int before = errno;
    name_of(fd, path);
    errno = before;
    return look(name, path, room, part);
}

static int known(int fd) {
    return control != NULL && control->armed && !inside && fd >= 0 && fd < FILES && watched[fd];
}

static void mark(int fd, int is) {
    if (fd >= 0 && fd < FILES) watched[fd] = is;
}

/* What is about a path, what about an open file, and what reads or writes one. */
#define PATH_CALL(type, bad, name, room, at, path, parameters, values)        \
    type name parameters {                                                    \
        static type(*own) parameters;                                         \
        char full[ROOM];                                                      \
        if (own == NULL) *(void **)&own = dlsym(RTLD_NEXT, #name);            \
        if (below(at, path, full)) {                                          \
            int64_t error = look(#name, full, room, 0);                       \
            if (error > 0) {                                                  \
                errno = (int)error;                                           \
                return bad;                                                   \
            }                                                                 \
        }                                                                     \
        return own values;                                                    \
    }

#define FILE_CALL(type, bad, name, room, parameters, values)                  \
    type name parameters {                                                    \
        static type(*own) parameters;                                         \
        if (own == NULL) *(void **)&own = dlsym(RTLD_NEXT, #name);            \
        if (known(fd)) {                                                      \
            int64_t error = look_at(#name, fd, room, 0);                      \
            if (error > 0) {                                                  \
                errno = (int)error;                                           \
                return bad;                                                   \
            }                                                                 \
        }                                                                     \
        return own values;                                                    \
    }

/* A read or a write: it may be done in part. */
#define DATA_CALL(name, room, parameters, values)                             \
    ssize_t name parameters {                                                 \
        static ssize_t(*own) parameters;                                      \
        if (own == NULL) *(void **)&own = dlsym(RTLD_NEXT, #name);            \
        if (known(fd)) {                                                      \
            int64_t error = look_at(#name, fd, room, 1);                      \
            if (error > 0) {                                                  \
                errno = (int)error;                                           \
                return -1;                                                    \
            }                                                                 \
            if (error < 0) {                                                  \
                size = size > 1 ? size / 2 : size;                            \
                ssize_t done = own values;                                    \
                if (error == KILL) die();                                     \
                return done;                                                  \
            }                                                                 \
        }                                                                     \
        return own values;                                                    \
    }

#define OPENING(name, at, parameters, values)                                 \
    int name parameters {                                                     \
        static int (*own) parameters;                                         \
        char full[ROOM];                                                      \
        mode_t mode = 0;                                                      \
        if (flags & (O_CREAT | O_TMPFILE)) {                                  \
            va_list more;                                                     \
            va_start(more, flags);                                            \
            mode = va_arg(more, mode_t);                                      \
            va_end(more);                                                     \
        }                                                                     \
        if (own == NULL) *(void **)&own = dlsym(RTLD_NEXT, #name);            \
        int mine = below(at, path, full);                                     \
        if (mine) {                                                           \
            int64_t error = look(#name, full, flags & O_CREAT, 0);            \
            if (error > 0) {                                                  \
                errno = (int)error;                                           \
                return -1;                                                    \
            }                                                                 \
        }                                                                     \
        int fd = own values;                                                  \
        mark(fd, mine);                                                       \
        return fd;                                                            \
    }
#define OPEN(name) OPENING(name, AT_FDCWD, (const char *path, int flags, ...), (path, flags, mode))
#define OPENAT(name) \
    OPENING(name, at, (int at, const char *path, int flags, ...), (at, path, flags, mode))
OPEN(open)
OPEN(open64)
OPENAT(openat)
OPENAT(openat64)

#define FOPEN(name)                                                           \
    FILE *name(const char *path, const char *how) {                           \
        static FILE *(*own)(const char *, const char *);                      \
        char full[ROOM];                                                      \
        if (own == NULL) *(void **)&own = dlsym(RTLD_NEXT, #name);            \
        if (below(AT_FDCWD, path, full)) {                                    \
            int64_t error = look(#name, full, how[0] != 'r', 0);              \
            if (error > 0) {                                                  \
                errno = (int)error;                                           \
                return NULL;                                                  \
            }                                                                 \
        }                                                                     \
        return own(path, how);                                                \
    }
FOPEN(fopen)
FOPEN(fopen64)

/* A file that is closed is closed, whatever close returns. */
int close(int fd) {
    static int (*own)(int);
    if (own == NULL) *(void **)&own = dlsym(RTLD_NEXT, "close");
    if (!known(fd)) {
        mark(fd, 0);
        return own(fd);
    }
    int64_t error = look_at("close", fd, 0, 0);
    mark(fd, 0);
    int done = own(fd);
    if (error > 0) {
        errno = (int)error;
        return -1;
    }
    return done;
}

int dup(int fd) {
    static int (*own)(int);
    if (own == NULL) *(void **)&own = dlsym(RTLD_NEXT, "dup");
    int made = own(fd);
    if (made >= 0) mark(made, fd >= 0 && fd < FILES && watched[fd]);
    return made;
}

DATA_CALL(read, 0, (int fd, void *to, size_t size), (fd, to, size))
DATA_CALL(pread, 0, (int fd, void *to, size_t size, off_t at), (fd, to, size, at))
DATA_CALL(pread64, 0, (int fd, void *to, size_t size, off64_t at), (fd, to, size, at))
DATA_CALL(write, 1, (int fd, const void *from, size_t size), (fd, from, size))
DATA_CALL(pwrite, 1, (int fd, const void *from, size_t size, off_t at), (fd, from, size, at))
DATA_CALL(pwrite64, 1, (int fd, const void *from, size_t size, off64_t at), (fd, from, size, at))
FILE_CALL(ssize_t, -1, writev, 1, (int fd, const struct iovec *io, int count), (fd, io, count))
FILE_CALL(ssize_t, -1, readv, 0, (int fd, const struct iovec *io, int count), (fd, io, count))
FILE_CALL(ssize_t, -1, sendfile64, 1, (int to, int fd, off64_t *at, size_t n), (to, fd, at, n))
FILE_CALL(ssize_t, -1, copy_file_range, 1,
          (int from, off64_t *at, int fd, off64_t *to, size_t n, unsigned how),
          (from, at, fd, to, n, how))

FILE_CALL(int, -1, fsync, 0, (int fd), (fd))
FILE_CALL(int, -1, fdatasync, 0, (int fd), (fd))
FILE_CALL(int, -1, ftruncate, 1, (int fd, off_t size), (fd, size))
FILE_CALL(int, -1, ftruncate64, 1, (int fd, off64_t size), (fd, size))
FILE_CALL(int, -1, fchmod, 0, (int fd, mode_t mode), (fd, mode))
FILE_CALL(int, -1, fchown, 0, (int fd, uid_t user, gid_t group), (fd, user, group))
FILE_CALL(int, -1, futimens, 0, (int fd, const struct timespec to[2]), (fd, to))
FILE_CALL(int, -1, flock, 0, (int fd, int how), (fd, how))
FILE_CALL(off_t, -1, lseek, 0, (int fd, off_t at, int how), (fd, at, how))
FILE_CALL(off64_t, -1, lseek64, 0, (int fd, off64_t at, int how), (fd, at, how))
FILE_CALL(int, -1, fstat, 0, (int fd, struct stat *to), (fd, to))
FILE_CALL(int, -1, fstat64, 0, (int fd, struct stat64 *to), (fd, to))
FILE_CALL(int, -1, __fxstat, 0, (int form, int fd, struct stat *to), (form, fd, to))
FILE_CALL(int, -1, __fxstat64, 0, (int form, int fd, struct stat64 *to), (form, fd, to))

#define HERE AT_FDCWD
PATH_CALL(int, -1, stat, 0, HERE, path, (const char *path, struct stat *to), (path, to))
PATH_CALL(int, -1, stat64, 0, HERE, path, (const char *path, struct stat64 *to), (path, to))
PATH_CALL(int, -1, lstat, 0, HERE, path, (const char *path, struct stat *to), (path, to))
PATH_CALL(int, -1, lstat64, 0, HERE, path, (const char *path, struct stat64 *to), (path, to))
PATH_CALL(int, -1, __xstat, 0, HERE, path, (int f, const char *path, struct stat *to),
          (f, path, to))
PATH_CALL(int, -1, __xstat64, 0, HERE, path, (int f, const char *path, struct stat64 *to),
          (f, path, to))
PATH_CALL(int, -1, fstatat, 0, at, path, (int at, const char *path, struct stat *to, int how),
          (at, path, to, how))
PATH_CALL(int, -1, fstatat64, 0, at, path, (int at, const char *path, struct stat64 *to, int how),
          (at, path, to, how))
PATH_CALL(int, -1, access, 0, HERE, path, (const char *path, int how), (path, how))
PATH_CALL(int, -1, faccessat, 0, at, path, (int at, const char *path, int how, int more),
          (at, path, how, more))
PATH_CALL(ssize_t, -1, readlink, 0, HERE, path, (const char *path, char *to, size_t size),
          (path, to, size))
PATH_CALL(ssize_t, -1, readlinkat, 0, at, path, (int at, const char *path, char *to, size_t size),
          (at, path, to, size))
PATH_CALL(int, -1, mkdir, 1, HERE, path, (const char *path, mode_t mode), (path, mode))
PATH_CALL(int, -1, mkdirat, 1, at, path, (int at, const char *path, mode_t mode), (at, path, mode))
PATH_CALL(int, -1, rmdir, 0, HERE, path, (const char *path), (path))
PATH_CALL(int, -1, unlink, 0, HERE, path, (const char *path), (path))
PATH_CALL(int, -1, unlinkat, 0, at, path, (int at, const char *path, int how), (at, path, how))
PATH_CALL(int, -1, rename, 1, HERE, path, (const char *from, const char *path), (from, path))
PATH_CALL(int, -1, renameat, 1, at, path, (int old, const char *from, int at, const char *path),
          (old, from, at, path))
PATH_CALL(int, -1, link, 1, HERE, path, (const char *from, const char *path), (from, path))
PATH_CALL(int, -1, symlink, 1, HERE, path, (const char *from, const char *path), (from, path))
PATH_CALL(int, -1, chmod, 0, HERE, path, (const char *path, mode_t mode), (path, mode))
PATH_CALL(int, -1, fchmodat, 0, at, path, (int at, const char *path, mode_t mode, int how),
          (at, path, mode, how))
PATH_CALL(int, -1, chown, 0, HERE, path, (const char *path, uid_t user, gid_t group),
          (path, user, group))
PATH_CALL(int, -1, lchown, 0, HERE, path, (const char *path, uid_t user, gid_t group),
          (path, user, group))
PATH_CALL(int, -1, fchownat, 0, at, path, (int at, const char *path, uid_t u, gid_t g, int how),
          (at, path, u, g, how))
PATH_CALL(int, -1, truncate64, 1, HERE, path, (const char *path, off64_t size), (path, size))
PATH_CALL(int, -1, utimensat, 0, at, path,
          (int at, const char *path, const struct timespec to[2], int how), (at, path, to, how))

DIR *opendir(const char *path) {
    static DIR *(*own)(const char *);
    char full[ROOM];
    if (own == NULL) *(void **)&own = dlsym(RTLD_NEXT, "opendir");
    int mine = below(AT_FDCWD, path, full);
    if (mine) {
        int64_t error = look("opendir", full, 0, 0);
        if (error > 0) {
            errno = (int)error;
            return NULL;
        }
    }
    DIR *made = own(path);
    if (made != NULL) mark(dirfd(made), mine);
    return made;
}

int closedir(DIR *folder) {
    static int (*own)(DIR *);
    if (own == NULL) *(void **)&own = dlsym(RTLD_NEXT, "closedir");
    mark(dirfd(folder), 0);
    return own(folder);
}

#define READDIR(type, name)                                                   \
    type *name(DIR *folder) {                                                 \
        static type *(*own)(DIR *);                                           \
        if (own == NULL) *(void **)&own = dlsym(RTLD_NEXT, #name);            \
        if (known(dirfd(folder))) {                                           \
            int64_t error = look_at(#name, dirfd(folder), 0, 0);              \
            if (error > 0) {                                                  \
                errno = (int)error;                                           \
                return NULL;                                                  \
            }                                                                 \
        }                                                                     \
        return own(folder);                                                   \
    }
READDIR(struct dirent, readdir)
READDIR(struct dirent64, readdir64)
