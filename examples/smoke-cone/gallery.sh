# Fig 6: three winds, and Fourier's law in the middle one, in one scale. See tools/gallery.sh.
grow wind-1 scene.yaml --set let.H=1.41421356 --set "title='H_c = sqrt 2: 45 degrees'"
grow wind-2 scene.yaml --set "title='H_c = 2: 30 degrees'"
grow wind-3 scene.yaml --set let.H=3 --set "title='H_c = 3: 19.5 degrees'"
grow wind-4 scene.yaml --set diffusion.tau=0 --set "title='Fourier'"
"$program" sheet "$out"/wind-? -o "$out/sheet.png" --columns 2
show sheet.png 960
