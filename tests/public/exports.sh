#!/bin/bash
# SPDX-License-Identifier: MIT
#
# exports.sh NM HEADER LIBRARY PREFIX: the library exports every function of the header's CF_PUBLIC_LIST under the
# prefix, and nothing else; and every function that the header declares is in that list.
set -euo pipefail
export LC_ALL=C
nm=$1 header=$2 library=$3 prefix=$4

listed=$(sed -n '/#define CF_PUBLIC_LIST/,/[^\\]$/p' "$header" | grep -o 'F([a-z0-9_]\+)' | sed 's/F(\(.*\))/\1/' | sort)
declared=$(sed 's|//.*||; /^ \*/d; /^\/\*/d; /typedef/d' "$header" | grep -o '^[a-z].*[ *]cf_[a-z0-9_]\+(' |
  grep -o 'cf_[a-z0-9_]\+($' | sed 's/^cf_//; s/($//' | sort)
exported=$("$nm" -D --defined-only "$library" | awk '{print $NF}' | sed 's/@.*//' | sort)

compare() {
  local difference
  if ! difference=$(diff <(echo "$2") <(echo "$3")); then
    echo "$1"
    echo "$difference"
    exit 1
  fi
}
[ "$(echo "$listed" | wc -l)" -gt 40 ] || { echo "the list of $header was not found"; exit 1; }
compare "declared (<) and listed (>) in $header differ:" "$declared" "$listed"
compare "listed (<) in $header and exported (>) by $library differ:" "$(echo "$listed" | sed "s/^/$prefix/")" "$exported"
echo "$(echo "$listed" | wc -l) functions"
