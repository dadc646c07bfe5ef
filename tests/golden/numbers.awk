# numbers.awk - awk -f numbers.awk EXPECTED ACTUAL: are they the same text, but for numbers that may be a little off?
# A number may be off by 1 %, or by one in its last digit after the point: other processors round sums in another order.
function is_number(s) { return s ~ /^[-+]?[0-9]+(\.[0-9]*)?([eE][-+]?[0-9]+)?$/ }
function abs(x) { return x < 0 ? -x : x }
function tolerance(e, a,   larger, point, unit) {
    larger = abs(e + 0) > abs(a + 0) ? abs(e + 0) : abs(a + 0)
    point = index(e, ".")
    unit = point && e !~ /[eE]/ ? 1.001 * 10 ^ (point - length(e)) : 0
    return 0.01 * larger > unit ? 0.01 * larger : unit
}
function same(e, a) {
    if (is_number(e) && is_number(a)) return abs(e - a) <= tolerance(e, a)
    return e == a
}
function complain() {
    print "line " FNR ": expected '" expected[FNR] "'"
    print "line " FNR ":      got '" $0 "'"
    bad = 1
}
FNR == NR { expected[FNR] = $0; n = FNR; next }
{
    n_word = split(expected[FNR], word)
    is_same = FNR <= n && n_word == NF
    for (i = 1; i <= NF && is_same; i++) is_same = same(word[i], $i)
    if (!is_same) complain()
    n_actual = FNR
}
END {
    if (n_actual < n) { print "lines missing after line " n_actual; bad = 1 }
    exit bad
}
