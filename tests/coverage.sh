#!/bin/sh
# SPDX-License-Identifier: MIT
# Which lines and branches of core/las and core/edit the tests of core reach, file by file, in build/coverage/: table.md, and
# lines.txt and branches.txt, which say what is not reached. Needs gcc, gcovr and python3 (apt install gcovr).
# `tests/coverage.sh TEST...` runs these tests alone and adds to what was counted before. See docs/dev/testing.md.
set -eu
cd "$(dirname "$0")/.."
cmake --preset coverage
if [ $# -gt 0 ]; then
  tests="$*"
else
  # Without those that use neither folder.
  tests=$(ctest --preset coverage -N -L core | sed -n 's/^ *Test *#[0-9]*: //p' | grep -vE '^(PclTest|IncludesTest|FuzzReplay.camera)$')
fi
# shellcheck disable=SC2086 # the names are words
cmake --build --preset coverage ${JOBS:+-j "$JOBS"} --target $(printf '%s\n' $tests | sed 's/^FuzzReplay\./fuzz_/')
[ $# -gt 0 ] || find build/coverage/core -name '*.gcda' -delete

# The counters are plain numbers, so the threads of a test share one processor; as many tests run at once as there are such.
cpus=$(python3 -c 'import os; print(*os.sched_getaffinity(0))')
export cpus
# shellcheck disable=SC2016,SC2086 # the inner shell is to expand them; words again
printf '%s\n' $tests | xargs -n 1 -P "$(printf '%s\n' $cpus | wc -l)" --process-slot-var=slot sh -c '
  test=$1; set -- $cpus; shift "$slot"
  exec taskset -c "$1" ctest --preset coverage -R "^$test\$"' sh |
  grep --line-buffered -vE '^(Preset|Test project|  *Start|Total|Label|core|$)' ||
  echo "Some tests failed; the tables tell what was reached all the same." >&2

cd build/coverage
counted() { gcovr --root ../.. --add-tracefile counted.json "$@"; }
gcovr --root ../.. --object-directory core --filter ../../core/las/ --filter ../../core/edit/ --exclude-throw-branches \
  --exclude-unreachable-branches --gcov-ignore-parse-errors --json counted.json core
counted --txt lines.txt
counted --branches --txt branches.txt
counted --json-summary summary.json
python3 - <<'TABLE' | tee table.md
import json
sums = json.load(open("summary.json"))
print("| file | lines | not reached | branches | not reached |\n| --- | --- | --- | --- | --- |")
def row(name, of):
    cells = []
    for what in ("line", "branch"):
        total, covered = of[what + "_total"], of[what + "_covered"]
        cells += ["-" if total == 0 else f"{int(1000 * covered / total) / 10:g} %", f"{total - covered} of {total}"]
    print(f"| {name} | {' | '.join(cells)} |")
for one in sums["files"]:
    row(one["filename"].removeprefix("core/"), one)
row("all", sums)
TABLE
