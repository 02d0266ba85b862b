#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Makes every picture of the gallery, at the quality they are shown in: examples/NAME/gallery.sh says how for its own.
# What is finished is not computed again and what was stopped goes on where it was, so it may be stopped at any time and
# called again. A picture becomes examples/NAME/picture.png (or .jpg, where that is smaller), at most 200 KB.
#
#   tools/gallery.sh [-n] OUT [NAME...]     all examples, or these; the program is $CATTANEO, or cattaneo
#                                           -n: leave examples/ as it is, pictures stay under OUT
#
# For the scripts, which are read by this one ($here: their folder, $out: where to work):
#   grow NAME SCENE [OPTION...]       a run of $here/SCENE in $out/NAME: started, gone on with, or finished already
#   spread NAME SCENE OPTION...       a sweep, likewise
#   show FILE [WIDTH] [NAME]          $out/FILE is the picture (or a further one, NAME), scaled down to WIDTH
set -eu

keep=no
if [ "${1:-}" = -n ]; then keep=yes; shift; fi
if [ $# -lt 1 ]; then echo "usage: tools/gallery.sh [-n] OUT [NAME...]" >&2; exit 2; fi
program=${CATTANEO:-cattaneo}
folder=$1
shift
examples=$(cd "$(dirname "$0")/../examples" && pwd)
limit=200000

command -v convert >/dev/null || { echo "gallery.sh: convert is missing: apt-get install imagemagick" >&2; exit 2; }

grow() {
  name=$1 scene=$2
  shift 2
  if [ -e "$out/$name/run.yaml" ]; then
    "$program" resume "$out/$name" --progress none
  else
    "$program" run "$here/$scene" -o "$out/$name" --progress none "$@"
  fi
}

spread() {
  name=$1 scene=$2
  shift 2
  "$program" sweep "$here/$scene" -o "$out/$name" "$@"
}

# Smaller and smaller until it fits; photographs as JPEG, drawings as PNG.
show() {
  from=$out/$1 width=${2:-1400} to=${3:-picture}
  if [ $keep = yes ]; then return; fi
  rm -f "$here/$to.png" "$here/$to.jpg"
  convert "$from" -resize "${width}x>" -strip -define png:compression-level=9 "$here/$to.png"
  if [ "$(wc -c <"$here/$to.png")" -le $limit ]; then return; fi
  for quality in 92 88 84 80 75 70 60 50; do
    convert "$from" -resize "${width}x>" -strip -sampling-factor 4:4:4 -quality $quality "$here/$to.jpg"
    if [ "$(wc -c <"$here/$to.jpg")" -le $limit ]; then break; fi
  done
  rm "$here/$to.png"
}

for script in "$examples"/*/gallery.sh; do
  here=$(dirname "$script")
  example=$(basename "$here")
  if [ $# -gt 0 ]; then
    case " $* " in *" $example "*) ;; *) continue ;; esac
  fi
  echo "$example"
  out=$folder/$example
  mkdir -p "$out"
  . "$script"
done
