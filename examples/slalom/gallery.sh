# A front and plain diffusion around the same plates. See tools/gallery.sh.
grow slalom scene.yaml
for field in wave fourier; do
  "$program" render "$out/slalom" --frame 10 --field $field -o "$out/$field.png"
done
convert "$out/wave.png" "$out/fourier.png" -append "$out/both.png"
show both.png 1200
