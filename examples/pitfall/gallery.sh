# Appendix A: the same release with the flux carried along, and left behind. See tools/gallery.sh.
spread flux-rate scene.yaml --grid diffusion.flux_rate=objective,partial
show flux-rate/sheet.png 1400
