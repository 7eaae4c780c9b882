#!/bin/sh
# SPDX-License-Identifier: MIT
# Which lines and branches of core/las and core/edit the tests of core reach: a table, file by file, for lines and one for
# branches, in build/coverage/. Needs gcc and gcovr (apt install gcovr). See docs/dev/testing.md.
set -eu
cd "$(dirname "$0")/.."
cmake --preset coverage
tests=$(ctest --preset coverage -N -L core | sed -n 's/^ *Test *#[0-9]*: //p')
# shellcheck disable=SC2086 # the names are words
cmake --build --preset coverage --target $tests
find build/coverage/core -name '*.gcda' -delete
ctest --preset coverage -L core || echo "Some tests failed; the tables tell what was reached all the same." >&2
report() {
  gcovr --root . --object-directory build/coverage/core --filter core/las/ --filter core/edit/ --exclude-throw-branches \
    "$@" build/coverage/core
}
report --txt build/coverage/lines.txt
report --branches --txt build/coverage/branches.txt
cat build/coverage/lines.txt build/coverage/branches.txt
