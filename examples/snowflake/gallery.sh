# One crystal at print quality; Figs 11 and 13 as sheets.
grow flake scene-full.yaml
"$program" render "$out/flake" --size 1024x1024 -o "$out/flake.png"
spread fig-11 scene.yaml --grid phase.tau_1=1e-3,1e-4,1e-5 --grid diffusion.tau=1e-3,1e-4,1e-5
spread fig-13 scene.yaml --grid phase.form=stable,paper --grid phase.tau_1=0.1,1e-2,1e-3
grow star-full star-full.yaml --precision single
"$program" render "$out/star-full" --size 1080x840 -o "$out/star.png"
for crystal in plate star column; do
  grow $crystal $crystal.yaml
  "$program" render "$out/$crystal" --size 460x400 -o "$out/$crystal.png"
done
convert "$out/plate.png" "$out/star.png" "$out/column.png" +append "$out/space.png"
show flake.png 1024
show space.png 1380 space
show star.png 1080 star
show fig-11/sheet.png 1100 fig-11
show fig-13/sheet.png 1100 fig-13
