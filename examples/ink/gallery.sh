# Fig 5: the jet with ever more of Fourier's law, with Fourier's law alone, and without diffusion; and a heavy drop that
# breaks into rings. See tools/gallery.sh.
for f_t in 0 0.25 0.5 0.75 1; do
  grow "jet-f_t-$f_t" scene.yaml --set "diffusion.f_t=$f_t" --set "title='F_T = $f_t'"
done
grow jet-z-fourier scene.yaml --set diffusion.tau=0 --set "title='Fourier'"
grow jet-z-none scene.yaml --set diffusion.k=0 --set "title='No diffusion'"
"$program" sheet "$out"/jet-* -o "$out/jet.png" --columns 7
show jet.png 1600 jet
grow drop drop.yaml --precision single --set points.0.count=2000000
for frame in 3 5 7 9 12; do
  "$program" render "$out/drop" --frame $frame --field points --size 340x640 --set 'render.range=[0, 320]' \
    --set render.camera.zoom=1.3 --set 'render.camera.aim=[0, 0.128, 0]' -o "$out/drop-$(printf %02d $frame).png"
done
convert "$out"/drop-??.png +append "$out/drop.png"
show drop.png 1600
