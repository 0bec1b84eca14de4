#!/bin/sh
# budget_truth: the tables of docs/budgets.md: does `--error E` keep its word? 40 runs of 32 x 24 pixels for each of
# five scenes, plain and adaptive, then harder ones, with small lamps and narrow lobes. About 15 minutes on two cores.
#     make build/release/budget_truth data && scripts/budget_truth.sh [build/release]
B=${1:-build/release}
echo "| scene | E | runs | camera samples | true error / E | at most E | below E/2 | bias / E |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- |"
for adaptive in "" --adaptive; do
    for scene in overcast-diffuse coloured-shadows louvres trianglemesh orthographic; do
        "$B"/budget_truth $adaptive 40 32x24 1500 0.08 data/scenes/$scene.txt || exit 1
    done
done
for scene in data/scenes/outdoor-sun.txt data/scenes/pinpoint.txt scene.txt; do
    "$B"/budget_truth 20 32x24 1500 0.15 $scene || exit 1
done
