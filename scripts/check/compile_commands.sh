#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# compile_commands: how each source file is compiled, as the JSON that editors and clang's tools read.
#     scripts/check/compile_commands.sh "COMPILER AND FLAGS" FILE...      (make compile_commands.json)
quoted() { printf '%s' "$1" | sed 's/\\/\\\\/g; s/"/\\"/g'; }
command=$(quoted "$1")
folder=$(quoted "$PWD")
shift
comma="["
for file in "$@"; do
    printf '%s\n{"directory": "%s", "file": "%s", "command": "%s -c %s"}' "$comma" "$folder" "$file" "$command" "$file"
    comma=,
done
printf '\n]\n'
