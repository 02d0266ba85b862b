# Two memories side by side.
grow waves scene.yaml --set "title=Dendrite, Cattaneo"
grow fourier scene.yaml --set phase.tau_1=0 --set diffusion.tau=0 --set "title=Dendrite, Fourier"
"$program" sheet "$out/waves" "$out/fourier" -o "$out/sheet.png" --columns 2
show sheet.png 1400
