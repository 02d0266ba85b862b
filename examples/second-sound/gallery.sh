# A release in the plane, at its end. See tools/gallery.sh.
grow plane scene.yaml
show plane/preview_000006.png 900
