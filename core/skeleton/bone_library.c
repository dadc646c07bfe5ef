#include "skeleton/bone_library.h"

#include "base/alloc.h"
#include "base/names.h"

#include <string.h>

typedef struct entry {
    char *name;
    const sn_bone_asset *asset; /* NULL: a user's            */
    sn_bone_template *read;     /* NULL: not asked for so far */
} entry;

struct sn_bone_library {
    entry *entry;
    int32_t n;
};

static sn_status no_memory(sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "bone library: no memory");
}

static sn_status add_entry(sn_bone_library *l, const char *name, const sn_bone_asset *asset, sn_error *err)
{
    entry *list = sn_realloc(l->entry, (size_t)l->n + 1, sizeof *list);
    if (!list) return no_memory(err);
    l->entry = list;
    list[l->n] = (entry){.name = sn_strdup(name), .asset = asset};
    if (!list[l->n].name) return no_memory(err);
    l->n++;
    return SN_OK;
}

sn_status sn_bone_library_create(sn_bone_library **out, sn_error *err)
{
    *out = NULL;
    sn_bone_library *l = SN_NEW_ZERO(sn_bone_library, 1);
    if (!l) return no_memory(err);
    sn_status st = SN_OK;
    for (const sn_bone_asset *a = sn_bone_assets; a->name && !st; a++) st = add_entry(l, a->name, a, err);
    if (st)
        sn_bone_library_destroy(l);
    else
        *out = l;
    return st;
}

static void release_template(sn_bone_template *t)
{
    if (t) sn_bone_template_free(t);
    sn_release(t);
}

void sn_bone_library_destroy(sn_bone_library *l)
{
    if (!l) return;
    for (int32_t i = 0; i < l->n; i++) {
        sn_release(l->entry[i].name);
        release_template(l->entry[i].read);
    }
    sn_release(l->entry);
    sn_release(l);
}

int32_t sn_bone_library_count(const sn_bone_library *l)
{
    return l->n;
}

const char *sn_bone_library_name(const sn_bone_library *l, int32_t i)
{
    return l->entry[i].name;
}

static entry *find_entry(const sn_bone_library *l, const char *name)
{
    for (int32_t i = 0; i < l->n; i++)
        if (strcmp(l->entry[i].name, name) == 0) return &l->entry[i];
    return NULL;
}

/* "no bone template 'x' (did you mean 'y'? known: a, b, ...)" */
static sn_status fail_unknown(const sn_bone_library *l, const char *name, sn_error *err)
{
    size_t size = 1;
    for (int32_t i = 0; i < l->n; i++) size += strlen(l->entry[i].name) + 2;
    char *known = sn_alloc_zero(size, 1);
    const char **names = SN_NEW(const char *, l->n);
    sn_status st = known && names ? SN_OK : no_memory(err);
    for (int32_t i = 0; !st && i < l->n; i++) {
        names[i] = l->entry[i].name;
        strcat(strcat(known, i ? ", " : ""), names[i]);
    }
    const char *near = st ? NULL : sn_nearest_name(name, names, (size_t)l->n);
    if (!st)
        st = sn_fail(err, SN_EINVAL, "no bone template '%.64s' (%s%s%sknown: %s)", name,
                     near ? "did you mean '" : "", near ? near : "", near ? "'? " : "", known);
    sn_release(known);
    sn_release(names);
    return st;
}

sn_status sn_bone_library_find(sn_bone_library *l, const char *name, const sn_bone_template **out,
                               sn_error *err)
{
    *out = NULL;
    entry *e = find_entry(l, name);
    if (!e) return fail_unknown(l, name, err);
    if (!e->read) {
        sn_bone_template *t = SN_NEW_ZERO(sn_bone_template, 1);
        if (!t) return no_memory(err);
        sn_status st = sn_bone_template_parse(t, name, e->asset->text, e->asset->obj, err);
        if (st) {
            sn_release(t);
            return st;
        }
        e->read = t;
    }
    *out = e->read;
    return SN_OK;
}

sn_status sn_bone_library_add(sn_bone_library *l, sn_bone_template *t, sn_error *err)
{
    sn_status st = sn_check_name("bone template", t->name, err);
    if (!st) st = sn_bone_template_check(t, err);
    entry *e = st ? NULL : find_entry(l, t->name);
    if (e && e->asset)
        return sn_fail(err, SN_EINVAL, "bone template '%s' comes with sinew: give yours another name",
                       t->name);
    sn_bone_template *own = st ? NULL : SN_NEW(sn_bone_template, 1);
    if (!st && !own) st = no_memory(err);
    if (!st && !e) {
        st = add_entry(l, t->name, NULL, err);
        e = &l->entry[l->n - 1];
    }
    if (st) {
        sn_release(own);
        return st;
    }
    release_template(e->read);
    e->read = own;
    *own = *t;
    memset(t, 0, sizeof *t);
    return SN_OK;
}
