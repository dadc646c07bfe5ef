/* fuzz_surface_io.c - damages small surface files at random and loads each. Run under the sanitizers.
 *   fuzz_surface_io [rounds] [seed]
 * Ends with 1 when a promise of sn_surface_load does not hold: a mesh that was accepted must be valid, and a
 * file that was refused must leave a message and an empty mesh. The file that did it stays in the folder that
 * is named. */
#define _DEFAULT_SOURCE /* mkdtemp */

#include "mesh/surface_io.h"

#include "base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROOM = 8192 };

typedef struct sample {
    const char *ext;
    unsigned char data[ROOM];
    size_t size;
} sample;

typedef struct chance {
    uint64_t state;
} chance;

static size_t below(chance *c, size_t n) /* 0 .. n - 1; 0 for n = 0 */
{
    c->state ^= c->state << 13;
    c->state ^= c->state >> 7;
    c->state ^= c->state << 17;
    return n ? (size_t)(c->state >> 16) % n : 0;
}

/* ---- Seeds ---- */

static const char *const text_seed[][2] = {
    {"obj", "# c\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.25 0 1\nvt 0 0\nvn 0 0 1\ng x y\nf 1/1/1 "
            "2//2 3/3 \\\n -2\n"
            "f 1 2 5 3 4\nf -1 -2 -3\nl 1 2\n"},
    {"off", "COFF # c\n5 3 0\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n1 1 0 1 0 0 1\n0 1 0 1 0 0 1\n.5 .25 0 1 1 1 "
            "1\n4 0 1 2 3\n"
            "3 0 1 2 255 0 0\n5 0 1 4 2 3\n"},
    {"ply",
     "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
     "double z\n"
     "property list uchar int t\nelement face 2\nproperty uchar red\nproperty list uchar int vertex_indices\n"
     "element e 1\nproperty int a\nend_header\n0 0 0 0\n1 0 0 1 7\n1 1 0 2 7 7\n0 1 0 0\n9 4 0 1 2 3\n9 3 0 "
     "1 2\n5\n"},
    {"stl",
     "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
     "facet normal nan nan nan\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 "
     "0\nendloop\nendfacet\nendsolid a\n"},
    {"vtp", "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\"><PolyData><Piece>\n<Points><DataArray "
            "type=\"Float32\" format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>\n<Polys>\n"
            "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3 0 2 3</DataArray>\n"
            "<DataArray type=\"Int32\" Name=\"offsets\" format=\"binary\">CAAAAAQAAAAHAAAA</DataArray>\n"
            "</Polys></Piece></PolyData></VTKFile>\n"},
};

static void add(sample *s, const void *data, size_t n)
{
    memcpy(s->data + s->size, data, n);
    s->size += n;
}

/* The low n bytes of v in the order that is wanted. */
static void add_int(sample *s, uint64_t v, size_t n, bool is_big)
{
    for (size_t k = 0; k < n; k++)
        s->data[s->size++] = (unsigned char)(v >> 8 * (is_big ? n - 1 - k : k) & 255);
}

static sample binary_ply(bool is_big)
{
    static const char head[] =
        " 1.0\nelement vertex 4\nproperty float x\nproperty short y\nproperty uchar z\nproperty list "
        "uchar short t\nelement face 2\nproperty list ushort uint vertex_index\nend_header\n";
    static const uint32_t x[4] = {0, 0x3F800000, 0x3F800000, 0xBF000000}; /* 0 1 1 -0.5 */
    sample s = {.ext = "ply"};
    add(&s, "ply\nformat binary_", 18);
    add(&s, is_big ? "big_endian" : "little_endian", is_big ? 10 : 13);
    add(&s, head, sizeof head - 1);
    for (unsigned i = 0; i < 4; i++) {
        add_int(&s, x[i], 4, is_big);
        add_int(&s, i / 2, 2, is_big);
        add_int(&s, 0, 1, is_big);
        add_int(&s, i, 1, is_big);
        for (unsigned k = 0; k < i; k++) add_int(&s, k, 2, is_big);
    }
    for (unsigned n = 3; n <= 4; n++) {
        add_int(&s, n, 2, is_big);
        for (unsigned k = 0; k < n; k++) add_int(&s, k, 4, is_big);
    }
    return s;
}

static sample binary_stl(void)
{
    sample s = {.ext = "stl", .size = 80};
    memcpy(s.data, "solid by an exporter", 20);
    add_int(&s, 3, 4, false);
    for (unsigned i = 0; i < 3; i++) {
        for (unsigned k = 0; k < 12; k++) add_int(&s, (k + i) % 4 == 3 ? 0x3F800000 : 0, 4, false);
        add_int(&s, 0, 2, false);
    }
    return s;
}

static sample make_seed(chance *c)
{
    size_t n = sizeof text_seed / sizeof *text_seed, i = below(c, n + 3);
    if (i == n) return binary_ply(false);
    if (i == n + 1) return binary_ply(true);
    if (i == n + 2) return binary_stl();
    sample s = {.ext = text_seed[i][0]};
    add(&s, text_seed[i][1], strlen(text_seed[i][1]));
    return s;
}

/* ---- Damage ---- */

/* Puts n bytes at `at` in the place of `cut` bytes. */
static void replace(sample *s, size_t at, size_t cut, const void *data, size_t n)
{
    if (cut > s->size - at) cut = s->size - at;
    if (s->size - cut + n > ROOM) return;
    memmove(s->data + at + n, s->data + at + cut, s->size - at - cut);
    memcpy(s->data + at, data, n);
    s->size = s->size - cut + n;
}

static void put_word(sample *s, chance *c)
{
    static const char *const words[] = {"-1",
                                        "0",
                                        "1",
                                        "4294967295",
                                        "2147483648",
                                        "99999999999999999999",
                                        "nan",
                                        "-inf",
                                        "1e999",
                                        "1e-999",
                                        "0x10",
                                        " ",
                                        "\n",
                                        "\r\n",
                                        "\\\n",
                                        "#",
                                        "/",
                                        "//",
                                        "-",
                                        ".",
                                        "e5",
                                        "255",
                                        "solid",
                                        "endsolid",
                                        "facet",
                                        "f",
                                        "v",
                                        "vertex",
                                        "end_header",
                                        "element face 3",
                                        "list",
                                        "OFF",
                                        "\t",
                                        "1e308",
                                        "f 1 2 3 4 5 4 3 2 1"};
    const char *w = words[below(c, sizeof words / sizeof *words)];
    replace(s, below(c, s->size + 1), below(c, 4), w, strlen(w));
}

static void copy_piece(sample *s, chance *c)
{
    unsigned char piece[256];
    size_t from = below(c, s->size), n = below(c, sizeof piece);
    if (n > s->size - from) n = s->size - from;
    memcpy(piece, s->data + from, n);
    replace(s, below(c, s->size + 1), below(c, 2) ? n : 0, piece, n);
}

static void damage(sample *s, chance *c)
{
    static const unsigned char odd[] = {0, 1, 127, 128, 255, '\n', ' ', '9'};
    size_t at = below(c, s->size);
    if (s->size == 0) return;
    switch (below(c, 6)) {
    case 0:
        s->data[at] ^= (unsigned char)(1u << below(c, 8));
        break;
    case 1:
        s->data[at] = odd[below(c, sizeof odd)];
        break;
    case 2:
        put_word(s, c);
        break;
    case 3:
        copy_piece(s, c);
        break;
    case 4:
        replace(s, at, 1 + below(c, 8), "", 0);
        break;
    default:
        if (below(c, 4) == 0)
            s->size = at;
        else
            s->data[at] = (unsigned char)below(c, 256);
    }
}

/* ---- Checks ---- */

static bool write_sample(const sample *s, const char *path)
{
    FILE *f = fopen(path, "wb");
    if (!f) return false;
    bool ok = fwrite(s->data, 1, s->size, f) == s->size;
    return fclose(f) == 0 && ok;
}

/* Returns what is wrong, or NULL. */
static const char *broken_promise(const char *path, int *n_accepted)
{
    sn_tri_mesh m;
    sn_error err = {SN_OK, ""}, why;
    const char *wrong = NULL;
    sn_tri_mesh_init(&m);
    sn_status st = sn_surface_load(&m, path, &err);
    if (!st && sn_tri_mesh_validate(&m, &why)) wrong = "an accepted mesh is not valid";
    if (st && (m.pos || m.face || m.n_vert || m.n_face)) wrong = "a refused file left a mesh";
    if (st && (err.code != st || strncmp(err.msg, path, strlen(path)) != 0))
        wrong = "a refusal without its message";
    if (st != SN_OK && st != SN_EFORMAT) wrong = "a status that is not of the file's contents";
    for (const char *c = err.msg; *c; c++)
        if ((unsigned char)*c < 32) wrong = "a control character in the message";
    *n_accepted += !st;
    sn_tri_mesh_free(&m);
    return wrong;
}

int main(int argc, char **argv)
{
    long n_round = argc > 1 ? strtol(argv[1], NULL, 10) : 2000;
    chance c = {argc > 2 ? strtoull(argv[2], NULL, 10) * 2 + 1 : 0x9E3779B97F4A7C15u};
    char folder[] = "/tmp/sn_fuzz_surface_XXXXXX", path[64];
    int n_accepted = 0;
    if (!mkdtemp(folder)) return 2;
    for (long i = 0; i < n_round; i++) {
        sample s = make_seed(&c);
        for (size_t k = below(&c, 6); k > 0; k--)
            damage(&s, &c); /* sometimes none: seeds must stay readable */
        (void)snprintf(path, sizeof path, "%s/f.%s", folder, s.ext);
        if (!write_sample(&s, path)) return 2;
        const char *wrong = broken_promise(path, &n_accepted);
        if (wrong) {
            (void)fprintf(stderr, "round %ld: %s: %s\n", i, path, wrong);
            return 1;
        }
        (void)remove(path);
    }
    (void)rmdir(folder);
    (void)printf("%ld files, %d accepted\n", n_round, n_accepted);
    return 0;
}
