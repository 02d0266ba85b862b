#!/bin/bash
# SPDX-License-Identifier: MIT
#
# says.sh REGEX PROGRAM ARGUMENTS...: the program succeeds and the last line it prints is of that form.
set -uo pipefail
expected=$1
shift
if ! said=$("$@"); then
  echo "$1 failed"
  exit 1
fi
echo "$said"
[[ $(tail -n 1 <<<"$said") =~ ^$expected$ ]] || { echo "expected: $expected"; exit 1; }
