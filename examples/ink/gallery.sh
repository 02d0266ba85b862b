# Fig 5: the jet with ever more of Fourier's law, with Fourier's law alone, and without diffusion, in the middle of its tank;
# and a heavy drop that becomes a crown of smaller ones. See tools/gallery.sh.
jet() {
  name=$1
  shift
  grow "$name" scene.yaml --precision single --set 'domain.size=[3, 6.5, 3]' --set 'domain.cells=[48, 104, 48]' \
    --set 'domain.origin=[0.5, 0, 0.5]' --set time.end=13 --set time.frames=0.5 --set sparse.follow=on "$@"
}
for f_t in 0 0.25 0.5 0.75; do # 1 is Fourier's law
  jet "jet-f_t-$f_t" --set "diffusion.f_t=$f_t" --set "title='F_T = $f_t'"
done
jet jet-z-fourier --set diffusion.tau=0 --set "title='Fourier'"
jet jet-z-none --set diffusion.k=0 --set "title='No diffusion'"
"$program" render "$out"/jet-f* "$out"/jet-z* --style ink --columns 6 --size 260x560 --set 'render.range=[0, 0.6]' \
  --set render.camera.zoom=1.25 --set 'render.camera.aim=[2, 3.6, 2]' -o "$out/six.png"
show six.png 1600 jet
grow drop drop.yaml --precision single --set points.0.count=1000000
for frame in 2 4 6 8 10 12; do
  "$program" render "$out/drop" --frame $frame --field points --size 280x500 --set 'render.range=[0, 500]' \
    --set render.camera.rise=15 --set render.camera.zoom=1.5 --set 'render.camera.aim=[0, 0.025, 0]' -o "$out/drop-$(printf %02d $frame).png"
done
convert "$out"/drop-??.png +append "$out/drop.png"
show drop.png 1680
