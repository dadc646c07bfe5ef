/* The two texts of a template: what it is, and its surfaces. */
#include "base/alloc.h"
#include "base/file.h"
#include "skeleton/bone_template.h"

#include <string.h>

/* ---- words and numbers of a line ---- */

typedef struct reader {
    const char *p; /* 0-terminated text */
    const char *name, *part;
    int line;
} reader;

static void skip_blanks(reader *r)
{
    while (*r->p == ' ' || *r->p == '\t' || *r->p == '\r') r->p++;
}

static bool at_end_of_line(reader *r)
{
    skip_blanks(r);
    return *r->p == '\0' || *r->p == '\n' || *r->p == '#';
}

static void next_line(reader *r)
{
    while (*r->p && *r->p != '\n') r->p++;
    if (*r->p) r->p++;
    r->line++;
}

static sn_status wrong(const reader *r, const char *want, sn_error *err)
{
    return sn_fail(err, SN_EFORMAT, "template '%s', %s, line %d: need %s", r->name, r->part, r->line, want);
}

/* Steps over the word when it is this one. */
static bool is_word(reader *r, const char *word)
{
    size_t n = strlen(word);
    skip_blanks(r);
    if (strncmp(r->p, word, n) != 0 || strchr(" \t\r\n", r->p[n]) == NULL) return false;
    r->p += n;
    return true;
}

static sn_status read_number(reader *r, double *out, sn_error *err)
{
    const char *end;
    skip_blanks(r);
    *out = sn_parse_double(r->p, &end);
    if (end == r->p || !isfinite(*out)) return wrong(r, "a number", err);
    r->p = end;
    return SN_OK;
}

static sn_status read_point(reader *r, sn_vec3 *out, sn_error *err)
{
    double p[3];
    for (int k = 0; k < 3; k++) {
        sn_status st = read_number(r, &p[k], err);
        if (st) return st;
    }
    *out = sn_v3_load(p);
    return SN_OK;
}

static sn_status read_name(reader *r, char **out, sn_error *err)
{
    skip_blanks(r);
    size_t n = strcspn(r->p, " \t\r\n");
    if (n == 0 || n > 64) return wrong(r, "a name of 1..64 characters", err);
    *out = SN_NEW(char, n + 1);
    if (!*out) return sn_fail(err, SN_ENOMEM, "template '%s': no memory", r->name);
    memcpy(*out, r->p, n);
    (*out)[n] = '\0';
    r->p += n;
    return SN_OK;
}

/* ---- what it is ---- */

static sn_status read_kind(reader *r, sn_bone_template *t, sn_error *err)
{
    static const sn_bone_kind kinds[] = {SN_BONE_CYLINDER, SN_BONE_CURVE, SN_BONE_SHAPE};
    for (int k = 0; k < 3; k++)
        if (is_word(r, sn_bone_kind_name(kinds[k]))) {
            t->kind = kinds[k];
            return SN_OK;
        }
    return wrong(r, "cylinder, curve or shape", err);
}

static sn_status read_landmark(reader *r, sn_bone_template *t, bool is_joint, sn_error *err)
{
    sn_landmark *list = sn_realloc(t->landmark, (size_t)t->n_landmark + 1, sizeof *list);
    if (!list) return sn_fail(err, SN_ENOMEM, "template '%s': no memory", r->name);
    t->landmark = list;
    sn_landmark *l = &list[t->n_landmark++];
    *l = (sn_landmark){0};
    sn_status st = read_name(r, &l->name, err);
    if (!st) st = read_point(r, &l->at, err);
    if (!st && !is_joint) st = read_number(r, &l->radius, err);
    return st;
}

static sn_status read_entry(reader *r, sn_bone_template *t, sn_error *err)
{
    if (is_word(r, "kind")) return read_kind(r, t, err);
    if (is_word(r, "from")) return read_point(r, &t->from, err);
    if (is_word(r, "to")) return read_point(r, &t->to, err);
    if (is_word(r, "length")) return read_number(r, &t->length, err);
    if (is_word(r, "landmark")) return read_landmark(r, t, false, err);
    if (is_word(r, "joint")) return read_landmark(r, t, true, err);
    return wrong(r, "kind, from, to, length, landmark or joint", err);
}

static sn_status read_text(sn_bone_template *t, const char *text, sn_error *err)
{
    reader r = {text, t->name, "text", 1};
    sn_status st = SN_OK;
    for (; !st && *r.p; next_line(&r)) {
        if (at_end_of_line(&r)) continue;
        st = read_entry(&r, t, err);
        if (!st && !at_end_of_line(&r)) st = wrong(&r, "the end of the line", err);
        if (st) return st;
    }
    return SN_OK;
}

/* ---- its surfaces ---- */

static sn_tri_mesh *mesh_of(reader *r, sn_bone_template *t)
{
    if (is_word(r, "cage")) return &t->cage;
    if (is_word(r, "skin")) return &t->skin;
    return &t->bone;
}

typedef struct surfaces { /* read twice: the first time only counts */
    sn_bone_template *t;
    sn_tri_mesh *m;                 /* the one being read                     */
    int32_t base, n_vert, own_vert; /* vertices before it, so far, of it      */
    int32_t n_face;                 /* of it so far                           */
    bool is_counting;
} surfaces;

static sn_status read_vertex(reader *r, surfaces *s, sn_error *err)
{
    sn_vec3 p = {0};
    sn_status st = read_point(r, &p, err);
    if (st) return st;
    if (s->is_counting)
        s->m->n_vert++;
    else
        sn_v3_store(s->m->pos + 3 * (size_t)s->own_vert, p);
    s->n_vert++;
    s->own_vert++;
    return SN_OK;
}

static sn_status read_face(reader *r, surfaces *s, sn_error *err)
{
    double corner[3];
    for (int k = 0; k < 3; k++) {
        sn_status st = read_number(r, &corner[k], err);
        if (st) return st;
    }
    if (!at_end_of_line(r)) return wrong(r, "a triangle", err);
    if (s->is_counting) {
        s->m->n_face++;
        return SN_OK;
    }
    for (int k = 0; k < 3; k++) {
        double i = corner[k] - s->base;
        if (!(i >= 1.0 && i <= s->m->n_vert && i == floor(i)))
            return wrong(r, "the index of a vertex of the same surface", err);
        s->m->face[3 * (size_t)s->n_face + (size_t)k] = (int32_t)i - 1;
    }
    s->n_face++;
    return SN_OK;
}

static sn_status read_surfaces(sn_bone_template *t, const char *obj, bool is_counting, sn_error *err)
{
    reader r = {obj, t->name, "surfaces", 1};
    surfaces s = {.t = t, .m = &t->bone, .is_counting = is_counting};
    for (; *r.p; next_line(&r)) {
        sn_status st = SN_OK;
        if (is_word(&r, "o")) {
            s.m = mesh_of(&r, t);
            s.base = s.n_vert;
            s.own_vert = s.n_face = 0;
        } else if (is_word(&r, "v")) {
            st = read_vertex(&r, &s, err);
        } else if (is_word(&r, "f")) {
            st = read_face(&r, &s, err);
        }
        if (st) return st;
    }
    return SN_OK;
}

static sn_status reserve(sn_tri_mesh *m, sn_error *err)
{
    int32_t n_vert = m->n_vert, n_face = m->n_face;
    sn_tri_mesh_init(m);
    return n_vert > 0 ? sn_tri_mesh_reserve(m, n_vert, n_face, err) : SN_OK;
}

static sn_status read_obj(sn_bone_template *t, const char *obj, sn_error *err)
{
    sn_status st = read_surfaces(t, obj, true, err);
    sn_tri_mesh *const mesh[] = {&t->bone, &t->cage, &t->skin};
    for (int k = 0; k < 3; k++) {
        if (st) sn_tri_mesh_init(mesh[k]); /* counted only */
        if (!st) st = reserve(mesh[k], err);
    }
    return st ? st : read_surfaces(t, obj, false, err);
}

sn_status sn_bone_template_parse(sn_bone_template *out, const char *name, const char *text, const char *obj,
                                 sn_error *err)
{
    memset(out, 0, sizeof *out);
    out->name = sn_strdup(name);
    sn_status st = out->name ? SN_OK : sn_fail(err, SN_ENOMEM, "template '%s': no memory", name);
    if (!st) st = read_text(out, text, err);
    if (!st) st = read_obj(out, obj, err);
    if (!st) st = sn_bone_template_check(out, err);
    if (st) sn_bone_template_free(out);
    return st;
}
