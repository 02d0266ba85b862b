# Figs 3 and 4: four streams without Fourier diffusion, then ever more of it in the fastest. See tools/gallery.sh.
grow hc-1.00 hc-1.yaml
grow hc-1.15 hc-1.15.yaml
grow hc-1.41 hc-1.41.yaml
grow hc-2.00 scene.yaml
for f_t in 0.25 0.5 0.75 1; do
  grow "hc-2.00-ft-$f_t" scene.yaml --set "diffusion.f_t=$f_t" --set "title=Share of Fourier F_T = $f_t"
done
"$program" sheet "$out"/hc-?.?? "$out"/hc-2.00-ft-* -o "$out/sheet.png" --columns 4
show sheet.png 1400
