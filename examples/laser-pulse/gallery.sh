# A laser spot after 10 s, Cattaneo beside Fourier. See tools/gallery.sh.
spread spot scene.yaml --grid 'diffusion.tau=16 s,0 s'
show spot/sheet.png 1400
