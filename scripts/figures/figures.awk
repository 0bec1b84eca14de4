# SPDX-License-Identifier: BSD-2-Clause
# figures: the lines of scripts/figures/figures.c as tables for people. relMSE is without the reference's own error. The
# last column: seconds to equal error, by error x time, relative to the row's first method.
$1 == "price" {
    if (!heads++) print "material  method         candidate          ray         A         B  best M/N   " \
        "error x us at 15/800, at best M/N"
    printf "%-9s %-11s %9s ns %9s ns %9s %9s %9s %12s %12s\n", $2, $3, $4, $5, $6, $7, $8, $9, $10
    next
}
{
    e = $8 - $10
    if (!($2 in first)) {
        first[$2] = e * $6
        row[++n] = $2
    }
    text[$2] = text[$2] sprintf("  %-11s %5d/%-6d %9.2f %9.1f %12.2e %10.1e %9.2f x\n", $3, $4, $5, $6, $7,
        e, $9, e * $6 / first[$2])
}
END {
    for (i = 1; i <= n; i++)
        printf "%-14s    N/M       us/pixel  rays/pixel   relMSE  (trimmed) to equal error\n%s",
            row[i], text[row[i]]
}
