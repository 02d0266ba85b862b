# Fig 2: the slab by Cattaneo's law and by Fick's, at the same time. See tools/gallery.sh.
grow cattaneo scene.yaml
grow fick scene.yaml --set diffusion.tau=0 --set "title=The same by Fick's law"
"$program" render "$out/cattaneo" "$out/fick" --style gel --frame 4 --size 1000x700 -o "$out/both.png"
show both.png 1600
