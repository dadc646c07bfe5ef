/* child.h - runs a step in a child process, so that third-party code which crashes, hangs or eats memory
 * harms nobody.
 *
 * The child is a fork of the caller: it sees the caller's data and sends its result back as bytes. It must
 * not start threads of OpenMP. Ctrl-C does not reach it; a stopped run kills it. */
#ifndef SN_BASE_CHILD_H
#define SN_BASE_CHILD_H

#include "base/run.h"

#include <stddef.h>

typedef struct sn_child_out sn_child_out; /* opaque: the pipe to the parent */
/* Sends size bytes; the child ends when the parent has gone. */
void sn_child_send(sn_child_out *out, const void *data, size_t size);

/* Replaces the child by another program, which reads `input` from its standard input and writes the result to
 * its standard output: see sn_child_serve. A fresh process has the same memory layout every time (addresses
 * are not randomized), so code whose result depends on addresses gives the same result every time. Returns
 * only when that program cannot be run. */
void sn_child_exec(sn_child_out *out, const char *program, const void *input, size_t size);
/* The same with the program `name` beside the running one; else with the one at `built`. */
void sn_child_exec_beside(sn_child_out *out, const char *name, const char *built, const void *input,
                          size_t size);
/* The main function of such a program: returns its exit code. fn as in sn_child_run, with the input. */
int sn_child_serve(sn_status (*fn)(const char *input, size_t size, sn_child_out *out, sn_error *err));

typedef struct sn_child {
    const char *step;       /* for messages and progress: "meshing with TetGen"                    */
    double time_limit;      /* seconds, 0: none                                                    */
    size_t memory_limit;    /* bytes that the child may take beyond what the caller has, 0: none   */
    sn_status crash_status; /* status when it crashes: SN_EMESH for a mesher                       */
} sn_child;

/* Runs fn in a child and returns what it sent: *data by sn_alloc, *size bytes. When fn fails its status and
 * message come back, but SN_ENOMEM under a memory limit as SN_ELIMIT. Errors besides: crash_status (crash;
 * the message has the signal), SN_ELIMIT (time), SN_ECANCEL, SN_ENOMEM, SN_EINTERNAL (no process or pipe to
 * be had). *data is then NULL. */
SN_MUST_USE sn_status sn_child_run(const sn_child *opt,
                                   sn_status (*fn)(void *user, sn_child_out *out, sn_error *err), void *user,
                                   const sn_run *run, char **data, size_t *size, sn_error *err);

#endif
