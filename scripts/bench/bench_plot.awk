# SPDX-License-Identifier: BSD-2-Clause
# bench_plot: lines `WHAT ACCELERATOR X VALUE` of scripts/bench/bench_scale.c whose WHAT begins with `what`: the
# curves into `json` (docs/live.md), and a table of slopes: over all points, and between the last two, where fixed costs
# no longer hide the growth. axis: the name of X. Bytes are in the table alone.
index($1, what) == 1 {
    s = substr($1, length(what) + 2)
    s = (s == "" ? "render" : s) " " $2
    if (!(s in n)) series[++n_series] = s
    n[s]++
    x[s, n[s]] = $3
    y[s, n[s]] = $4
}

function slope(s, from,    i, k, sx, sy, sxx, sxy) {
    for (i = from; i <= n[s]; i++) {
        if (y[s, i] <= 0) continue
        k++; sx += log(x[s, i]); sy += log(y[s, i]); sxx += log(x[s, i]) ^ 2; sxy += log(x[s, i]) * log(y[s, i])
    }
    return k > 1 ? sprintf("%.2f", (k * sxy - sx * sy) / (k * sxx - sx * sx)) : "-"
}
# What theory says of a series against this axis; rays against n triangles by a grid of about n cells, by a hierarchy.
function theory(s) {
    if (what == "triangles") {
        if (s ~ /render grid/) return "rays n^1/3, the rest 0"
        if (s ~ /render/) return "rays log n, the rest 0"
        return s ~ /envmap|light/ ? "0" : s ~ /accel embree/ ? "n log n" : "1"
    }
    if (what == "maps") return s ~ /render/ ? "0" : s ~ /accel/ ? "0" : "1"
    return "1 and a fixed part"
}
function draw(    i, j, s, xs, ys, comma) {
    printf "{\"title\": \"seconds against %s\", \"x\": \"%s\", \"y\": \"processor seconds\", \"curves\": [",
        axis, axis > json
    for (j = 1; j <= n_series; j++) {
        s = series[j]
        if (s ~ /bytes/) continue
        xs = ys = ""
        for (i = 1; i <= n[s]; i++) if (y[s, i] > 0) {
            xs = xs (xs == "" ? "" : ", ") x[s, i]
            ys = ys (ys == "" ? "" : ", ") y[s, i]
        }
        printf "%s\n{\"label\": \"%s: slope %s\", \"x\": [%s], \"y\": [%s]}", comma, s, slope(s, 1), xs, ys > json
        comma = ","
    }
    print "]}" > json
}

END {
    if (!n_series) exit
    printf "\nagainst %s (%g to %g)\n", axis, x[series[1], 1], x[series[1], n[series[1]]]
    for (j = 1; j <= n_series; j++) {
        s = series[j]
        printf "  %-20s %10.4g to %-10.4g slope %5s  last two %5s  theory %s\n", s, y[s, 1], y[s, n[s]],
            slope(s, 1), slope(s, n[s] - 1), theory(s)
    }
    draw()
}
