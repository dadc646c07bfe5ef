#include "options.h"

#include "base/alloc.h"
#include "base/file.h"
#include "scene/scene.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

const char cli_help_text[] =
    "usage: sinew [options] script.lua [args]   run a script (- for standard input)\n"
    "       sinew [options]                     read lines and run them, when standard input is a terminal\n"
    "       sinew info FILE...                  what is right and wrong with meshes\n"
    "       sinew compare A.png B.png [--diff D.png] [--max N] [--count N]\n"
    "\n"
    "options of a run, before the script:\n"
    "  -D name=value     set a global variable; wins over the script's own default\n"
    "  -e CODE           run CODE before the script\n"
    "  -i                read lines after the script\n"
    "  -o FILE           write the newest scene at the end: a picture to .png, the muscles\n"
    "                    to .vtu, .mesh, .msh or a folder\n"
    "  --threads N       use N threads (one per core)\n"
    "  --renderer NAME   draw with osmesa (in software), egl (a GPU, or EGL's software) or auto:\n"
    "                    egl where it gives a GPU, else osmesa (auto). -v says what was found\n"
    "  --time-limit S    stop after S seconds\n"
    "  --strict          fail when there was a warning\n"
    "  --json FILE       write a report of the run\n"
    "  -q                no warnings, no progress\n"
    "  -v                versions, timings, tracebacks\n"
    "  --version, --help\n"
    "-D, -e and -o may be given several times. info takes --threads, --time-limit, -q and -v as well.\n"
    "\n"
    "compare:\n"
    "  --diff D.png      write a picture of the differences\n"
    "  --max N           differences up to N in a channel do not count (0)\n"
    "  --count N         up to N pixels may differ by more (0)\n"
    "\n"
    "exit code: 0 all went well, 1 script error, 2 usage, 3 input file, 4 meshing, 5 solver, 6 rendering,\n"
    "           7 pictures differ, 8 a limit was reached, 130 interrupted\n";

enum option_id {
    OPT_DEFINE,
    OPT_CODE,
    OPT_REPL,
    OPT_OUTPUT,
    OPT_THREADS,
    OPT_RENDERER,
    OPT_TIME_LIMIT,
    OPT_STRICT,
    OPT_JSON,
    OPT_QUIET,
    OPT_VERBOSE,
    OPT_VERSION,
    OPT_HELP,
    OPT_DIFF,
    OPT_MAX,
    OPT_COUNT,
    N_OPTION
};

#define FOR_RUN (1u << CLI_RUN)
#define FOR_INFO (1u << CLI_INFO)
#define FOR_COMPARE (1u << CLI_COMPARE)
#define FOR_ALL (FOR_RUN | FOR_INFO | FOR_COMPARE)

typedef struct option {
    const char *name;
    bool has_value;
    unsigned modes;
} option;

static const option known[N_OPTION] = {
    [OPT_DEFINE] = {"-D", true, FOR_RUN},
    [OPT_CODE] = {"-e", true, FOR_RUN},
    [OPT_REPL] = {"-i", false, FOR_RUN},
    [OPT_OUTPUT] = {"-o", true, FOR_RUN},
    [OPT_THREADS] = {"--threads", true, FOR_RUN | FOR_INFO},
    [OPT_RENDERER] = {"--renderer", true, FOR_RUN},
    [OPT_TIME_LIMIT] = {"--time-limit", true, FOR_RUN | FOR_INFO},
    [OPT_STRICT] = {"--strict", false, FOR_RUN},
    [OPT_JSON] = {"--json", true, FOR_RUN},
    [OPT_QUIET] = {"-q", false, FOR_ALL},
    [OPT_VERBOSE] = {"-v", false, FOR_ALL},
    [OPT_VERSION] = {"--version", false, FOR_ALL},
    [OPT_HELP] = {"--help", false, FOR_ALL},
    [OPT_DIFF] = {"--diff", true, FOR_COMPARE},
    [OPT_MAX] = {"--max", true, FOR_COMPARE},
    [OPT_COUNT] = {"--count", true, FOR_COMPARE},
};

static const char *mode_name(cli_mode mode)
{
    return mode == CLI_INFO ? "info" : mode == CLI_COMPARE ? "compare" : "a script";
}

static sn_status parse_number(const char *name, const char *text, double *v, sn_error *err)
{
    const char *end = text;
    *v = sn_parse_double(text, &end);
    if (end == text || *end != '\0' || !isfinite(*v))
        return sn_fail(err, SN_EINVAL, "option '%s' needs a number, found '%s'", name, text);
    return SN_OK;
}

static sn_status parse_whole(const char *name, const char *text, double low, double high, double *v,
                             sn_error *err)
{
    sn_status st = parse_number(name, text, v, err);
    if (st) return st;
    if (!(*v >= low && *v <= high && floor(*v) == *v))
        return sn_fail(err, SN_EINVAL, "option '%s' needs a whole number from %.0f to %.0f, found '%s'", name,
                       low, high, text);
    return SN_OK;
}

static bool is_lua_name(const char *s, size_t n)
{
    static const char *const reserved[] = {
        "and", "break", "do",  "else", "elseif", "end",    "false",  "for",  "function", "goto",  "if",
        "in",  "local", "nil", "not",  "or",     "repeat", "return", "then", "true",     "until", "while"};
    if (n == 0 || isdigit((unsigned char)s[0])) return false;
    for (size_t i = 0; i < n; i++)
        if (!isalnum((unsigned char)s[i]) && s[i] != '_') return false;
    for (size_t i = 0; i < sizeof reserved / sizeof reserved[0]; i++)
        if (strlen(reserved[i]) == n && memcmp(reserved[i], s, n) == 0) return false;
    return true;
}

static sn_status add_define(cli_options *o, const char *value, sn_error *err)
{
    const char *eq = strchr(value, '=');
    if (!eq) return sn_fail(err, SN_EINVAL, "option '-D' needs name=value, found '%s'", value);
    if (!is_lua_name(value, (size_t)(eq - value)))
        return sn_fail(err, SN_EINVAL, "option '-D': '%.*s' cannot be the name of a variable",
                       (int)(eq - value), value);
    o->define.item[o->define.n++] = value;
    return SN_OK;
}

cli_output cli_output_kind(const char *path)
{
    char ext[16];
    sn_file_extension(path, ext);
    if (strcmp(ext, "png") == 0) return CLI_OUTPUT_PICTURE;
    if (strcmp(ext, "vtu") == 0 || strcmp(ext, "mesh") == 0 || strcmp(ext, "msh") == 0)
        return CLI_OUTPUT_MESH;
    /* An extension too long for sn_file_extension is not the lack of one. */
    const char *slash = strrchr(path, '/');
    return *path && !ext[0] && !strchr(slash ? slash : path, '.') ? CLI_OUTPUT_MESH : CLI_OUTPUT_UNKNOWN;
}

static sn_status add_output(cli_options *o, const char *value, sn_error *err)
{
    if (cli_output_kind(value) == CLI_OUTPUT_UNKNOWN)
        return sn_fail(
            err, SN_EINVAL,
            "option '-o': unknown extension of '%s' (known: .png, .vtu, .mesh, .msh, and none for a folder)",
            value);
    o->output.item[o->output.n++] = value;
    return SN_OK;
}

static sn_status set_diff(cli_options *o, const char *value, sn_error *err)
{
    char ext[16];
    sn_file_extension(value, ext);
    if (strcmp(ext, "png") != 0)
        return sn_fail(err, SN_EINVAL, "option '--diff' needs a .png file, found '%s'", value);
    o->diff = value;
    return SN_OK;
}

static sn_status set_number(cli_options *o, enum option_id id, const char *value, sn_error *err)
{
    static const double low[N_OPTION] = {[OPT_THREADS] = 1.0};
    static const double high[N_OPTION] = {[OPT_THREADS] = 1024.0, [OPT_MAX] = 255.0, [OPT_COUNT] = 1e15};
    double v;
    sn_status st = parse_whole(known[id].name, value, low[id], high[id], &v, err);
    if (st) return st;
    if (id == OPT_THREADS) o->threads = (int)v;
    if (id == OPT_MAX) o->max = (int32_t)v;
    if (id == OPT_COUNT) o->count = (int64_t)v;
    return SN_OK;
}

static sn_status set_time_limit(cli_options *o, const char *value, sn_error *err)
{
    sn_status st = parse_number("--time-limit", value, &o->time_limit, err);
    if (!st && !(o->time_limit > 0.0))
        return sn_fail(err, SN_EINVAL, "option '--time-limit' needs more than 0 seconds, found '%s'", value);
    return st;
}

static sn_status set_renderer(cli_options *o, const char *value, sn_error *err)
{
    for (int i = 0; i < SN_RENDERER_COUNT; i++) {
        o->renderer = (sn_renderer)i;
        if (strcmp(sn_renderer_name(o->renderer), value) == 0) return SN_OK;
    }
    return sn_fail(err, SN_EINVAL, "option '--renderer' needs auto, osmesa or egl, found '%s'", value);
}

static sn_status apply(cli_options *o, enum option_id id, const char *value, sn_error *err)
{
    switch (id) {
    case OPT_DEFINE:
        return add_define(o, value, err);
    case OPT_CODE:
        o->code.item[o->code.n++] = value;
        break;
    case OPT_REPL:
        o->has_repl = true;
        break;
    case OPT_OUTPUT:
        return add_output(o, value, err);
    case OPT_TIME_LIMIT:
        return set_time_limit(o, value, err);
    case OPT_RENDERER:
        return set_renderer(o, value, err);
    case OPT_THREADS:
    case OPT_MAX:
    case OPT_COUNT:
        return set_number(o, id, value, err);
    case OPT_STRICT:
        o->is_strict = true;
        break;
    case OPT_JSON:
        o->json = value;
        break;
    case OPT_QUIET:
        o->is_quiet = true;
        break;
    case OPT_VERBOSE:
        o->is_verbose = true;
        break;
    case OPT_DIFF:
        return set_diff(o, value, err);
    case OPT_VERSION:
        o->mode = CLI_VERSION;
        break;
    case OPT_HELP:
        o->mode = CLI_HELP;
        break;
    case N_OPTION:
        break;
    }
    return SN_OK;
}

/* Is arg this option: "-o", "-oFILE", "--json", "--json=FILE". *attached: the value in arg itself, or NULL.
 */
static bool matches(const option *opt, const char *arg, const char **attached)
{
    size_t n = strlen(opt->name);
    *attached = NULL;
    if (strncmp(arg, opt->name, n) != 0) return false;
    if (arg[n] == '\0') return true;
    bool is_long = opt->name[1] == '-';
    if (is_long ? arg[n] != '=' : !opt->has_value) return false;
    *attached = arg + n + (is_long ? 1 : 0);
    return true;
}

static sn_status unknown_option(const char *arg, sn_error *err)
{
    const char *name[N_OPTION];
    for (int i = 0; i < N_OPTION; i++) name[i] = known[i].name;
    const char *near = sn_nearest_name(arg, name, N_OPTION);
    if (near) return sn_fail(err, SN_EINVAL, "unknown option '%s' (did you mean '%s'?)", arg, near);
    return sn_fail(err, SN_EINVAL, "unknown option '%s' (sinew --help lists the known ones)", arg);
}

/* Takes argv[*i] and, when the option's value stands apart, argv[*i + 1]. given: bits of the options met so
 * far. */
static sn_status take_option(cli_options *o, int *i, unsigned *given, sn_error *err)
{
    const char *arg = o->argv[*i], *value = NULL;
    int id = 0;
    while (id < N_OPTION && !matches(&known[id], arg, &value)) id++;
    if (id == N_OPTION) return unknown_option(arg, err);
    if (!known[id].has_value && value)
        return sn_fail(err, SN_EINVAL, "option '%s' takes no value", known[id].name);
    if (known[id].has_value && !value) {
        if (*i + 1 >= o->argc) return sn_fail(err, SN_EINVAL, "option '%s' needs a value", arg);
        value = o->argv[++*i];
    }
    *given |= 1u << id;
    return apply(o, (enum option_id)id, value, err);
}

/* After the command's name options and files may stand in any order. */
static sn_status parse_command(cli_options *o, int i, unsigned *given, sn_error *err)
{
    bool options_end = false;
    for (; i < o->argc; i++) {
        const char *arg = o->argv[i];
        if (!options_end && strcmp(arg, "--") == 0) {
            options_end = true;
        } else if (!options_end && arg[0] == '-' && arg[1]) {
            cli_mode mode = o->mode;
            sn_status st = take_option(o, &i, given, err);
            if (st || o->mode != mode) return st;
        } else {
            o->operand.item[o->operand.n++] = arg;
        }
    }
    if (o->mode == CLI_INFO && o->operand.n == 0)
        return sn_fail(err, SN_EINVAL, "info: need at least one file");
    if (o->mode == CLI_COMPARE && o->operand.n != 2)
        return sn_fail(err, SN_EINVAL, "compare: need two pictures, found %d", o->operand.n);
    return SN_OK;
}

static sn_status check_modes(const cli_options *o, unsigned given, sn_error *err)
{
    for (int id = 0; id < N_OPTION; id++)
        if (given & 1u << id && !(known[id].modes & 1u << o->mode))
            return sn_fail(err, SN_EINVAL, "option '%s' does not go with %s", known[id].name,
                           mode_name(o->mode));
    return SN_OK;
}

static sn_status make_lists(cli_options *o, sn_error *err)
{
    cli_list *list[] = {&o->define, &o->code, &o->output, &o->operand};
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++) {
        list[i]->item = SN_NEW(const char *, o->argc + 1);
        if (!list[i]->item) return sn_fail(err, SN_ENOMEM, "no memory for the command line");
    }
    return SN_OK;
}

sn_status cli_options_parse(cli_options *o, int argc, char **argv, sn_error *err)
{
    *o = (cli_options){.mode = CLI_RUN, .argc = argc, .argv = argv};
    sn_status st = make_lists(o, err);
    unsigned given = 0;
    int i = 1;
    bool options_end = false; /* what follows "--" is a script, whatever its name */
    for (; !st && !options_end && i < argc && argv[i][0] == '-' && argv[i][1]; i++) {
        options_end = strcmp(argv[i], "--") == 0;
        if (!options_end) st = take_option(o, &i, &given, err);
        if (!st && o->mode != CLI_RUN) return SN_OK; /* help and version ask for nothing else */
    }
    if (st) return st;
    if (!options_end && i < argc && strcmp(argv[i], "info") == 0) o->mode = CLI_INFO;
    if (!options_end && i < argc && strcmp(argv[i], "compare") == 0) o->mode = CLI_COMPARE;
    if (o->mode == CLI_RUN) {
        if (i < argc) o->i_script = i;
    } else {
        cli_mode mode = o->mode;
        st = parse_command(o, i + 1, &given, err);
        if (st || o->mode != mode) return st;
    }
    return check_modes(o, given, err);
}

void cli_options_free(cli_options *o)
{
    sn_release(o->define.item);
    sn_release(o->code.item);
    sn_release(o->output.item);
    sn_release(o->operand.item);
    *o = (cli_options){.mode = CLI_RUN};
}
