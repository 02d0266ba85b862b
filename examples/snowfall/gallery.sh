# Fig 1: twelve crystals grown by ../snowflake become flakes; they fall by dusk; three of them from close by, of the same
# moment. The small atlas of the scene is made of the same crystals. See tools/gallery.sh.
for scene in "$here"/../snowflake/flakes/*.yaml; do
  flake=$(basename "$scene" .yaml)
  grow "flakes/$flake" "../snowflake/flakes/$flake.yaml"
done
"$program" atlas "$out"/flakes/* -o "$out/atlas" --pixels 512 --force
grow full scene-full.yaml --set "snowfall.atlas=$(cd "$out/atlas" && pwd)/atlas.json"
"$program" render "$out/full" --frame 201 --size 1600x900 -o "$out/wide.png"
show wide.png 1600
# A flake: where it is, how far from the eye, and the angle that it fills.
near() {
  "$program" render "$out/full" --frame 201 --size 600x600 --set "render.camera.aim=$2" --set "render.camera.focus=$3" \
    --set "render.camera.angle=$4" -o "$out/near-$1.png"
}
near 1 "[0.3767, 0.0579, 0.0902]" 0.068 9
near 2 "[0.4151, 0.0480, 0.0781]" 0.052 15
near 3 "[0.3954, 0.0730, 0.1008]" 0.082 4.5
montage "$out"/near-[123].png -tile 3x -geometry 600x600+4+4 -background "#0a1020" "$out/near.png"
show near.png 1400 near
for flake in "$out"/atlas/*.rgba.png; do
  convert "$flake" -background "#0a1020" -flatten "$out/$(basename "$flake" .rgba.png).flat.png"
done
montage "$out"/*.flat.png -tile 6x -geometry 200x200+2+2 -background "#0a1020" "$out/flakes.png"
show flakes.png 1200 flakes
