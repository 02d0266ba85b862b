# The reef of Fig. 7; with memories and by Fourier's law, early on.
grow reef scene.yaml
"$program" render "$out/reef" --size 1400x950 --set render.camera.zoom=1.3 -o "$out/reef.png"
grow memories scene.yaml --set phase.noise.amplitude=0.12
grow fourier scene.yaml --set phase.noise.amplitude=0.12 --set phase.tau_1=0 --set diffusion.tau=0 --set "title=Coral, Fourier"
"$program" render "$out/memories" "$out/fourier" --frame 4 --columns 2 --size 560x400 --set render.camera.zoom=1.3 -o "$out/laws.png"
show reef.png 1000
show laws.png 1120 laws
