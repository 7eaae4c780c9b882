#!/bin/sh
# SPDX-License-Identifier: MIT
# Builds the fuzz targets and runs them, one after the other, each for SECONDS (60), from the kept inputs on:
# tests/fuzz/run.sh [SECONDS [TARGET...]]. New inputs gather in build/fuzz/corpus/, what fails in build/fuzz/.
# Needs clang with its runtime libraries (Debian: clang, libclang-rt-14-dev); nothing else of Punctum does.
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
cd "$root"
seconds=${1:-60}
[ $# -eq 0 ] || shift
targets=${*:-header extra_bytes chunk_table chunk open_save_open journal manifest expression camera}

if ! command -v clang++ >/dev/null || ! ls "$(clang++ -print-resource-dir)"/lib/linux/libclang_rt.fuzzer-*.a >/dev/null 2>&1; then
    echo "fuzz: clang or its libFuzzer is missing; install clang and libclang-rt-dev." >&2
    exit 1
fi
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz

# LASzip forgets some of its memory after errors. The stack is no larger than that of the threads which evaluate,
# though the sanitizers use several times as much of it.
export ASAN_OPTIONS="detect_leaks=0:quarantine_size_mb=16:${ASAN_OPTIONS:-}"
export UBSAN_OPTIONS="print_stacktrace=1:${UBSAN_OPTIONS:-}"
ulimit -s 4096
failed=0
for target in $targets; do
    gathered=build/fuzz/corpus/$target
    log=build/fuzz/$target.log
    mkdir -p "$gathered"
    kept=tests/fuzz/corpus/$target
    case $target in
    header | open_save_open) kept="$kept tests/fuzz/corpus/files" ;;
    esac
    # shellcheck disable=SC2086 # a list of words
    build/fuzz/fuzz/fuzz_"$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=512 -max_len=4096 \
        -print_final_stats=1 -artifact_prefix="build/fuzz/$target-" "$gathered" $kept >"$log" 2>&1 || {
        failed=1
        echo "$target FAILED; see $log"
        grep -E 'SUMMARY|promise|Test unit written' "$log" || true
    }
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    reached=$(grep -o 'cov: [0-9]* ft: [0-9]*' "$log" | tail -n 1)
    found=$(find build/fuzz -maxdepth 1 -name "$target-*" ! -name '*.log' | wc -l)
    echo "$target: ${runs:-0} executions in $seconds s, $reached, $found failing inputs"
done
exit $failed
