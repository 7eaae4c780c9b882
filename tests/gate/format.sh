#!/bin/sh
# SPDX-License-Identifier: MIT
# format.sh CLANG_FORMAT SOURCE_DIR: fails, and names the lines, where a file of ours is not as .clang-format says.
set -eu
format=$1
cd "$2"
find core render ui app tests -name '*.cpp' -o -name '*.h' -o -name '*.inl' | sort |
    xargs "$format" --dry-run --Werror --ferror-limit=3 --style=file
