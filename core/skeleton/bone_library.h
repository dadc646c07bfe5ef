/* bone_library.h - templates by name: those that come with sinew (assets/bones, made by scripts/bones) and
 * those that a user adds. */
#ifndef SN_SKELETON_BONE_LIBRARY_H
#define SN_SKELETON_BONE_LIBRARY_H

#include "skeleton/bone_template.h"

typedef struct sn_bone_asset { /* as it lies in the library, unread */
    const char *name, *text, *obj;
} sn_bone_asset;
extern const sn_bone_asset sn_bone_assets[]; /* ends with a NULL name */

typedef struct sn_bone_library sn_bone_library; /* opaque; one thread at a time */
/* Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_bone_library_create(sn_bone_library **out, sn_error *err);
void sn_bone_library_destroy(sn_bone_library *l); /* NULL is fine */
int32_t sn_bone_library_count(const sn_bone_library *l);
const char *sn_bone_library_name(const sn_bone_library *l,
                                 int32_t i); /* in the order of the alphabet, then as added */
/* Reads it at the first use. The template lives as long as the library or until one of that name is added.
 * Errors: SN_EINVAL: no such template (suggests the nearest and lists the known), SN_EFORMAT, SN_ENOMEM. */
SN_MUST_USE sn_status sn_bone_library_find(sn_bone_library *l, const char *name, const sn_bone_template **out,
                                           sn_error *err);
/* Takes *t over and leaves it empty; replaces a template that a user added under this name. Errors: SN_EINVAL
 * (sn_bone_template_check, sn_check_name, the name of one that comes with sinew), SN_ENOMEM; the library is
 * then as before and *t the caller's. */
SN_MUST_USE sn_status sn_bone_library_add(sn_bone_library *l, sn_bone_template *t, sn_error *err);

#endif
