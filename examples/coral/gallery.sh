# The reef of Fig. 7.
grow reef scene-full.yaml
"$program" render "$out/reef" --style coral --size 1400x1000 -o "$out/reef.png"
show reef.png 1400
