#!/bin/sh
# cli_test.sh - the program `sinew` from outside: exit codes, what goes to which stream, which files appear.
# usage: sh tests/cli/cli_test.sh path/to/sinew
#
# A case starts with `run NAME CODE command...` and goes on with want_* lines. Besides what these ask for, every case
# checks that no file appeared in its folder but those that want_file names.

case $1 in
'') echo "usage: $0 path/to/sinew" >&2; exit 2 ;;
/*) sinew=$1 ;;
*) sinew=$(pwd)/$1 ;;
esac
[ -x "$sinew" ] || { echo "$0: no program at $sinew" >&2; exit 2; }

tmp=$(mktemp -d /tmp/sinew_cli.XXXXXX) || exit 2
trap 'rm -rf "$tmp"' EXIT
trap 'exit 130' INT TERM
mkdir "$tmp/work"
cd "$tmp/work" || exit 2
export XDG_STATE_HOME="$tmp/state"
export LC_ALL=C
echo 'leak:libOSMesa' >"$tmp/lsan" # Mesa keeps a few bytes; matters to sanitizer builds only
export LSAN_OPTIONS="${LSAN_OPTIONS:-suppressions=$tmp/lsan:print_suppressions=0}"

n_pass=0 n_fail=0 name='' is_good=1

bad() {
    is_good=0
    echo "FAIL $name: $1"
}

finish() {
    [ -n "$name" ] || return 0
    for f in *; do
        case " $before " in
        *" $f "*) ;;
        *) [ "$f" = '*' ] || bad "a file appeared: $f" ;;
        esac
    done
    if [ $is_good = 1 ]; then
        n_pass=$((n_pass + 1))
    else
        n_fail=$((n_fail + 1))
        echo "  standard output:"; head -n 20 "$tmp/out" | sed 's/^/    /'
        echo "  standard error:"; head -n 20 "$tmp/err" | sed 's/^/    /'
    fi
    name=''
}

start() { # name
    finish
    name=$1 is_good=1 before=$(echo *)
}

check_code() { # wanted, found
    [ "$1" = "$2" ] || bad "exit code $2, wanted $1"
}

run() { # name, exit code, command...
    start "$1"
    code=$2
    shift 2
    "$@" </dev/null >"$tmp/out" 2>"$tmp/err"
    check_code "$code" $?
}

run_with() { # text for standard input, name, exit code, command...
    printf '%s\n' "$1" >"$tmp/in"
    start "$2"
    code=$3
    shift 3
    "$@" <"$tmp/in" >"$tmp/out" 2>"$tmp/err"
    check_code "$code" $?
}

want_out() { grep -qF -e "$1" "$tmp/out" || bad "standard output has no '$1'"; }
want_err() { grep -qF -e "$1" "$tmp/err" || bad "standard error has no '$1'"; }
want_no_out() { [ ! -s "$tmp/out" ] || bad "standard output is not empty"; }
want_no_err() { [ ! -s "$tmp/err" ] || bad "standard error is not empty"; }
want_out_lines() { [ "$(cat "$tmp/out")" = "$1" ] || bad "standard output is not '$1'"; }
want_err_lines() { [ "$(cat "$tmp/err")" = "$1" ] || bad "standard error is not '$1'"; }
lacks_err() { ! grep -qF -e "$1" "$tmp/err" || bad "standard error has '$1'"; }
want_file() { # the case was to write it
    [ -s "$1" ] || bad "no file $1"
    before="$before $1"
}
forget() { rm -rf "$@"; }
skip() { echo "SKIPPED: $1"; }

# ---- scripts ----

mkdir lib
cat >lib/ball.lua <<'END'
edge = edge or 0.4
local s = sinew.scene{name = "ball"}
s:set_skin(sinew.shape.sphere({0, 0, 0}, 1):mesh{cell = 0.25})
s:add_muscle("long", {points = {{-0.5, 0, 0}, {0.5, 0, 0}}})
s:add_muscle("short", {points = {{0, 0.3, 0}, {0, 0.3, 0.5}}})
s:tetrahedralize{edge_length = edge}
END
cat >lib/fails.lua <<'END'
local function inner()
    error("it broke")
end
inner()
END
echo 'x = = 3' >lib/syntax.lua
echo 'for i = 1, 3 do' >lib/short.lua
cat >lib/args.lua <<'END'
print(arg[0], arg[1], arg[2], arg[-1], select("#", ...), ...)
END
cat >lib/tetra.obj <<'END'
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
END
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >lib/open.obj
printf 'v 0 0 0\nf 1 2 9\n' >lib/bad.obj

# ---- the command line ----

run help 0 "$sinew" --help
want_out 'usage: sinew'; want_out '--time-limit'; want_no_err
run version 0 "$sinew" --version
want_out 'sinew '; want_no_err
run unknown_option 2 "$sinew" --thread 2 lib/args.lua
want_err "sinew: error: unknown option '--thread' (did you mean '--threads'?)"; want_no_out
run unknown_short_option 2 "$sinew" -z
want_err "unknown option '-z'"
run missing_value 2 "$sinew" --threads
want_err "option '--threads' needs a value"
run threads_not_a_number 2 "$sinew" --threads many -e 'x = 1'
want_err "option '--threads' needs a number, found 'many'"
run threads_zero 2 "$sinew" --threads=0 -e 'x = 1'
want_err "option '--threads' needs a whole number from 1 to 1024, found '0'"
run time_limit_negative 2 "$sinew" --time-limit -1 -e 'x = 1'
want_err "needs more than 0 seconds, found '-1'"
run flag_with_value 2 "$sinew" --strict=yes -e 'x = 1'
want_err "option '--strict'"
run define_without_value 2 "$sinew" -D size -e 'x = 1'
want_err "option '-D' needs name=value, found 'size'"
run define_bad_name 2 "$sinew" -D 3x=1 -e 'x = 1'
want_err "'3x' cannot be the name of a variable"
run define_keyword 2 "$sinew" -D end=1 -e 'x = 1'
want_err "'end' cannot be the name of a variable"
run option_of_another_command 2 "$sinew" info --diff d.png lib/tetra.obj
want_err "option '--diff' does not go with info"
run no_tui 3 "$sinew" tui
want_err 'cannot open tui'
run renderer_unknown 2 "$sinew" --renderer opengl -e 'x = 1'
want_err "option '--renderer' needs auto, osmesa or egl, found 'opengl'"
run renderer_is_said 0 "$sinew" --renderer osmesa -v -e 'x = 1'
want_err 'renderer: llvmpipe'
run renderer_egl_or_why_not 0 "$sinew" --renderer egl -v -e 'x = 1'
grep -qE -e 'renderer: EGL, |renderer egl: .*; use osmesa' "$tmp/err" || bad "nothing is said of EGL"
run threads_reach_script 0 "$sinew" --threads 3 -e 'print(sinew.threads())'
want_out_lines 3

# ---- running ----

run arguments 0 "$sinew" -q lib/args.lua one two
want_out_lines "lib/args.lua	one	two	-q	2	one	two"; want_no_err
run double_dash 0 "$sinew" -- lib/args.lua one
want_out 'lib/args.lua	one	nil	--'
run stdin_script 0 sh -c 'echo "print(arg[0], ...)" | "$0" - a' "$sinew"
want_out_lines '-	a'
run stdin_when_no_terminal 0 sh -c 'echo "print(6 * 7)" | "$0"' "$sinew"
want_out_lines 42
run stdin_error 1 sh -c 'echo "error{}" | "$0"' "$sinew"
want_err_lines 'stdin: error: (error object is a table value)'
run missing_script 3 "$sinew" nowhere.lua
want_err_lines 'sinew: error: cannot open nowhere.lua: No such file or directory'; want_no_out
run folder_as_script 3 "$sinew" lib
want_err 'sinew: error: cannot read lib'
run runtime_error 1 "$sinew" lib/fails.lua
want_err_lines 'lib/fails.lua:2: error: it broke'; want_no_out
run traceback 1 "$sinew" -v lib/fails.lua
want_err 'lib/fails.lua:2: error: it broke'; want_err 'stack traceback:'; want_err "in local 'inner'"
sed -n '/traceback/,$p' "$tmp/err" | grep -q 'lib/fails.lua:4: in main chunk' || bad 'no line 4 in the traceback'
run syntax_error 1 "$sinew" lib/syntax.lua
want_err_lines "lib/syntax.lua:1: error: unexpected symbol near '='"
run syntax_error_at_end 1 "$sinew" lib/short.lua
want_err "lib/short.lua:"; want_err "error: 'end' expected"; want_err 'near <eof>'
run error_without_position 1 "$sinew" -e 'error("plain", 0)'
want_err_lines 'sinew: error: plain'
run error_with_object 1 "$sinew" -e 'error(setmetatable({}, {__tostring = function() return "own text" end}))'
want_err_lines 'sinew: error: own text'
run error_nil 1 "$sinew" -e 'error(nil)'
want_err_lines 'sinew: error: (error object is a nil value)'
run error_number 1 "$sinew" -e 'error(12, 0)'
want_err_lines 'sinew: error: 12'
run error_of_failing_tostring 1 "$sinew" -e 'error(setmetatable({}, {__tostring = function() error("x") end}))'
want_err 'error: x'
run ratio_is_no_position 1 "$sinew" -e 'error("a ratio of 3:4: too much", 0)'
want_err_lines 'sinew: error: a ratio of 3:4: too much'
long=lib/$(printf 'd%.0s' 1 2 3 4 5 6 7 8 9 0 1 2 3 4 5 6 7 8 9 0 1 2 3 4 5 6 7 8 9 0 1 2 3 4 5 6 7 8 9 0)/a_long_name_of_a_script.lua
mkdir -p "${long%/*}"
cp lib/fails.lua "$long"
run long_path_in_full 1 "$sinew" "$long"
want_err_lines "$long:2: error: it broke"
run stack_overflow 1 "$sinew" -e 'local function f() return 1 + f() end f()'
want_err 'stack overflow'
run exit_code_of_script 7 "$sinew" -e 'os.exit(7)'
run exit_true 0 "$sinew" -e 'os.exit(true, true)'
run exit_false 1 "$sinew" -e 'os.exit(false)'
run exit_in_coroutine 5 "$sinew" --json r.json -e 'coroutine.wrap(function() os.exit(5) end)()'
want_file r.json; grep -q '"exit_code": 5' r.json || bad 'the report has another exit code'
forget r.json
run code_before_script 0 "$sinew" -e 'a = 1' -e 'a = a + 1' -e 'print(a)' lib/args.lua
want_out '2'; want_out 'lib/args.lua'
run code_alone 0 "$sinew" -e 'print(sinew.version ~= nil)'
want_out_lines true
run code_syntax 1 "$sinew" -e 'print('
want_err '(command line):1: error: unexpected symbol near <eof>'
run unreadable_input 3 "$sinew" -e 'assert(sinew.surface.load("nowhere.obj"))'
want_err 'nowhere.obj: cannot open'
run wrong_input 3 "$sinew" -e 'assert(sinew.surface.load("lib/bad.obj"))'
want_err '(command line):1: error: lib/bad.obj:2: '
run input_error_caught 0 "$sinew" -e 'print(sinew.surface.load("nowhere.obj"))'
want_out 'nowhere.obj: cannot open'; want_no_err
run open_skin 4 "$sinew" -e 's = sinew.scene{} s:set_skin(sinew.surface.load("lib/open.obj")) s:tetrahedralize{}'
want_err 'error: '
run results_and_messages 0 "$sinew" -e 'print "result" warn("careful")'
want_out_lines result; want_err_lines 'sinew: warning: careful'
run full_disk 3 sh -c '"$0" -e "print(1)" >/dev/full' "$sinew"
want_err 'cannot write standard output'
run closed_pipe 0 sh -c '"$0" -e "while true do print(1) end" | head -n 1' "$sinew"
want_out_lines 1; want_no_err
if locale -a 2>/dev/null | grep -qi '^de_DE.utf'; then
    run decimal_point 0 env LC_ALL=de_DE.UTF-8 "$sinew" -e 'print(1.5, tonumber("2.5"))'
    want_out_lines '1.5	2.5'
else
    skip 'decimal_point: no de_DE locale here'
fi

# ---- -D ----

echo 'size = size or 3 print(size)' >lib/default_or.lua
echo 'size = 3 print(size) size = size + 1 print(size)' >lib/default.lua
run define_none 0 "$sinew" lib/default.lua
want_out_lines '3
4'
run define_over_or 0 "$sinew" -D size=5 lib/default_or.lua
want_out_lines 5
run define_over_assignment 0 "$sinew" -D size=5 lib/default.lua
want_out_lines '5
6'
run define_then_computed 0 "$sinew" -Dn=5 -e 'if not n then n = 1 end n = n * 2 print(n)'
want_out_lines 10
run define_types 0 "$sinew" -D a=0x10 -D b=1.5 -D c=true -D d=false -D e= -D f=x=y -D g=1e \
    -e 'print(math.type(a), a, b, c, d, "<" .. e .. ">", f, type(g))'
want_out_lines 'integer	16	1.5	true	false	<>	x=y	string'
run define_twice 0 "$sinew" -D a=1 -D a=2 -e 'print(a)'
want_out_lines 2
run define_known_name 0 "$sinew" -D type=flat -e 'print(type)'
want_out_lines flat

# ---- files of -o and the report ----

run output_unknown_extension 2 "$sinew" -o out.jpg lib/fails.lua
want_err "unknown extension of 'out.jpg' (known: .png, .vtu, .mesh, .msh, and none for a folder)"
lacks_err 'it broke'
run output_without_scene 1 "$sinew" -o out.png -e 'x = 1'
want_err '-o out.png: the script made no scene'
run output_after_error 1 "$sinew" -o out.png lib/fails.lua
want_err 'it broke'; lacks_err wrote
run output_no_folder 3 "$sinew" -o nowhere/out.vtu lib/ball.lua
want_err 'nowhere/out.vtu'; lacks_err wrote
run outputs 0 "$sinew" -o out.png -o out.vtu -o parts --json r.json lib/ball.lua
want_err_lines 'wrote out.png
wrote out.vtu
wrote parts
wrote r.json'
want_file out.png; want_file out.vtu; want_file r.json; want_file parts/long.obj; want_file parts/short.obj
before="$before parts"
want_no_out
grep -q '"name": "ball"' r.json || bad 'the report has no scene'
if command -v python3 >/dev/null 2>&1; then
    python3 - r.json <<'END' || bad 'the report does not say what was done'
import json, sys
r = json.load(open(sys.argv[1]))
assert r["exit_code"] == 0 and r["error"] is None and r["warnings"] == []
assert r["files"] == ["out.png", "out.vtu", "parts"] and r["script"] == "lib/ball.lua"
assert set(r["scene"]["muscles"]) == {"long", "short"} and r["peak_memory"] > 1 << 20
assert 0 < r["seconds"]["script"] < r["seconds"]["total"] < 600
END
else
    skip 'report of outputs: no python3 here'
fi
run outputs_quiet 0 "$sinew" -q -D edge=0.5 -o out2.png lib/ball.lua
want_no_err; want_file out2.png
run report_of_error 1 "$sinew" --json r2.json -q lib/fails.lua
want_file r2.json; want_err_lines 'lib/fails.lua:2: error: it broke'
run report_of_strange_text 1 "$sinew" -q --json r3.json -e 'warn("a\"\\\n\1\xff\xc3\xa9") error("tab\t\xed\xa0\x80", 0)'
want_file r3.json
run report_cannot_be_written 3 "$sinew" --json nowhere/r.json -e 'x = 1'
want_err 'nowhere/r.json: cannot write'
if command -v python3 >/dev/null 2>&1; then
    run reports_are_json 0 sh -c 'for f in r.json r2.json r3.json; do python3 -m json.tool $f || exit 1; done'
    run report_has_error 0 python3 -c '
import json
e = json.load(open("r2.json"))["error"]
assert (e["file"], e["line"], e["code"], e["message"]) == ("lib/fails.lua", 2, 1, "it broke"), e
assert "main chunk" in e["traceback"]
r = json.load(open("r3.json"))
assert r["warnings"] == ["a\"\\\n\x01\ufffd\u00e9"], r["warnings"]
assert r["error"]["message"] == "tab\t\ufffd\ufffd\ufffd" and r["error"]["line"] is None'
else
    skip 'reports_are_json: no python3 here'
fi
run strict_without_warning 0 "$sinew" --strict -e 'x = 1'
run strict_with_warning 1 "$sinew" --strict -e 'warn("a", "b") print "went on"'
want_out_lines 'went on'; want_err 'sinew: warning: ab'; want_err '1 warning, and --strict was given'
run strict_exit 1 "$sinew" --strict -q -e 'warn("ab") os.exit(0)'
lacks_err 'sinew: warning'
run quiet_warning 0 "$sinew" -q -e 'warn("ab")'
want_no_err

# ---- limits and Ctrl-C ----

run time_limit_lua 8 "$sinew" --time-limit 0.2 -e 'while true do end'
want_err_lines '(command line):1: error: time limit reached'
run time_limit_no_way_around 8 "$sinew" --time-limit 0.2 -e 'while true do pcall(function() while true do end end) end'
want_err 'time limit reached'
run time_limit_coroutine 8 "$sinew" --time-limit 0.2 -e 'coroutine.wrap(function() while true do end end)()'
want_err 'time limit reached'
run time_limit_step 8 "$sinew" --time-limit 0.2 -o out9.vtu -e 'sinew.shape.sphere({0, 0, 0}, 1):mesh{cell = 0.008}'
want_err 'time limit reached while'; lacks_err wrote
run time_limit_not_reached 0 "$sinew" --time-limit 100 -e 'print(1)'
want_out_lines 1

# Starts the program in the background, waits until it says "ready", and sends SIGINT n times, half a second apart.
interrupt() { # name, exit code, n, arguments of sinew...
    start "$1"
    code=$2 n=$3
    shift 3
    : >"$tmp/err"
    "$sinew" "$@" </dev/null >"$tmp/out" 2>"$tmp/err" &
    pid=$!
    tries=0
    while ! grep -q ready "$tmp/err" && [ $tries -lt 100 ]; do
        sleep 0.1
        tries=$((tries + 1))
    done
    while [ "$n" -gt 0 ]; do
        sleep 0.5
        kill -INT $pid 2>/dev/null
        n=$((n - 1))
    done
    (sleep 20; kill -KILL $pid 2>/dev/null) &
    guard=$!
    wait $pid 2>/dev/null
    check_code "$code" $?
    kill $guard 2>/dev/null
    wait $guard 2>/dev/null
}
ready='io.stderr:write("ready\n") '
interrupt interrupt_lua 130 1 -e "$ready while true do end"
want_err '(command line):1: error: interrupted'
interrupt interrupt_caught 0 1 -e "$ready print(pcall(function() while true do end end)) print 'on'"
want_out 'false	(command line):1: interrupted'; want_out on
interrupt interrupt_again 130 2 -e "$ready pcall(function() while true do end end) while true do end"
want_err 'interrupted'
interrupt interrupt_coroutine 130 1 -e "$ready coroutine.wrap(function() while true do end end)()"
want_err 'interrupted'
interrupt interrupt_step 130 1 -o out9.vtu -e "$ready sinew.shape.sphere({0, 0, 0}, 1):mesh{cell = 0.008}"
want_err 'error: '; want_err 'interrupted while'; lacks_err wrote
interrupt interrupt_step_caught 0 1 \
    -e "$ready print(pcall(function() sinew.shape.sphere({0, 0, 0}, 1):mesh{cell = 0.008} end)) print 'on'"
want_out 'interrupted while'; want_out on
interrupt interrupt_step_raised_again 130 1 \
    -e "$ready local ok, e = pcall(function() sinew.shape.sphere({0, 0, 0}, 1):mesh{cell = 0.008} end) error(e, 0)"
want_err 'interrupted while'
interrupt interrupt_two_steps 130 2 -e "$ready local s = sinew.shape.sphere({0, 0, 0}, 1)
print(pcall(s.mesh, s, {cell = 0.008})) s:mesh{cell = 0.008}"
want_out 'interrupted while'; want_err '(command line):2: error: interrupted while'
interrupt interrupt_twice_in_one_wait 130 2 -e "$ready string.find(('a'):rep(40), ('.-'):rep(20) .. 'b')"

# ---- reading lines ----

run_with '1 + 1
{b = 2, a = {1, {2}}, "x"}
for i = 1, 2 do
print(i)
end
"text", nil
error("q")
x =
1, 2
x' repl_piped 0 "$sinew" -i
want_out_lines '2
{"x", a = {1, {...}}, b = 2}
1
2
text	nil
1'
want_err 'stdin:1: error: q'; want_err 'stack traceback:'
run_with 'size
size = 7
size' repl_after_script 0 "$sinew" -i -D size=5 lib/default_or.lua
want_out_lines '5
5
7'
run_with 'print "still here"' repl_after_error 1 "$sinew" -i lib/fails.lua
want_out_lines 'still here'; want_err 'it broke'
run_with 'help("sinew.surface.load")
help(sinew.surface.load)
help(5)' repl_help 0 "$sinew" -i
want_out 'sinew.surface.load('; want_err 'a name, or a function or an object of sinew expected'
[ "$(grep -c 'sinew.surface.load(' "$tmp/out")" = 2 ] || bad 'help by name and by function differ'
run_with 'while true do end
print "next"' repl_time_limit 0 "$sinew" -i --time-limit 0.3
want_out_lines next; want_err 'time limit reached'

# Types at the program on a terminal of its own: each argument, then a pause.
# `exec`: a shell that stays (dash) would answer the Ctrl-C too, and end with 130.
type_at() { # name, exit code, keys (for printf)...
    start "$1"
    code=$2
    shift 2
    : >"$tmp/err"
    (
        sleep 1
        for keys in "$@"; do
            # shellcheck disable=SC2059
            printf "$keys"
            sleep 0.6
        done
    ) | TERM=xterm script -qec "exec '$sinew'" /dev/null >"$tmp/out" 2>&1
    check_code "$code" $?
}
if script -qec true /dev/null >/dev/null 2>&1 </dev/null; then
    type_at repl_banner 0 'print(6 * 7)\n' '\004'
    want_out 'help() explains'; want_out 42
    type_at repl_interrupt 3 'while true do end\n' '\003' 'print "a" .. "fter"\n' 'os.exit(3)\n'
    want_out 'interrupted'
    type_at repl_clear_line 0 'error("nev" .. "er")\003' 'print(2 ^ 5)\n' '\004'
    want_out 32.0
    ! grep -q 'error: never' "$tmp/out" || bad 'a line that Ctrl-C cleared was run'
    type_at repl_clear_block 0 'for i = 1, 2 do\n' '\003' 'print(2 ^ 6)\n' '\004'
    want_out 64.0
    type_at repl_completion 0 'print(sinew.vers\t == nil)\n' '\004'
    want_out 'print(sinew.version'; want_out false
    type_at repl_completes_muscles 0 's = dofile("lib/ball.lua") s = sinew.scene{}\n' \
        's:add_muscle("gluteus", {points = {{0, 0, 0}, {1, 0, 0}}}) print "made"\n' 's:muscle("glu\t):leng\t()\n' '\004'
    want_out 's:muscle("gluteus"):length()'; want_out '1.0'
    type_at repl_exit_code 9 'os.exit(9)\n'
    start repl_history
    grep -q '^print(6 \* 7)$' "$tmp/state/sinew/history" || bad 'no history'
    case $(ls -l "$tmp/state/sinew/history") in
    -rw-------*) ;;
    *) bad 'others may read the history' ;;
    esac
    XDG_STATE_HOME=/proc/nowhere type_at repl_no_history 0 'print(6 * 8)\n' '\004'
    want_out 48
else
    skip 'REPL at a terminal: script(1) cannot be used here'
fi

# ---- info and compare ----

run info 0 "$sinew" info lib/tetra.obj lib/open.obj
want_out 'lib/tetra.obj'; want_out '  vertices: 4'; want_out '  faces: 4'; want_out '  bounds: 0 0 0 .. 1 1 1'
want_out '  volume: 0.16666666666666666'; want_out '  closed: true'; want_out '  closed: false'
want_out '  boundary_edges: 3'; want_out '  self_intersections: 0'; want_no_err
[ "$(grep -c '^  hint: surface:repair{} may mend it$' "$tmp/out")" = 1 ] || bad 'no hint for the open one alone'
for field in area manifold oriented components nonmanifold_edges nonmanifold_vertices degenerate_faces \
    duplicate_vertices duplicate_faces unused_vertices first_pair; do
    [ "$(grep -c "^  $field: " "$tmp/out")" = 2 ] || bad "no field $field in each block"
done
run info_goes_on 3 "$sinew" info nowhere.obj lib/bad.obj lib/args.lua lib/tetra.obj
want_out 'lib/tetra.obj'; want_err 'nowhere.obj: cannot open'; want_err 'lib/bad.obj:2: '
want_err 'lib/args.lua: unknown extension'
run info_tets 0 "$sinew" info out.vtu
want_out '  tets: '; want_out '  parts: 3'; want_out '  min_volume: '
run info_nothing 2 "$sinew" info
want_err 'info: need at least one file'
run info_closed_pipe 0 sh -c '"$0" info $(yes lib/tetra.obj | head -n 3000) | head -n 1' "$sinew"
want_out_lines lib/tetra.obj; want_no_err
run compare_same 0 "$sinew" compare out.png out.png
want_out_lines 'max: 0
count: 0
rmse: 0
equal'
run compare_max 0 "$sinew" compare --max 255 out.png out2.png
want_out equal
run compare_different 7 "$sinew" compare out.png out2.png --diff d.png
want_out differs; want_err 'wrote d.png'; want_file d.png
run compare_count 0 "$sinew" compare out.png out2.png --count 480000
want_out equal
run small_picture 0 "$sinew" -q -e 's = sinew.scene{} s:set_skin(sinew.surface.load("lib/tetra.obj")) s:render{file = "small.png", size = {20, 10}}'
want_file small.png
run compare_sizes 7 "$sinew" compare out.png small.png --diff d3.png
want_out 'sizes: 800x600 and 20x10'; want_out differs; want_err 'd3.png is not written'
run compare_unreadable 3 "$sinew" compare out.png nowhere.png
want_err 'nowhere.png: cannot open'; want_no_out
run compare_not_a_picture 3 "$sinew" compare lib/tetra.obj out.png
want_err 'lib/tetra.obj'
run compare_one 2 "$sinew" compare out.png
want_err 'compare: need two pictures, found 1'
run compare_bad_max 2 "$sinew" compare a.png b.png --max 300
want_err "option '--max' needs a whole number from 0 to 255, found '300'"
run compare_bad_diff 2 "$sinew" compare a.png b.png --diff d.jpg
want_err "option '--diff' needs a .png file, found 'd.jpg'"

finish
echo "$n_pass passed, $n_fail failed"
[ $n_fail = 0 ]
