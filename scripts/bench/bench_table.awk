# SPDX-License-Identifier: BSD-2-Clause
# bench_table: the tables of `make bench` from what its sections have written, build/bench/SECTION.txt. Its columns are
#   references  scene, material, own relMSE, disagreement, difference of the means, processor seconds
#   equal, resample  scene, material, setting, N, us, relMSE, reference's own, trimmed relMSE, relMSE of each seed
#   steps       material, setting, processor seconds of 16 camera samples, us a camera sample, relMSE less the
#               reference's own, relMSE x seconds
#   rival       scene, setting, seconds to 1e-2 and 1e-3, rival : bis of both, floor, how far the mean is off
BEGIN {
    split("n10 n50 mixed diffuse", material, " ")
    split("mis-50 mis-90 em brdf", rival, " ")
    n_methods = split("mis-iid mis-50 mis-90 em brdf ours mix", method, " ")
}
FNR == 1 { file = FILENAME; sub(/.*\//, "", file); sub(/\.txt$/, "", file) }

file == "references" { n_references++; reference[n_references] = $0 }
file == "equal" || file == "resample" {
    key = $1 SUBSEP $2 SUBSEP $3
    if (file == "equal" && !($1 in seen)) { seen[$1]; scene[++n_scenes] = $1 }
    if (file == "resample") key = "resample" SUBSEP $2 SUBSEP $3
    N[key] = $4; us[key] = $5; error[key] = $6; own[key] = $7; trimmed[key] = $8
    n_seeds = NF - 8
    for (i = 1; i <= n_seeds; i++) seed[key, i] = $(8 + i)
}
file == "steps" { steps[++n_steps] = $0 }
file == "rival" { beside[++n_beside] = $0 }

# Sum of logarithms and number.
function note(a, x) { a["log"] += log(x); a["n"]++ }
function geometric(a) { return exp(a["log"] / a["n"]) }
function short(x) { return x >= 100 ? sprintf("%.0f", x) : x >= 10 ? sprintf("%.1f", x) : sprintf("%.2f", x) }

# One line of the last table.
function row(what, value, lo, hi) {
    line(what, value == "" ? "not measured" : short(value) (lo == "" ? "" : " (" short(lo) ".." short(hi) ")"))
}
function line(what, value) { printf "| %-66s | %-26s |\n", what, value }

# Ratio of two settings' errors: mean over seeds, and the range of the ratios seed by seed.
function ratio(a, b,    i, r) {
    lo = hi = ""
    for (i = 1; i <= n_seeds; i++) {
        r = seed[a, i] / seed[b, i]
        if (lo == "" || r < lo) lo = r
        if (hi == "" || r > hi) hi = r
    }
    return error[a] / error[b]
}

function print_equal(    s, m, k, key, name) {
    printf "\nequal time, %d seeds: relMSE [without the worst 1%% of pixels] and N; us a shaded pixel in {}. " \
        "last: its best stratified rival : ours\n", n_seeds
    printf "%-25s %6s", "scene and material", "ref"
    for (k = 1; k <= n_methods; k++) printf "  %-34s", method[k]
    print " best rival"
    for (s = 1; s <= n_scenes; s++) for (m = 1; m <= 4; m++) {
        name = scene[s] SUBSEP material[m]
        printf "%-17s %-7s %s", scene[s], material[m], own[name, "ours"]
        for (k = 1; k <= n_methods; k++) {
            key = name SUBSEP method[k]
            printf "  %-34s", sprintf("%.4f [%.4f] N %d {%.1f}", error[key], trimmed[key], N[key], us[key])
        }
        best = ""
        best_trimmed = ""
        for (k = 1; k <= 4; k++) {
            key = name SUBSEP rival[k]
            if (best == "" || error[key] < error[name, best]) best = rival[k]
            if (best_trimmed == "" || trimmed[key] < best_trimmed) best_trimmed = trimmed[key]
        }
        r = ratio(name SUBSEP best, name SUBSEP "ours")
        note(over_rival, r)
        note(over_rival_trimmed, best_trimmed / trimmed[name, "ours"])
        worse += r < 1 / 1.1
        for (i = 1; i <= n_seeds; i++) {
            by_seed[i] += log(seed[name, best, i] / seed[name, "ours", i])
            worse_by_seed[i] += seed[name, best, i] / seed[name, "ours", i] < 1 / 1.1
        }
        printf " %s %s (%s..%s) [%s]\n", best, short(r), short(lo), short(hi),
            short(best_trimmed / trimmed[name, "ours"])
    }
}

# a[1..n_seeds] into lo and hi.
function range(a,    i) {
    lo = hi = a[1]
    for (i = 2; i <= n_seeds; i++) { if (a[i] < lo) lo = a[i]; if (a[i] > hi) hi = a[i] }
}

END {
    if (n_references) print "references: scene, material, own relMSE, disagreement of mis and sir : expected, " \
        "difference of their means, processor seconds"
    for (i = 1; i <= n_references; i++) print "  " reference[i]
    if (n_scenes) print_equal()

    if (n_steps) print "\nsteps to the default, 16 antialiased camera samples: material, setting, seconds, " \
        "us a camera sample, relMSE, relMSE x seconds"
    for (i = 1; i <= n_steps; i++) print "  " substr(steps[i], 7)
    if (n_beside) print "\nbeside Mitsuba 3, one core"
    for (i = 1; i <= n_beside; i++) print "  " beside[i]

    print ""
    line("quantity", "measured (min..max)")
    line("---", "---")
    for (s = 1; s <= n_scenes; s++) for (m = 1; m <= 4; m++) {
        r = ratio(scene[s] SUBSEP material[m] SUBSEP "mis-iid", scene[s] SUBSEP material[m] SUBSEP "ours")
        row("equal time, i.i.d. MIS : SIR, " scene[s] " " material[m], r, lo, hi)
    }
    if (n_scenes) {
        pairs = over_rival["n"]
        for (i = 1; i <= n_seeds; i++) by_seed[i] = exp(by_seed[i] / pairs)
        range(by_seed)
        row("best of stratified MIS, EM, BRDF : SIR, geometric mean of " pairs, geometric(over_rival), lo, hi)
        row("the same, trimmed", geometric(over_rival_trimmed))
        range(worse_by_seed)
        row("pairs of " pairs " where SIR is over 10% worse than the best rival", worse + 0, lo, hi)
    }
    for (m = 3; m <= 4; m++) if (("resample", material[m], "ours") in error) {
        r = ratio("resample" SUBSEP material[m] SUBSEP "independent", "resample" SUBSEP material[m] SUBSEP "ours")
        row("i.i.d. + multinomial : stratified + systematic, 50/800, " material[m], r, lo, hi)
    }
}
