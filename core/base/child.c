#define _GNU_SOURCE
#include "base/child.h"

#include "base/alloc.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/personality.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#define POLL_MS 50
#define EXIT_SENT 0
#define EXIT_FAILED 3 /* the last sizeof(sn_error) bytes are the error */

struct sn_child_out {
    int fd;
};

static bool write_all(int fd, const char *p, size_t size)
{
    while (size > 0) {
        ssize_t n = write(fd, p, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        p += n;
        size -= (size_t)n;
    }
    return true;
}

void sn_child_send(sn_child_out *out, const void *data, size_t size)
{
    if (!write_all(out->fd, data, size)) _exit(1); /* the parent has gone */
}

void sn_child_exec(sn_child_out *out, const char *program, const void *input, size_t size)
{
    if (access(program, X_OK) != 0) return;
    int in = memfd_create("sinew", 0);
    if (in < 0 || !write_all(in, input, size) || lseek(in, 0, SEEK_SET) != 0) return;
    (void)personality(ADDR_NO_RANDOMIZE);
    if (dup2(in, STDIN_FILENO) < 0 || dup2(out->fd, STDOUT_FILENO) < 0) return;
    char *argv[] = {(char *)(uintptr_t)program, NULL}, *env[] = {NULL};
    (void)execve(program, argv, env);
}

void sn_child_exec_beside(sn_child_out *out, const char *name, const char *built, const void *input,
                          size_t size)
{
    char path[4096];
    size_t room = strlen(name) + 1;
    ssize_t n = room < sizeof path ? readlink("/proc/self/exe", path, sizeof path - room) : -1;
    if (n > 0) {
        path[n] = '\0';
        char *slash = strrchr(path, '/');
        memcpy(slash ? slash + 1 : path, name, room);
        sn_child_exec(out, path, input, size);
    }
    sn_child_exec(out, built, input, size);
}

int sn_child_serve(sn_status (*fn)(const char *, size_t, sn_child_out *, sn_error *))
{
    sn_child_out out = {STDOUT_FILENO};
    sn_error err = {SN_OK, ""};
    char *input = NULL;
    size_t size = 0, cap = 0;
    for (;;) {
        if (!sn_grow(&input, &cap, size + (1u << 20), 1)) return 1;
        ssize_t n = read(STDIN_FILENO, input + size, cap - size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        size += (size_t)n;
    }
    sn_status st = fn(input, size, &out, &err);
    if (st) sn_child_send(&out, &err, sizeof err);
    sn_release(input);
    return st ? EXIT_FAILED : EXIT_SENT;
}

static size_t address_space_now(void)
{
    unsigned long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (!f) return 0;
    if (fscanf(f, "%lu", &pages) != 1) pages = 0;
    (void)fclose(f);
    return (size_t)pages * (size_t)sysconf(_SC_PAGESIZE);
}

static void limit_child(const sn_child *opt)
{
    (void)signal(SIGINT, SIG_IGN);
    (void)signal(SIGPIPE, SIG_DFL);
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    struct rlimit no_core = {0, 0};
    (void)setrlimit(RLIMIT_CORE, &no_core);
    size_t now = opt->memory_limit ? address_space_now() : 0;
    if (now) {
        struct rlimit lim = {now + opt->memory_limit, now + opt->memory_limit};
        (void)setrlimit(RLIMIT_AS, &lim);
    }
}

/* Nothing to read, nothing to be seen. Returns fd, or its copy when it had the number of a standard stream.
 */
static int mute_child(int fd)
{
    if (fd <= STDERR_FILENO) fd = fcntl(fd, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    int null = open("/dev/null", O_RDWR);
    if (null >= 0) {
        (void)dup2(null, STDIN_FILENO);
        (void)dup2(null, STDOUT_FILENO);
        (void)dup2(null, STDERR_FILENO);
    }
    return fd;
}

static void child_main(const sn_child *opt, sn_status (*fn)(void *, sn_child_out *, sn_error *), void *user,
                       int fd)
{
    limit_child(opt);
    sn_child_out out = {mute_child(fd)};
    sn_error err = {SN_OK, ""};
    if (fn(user, &out, &err)) {
        sn_child_send(&out, &err, sizeof err);
        _exit(EXIT_FAILED);
    }
    _exit(EXIT_SENT);
}

/* Reads until the child closes the pipe, or the run stops, or time is up. */
static sn_status collect(const sn_child *opt, int fd, const sn_run *run, char **data, size_t *size,
                         sn_error *err)
{
    double end = opt->time_limit > 0.0 ? sn_clock() + opt->time_limit : 0.0;
    size_t cap = 0;
    for (;;) {
        sn_status st = sn_run_step(run, opt->step, -1.0, err);
        if (st) return st;
        if (end > 0.0 && sn_clock() > end)
            return sn_fail(err, SN_ELIMIT, "%s: time limit of %g s reached", opt->step, opt->time_limit);
        struct pollfd p = {.fd = fd, .events = POLLIN};
        int ready = poll(&p, 1, POLL_MS);
        if (ready <= 0) continue;
        if (!sn_grow(data, &cap, *size + (1u << 16), 1))
            return sn_fail(err, SN_ENOMEM, "%s: no memory", opt->step);
        ssize_t n = read(fd, *data + *size, cap - *size);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return sn_fail(err, SN_EINTERNAL, "%s: %s", opt->step, strerror(errno));
        if (n == 0) return SN_OK;
        *size += (size_t)n;
    }
}

static sn_status judge(const sn_child *opt, int status, const char *data, size_t size, sn_error *err)
{
    if (WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SENT) return SN_OK;
    if (WIFEXITED(status) && WEXITSTATUS(status) == EXIT_FAILED && size >= sizeof(sn_error)) {
        sn_error child_err;
        memcpy(&child_err, data + size - sizeof child_err, sizeof child_err);
        if (child_err.code == SN_ENOMEM && opt->memory_limit > 0)
            return sn_fail(err, SN_ELIMIT, "%s: memory limit of %zu MiB reached (%s)", opt->step,
                           opt->memory_limit >> 20, child_err.msg);
        if (err) *err = child_err;
        return child_err.code;
    }
    if (WIFSIGNALED(status))
        return sn_fail(err, opt->crash_status, "%s: crashed (%s)", opt->step, strsignal(WTERMSIG(status)));
    return sn_fail(err, opt->crash_status, "%s: ended with exit code %d", opt->step,
                   WIFEXITED(status) ? WEXITSTATUS(status) : -1);
}

sn_status sn_child_run(const sn_child *opt, sn_status (*fn)(void *, sn_child_out *, sn_error *), void *user,
                       const sn_run *run, char **data, size_t *size, sn_error *err)
{
    int fd[2];
    *data = NULL;
    *size = 0;
    if (pipe2(fd, O_CLOEXEC) != 0)
        return sn_fail(err, SN_EINTERNAL, "%s: no pipe: %s", opt->step, strerror(errno));
    pid_t pid = fork();
    if (pid == 0) {
        (void)close(fd[0]);
        child_main(opt, fn, user, fd[1]);
    }
    (void)close(fd[1]);
    if (pid < 0) {
        (void)close(fd[0]);
        return sn_fail(err, SN_EINTERNAL, "%s: no process: %s", opt->step, strerror(errno));
    }
    sn_status st = collect(opt, fd[0], run, data, size, err);
    (void)close(fd[0]);
    if (st) (void)kill(pid, SIGKILL);
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {}
    if (!st) st = judge(opt, status, *data, *size, err);
    if (st) {
        sn_release(*data);
        *data = NULL;
        *size = 0;
    }
    return st;
}
