#!/bin/sh
# SPDX-License-Identifier: MIT
# breaks.sh GATE_DIR CLANG_FORMAT CLANG_TIDY CLANG: a gate that lets everything through is worth nothing, so this makes a
# small project, sees it pass, then breaks it in each way and sees the checks fail for that reason.
set -eu
gate=$1 format=$2 tidy=$3 clang=$4
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
mkdir -p "$made/core" "$made/render" "$made/ui" "$made/app" "$made/tests" "$made/build"
cp "$gate/../../.clang-format" "$gate/../../.clang-tidy" "$made/"

good() {
    cat >"$made/core/Good.h" <<'END'
// SPDX-License-Identifier: MIT
#pragma once

namespace punctum
{

inline int twice(int number)
{
    return 2 * number;
}

}  // namespace punctum
END
    cat >"$made/core/Good.cpp" <<'END'
// SPDX-License-Identifier: MIT
#include "core/Good.h"

namespace punctum
{

int fourTimes(int number)
{
    return twice(twice(number));
}

}  // namespace punctum
END
}
cat >"$made/build/compile_commands.json" <<END
[{"directory": "$made/build", "command": "c++ -I$made -std=c++20 -o core/CMakeFiles/c.dir/Good.cpp.o -c $made/core/Good.cpp",
  "file": "$made/core/Good.cpp"}]
END
checkFormat() { sh "$gate/format.sh" "$format" "$made" 2>&1; }
checkTidy() { python3 "$gate/tidy.py" "$tidy" "$clang" "$made" "$made/build" core 2>&1; }
failed=0
# expect NAME CHECK WORD: the check fails, and says WORD.
expect() {
    if said=$($2); then
        echo "breaks: $1 went through"
        failed=1
    elif ! printf '%s\n' "$said" | grep -q -e "$3"; then
        echo "breaks: $1 failed, but not for that:"
        printf '%s\n' "$said"
        failed=1
    fi
}

good
checkFormat || { echo "breaks: a well formatted file is refused"; failed=1; }
checkTidy || { echo "breaks: a good file is refused"; failed=1; }

sed -i 's/return twice/return  twice/' "$made/core/Good.cpp"
expect "a wrongly formatted file" checkFormat "clang-format-violations"
good
sed -i 's/fourTimes/Four_times/' "$made/core/Good.cpp"
expect "a wrong name" checkTidy "readability-identifier-naming"
good
sed -i 's/twice/Two_times/' "$made/core/Good.h" "$made/core/Good.cpp"
expect "a wrong name in a header" checkTidy "core/Good.h.*readability-identifier-naming"
good
sed -i 's/return twice(twice(number));/int* none = 0; return none ? *none : twice(number);/' "$made/core/Good.cpp"
expect "a check of .clang-tidy" checkTidy "modernize-use-nullptr"
exit $failed
