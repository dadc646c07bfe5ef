/* compare.c - `sinew compare`: are two pictures alike? */
#include "commands.h"

#include "exit_code.h"
#include "render/image.h"

#include <inttypes.h>
#include <stdio.h>

static int fail(const sn_error *err)
{
    (void)fprintf(stderr, "sinew: error: %s\n", err->msg);
    return cli_exit_code(err->code);
}

static int compare(const cli_options *o, const sn_image *a, const sn_image *b, sn_image *diff, sn_error *err)
{
    sn_image_diff d;
    if (a->width != b->width || a->height != b->height) {
        (void)printf("sizes: %" PRId32 "x%" PRId32 " and %" PRId32 "x%" PRId32 "\ndiffers\n", a->width,
                     a->height, b->width, b->height);
        if (o->diff) (void)fprintf(stderr, "sinew: %s is not written: the sizes differ\n", o->diff);
        return CLI_EXIT_DIFFERS;
    }
    if (sn_image_compare(a, b, o->max, o->count, &d, o->diff ? diff : NULL, err)) return fail(err);
    (void)printf("max: %" PRId32 "\ncount: %" PRId64 "\nrmse: %.6g\n%s\n", d.max, d.count, d.rmse,
                 d.equal ? "equal" : "differs");
    if (o->diff) {
        if (sn_image_save(diff, NULL, 0, o->diff, err)) return fail(err);
        if (!o->is_quiet) (void)fprintf(stderr, "wrote %s\n", o->diff);
    }
    return d.equal ? CLI_EXIT_OK : CLI_EXIT_DIFFERS;
}

int cli_compare(const cli_options *o)
{
    sn_image a, b, diff;
    sn_error err;
    int code;
    sn_image_init(&a);
    sn_image_init(&b);
    sn_image_init(&diff);
    if (sn_image_load(&a, o->operand.item[0], &err) || sn_image_load(&b, o->operand.item[1], &err))
        code = fail(&err);
    else
        code = compare(o, &a, &b, &diff, &err);
    sn_image_free(&a);
    sn_image_free(&b);
    sn_image_free(&diff);
    return code;
}
