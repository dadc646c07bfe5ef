/* attachment.h - where a muscle meets bone at its ends: origin and insertion areas. */
#ifndef SN_FIELD_ATTACHMENT_H
#define SN_FIELD_ATTACHMENT_H

#include "field/measure.h"
#include "muscle/path.h"

/* How much of the curve, from the end, its patch may lie along. */
#define SN_ATTACHMENT_REACH 0.25

typedef struct sn_attachment {
    int32_t i_bone;   /* -1: the body has no bones                                                  */
    double area;      /* of the bone's surface that the muscle covers there; 0: it does not touch the bone */
    sn_vec3 centroid; /* of that area; where it is 0, the corner of the bone's surface nearest to the end */
    double distance;  /* from the end of the curve to the patch (nearest face's centre or that corner) */
} sn_attachment;

/* For each head an origin and an insertion: out[2 h] and out[2 h + 1]. The bone is the one that the muscle
 * touches nearest to the end of the curve, else the one nearest to it. Heads that share an end have the same
 * patch there. m: a measure of the muscle's tissue on the body. Errors: SN_ENOMEM. */
SN_MUST_USE sn_status sn_attachments_find(const sn_body *body, const sn_measure *m, const sn_muscle *muscle,
                                          const sn_paths *paths, sn_attachment *out, sn_error *err);

#endif
