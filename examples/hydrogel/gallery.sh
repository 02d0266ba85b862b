# Fig 2: four slabs, soft and stiff, by Cattaneo's law and by Fick's, at the same time; Fig 10: the strip, with its
# curvature. See tools/gallery.sh.
fick="--set diffusion.tau=0"
stiff="--set gel.bodies.0.young=200"
light="--set output.formats=[ply]"
grow cattaneo40 scene.yaml $light
grow fick40 scene.yaml $light $fick --set "title=Soft gel, Fick"
grow cattaneo200 scene.yaml $light $stiff --set "title=Stiff gel, C-F"
grow fick200 scene.yaml $light $stiff $fick --set "title=Stiff gel, Fick"
"$program" render "$out/cattaneo40" "$out/fick40" "$out/cattaneo200" "$out/fick200" --frame 5 --size 800x560 -o "$out/four.png"
show four.png 1600
grow strip strip.yaml
"$program" render "$out/strip" --frame 20 --size 1200x640 -o "$out/strip.png"
show strip.png 1200 strip
