/* image_png.c - PNG files by libpng.
 *
 * libpng reports errors by longjmp. Each direction therefore has one function that calls setjmp and touches
 * no local afterwards but through pointers to a struct that outlives it, so nothing can be left in a
 * clobbered register. */
#include "render/image.h"

#include "base/alloc.h"
#include "base/file.h"

#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

typedef struct codec { /* what one direction needs across a longjmp */
    png_structp png;
    png_infop info;
    png_bytepp row;   /* pointers into the pixels */
    const char *data; /* reading: the file        */
    size_t size, at;
    sn_out *out;   /* writing                  */
    char msg[160]; /* libpng's words           */
} codec;

static void on_error(png_structp png, png_const_charp msg)
{
    codec *c = png_get_error_ptr(png);
    (void)snprintf(c->msg, sizeof c->msg, "%s", msg);
    png_longjmp(png, 1);
}

/* Warnings are about ancillary data that is not used. */
static void on_warning(png_structp png, png_const_charp msg)
{
    (void)png;
    (void)msg;
}

static png_voidp png_get_memory(png_structp png, png_alloc_size_t size)
{
    (void)png;
    return sn_alloc(size, 1);
}

static void png_drop_memory(png_structp png, png_voidp p)
{
    (void)png;
    sn_release(p);
}

static void read_bytes(png_structp png, png_bytep to, size_t n)
{
    codec *c = png_get_io_ptr(png);
    if (n > c->size - c->at) png_error(png, "the file is cut short");
    memcpy(to, c->data + c->at, n);
    c->at += n;
}

static void write_bytes(png_structp png, png_bytep from, size_t n)
{
    codec *c = png_get_io_ptr(png);
    sn_out_bytes(c->out, from, n);
}

static void flush_bytes(png_structp png)
{
    (void)png;
}

static sn_status rows_of(codec *c, const sn_image *m, sn_error *err)
{
    c->row = SN_NEW(png_bytep, m->height);
    if (!c->row) return sn_fail(err, SN_ENOMEM, "no memory for %d rows", m->height);
    for (int32_t y = 0; y < m->height; y++) c->row[y] = m->rgba + 4 * (size_t)y * (size_t)m->width;
    return SN_OK;
}

/* Every kind of pixel to 8-bit RGBA. */
static void ask_for_rgba8(codec *c)
{
    png_set_scale_16(c->png);
    png_set_expand(c->png); /* palette, short greys, tRNS */
    png_set_gray_to_rgb(c->png);
    png_set_add_alpha(c->png, 255, PNG_FILLER_AFTER);
    (void)png_set_interlace_handling(c->png);
    png_read_update_info(c->png, c->info);
}

static sn_status decode(codec *c, sn_image *out, sn_error *err)
{
    if (setjmp(png_jmpbuf(c->png))) return sn_fail(err, SN_EFORMAT, "damaged PNG: %s", c->msg);
    /* Our own limit gives the better message, so libpng's is raised to what the format allows. */
    png_set_user_limits(c->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_read_fn(c->png, c, read_bytes);
    png_read_info(c->png, c->info);
    png_uint_32 w = png_get_image_width(c->png, c->info), h = png_get_image_height(c->png, c->info);
    if (w > SN_IMAGE_MAX_SIDE || h > SN_IMAGE_MAX_SIDE)
        return sn_fail(err, SN_ELIMIT, "picture of %lu x %lu pixels, at most %d per side are read",
                       (unsigned long)w, (unsigned long)h, SN_IMAGE_MAX_SIDE);
    ask_for_rgba8(c);
    sn_status st = sn_image_reserve(out, (int32_t)w, (int32_t)h, err);
    if (!st) st = rows_of(c, out, err);
    if (st) return st;
    png_read_image(c->png, c->row);
    png_read_end(c->png, NULL);
    return SN_OK;
}

sn_status sn_image_load(sn_image *out, const char *path, sn_error *err)
{
    codec c = {0};
    char *data = NULL;
    sn_image_free(out);
    sn_status st = sn_file_read(path, &data, &c.size, err);
    if (st) return st;
    c.data = data;
    if (c.size < 8 || png_sig_cmp((png_const_bytep)data, 0, 8) != 0) {
        st = sn_fail(err, SN_EFORMAT, "not a PNG file");
        goto done;
    }
    c.png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &c, on_error, on_warning, NULL, png_get_memory,
                                     png_drop_memory);
    c.info = c.png ? png_create_info_struct(c.png) : NULL;
    st = c.info ? decode(&c, out, err) : sn_fail(err, SN_ENOMEM, "no memory to read a PNG");
done:
    if (c.png) png_destroy_read_struct(&c.png, &c.info, NULL);
    sn_release(c.row);
    sn_release(data);
    if (st) {
        sn_image_free(out);
        return sn_fail_prefix(err, st, "%s: ", path);
    }
    return SN_OK;
}

/* The PNG rules for a key: 1..79 printable Latin-1 characters, no space at either end or twice in a row. */
static bool is_good_key(const char *key)
{
    size_t n = strlen(key);
    if (n < 1 || n > 79 || key[0] == ' ' || key[n - 1] == ' ') return false;
    for (size_t i = 0; i < n; i++) {
        unsigned char ch = (unsigned char)key[i];
        if (ch < 32 || (ch > 126 && ch < 161) || (ch == ' ' && key[i + 1] == ' ')) return false;
    }
    return true;
}

static sn_status encode(codec *c, const sn_image *m, png_text *chunk, int n_chunk, sn_error *err)
{
    if (setjmp(png_jmpbuf(c->png))) return sn_fail(err, SN_EIO, "cannot write the PNG: %s", c->msg);
    png_set_user_limits(c->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_write_fn(c->png, c, write_bytes, flush_bytes);
    png_set_IHDR(c->png, c->info, (png_uint_32)m->width, (png_uint_32)m->height, 8, PNG_COLOR_TYPE_RGB_ALPHA,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(c->png, c->info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (n_chunk > 0) png_set_text(c->png, c->info, chunk, n_chunk);
    png_write_info(c->png, c->info);
    png_write_image(c->png, c->row);
    png_write_end(c->png, c->info);
    return SN_OK;
}

static sn_status chunks_of(const sn_image_text *text, int n_text, png_text **out, sn_error *err)
{
    *out = SN_NEW_ZERO(png_text, n_text);
    if (!*out) return sn_fail(err, SN_ENOMEM, "no memory for %d texts", n_text);
    for (int i = 0; i < n_text; i++) {
        if (!is_good_key(text[i].key))
            return sn_fail(err, SN_EINVAL, "text key '%.100s' is not 1..79 plain Latin-1 characters",
                           text[i].key);
        (*out)[i].compression = PNG_TEXT_COMPRESSION_NONE;
        (*out)[i].key = (char *)text[i].key; /* libpng's type is not const, but it only reads */
        (*out)[i].text = (char *)text[i].text;
        (*out)[i].text_length = strlen(text[i].text);
    }
    return SN_OK;
}

static sn_status check_target(const sn_image *m, const char *path, sn_error *err)
{
    char ext[16];
    sn_file_extension(path, ext);
    if (strcmp(ext, "png") != 0)
        return sn_fail(err, SN_EINVAL, "pictures are written as .png, found '.%s'", ext);
    if (!m->rgba) return sn_fail(err, SN_EINVAL, "the picture has no pixels");
    return SN_OK;
}

sn_status sn_image_save(const sn_image *m, const sn_image_text *text, int n_text, const char *path,
                        sn_error *err)
{
    codec c = {0};
    png_text *chunk = NULL;
    sn_status st = check_target(m, path, err);
    if (!st) st = chunks_of(text, n_text, &chunk, err);
    if (!st) st = rows_of(&c, m, err);
    if (st) {
        (void)sn_fail_prefix(err, st, "%s: ", path);
        goto done;
    }
    st = sn_out_open(&c.out, path, err);
    if (st) goto done;
    c.png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &c, on_error, on_warning, NULL, png_get_memory,
                                      png_drop_memory);
    c.info = c.png ? png_create_info_struct(c.png) : NULL;
    st = c.info ? encode(&c, m, chunk, n_text, err) : sn_fail(err, SN_ENOMEM, "no memory to write a PNG");
    if (st) {
        sn_out_abort(c.out);
        (void)sn_fail_prefix(err, st, "%s: ", path);
    } else {
        st = sn_out_commit(c.out, err);
    }
done:
    if (c.png) png_destroy_write_struct(&c.png, &c.info);
    sn_release(c.row);
    sn_release(chunk);
    return st;
}
