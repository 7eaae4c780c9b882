#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs clang-tidy with .clang-tidy over all of our files, its findings being errors.

    tidy.py CLANG_TIDY CLANG SOURCE_DIR BUILD_DIR [FOLDER...]

Most of its time goes into the headers of libraries, so files of a folder are read together, as many as agree with each
other: in a batch that does not compile constants of one name are told apart, then it is tried again without the files
that clang complains of, which form the next batch. What is reported is the place in the file itself. Exit 1 when there
is any finding.
"""
import concurrent.futures
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile

BATCH = 48
# Tests look at what was moved from, on purpose; their speed and the widths of made numbers are no matter.
NOT_IN_TESTS = ("-performance-*,-bugprone-use-after-move,-bugprone-integer-division,-bugprone-misplaced-widening-cast,"
                "-clang-diagnostic-unused-*")
# What only g++ knows, and what has no meaning without code being made.
FOREIGN = re.compile(r"^-(W|O|f(pch|fp-contract)|m)")


def flags_by_folder(build):
    """Definitions, include paths and language of each target, by the folder of its CMakeLists.txt."""
    flags = {}
    with open(os.path.join(build, "compile_commands.json")) as file:
        commands = json.load(file)
    for entry in commands:
        words = shlex.split(entry["command"])
        output = words[words.index("-o") + 1]
        folder, target = output.split("/CMakeFiles/", 1)
        target = target.split("/", 1)[0]
        kept, k = [], 0
        words = words[next(i for i, w in enumerate(words) if w.endswith(("c++", "g++", "++", "clang++-14"))) + 1:]
        while k < len(words):
            word = words[k]
            if word in ("-isystem", "-I", "-D"):
                kept += words[k:k + 2]
                k += 2
                continue
            if word in ("-include", "-o", "-MT", "-MF", "-Xclang"):
                k += 2
                continue
            if word.startswith(("-I", "-D", "-std=")) and not FOREIGN.match(word):
                kept.append(word)
            k += 1
        known = flags.setdefault(folder, [])
        if not known:
            known += kept
        else:  # another target of the folder: what it sees beside the others
            for i, word in enumerate(kept):
                if word == "-isystem":
                    if (word, kept[i + 1]) not in zip(known, known[1:]):
                        known += kept[i:i + 2]
                elif i and kept[i - 1] == "-isystem":
                    continue
                elif word not in known:
                    known.append(word)
    return flags


def sources_of(root, folder):
    found = []
    for path, _, names in os.walk(os.path.join(root, folder)):
        found += [os.path.join(path, n) for n in names if n.endswith(".cpp")]
    return sorted(found)


def folder_of(path, root, folders):
    """The innermost folder with a CMakeLists.txt that has targets."""
    here = os.path.relpath(os.path.dirname(path), root)
    while here and here not in folders:
        here = os.path.dirname(here)
    return here


class Batch:
    """Files that are read as one."""

    def __init__(self, files, flags, own, scratch, number):
        self.files = files
        self.flags = flags
        self.own = own  # words that mean something else in each file
        self.path = os.path.join(scratch, f"batch{number}.cpp")

    def write(self):
        lines = ["// TBB has a function named like a word of Qt's, so it comes before any file that includes Qt",
                 "#if __has_include(<tbb/profiling.h>)", "#include <tbb/profiling.h>", "#endif"]
        self.by_line = {}
        for k, name in enumerate(self.files):
            lines += [f"#define {word} {word}{k}" for word in self.own] + [f'#include "{name}"']
            self.by_line[len(lines)] = name
            lines += [f"#undef {word}" for word in self.own]
        with open(self.path, "w") as out:
            out.write("\n".join(lines) + "\n")

    def blamed(self, messages):
        """The files in which, or in headers of which, the compiler found an error."""
        found, top = set(), None
        for line in messages.splitlines():
            stack = re.match(rf"In file included from {re.escape(self.path)}:(\d+):", line)
            if stack:
                top = self.by_line.get(int(stack.group(1)))
            elif re.search(r": (fatal )?error: ", line) and top:
                found.add(top)
        return found


def batches(files, flags, clang, scratch, counter):
    """Splits files into batches that compile. A file that does not compile alone is a batch, and will be told."""
    waiting = list(files)
    own = {"main", "LLVMFuzzerTestOneInput"}  # every test and every fuzzer has a beginning of its own
    while waiting:
        batch, rest = waiting[:BATCH], waiting[BATCH:]
        while True:
            made = Batch(batch, flags, sorted(own), scratch, next(counter))
            made.write()
            if len(batch) == 1:
                break
            run = subprocess.run([clang, "-fsyntax-only", "-ferror-limit=0", "-w", *flags, made.path],
                                 capture_output=True, text=True)
            if run.returncode == 0:
                break
            constants = set(re.findall(r"error: (?:redefinition of|reference to) '(k[A-Z]\w*)'", run.stderr)) - own
            if constants:
                own |= constants
                continue
            found = made.blamed(run.stderr)
            blamed = [f for f in batch[1:] if f in found] or batch[1:]
            rest = blamed + rest
            batch = [f for f in batch if f not in blamed]
        yield made
        waiting = rest


def main():
    tidy, clang, root, build, *only = sys.argv[1:]
    root = os.path.realpath(root)
    flags = flags_by_folder(build)
    groups = {}
    for top in only or ["core", "render", "ui", "app", "tests"]:
        for path in sources_of(root, top):
            groups.setdefault(folder_of(path, root, flags), []).append(path)

    def numbers():
        n = 0
        while True:
            yield n
            n += 1

    counter = numbers()
    findings = set()
    with tempfile.TemporaryDirectory() as scratch, \
            concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        def check(batch):
            # a batch includes sources
            checks = "-bugprone-suspicious-include"
            if batch.files[0].startswith(os.path.join(root, "tests") + os.sep):
                checks += "," + NOT_IN_TESTS
            run = subprocess.run(
                [tidy, "--quiet", f"--config-file={root}/.clang-tidy", "--warnings-as-errors=*",
                 f"--checks={checks}",
                 f"--header-filter=^{re.escape(root)}/(core|render|ui|app|tests)/", batch.path, "--",
                 *batch.flags, "-w"], capture_output=True, text=True)
            lines = run.stdout.splitlines()
            told = [l.replace(root + "/", "") for l in lines if re.search(r": (warning|error): ", l)]
            if run.returncode != 0 and not told:
                told = [run.stderr.strip().splitlines()[-1] if run.stderr.strip() else "clang-tidy failed"]
            return len(batch.files), told

        def work(item):
            folder, files = item
            return [check(b) for b in batches(files, flags.get(folder, []), clang, scratch, counter)]

        pieces = []
        for folder, files in sorted(groups.items()):
            pieces += [(folder, files[k:k + BATCH]) for k in range(0, len(files), BATCH)]
        count = units = 0
        for results in pool.map(work, pieces):
            for files, told in results:
                count += files
                units += 1
                findings.update(told)
    for finding in sorted(findings):
        print(finding)
    print(f"{count} files in {units} batches, {len(findings)} findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
