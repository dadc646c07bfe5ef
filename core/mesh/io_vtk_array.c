/* io_vtk_array.c - the arrays of VTK XML files, read: base64, raw bytes or text, as doubles. */
#include "mesh/io_private.h"

#include "base/alloc.h"

#include <string.h>

static sn_status no_memory(const sn_scan *s, sn_error *err)
{
    return sn_fail(err, SN_ENOMEM, "%s: no memory to read it", s->path);
}

/* ---- numbers ---- */

#define DEFINE_CONVERT(name, T)                                                                              \
    static void name(const unsigned char *raw, size_t n, double *out)                                        \
    {                                                                                                        \
        for (size_t i = 0; i < n; i++) {                                                                     \
            T x;                                                                                             \
            memcpy(&x, raw + i * sizeof x, sizeof x);                                                        \
            out[i] = (double)x;                                                                              \
        }                                                                                                    \
    }
DEFINE_CONVERT(convert_f64, double)
DEFINE_CONVERT(convert_f32, float)
DEFINE_CONVERT(convert_i64, int64_t)
DEFINE_CONVERT(convert_i32, int32_t)
DEFINE_CONVERT(convert_u8, uint8_t)

/* n numbers of that type. The usual ones of this machine's byte order at the speed of memory. */
static void convert(const unsigned char *raw, size_t n, sn_number_type type, bool is_big, double *out)
{
    static void (*const fast[SN_NO_NUMBER])(const unsigned char *, size_t,
                                            double *) = {[SN_F64] = convert_f64,
                                                         [SN_F32] = convert_f32,
                                                         [SN_I64] = convert_i64,
                                                         [SN_I32] = convert_i32,
                                                         [SN_U8] = convert_u8};
    if (fast[type] && is_big == sn_host_is_big()) {
        fast[type](raw, n, out);
        return;
    }
    for (size_t i = 0; i < n; i++) out[i] = sn_number_decode(raw + i * sn_number_size(type), type, is_big);
}

static sn_status take_numbers(const sn_vtk_layout *f, const unsigned char *raw, size_t size,
                              sn_number_type type, sn_vtk_values *out, sn_error *err)
{
    out->n = size / sn_number_size(type);
    out->v = SN_NEW(double, out->n);
    if (!out->v) return no_memory(f->s, err);
    convert(raw, out->n, type, f->is_big, out->v);
    return SN_OK;
}

static size_t header_size(const sn_vtk_layout *f)
{
    return f->has_long_header ? 8 : 4;
}

static double promised_size(const sn_vtk_layout *f, const unsigned char *header)
{
    return sn_number_decode(header, f->has_long_header ? SN_U64 : SN_U32, f->is_big);
}

static sn_status damaged(const sn_vtk_layout *f, double said, size_t found, sn_error *err)
{
    return sn_scan_fail(f->s, err, "the array is damaged: it promises %.0f bytes and has %zu", said, found);
}

/* ---- base64 ---- */

enum { BLANK = 64, PADDING = 65, FOREIGN = 66 };

/* The value of each character as a digit, or one of the above. */
static void fill_digits(unsigned char of[256])
{
    memset(of, FOREIGN, 256);
    for (int i = 0; i < 26; i++) of['A' + i] = (unsigned char)i;
    for (int i = 0; i < 26; i++) of['a' + i] = (unsigned char)(26 + i);
    for (int i = 0; i < 10; i++) of['0' + i] = (unsigned char)(52 + i);
    of['+'] = 62;
    of['/'] = 63;
    of['='] = PADDING;
    of[' '] = of['\n'] = of['\r'] = of['\t'] = BLANK;
}

/* Decodes up to `most` bytes. Padding inside the text is fine: some writers encode the header and the data
 * one after the other. Returns the number of bytes; stops at what is no base64. */
static size_t decode_base64(const char *text, const char *end, unsigned char *out, size_t most)
{
    unsigned char digit[256];
    fill_digits(digit);
    const unsigned char *p = (const unsigned char *)text, *stop = (const unsigned char *)end;
    size_t n = 0;
    uint32_t bits = 0;
    int n_bits = 0;
    while (p < stop && n < most) {
        while (n_bits == 0 && stop - p >= 4 && most - n >= 3) { /* whole groups */
            unsigned a = digit[p[0]], b = digit[p[1]], c = digit[p[2]], d = digit[p[3]];
            if ((a | b | c | d) >= BLANK) break;
            uint32_t group = a << 18 | b << 12 | c << 6 | d;
            out[n] = (unsigned char)(group >> 16);
            out[n + 1] = (unsigned char)(group >> 8);
            out[n + 2] = (unsigned char)group;
            n += 3;
            p += 4;
        }
        if (p >= stop || n >= most) break;
        unsigned d = digit[*p++];
        if (d == FOREIGN) break;
        if (d == PADDING) n_bits = 0; /* the rest of the group is padding */
        if (d >= BLANK) continue;
        bits = bits << 6 | d;
        n_bits += 6;
        if (n_bits >= 8) out[n++] = (unsigned char)(bits >> (n_bits -= 8) & 0xFF);
    }
    return n;
}

sn_status sn_vtk_read_base64(const sn_vtk_layout *f, const char *text, const char *end, bool is_whole,
                             sn_number_type type, sn_vtk_values *out, sn_error *err)
{
    unsigned char header[8];
    size_t head = header_size(f), n = decode_base64(text, end, header, head),
           most = (size_t)(end - text) / 4 * 3 + 3;
    if (n < head) return damaged(f, 0.0, 0, err);
    double said = promised_size(f, header);
    size_t size = !is_whole && said < (double)most ? head + (size_t)said : most; /* else all that there is */
    unsigned char *raw = SN_NEW(unsigned char, size);
    if (!raw) return no_memory(f->s, err);
    n = decode_base64(text, end, raw, size);
    sn_status st = said == (double)(n - head) ? take_numbers(f, raw + head, n - head, type, out, err)
                                              : damaged(f, said, n - head, err);
    sn_release(raw);
    return st;
}

sn_status sn_vtk_read_raw(const sn_vtk_layout *f, const char *data, const char *end, sn_number_type type,
                          sn_vtk_values *out, sn_error *err)
{
    size_t head = header_size(f), left = (size_t)(end - data);
    if (left < head) return damaged(f, 0.0, 0, err);
    double said = promised_size(f, (const unsigned char *)data);
    if (said > (double)(left - head)) return damaged(f, said, left - head, err);
    return take_numbers(f, (const unsigned char *)data + head, (size_t)said, type, out, err);
}

sn_status sn_vtk_read_text(const sn_vtk_layout *f, const char *end, sn_vtk_values *out, sn_error *err)
{
    sn_scan text = *f->s;
    text.end = end;
    size_t cap = 0;
    while (sn_scan_more(&text)) {
        if (!sn_grow(&out->v, &cap, out->n + 1, sizeof *out->v)) return no_memory(f->s, err);
        sn_status st = sn_scan_number(&text, &out->v[out->n], "a number", err);
        if (st) return st;
        out->n++;
    }
    return SN_OK;
}
