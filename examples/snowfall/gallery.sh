# Fig 1: twelve crystals grown by ../snowflake become flakes; they fall by dusk; three of them from close by, of the same
# moment. The small atlas of the scene is made of the same crystals. See tools/gallery.sh.
for scene in "$here"/../snowflake/flakes/*.yaml; do
  flake=$(basename "$scene" .yaml)
  grow "flakes/$flake" "../snowflake/flakes/$flake.yaml"
done
"$program" atlas "$out"/flakes/* -o "$out/atlas" --pixels 512 --force
grow full scene-full.yaml --set "snowfall.atlas=$(cd "$out/atlas" && pwd)/atlas.json"
"$program" render "$out/full" --frame 47 --size 1600x900 --set render.samples=64 -o "$out/wide.png"
show wide.png 1600
for flake in "$out"/atlas/*.rgba.png; do
  convert "$flake" -background "#0a1020" -flatten "$out/$(basename "$flake" .rgba.png).flat.png"
done
montage "$out"/*.flat.png -tile 6x -geometry 200x200+2+2 -background "#0a1020" "$out/flakes.png"
show flakes.png 1200 flakes
