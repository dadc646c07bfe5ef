/* embed_main.c - writes the bone library's files as C source: run by the build, on the machine that builds.
 *
 *     sinew-embed OUT.c DIR NAME...      DIR/NAME.txt and DIR/NAME.obj of each */
#include <stdio.h>
#include <string.h>

/* A text as string literals, a line each. */
static int put_file(FILE *out, const char *dir, const char *name, const char *extension)
{
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/%s.%s", dir, name, extension);
    FILE *in = fopen(path, "rb");
    if (!in) {
        (void)fprintf(stderr, "sinew-embed: cannot read %s\n", path);
        return 0;
    }
    (void)fputs("    \"", out);
    for (int c = fgetc(in); c != EOF; c = fgetc(in)) {
        if (c == '\n')
            (void)fputs("\\n\"\n    \"", out);
        else if (c == '"' || c == '\\')
            (void)fprintf(out, "\\%c", c);
        else if (c >= 32 && c < 127)
            (void)fputc(c, out);
    }
    (void)fputs("\"", out);
    return fclose(in) == 0;
}

static int put_asset(FILE *out, const char *dir, const char *name)
{
    (void)fprintf(out, "{\"%s\",\n", name);
    int is_ok = put_file(out, dir, name, "txt");
    (void)fputs(",\n", out);
    is_ok = is_ok && put_file(out, dir, name, "obj");
    (void)fputs("},\n", out);
    return is_ok;
}

int main(int argc, char **argv)
{
    FILE *out = argc > 2 ? fopen(argv[1], "wb") : NULL;
    if (!out) {
        (void)fprintf(stderr, "usage: sinew-embed OUT.c DIR NAME...\n");
        return 2;
    }
    int is_ok = 1;
    (void)fputs("#include \"skeleton/bone_library.h\"\n\nconst sn_bone_asset sn_bone_assets[] = {\n", out);
    for (int i = 3; i < argc && is_ok; i++) is_ok = put_asset(out, argv[2], argv[i]);
    (void)fputs("{0, 0, 0}};\n", out);
    return fclose(out) == 0 && is_ok ? 0 : 1;
}
