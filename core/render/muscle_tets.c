#include "render/muscle_tets.h"

#include "base/alloc.h"

#include <limits.h>
#include <string.h>

enum { vertex_block = 1024 }; /* vertices whose counters stay in the cache while all tissues pass by */

static void lists_free(sn_muscle_lists *l)
{
    sn_release(l->first);
    sn_release(l->muscle);
}

void sn_muscle_tets_init(sn_muscle_tets *m)
{
    memset(m, 0, sizeof *m);
}

void sn_muscle_tets_free(sn_muscle_tets *m)
{
    lists_free(&m->above);
    lists_free(&m->cand);
    lists_free(&m->need);
    sn_release(m->tet);
    sn_release(m->normal);
    sn_muscle_tets_init(m);
}

/* first holds a count per item at i + 1; makes them offsets and the room for the muscles. */
static sn_status lists_reserve(sn_muscle_lists *l, size_t n_item, sn_error *err)
{
    l->first[0] = 0;
    for (size_t i = 0; i < n_item; i++) l->first[i + 1] += l->first[i];
    l->muscle = SN_NEW(int32_t, l->first[n_item]);
    if (!l->muscle) return sn_fail(err, SN_ENOMEM, "picture: no memory for the muscles of %zu items", n_item);
    return SN_OK;
}

int32_t sn_muscle_lists_merge(const sn_muscle_lists *l, const int32_t *item, int n_item, int32_t *out)
{
    int64_t at[4], end[4];
    for (int k = 0; k < n_item; k++) {
        at[k] = l->first[item[k]];
        end[k] = l->first[item[k] + 1];
    }
    for (int32_t n = 0;; n++) {
        int32_t least = INT32_MAX;
        for (int k = 0; k < n_item; k++)
            if (at[k] < end[k] && l->muscle[at[k]] < least) least = l->muscle[at[k]];
        if (least == INT32_MAX) return n;
        for (int k = 0; k < n_item; k++)
            if (at[k] < end[k] && l->muscle[at[k]] == least) at[k]++;
        out[n] = least;
    }
}

/* One pass over a block of vertices: counts (fill = false) or writes the muscles above fat. */
static void above_in_block(sn_muscle_lists *l, const sn_picture_scene *s, int32_t v0, int32_t v1, bool fill)
{
    size_t n = (size_t)s->tets->n_vert;
    int64_t at[vertex_block] = {0};
    if (fill)
        for (int32_t v = v0; v < v1; v++) at[v - v0] = l->first[v];
    for (int32_t i = 1; i < s->n_tissue; i++) {
        const double *f = s->field + (size_t)i * n;
        for (int32_t v = v0; v < v1; v++)
            if (f[v] > s->field[v]) {
                if (fill) l->muscle[at[v - v0]] = i - 1;
                at[v - v0]++;
            }
    }
    if (!fill)
        for (int32_t v = v0; v < v1; v++) l->first[v + 1] = at[v - v0];
}

static sn_status find_above(sn_muscle_lists *l, const sn_picture_scene *s, const sn_run *run, sn_error *err)
{
    int32_t n_vert = s->tets->n_vert, n_block = (n_vert + vertex_block - 1) / vertex_block;
    l->first = SN_NEW(int64_t, (size_t)n_vert + 1);
    if (!l->first) return sn_fail(err, SN_ENOMEM, "picture: no memory for %d vertices", n_vert);
    for (int pass = 0; pass < 2; pass++) {
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run))
        for (int32_t b = 0; b < n_block; b++) {
            int32_t v0 = b * vertex_block, v1 = n_vert - v0 > vertex_block ? v0 + vertex_block : n_vert;
            above_in_block(l, s, v0, v1, pass == 1);
        }
        sn_status st = pass == 0 ? lists_reserve(l, (size_t)n_vert, err) : SN_OK;
        if (st) return st;
    }
    return SN_OK;
}

static sn_status check_field(const sn_picture_scene *s, const sn_run *run, sn_error *err)
{
    int64_t n = (int64_t)s->n_tissue * s->tets->n_vert, bad = n;
#pragma omp parallel for schedule(static) num_threads(sn_run_threads(run)) reduction(min : bad)
    for (int64_t i = 0; i < n; i++)
        if (!isfinite(s->field[i]) && i < bad) bad = i;
    if (bad == n) return SN_OK;
    return sn_fail(err, SN_EINVAL, "picture: tissue %lld has the value %g at vertex %lld",
                   (long long)(bad / s->tets->n_vert), s->field[bad], (long long)(bad % s->tets->n_vert) + 1);
}

/* Corner values of the candidates of one tet: muscle[k] has g[k][0..3]. */
typedef struct tet_scratch {
    int32_t *muscle;
    double (*g)[4];
} tet_scratch;

static bool dominates(const double a[4], const double b[4], bool wins_ties)
{
    bool is_above = false;
    for (int k = 0; k < 4; k++) {
        if (a[k] < b[k]) return false;
        is_above = is_above || a[k] > b[k];
    }
    return is_above || wins_ties;
}

/* Drops each candidate that another one matches or beats at all corners, hence everywhere in the tet. */
static int32_t drop_dominated(const tet_scratch *c, int32_t n)
{
    int32_t kept = 0;
    for (int32_t j = 0; j < n; j++) {
        bool is_hidden = false;
        for (int32_t i = 0; i < kept && !is_hidden; i++) is_hidden = dominates(c->g[i], c->g[j], true);
        for (int32_t i = j + 1; i < n && !is_hidden; i++) is_hidden = dominates(c->g[i], c->g[j], false);
        if (is_hidden) continue;
        c->muscle[kept] = c->muscle[j];
        memcpy(c->g[kept], c->g[j], sizeof c->g[j]);
        kept++;
    }
    return kept;
}

static double mix_min(const double a[4], const double b[4], double s)
{
    double least = INFINITY;
    for (int k = 0; k < 4; k++) least = fmin(least, s * a[k] + (1.0 - s) * b[k]);
    return least;
}

/* max(a, b) >= 0 in the whole tet? By duality the least value of max(a, b) is the greatest over s in [0, 1]
 * of min_k (s a_k + (1 - s) b_k), reached at an end or where two of the four lines cross. */
static bool pair_covers(const double a[4], const double b[4])
{
    if (mix_min(a, b, 0.0) >= 0.0 || mix_min(a, b, 1.0) >= 0.0) return true;
    for (int e = 0; e < 6; e++) {
        int i = sn_tet_edge[e][0], j = sn_tet_edge[e][1];
        double di = b[i] - b[j], slope = (a[j] - b[j]) - (a[i] - b[i]);
        double s = slope != 0.0 ? di / slope : -1.0;
        if (s > 0.0 && s < 1.0 && mix_min(a, b, s) >= 0.0) return true;
    }
    return false;
}

/* Does fat win somewhere? Exact up to two candidates; with more, true unless one or two of them cover the
 * tet. */
static bool fat_shows(const tet_scratch *c, int32_t n)
{
    for (int k = 0; k < 4; k++) {
        bool is_fat = true;
        for (int32_t i = 0; i < n; i++) is_fat = is_fat && c->g[i][k] <= 0.0;
        if (is_fat) return true;
    }
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = i; j < n; j++)
            if (pair_covers(c->g[i], c->g[j])) return false;
    return true;
}

static bool is_in(const sn_muscle_lists *l, int32_t item, int32_t muscle)
{
    for (int64_t a = l->first[item]; a < l->first[item + 1]; a++)
        if (l->muscle[a] == muscle) return true;
    return false;
}

/* Is there no muscle at any corner, or one at all of them? So it is in nearly all tets of a body. */
static bool has_no_surface(const sn_muscle_lists *above, const int32_t v[4])
{
    int64_t n = 0;
    for (int k = 0; k < 4; k++) n += above->first[v[k] + 1] - above->first[v[k]];
    if (n == 0) return true;
    for (int64_t a = above->first[v[0]]; a < above->first[v[0] + 1]; a++) {
        int32_t i = above->muscle[a];
        if (is_in(above, v[1], i) && is_in(above, v[2], i) && is_in(above, v[3], i)) return true;
    }
    return false;
}

/* The candidates of tet t into the scratch; 0 when no change from fat to muscle can show in it. */
static int32_t tet_candidates(const sn_muscle_tets *m, const sn_picture_scene *s, int32_t t,
                              const tet_scratch *c)
{
    const int32_t *v = s->tets->tet + 4 * (size_t)t;
    if (has_no_surface(&m->above, v)) return 0;
    int32_t n = sn_muscle_lists_merge(&m->above, v, 4, c->muscle);
    for (int32_t i = 0; i < n; i++)
        for (int k = 0; k < 4; k++) c->g[i][k] = sn_muscle_above_fat(s, c->muscle[i], v[k]);
    n = drop_dominated(c, n);
    return fat_shows(c, n) ? n : 0;
}

/* Runs over all tets; fill = false: counts candidates per tet into count, fill = true: writes those of the
 * tets sent. */
static sn_status each_tet(sn_muscle_tets *m, const sn_picture_scene *s, int32_t *count, bool fill,
                          const sn_run *run, sn_error *err)
{
    int32_t n_item = fill ? m->n_tet : s->tets->n_tet;
    bool is_short = false;
#pragma omp parallel num_threads(sn_run_threads(run)) reduction(|| : is_short)
    {
        tet_scratch c = {SN_NEW(int32_t, s->n_tissue), sn_alloc((size_t)s->n_tissue, sizeof(double[4]))};
        is_short = !c.muscle || !c.g;
#pragma omp for schedule(dynamic, 4096)
        for (int32_t i = 0; i < n_item; i++) {
            if (is_short) continue;
            int32_t n = tet_candidates(m, s, fill ? m->tet[i] : i, &c);
            if (fill)
                memcpy(m->cand.muscle + m->cand.first[i], c.muscle, (size_t)n * sizeof *c.muscle);
            else
                count[i] = n;
        }
        sn_release(c.muscle);
        sn_release(c.g);
    }
    return is_short ? sn_fail(err, SN_ENOMEM, "picture: no memory for %d tissues", s->n_tissue) : SN_OK;
}

static sn_status find_tets(sn_muscle_tets *m, const sn_picture_scene *s, const sn_run *run, sn_error *err)
{
    int32_t *count = SN_NEW(int32_t, s->tets->n_tet);
    sn_status st = count ? each_tet(m, s, count, false, run, err)
                         : sn_fail(err, SN_ENOMEM, "picture: no memory for %d tets", s->tets->n_tet);
    if (st) goto done;
    for (int32_t t = 0; t < s->tets->n_tet; t++) m->n_tet += count[t] > 0;
    m->tet = SN_NEW(int32_t, m->n_tet);
    m->cand.first = SN_NEW(int64_t, (size_t)m->n_tet + 1);
    if (!m->tet || !m->cand.first) {
        st = sn_fail(err, SN_ENOMEM, "picture: no memory for %d tets", m->n_tet);
        goto done;
    }
    int32_t n = 0;
    for (int32_t t = 0; t < s->tets->n_tet; t++)
        if (count[t] > 0) {
            m->tet[n] = t;
            m->cand.first[++n] = count[t];
        }
    st = lists_reserve(&m->cand, (size_t)m->n_tet, err);
    if (!st) st = each_tet(m, s, NULL, true, run, err);
done:
    sn_release(count);
    return st;
}

typedef struct incidence { /* of the tets that are sent */
    const sn_tet_fans *fans;
    int32_t *sent; /* n_tet: position among the sent, -1 */
    char *is_used; /* n_vert: does a sent tet have it    */
} incidence;

static sn_status find_incidence(incidence *in, const sn_muscle_tets *m, const sn_tet_mesh *mesh,
                                sn_error *err)
{
    in->sent = SN_NEW(int32_t, mesh->n_tet);
    in->is_used = SN_NEW_ZERO(char, mesh->n_vert);
    if (!in->sent || !in->is_used)
        return sn_fail(err, SN_ENOMEM, "picture: no memory for %d vertices", mesh->n_vert);
    memset(in->sent, 0xff, (size_t)mesh->n_tet * sizeof *in->sent);
    for (int32_t i = 0; i < m->n_tet; i++) {
        in->sent[m->tet[i]] = i;
        for (size_t k = 0; k < 4; k++) in->is_used[mesh->tet[4 * (size_t)m->tet[i] + k]] = 1;
    }
    return SN_OK;
}

/* The union of the candidates of the sent tets around v, increasing; out has room for all muscles. */
static int32_t needed_at(const sn_muscle_tets *m, const incidence *in, int32_t v, int32_t *out)
{
    int32_t n = 0;
    for (int64_t a = in->fans->first[v]; a < in->fans->first[v + 1]; a++) {
        int32_t i = in->sent[in->fans->tet[a]];
        if (i < 0) continue;
        for (int64_t c = m->cand.first[i]; c < m->cand.first[i + 1]; c++) {
            int32_t at = n, id = m->cand.muscle[c];
            while (at > 0 && out[at - 1] > id) at--;
            if (at > 0 && out[at - 1] == id) continue;
            memmove(out + at + 1, out + at, (size_t)(n - at) * sizeof *out);
            out[at] = id;
            n++;
        }
    }
    return n;
}

static sn_status find_needed(sn_muscle_tets *m, const sn_picture_scene *s, const incidence *in,
                             const sn_run *run, sn_error *err)
{
    int32_t n_vert = s->tets->n_vert;
    m->need.first = SN_NEW_ZERO(int64_t, (size_t)n_vert + 1);
    if (!m->need.first) return sn_fail(err, SN_ENOMEM, "picture: no memory for %d vertices", n_vert);
    for (int pass = 0; pass < 2; pass++) {
        bool is_short = false;
#pragma omp parallel num_threads(sn_run_threads(run)) reduction(|| : is_short)
        {
            int32_t *out = SN_NEW(int32_t, s->n_tissue);
            is_short = !out;
#pragma omp for schedule(dynamic, 1024)
            for (int32_t v = 0; v < n_vert; v++) {
                if (is_short || !in->is_used[v]) continue;
                int32_t n = needed_at(m, in, v, out);
                if (pass == 0)
                    m->need.first[v + 1] = n;
                else
                    memcpy(m->need.muscle + m->need.first[v], out, (size_t)n * sizeof *out);
            }
            sn_release(out);
        }
        sn_status st =
            is_short ? sn_fail(err, SN_ENOMEM, "picture: no memory for %d tissues", s->n_tissue) : SN_OK;
        if (!st && pass == 0) st = lists_reserve(&m->need, (size_t)n_vert, err);
        if (st) return st;
    }
    return SN_OK;
}

/* Volume times the gradient of barycentric coordinate k (times a constant): the inward area vector of face k.
 */
static void area_vectors(const sn_tet_mesh *mesh, const int32_t v[4], sn_vec3 out[4])
{
    for (int k = 0; k < 4; k++) {
        const int *f = sn_tet_face[k];
        sn_vec3 a = sn_tet_mesh_point(mesh, v[f[0]]);
        out[k] = sn_v3_cross(sn_v3_sub(sn_tet_mesh_point(mesh, v[f[2]]), a),
                             sn_v3_sub(sn_tet_mesh_point(mesh, v[f[1]]), a));
    }
}

/* Gradients of g averaged by volume over all tets around v. sum: room for all muscles. */
static void vertex_normals(const sn_muscle_tets *m, const sn_picture_scene *s, const incidence *in, int32_t v,
                           sn_vec3 *sum)
{
    const int32_t *muscle = m->need.muscle + m->need.first[v];
    int64_t n = m->need.first[v + 1] - m->need.first[v];
    for (int64_t i = 0; i < n; i++) sum[i] = (sn_vec3){0};
    for (int64_t a = in->fans->first[v]; n > 0 && a < in->fans->first[v + 1]; a++) {
        const int32_t *corner = s->tets->tet + 4 * (size_t)in->fans->tet[a];
        sn_vec3 area[4];
        area_vectors(s->tets, corner, area);
        for (int64_t i = 0; i < n; i++)
            for (int k = 0; k < 4; k++)
                sum[i] = sn_v3_mad(sum[i], sn_muscle_above_fat(s, muscle[i], corner[k]), area[k]);
    }
    for (int64_t i = 0; i < n; i++) {
        sn_vec3 unit = sn_v3_unit(sum[i]);
        float *out = m->normal + 3 * (m->need.first[v] + i);
        out[0] = (float)-unit.x;
        out[1] = (float)-unit.y;
        out[2] = (float)-unit.z;
    }
}

static sn_status fill_normals(const sn_muscle_tets *m, const sn_picture_scene *s, const incidence *in,
                              const sn_run *run, sn_error *err)
{
    bool is_short = false;
#pragma omp parallel num_threads(sn_run_threads(run)) reduction(|| : is_short)
    {
        sn_vec3 *sum = SN_NEW(sn_vec3, s->n_tissue);
        is_short = !sum;
#pragma omp for schedule(dynamic, 512)
        for (int32_t v = 0; v < s->tets->n_vert; v++)
            if (!is_short) vertex_normals(m, s, in, v, sum);
        sn_release(sum);
    }
    return is_short ? sn_fail(err, SN_ENOMEM, "picture: no memory for normals") : SN_OK;
}

static sn_status find_normals(sn_muscle_tets *m, const sn_picture_scene *s, const sn_tet_fans *fans,
                              const sn_run *run, sn_error *err)
{
    incidence in = {.fans = fans};
    sn_status st = find_incidence(&in, m, s->tets, err);
    if (!st) st = find_needed(m, s, &in, run, err);
    if (!st) {
        m->normal = sn_alloc((size_t)m->need.first[s->tets->n_vert], sizeof(float[3]));
        st = m->normal ? fill_normals(m, s, &in, run, err)
                       : sn_fail(err, SN_ENOMEM, "picture: no memory for normals");
    }
    sn_release(in.sent);
    sn_release(in.is_used);
    return st;
}

/* ---- tets around vertices ---- */

sn_status sn_tet_fans_find(sn_tet_fans *f, const sn_tet_mesh *mesh, sn_error *err)
{
    size_t n_corner = 4 * (size_t)mesh->n_tet;
    f->first = SN_NEW_ZERO(int64_t, (size_t)mesh->n_vert + 2);
    f->tet = SN_NEW(int32_t, n_corner);
    if (!f->first || !f->tet) {
        sn_tet_fans_free(f);
        return sn_fail(err, SN_ENOMEM, "picture: no memory for the tets around %d vertices", mesh->n_vert);
    }
    /* Counts go two places up, so that filling moves the starts into place. */
    for (size_t c = 0; c < n_corner; c++) f->first[mesh->tet[c] + 2]++;
    for (int32_t v = 0; v < mesh->n_vert; v++) f->first[v + 2] += f->first[v + 1];
    for (size_t c = 0; c < n_corner; c++) f->tet[f->first[mesh->tet[c] + 1]++] = (int32_t)(c >> 2);
    return SN_OK;
}

void sn_tet_fans_free(sn_tet_fans *f)
{
    sn_release(f->first);
    sn_release(f->tet);
    memset(f, 0, sizeof *f);
}

const float *sn_muscle_tets_normal(const sn_muscle_tets *m, int32_t i_vert, int32_t i_muscle)
{
    int64_t n = m->need.first[i_vert];
    while (m->need.muscle[n] != i_muscle) n++;
    return m->normal + 3 * n;
}

sn_status sn_muscle_tets_find(sn_muscle_tets *m, const sn_picture_scene *s, const sn_tet_fans *fans,
                              const sn_run *run, sn_error *err)
{
    sn_muscle_tets_free(m);
    sn_status st = check_field(s, run, err);
    if (!st) st = find_above(&m->above, s, run, err);
    if (!st) st = sn_run_step(run, "choosing tets", 0.05, err);
    if (!st) st = find_tets(m, s, run, err);
    if (!st) st = sn_run_step(run, "smoothing normals", 0.15, err);
    if (!st) st = find_normals(m, s, fans, run, err);
    if (st) sn_muscle_tets_free(m);
    return st;
}
