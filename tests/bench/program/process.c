#define _GNU_SOURCE
#include "process.h"

#include <malloc.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* The rest of the line of the file that begins with key; "" when there is none. */
static void find_line(const char *path, const char *key, char *out, size_t room)
{
    FILE *f = fopen(path, "r");
    char line[512];
    out[0] = '\0';
    while (f && !out[0] && fgets(line, sizeof line, f)) {
        if (strncmp(line, key, strlen(key))) continue;
        const char *rest = line + strlen(key);
        rest += strspn(rest, " \t:");
        (void)snprintf(out, room, "%.*s", (int)strcspn(rest, "\n"), rest);
    }
    if (f) (void)fclose(f);
}

static double read_mib(const char *path, const char *key)
{
    char text[64];
    double kib = 0.0;
    find_line(path, key, text, sizeof text);
    return sscanf(text, "%lf", &kib) == 1 ? kib / 1024.0 : 0.0;
}

double bench_memory_now(void)
{
    return read_mib("/proc/self/status", "VmRSS");
}

double bench_memory_peak(void)
{
    return read_mib("/proc/self/status", "VmHWM");
}

void bench_reset_peak(void)
{
    FILE *f = fopen("/proc/self/clear_refs", "w");
    if (!f) return;
    (void)fputs("5", f);
    (void)fclose(f);
}

void bench_trim(void)
{
    (void)malloc_trim(0);
}

void bench_cpu(char *out, size_t room)
{
    find_line("/proc/cpuinfo", "model name", out, room);
}

int bench_cores(void)
{
    return (int)sysconf(_SC_NPROCESSORS_ONLN);
}

double bench_memory_total(void)
{
    return read_mib("/proc/meminfo", "MemTotal");
}
