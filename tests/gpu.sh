#!/bin/sh
# SPDX-License-Identifier: MIT
# What drawing costs on the graphics card of this machine: all of `punctum bench render` for gl-compute and gl-points, as plain
# points and as the window draws, at 20, 100 and 500 million points of `punctum sample`. Prints a table in Markdown for
# docs/dev/rendering.md and leaves it, with the reports, in build/gpu/. `tests/gpu.sh 0.2 5` measures 200,000 and 5 million points
# instead; ROUNDS=5 measures each more often than three times, SIZE=320x200 a smaller picture, which software renderers need;
# PUNCTUM=FILE measures another program than that of build/release.
# Sizes for which memory or disk are too small are left out and named. Needs python3. See docs/dev/testing.md.
set -eu
cd "$(dirname "$0")/.."
punctum=${PUNCTUM:-build/release/bin/punctum}
rounds=${ROUNDS:-3}
size=${SIZE:-1280x800}
out=build/gpu
for millions in "${@:-20}"; do
  case $millions in
  '' | *[!0-9.]* | *.*.* | .)
    echo "gpu: $millions is no number of millions of points; see the head of tests/gpu.sh" >&2
    exit 2
    ;;
  esac
done
if [ ! -x "$punctum" ]; then
  echo "gpu: there is no program $punctum; build it by ./run.sh or cmake --build --preset release first" >&2
  exit 1
fi
mkdir -p "$out"
rm -f "$out"/*.json "$out"/*.why
[ $# -gt 0 ] || set -- 20 100 500

pointsOf() { python3 -c 'import sys; print(round(float(sys.argv[1]) * 1e6))' "$1"; }
# Makes the file of so many points, once.
make() { [ -s "$out/$1.las" ] || "$punctum" sample "$out/$1.las" --points "$1" >"$out/sample.log" 2>&1; }
# bench NAME OPTION...: a report, or why there is none.
bench() {
  name=$1
  shift
  if ! "$punctum" bench render "$@" --rounds "$rounds" --size "$size" --json >"$out/$name.json" 2>"$out/$name.why"; then
    rm "$out/$name.json"
    echo "gpu: $name: $(tail -1 "$out/$name.why")" >&2
  fi
}

# What draws here, and how many bytes a point takes in a file.
make 10000
bench device "$out/10000.las" --backend gl-compute
record=$(python3 -c 'import struct, sys; print(struct.unpack("<H", open(sys.argv[1], "rb").read(107)[105:])[0])' "$out/10000.las")
device=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["device"])' "$out/device.json" 2>/dev/null || echo none)
rm -f "$out/device.json"
if [ "$device" = none ]; then
  echo "gpu: there is no OpenGL 4.3 here, so there is nothing to measure" >&2
  exit 1
fi
# Of the device's own memory, where there is some and it can be asked; else it is the machine's.
free=$(nvidia-smi --query-gpu=memory.free --format=csv,noheader,nounits 2>/dev/null | head -1 || true)
case $free in '' | *[!0-9]*) free=0 ;; esac
case $device in *llvmpipe* | *softpipe* | *swrast*) echo "gpu: no graphics card draws here, but $device" >&2 ;; esac

: >"$out/left.txt"
for millions in "$@"; do
  points=$(pointsOf "$millions")
  # The columns, 17 bytes of what is drawn, and 18 of it once more on the device.
  why=$(python3 - "$points" "$record" "$free" "$out" <<'ROOM'
import os, sys
points, record, free = map(int, sys.argv[1:4])
ram = next(int(line.split()[1]) * 1024 for line in open("/proc/meminfo") if line.startswith("MemAvailable"))
disk = os.statvfs(sys.argv[4])
made = os.path.exists(f"{sys.argv[4]}/{points}.las")
def lacks(what, needs, has):
    if needs > has:
        print(f"{what} needs {needs / 1e9:.1f} GB, and {has / 1e9:.1f} GB are free")
        sys.exit()
lacks("memory", points * (record + 17 + (0 if free else 18)) * 1.1, ram)
if free: lacks("the graphics card", points * 18 * 1.1, free * 1048576)
if not made: lacks("the disk", points * record, disk.f_bavail * disk.f_frsize)
ROOM
  )
  if [ -n "$why" ]; then
    echo "$millions million points are left out: $why." | tee -a "$out/left.txt" >&2
    continue
  fi
  if ! make "$points"; then
    echo "$millions million points are left out: $(tail -1 "$out/sample.log")" | tee -a "$out/left.txt" >&2
    continue
  fi
  for backend in gl-compute gl-points; do
    bench "$points.$backend.plain" "$out/$points.las" --backend "$backend"
    bench "$points.$backend.window" "$out/$points.las" --backend "$backend" --as-window
  done
done

python3 - "$out" "$device" "$rounds" "$size" "$@" <<'TABLE' | tee "$out/table.md"
import glob, json, os, sys
out, device, rounds, size = sys.argv[1:5]
print(f"{device}; median of rounds: {rounds}; {size.replace('x', ' x ')} px. One pass: all points at once, and positions read (12 bytes a point); orbit: a half\n"
      "turn of 120 frames of 16.6 ms; full: from nothing to the whole picture.\n")
print("| points | backend | drawn | one pass, ms | M points/s | GB/s | orbit median, ms | p95 | most | coverage | least | "
      "reproject, ms | fill | resolve | stream | KiB up | down | full, ms | idle frames |")
print("| --- " * 19 + "|")
def rows():
    for millions in sys.argv[5:]:
        points = round(float(millions) * 1e6)
        for backend in ("gl-compute", "gl-points"):
            for how, drawn in (("plain", "1 px"), ("window", "as the window")):
                yield points, backend, drawn, f"{out}/{points}.{backend}.{how}"
for points, backend, drawn, name in rows():
    head = f"| {points / 1e6:g} M | {backend} | {drawn} |"
    if not os.path.exists(name + ".json"):
        if os.path.exists(name + ".why"):
            why = open(name + ".why").read().strip().splitlines()
            print(head, "failed:", (why or ["no report"])[-1].replace("|", "/"), "|" * 16)
        continue
    report = json.load(open(name + ".json"))
    def of(*path):
        value = report
        for key in path: value = value[key]
        return value["median"]
    def ms(*path): return f"{of(*path):.3g}" if of(*path) < 1000 else f"{of(*path):.0f}"
    cells = [ms("brute_force_ms"), f"{of('mpts_per_s'):.4g}", f"{of('mpts_per_s') * 12e-3:.3g}",
             ms("orbit", "frame_ms"), ms("orbit", "frame_ms_p95"), ms("orbit", "frame_ms_max"),
             f"{of('orbit', 'coverage'):.3f}", f"{of('orbit', 'coverage_least'):.3f}",
             *(ms("passes", part) for part in ("reproject", "fill", "resolve", "stream")),
             f"{of('bytes_up') / 1024:.3g}", f"{of('bytes_down') / 1024:.3g}", ms("converge_ms"), f"{of('idle_frames'):g}"]
    print(head, " | ".join(cells), "|")
left = open(f"{out}/left.txt").read()
if left: print("\n" + left, end="")
TABLE
