#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Figs 3 and 4 of the paper: four streams without Fourier diffusion, then ever more of it in the fastest.
# usage: demo.sh [FOLDER]; the program is $CATTANEO, or cattaneo.
set -eu
program=${CATTANEO:-cattaneo}
out=${1:-out/cone}
here=$(dirname "$0")

run() { # NAME SCENE [--set KEY=VALUE]...
  name=$1
  scene=$2
  shift 2
  echo "  $name"
  "$program" run "$here/$scene" -o "$out/$name" --force --progress none "$@"
}

echo "Streams from as fast as the front to twice as fast (Fig 3):"
run hc-1.00 hc-1.yaml
run hc-1.15 hc-1.15.yaml
run hc-1.41 hc-1.41.yaml
run hc-2.00 scene.yaml
echo "The fastest stream, with a growing share of Fourier's law (Fig 4):"
for f_t in 0.25 0.5 0.75 1; do
  run "hc-2.00-ft-$f_t" scene.yaml --set "diffusion.f_t=$f_t" --set "title=Share of Fourier F_T = $f_t"
done

"$program" sheet "$out"/hc-?.?? "$out"/hc-2.00-ft-* -o "$out/sheet.png" --columns 4 > /dev/null

echo
echo "All last frames at once: $out/sheet.png"
echo "Pictures, one a frame:   $out/*/preview_*.png"
echo "Data for ParaView:       $out/*/fields.vtkhdf.series"
echo "A line a step:           $out/*/metrics.csv"
