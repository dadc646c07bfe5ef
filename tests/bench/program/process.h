/* process.h - what a measurement must say of its process and machine (Linux: /proc). */
#ifndef BENCH_PROCESS_H
#define BENCH_PROCESS_H

#include <stddef.h>

/* MiB that the process holds now, and at most since bench_reset_peak; 0 where the system does not tell. */
double bench_memory_now(void);
double bench_memory_peak(void);
/* Lets the peak start from what is held now. */
void bench_reset_peak(void);
void bench_trim(void); /* gives what is free back to the system */

void bench_cpu(char *out, size_t room); /* the processor's name */
int bench_cores(void);                  /* online */
double bench_memory_total(void);        /* MiB    */

#endif
