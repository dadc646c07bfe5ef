#define _GNU_SOURCE
#include "report.h"

#include "bind/lsn.h"
#include "json.h"

#include <sys/resource.h>

static double peak(int who)
{
    struct rusage use;
    return getrusage(who, &use) == 0 ? 1024.0 * (double)use.ru_maxrss : 0.0;
}

double cli_peak_memory(void)
{
    return peak(RUSAGE_SELF);
}

double cli_peak_memory_of_children(void)
{
    return peak(RUSAGE_CHILDREN);
}

static void write_failure(cli_json *j, const cli_failure *f)
{
    if (!f->exit_code) {
        cli_json_null(j, "error");
        return;
    }
    cli_json_begin(j, "error", '{');
    cli_json_string(j, "message", f->text);
    cli_json_int(j, "code", f->exit_code);
    cli_json_string(j, "file", f->file);
    if (f->line > 0)
        cli_json_int(j, "line", f->line);
    else
        cli_json_null(j, "line");
    cli_json_string(j, "traceback", f->traceback);
    cli_json_end(j, '}');
}

static void write_strings(cli_json *j, const char *key, const char *const *item, size_t n)
{
    cli_json_begin(j, key, '[');
    for (size_t i = 0; i < n; i++) cli_json_string(j, NULL, item[i]);
    cli_json_end(j, ']');
}

static int call_report(lua_State *L)
{
    lua_getfield(L, 1, "report");
    lua_pushvalue(L, 1);
    lua_call(L, 1, 1);
    return 1;
}

/* The scene's own report. It extracts: only when the fields are there, so that no long step starts here, and
 * not after a failure. */
static void write_scene(cli_json *j, const cli_session *s, lua_State *L)
{
    lsn_push_last_scene(L);
    if (!lua_isnil(L, -1) && !s->failure.exit_code && sn_scene_fields(lsn_check_scene(L, -1))) {
        lua_pushcfunction(L, call_report);
        lua_pushvalue(L, -2);
        if (lua_pcall(L, 1, 1, 0) == LUA_OK && lua_istable(L, -1))
            cli_json_value(j, "scene", L, -1);
        else
            cli_json_null(j, "scene");
        lua_pop(L, 1);
    } else {
        cli_json_null(j, "scene");
    }
    lua_pop(L, 1);
}

typedef struct report {
    const cli_session *session;
    sn_out *out;
    int exit_code;
} report;

static int write_report(lua_State *L)
{
    const report *r = lua_touserdata(L, 1);
    const cli_session *s = r->session;
    const cli_options *o = s->opt;
    cli_json j;
    cli_json_init(&j, r->out);
    cli_json_begin(&j, NULL, '{');
    cli_json_string(&j, "version", SN_VERSION);
    cli_json_string(&j, "lua", LUA_RELEASE);
    cli_json_string(&j, "script", o->i_script ? o->argv[o->i_script] : NULL);
    cli_json_int(&j, "exit_code", r->exit_code);
    cli_json_int(&j, "threads", sn_run_threads(&lsn_get_state(L)->run));
    write_failure(&j, &s->failure);
    write_strings(&j, "files", o->output.item, (size_t)s->n_written);
    write_strings(&j, "warnings", (const char *const *)s->warnings.line, s->warnings.n_line);
    write_scene(&j, s, L);
    cli_json_begin(&j, "seconds", '{');
    cli_json_double(&j, "script", s->script_seconds);
    cli_json_double(&j, "output", s->output_seconds);
    cli_json_double(&j, "total", sn_clock() - s->start);
    cli_json_end(&j, '}');
    cli_json_int(&j, "peak_memory", (int64_t)cli_peak_memory());
    cli_json_int(&j, "peak_memory_of_children", (int64_t)cli_peak_memory_of_children());
    cli_json_end(&j, '}');
    return 0;
}

sn_status cli_report_write(const cli_session *s, lua_State *L, int exit_code, sn_error *err)
{
    report r = {s, NULL, exit_code};
    sn_status st = sn_out_open(&r.out, s->opt->json, err);
    if (st) return st;
    if (!lua_checkstack(L, 16)) {
        sn_out_abort(r.out);
        return sn_fail(err, SN_ENOMEM, "%s: no memory for the report", s->opt->json);
    }
    lua_pushcfunction(L, write_report);
    lua_pushlightuserdata(L, &r);
    if (lua_pcall(L, 1, 0, 0) != LUA_OK) {
        const char *why = lua_tostring(L, -1);
        st = sn_fail(err, SN_ENOMEM, "%s: cannot make the report: %s", s->opt->json, why ? why : "unknown");
        lua_pop(L, 1);
        sn_out_abort(r.out);
        return st;
    }
    return sn_out_commit(r.out, err);
}
