# SPDX-License-Identifier: BSD-2-Clause
# bench_plot: lines `WHAT ACCELERATOR X VALUE` of scripts/bench/bench_scale.c whose WHAT begins with `what`: an SVG,
# both axes logarithmic, into `svg`, and a table of slopes: over all points, and between the last two, where fixed costs
# no longer hide the growth. axis: the name of X. Bytes are in the table alone.
index($1, what) == 1 {
    s = substr($1, length(what) + 2)
    s = (s == "" ? "render" : s) " " $2
    if (!(s in n)) series[++n_series] = s
    n[s]++
    x[s, n[s]] = $3
    y[s, n[s]] = $4
}

function log10(v) { return log(v) / log(10) }
function slope(s, from,    i, k, sx, sy, sxx, sxy) {
    for (i = from; i <= n[s]; i++) {
        if (y[s, i] <= 0) continue
        k++; sx += log(x[s, i]); sy += log(y[s, i]); sxx += log(x[s, i]) ^ 2; sxy += log(x[s, i]) * log(y[s, i])
    }
    return k > 1 ? sprintf("%.2f", (k * sxy - sx * sy) / (k * sxx - sx * sx)) : "-"
}
# What theory says of a series against this axis; rays against n triangles by a grid of about n cells, by a hierarchy.
function theory(s) {
    if (what == "triangles") return s ~ /render grid/ ? "rays n^1/3, the rest 0" : s ~ /render/ ? "rays log n, the rest 0" : s ~ /envmap|light/ ? "0" : s ~ /accel embree/ ? "n log n" : "1"
    if (what == "maps") return s ~ /render/ ? "0" : s ~ /accel/ ? "0" : "1"
    return "1 and a fixed part"
}
function place_x(v) { return 60 + 420 * (log10(v) - x0) / (x1 - x0) }
function place_y(v) { return 300 - 270 * (log10(v) - y0) / (y1 - y0) }
function floor(v) { return int(v) > v ? int(v) - 1 : int(v) }

function draw(    i, j, k, s, path, colour) {
    split("#1b6ca8 #c0392b #1e8449 #8e44ad #b9770e #566573 #117a65 #7b241c", colour, " ")
    x0 = y0 = 99; x1 = y1 = -99
    for (j = 1; j <= n_series; j++) for (i = 1; i <= n[series[j]]; i++) {
        s = series[j]
        if (s ~ /bytes/ || y[s, i] <= 0) continue
        if (log10(x[s, i]) < x0) x0 = log10(x[s, i])
        if (log10(x[s, i]) > x1) x1 = log10(x[s, i])
        if (log10(y[s, i]) < y0) y0 = log10(y[s, i])
        if (log10(y[s, i]) > y1) y1 = log10(y[s, i])
    }
    y0 = floor(y0); y1 = -floor(-y1)
    if (x1 <= x0) x1 = x0 + 1
    if (y1 <= y0) y1 = y0 + 1
    print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"350\" font-family=\"sans-serif\" font-size=\"11\">" > svg
    print "<rect width=\"640\" height=\"350\" fill=\"white\"/><rect x=\"60\" y=\"30\" width=\"420\" height=\"270\" fill=\"none\" stroke=\"#888\"/>" > svg
    printf "<text x=\"270\" y=\"340\" text-anchor=\"middle\">%s</text><text x=\"60\" y=\"20\">processor seconds</text>\n", axis > svg
    for (k = -floor(-x0); k <= x1 + 1e-9; k++)
        printf "<line x1=\"%.1f\" x2=\"%.1f\" y1=\"30\" y2=\"300\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"316\" text-anchor=\"middle\">1e%d</text>\n", place_x(10 ^ k), place_x(10 ^ k), place_x(10 ^ k), k > svg
    for (k = y0; k <= y1; k++)
        printf "<line x1=\"60\" x2=\"480\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#ddd\"/><text x=\"54\" y=\"%.1f\" text-anchor=\"end\">1e%d</text>\n", place_y(10 ^ k), place_y(10 ^ k), place_y(10 ^ k) + 4, k > svg
    for (j = k = 1; j <= n_series; j++) {
        s = series[j]
        if (s ~ /bytes/) continue
        path = ""
        for (i = 1; i <= n[s]; i++) if (y[s, i] > 0) path = path sprintf("%.1f,%.1f ", place_x(x[s, i]), place_y(y[s, i]))
        printf "<polyline points=\"%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\"/><text x=\"490\" y=\"%d\" fill=\"%s\">%s: slope %s</text>\n", path, colour[(k - 1) % 8 + 1], 26 + 16 * k, colour[(k - 1) % 8 + 1], s, slope(s, 1) > svg
        k++
    }
    print "</svg>" > svg
}

END {
    if (!n_series) exit
    printf "\nagainst %s (%g to %g)\n", axis, x[series[1], 1], x[series[1], n[series[1]]]
    for (j = 1; j <= n_series; j++) {
        s = series[j]
        printf "  %-20s %10.4g to %-10.4g slope %5s  last two %5s  theory %s\n", s, y[s, 1], y[s, n[s]], slope(s, 1), slope(s, n[s] - 1), theory(s)
    }
    draw()
}
