/* repair_child.c - CGAL's steps in a process of their own, where Ctrl-C and limits reach them. */
#include "mesh/repair_private.h"

#include "base/alloc.h"

#include <string.h>

typedef struct job {
    uint64_t kind; /* SN_REPAIR_JOB: sinew-mesher tells its jobs apart by it */
    int32_t task, n_vert, n_face, pad;
    sn_repair_sizes sizes;
} job;

typedef struct answer {
    int32_t n_vert, n_face;
    sn_repair_counts n;
} answer;

typedef struct request {
    job head;
    const sn_tri_mesh *in;
} request;

static size_t mesh_bytes(int32_t n_vert, int32_t n_face)
{
    return 3 * (size_t)n_vert * sizeof(double) + 3 * (size_t)n_face * sizeof(int32_t);
}

static sn_status do_task(const job *j, const sn_tri_mesh *in, sn_tri_mesh *out, sn_repair_counts *n,
                         sn_error *err)
{
    if (j->task == SN_TASK_ORIENT_FILL)
        return sn_bridge_orient_fill(in, j->sizes.hole, j->sizes.crumb, out, n, err);
    if (j->task == SN_TASK_UNTANGLE) return sn_bridge_untangle(in, out, n, err);
    return sn_bridge_wrap(in, &j->sizes.wrap, out, err);
}

static sn_status answer_job(const job *j, const sn_tri_mesh *in, sn_child_out *to, sn_error *err)
{
    sn_tri_mesh out;
    answer a = {0};
    sn_tri_mesh_init(&out);
    sn_status st = do_task(j, in, &out, &a.n, err);
    if (!st) {
        a.n_vert = out.n_vert;
        a.n_face = out.n_face;
        sn_child_send(to, &a, sizeof a);
        sn_child_send(to, out.pos, 3 * (size_t)out.n_vert * sizeof *out.pos);
        sn_child_send(to, out.face, 3 * (size_t)out.n_face * sizeof *out.face);
    }
    sn_tri_mesh_free(&out);
    return st;
}

/* Positions and faces, as they follow a job and an answer. */
static sn_status unpack_mesh(const char *at, int32_t n_vert, int32_t n_face, sn_tri_mesh *out, sn_error *err)
{
    sn_status st = sn_tri_mesh_reserve(out, n_vert, n_face, err);
    if (st) return st;
    size_t pos = 3 * (size_t)n_vert * sizeof *out->pos;
    memcpy(out->pos, at, pos);
    memcpy(out->face, at + pos, 3 * (size_t)n_face * sizeof *out->face);
    return SN_OK;
}

sn_status sn_repair_serve(const char *input, size_t size, sn_child_out *out, sn_error *err)
{
    job j;
    sn_tri_mesh in;
    if (size < sizeof j) return sn_fail(err, SN_EINTERNAL, "sinew-mesher: the job is cut short");
    memcpy(&j, input, sizeof j);
    bool fits = j.n_vert >= 0 && j.n_face >= 0 && size == sizeof j + mesh_bytes(j.n_vert, j.n_face);
    if (!fits || j.task < SN_TASK_ORIENT_FILL || j.task > SN_TASK_WRAP)
        return sn_fail(err, SN_EINTERNAL, "sinew-mesher: the job is %zu bytes, its header says other", size);
    sn_tri_mesh_init(&in);
    sn_status st = unpack_mesh(input + sizeof j, j.n_vert, j.n_face, &in, err);
    if (!st) st = answer_job(&j, &in, out, err);
    sn_tri_mesh_free(&in);
    return st;
}

static sn_status work_in_child(void *user, sn_child_out *out, sn_error *err)
{
    const request *r = user;
    size_t pos = 3 * (size_t)r->in->n_vert * sizeof *r->in->pos;
    size_t size = sizeof r->head + mesh_bytes(r->in->n_vert, r->in->n_face);
    char *input = sn_alloc(size, 1);
    if (input) {
        memcpy(input, &r->head, sizeof r->head);
        memcpy(input + sizeof r->head, r->in->pos, pos);
        memcpy(input + sizeof r->head + pos, r->in->face, 3 * (size_t)r->in->n_face * sizeof *r->in->face);
        sn_child_exec_beside(out, "sinew-mesher", SN_MESHER, input, size);
    }
    sn_release(input);
    return answer_job(&r->head, r->in, out, err);
}

sn_status sn_repair_in_child(sn_repair_task task, const sn_tri_mesh *in, sn_repair_sizes sizes,
                             const sn_repair *opt, const sn_run *run, sn_tri_mesh *out, sn_repair_counts *n,
                             sn_error *err)
{
    static const char *const step[] = {"filling holes", "resolving self-intersections", "wrapping"};
    sn_child child = {step[task], opt->time_limit, opt->memory_limit, SN_EMESH};
    request r = {{SN_REPAIR_JOB, (int32_t)task, in->n_vert, in->n_face, 0, sizes}, in};
    char *data;
    size_t size;
    answer got;
    sn_status st = sn_child_run(&child, work_in_child, &r, run, &data, &size, err);
    if (st) return st;
    if (size >= sizeof got) memcpy(&got, data, sizeof got);
    if (size < sizeof got || size != sizeof got + mesh_bytes(got.n_vert, got.n_face))
        st = sn_fail(err, SN_EINTERNAL, "%s: the result was cut short", step[task]);
    else
        st = unpack_mesh(data + sizeof got, got.n_vert, got.n_face, out, err);
    if (!st) *n = got.n;
    sn_release(data);
    return st;
}
