/* SPDX-License-Identifier: MIT
 *
 * The keys of `render:` in a scene: how `cattaneo render` and `cattaneo movie` show a run. They change nothing that is
 * computed, and can be set anew for every picture: cattaneo render DIR --set render.camera.turn=60.
 */
#ifndef CF_MODEL_RENDER_KEYS_H
#define CF_MODEL_RENDER_KEYS_H

#include "base/param.h"

#define CF_RENDER_STYLE_WORDS(W) \
  W(AUTO, auto)                  \
  W(FIELD, field)                \
  W(INK, ink)                    \
  W(SMOKE, smoke)                \
  W(CRYSTAL, crystal) W(CORAL, coral) W(MESH, mesh) W(GEL, gel) W(PARTICLES, particles) W(CARDS, cards)

#define CF_RENDER_UP_WORDS(W) W(AUTO, auto) W(X, x) W(Y, y) W(Z, z)

#define CF_RENDER_CAMERA_TABLE(P, R)                                                                     \
  P(up, word, "auto", "", CF_WORDS(CF_RENDER_UP_WORDS),                                                  \
    "The axis that is upwards in 3D; auto: the longest one, if one alone is, else z; always z in model " \
    "snowfall")                                                                                          \
  P(turn, number, CF_NONE, "degree", "[-360, 360]",                                                      \
    "Direction it looks from, around z: 0 is from -y, 90 from +x; left out: what suits the style")       \
  P(rise, number, CF_NONE, "degree", "[-90, 90]", "How far above the horizon it stands")                 \
  P(angle, number, CF_NONE, "degree", "(0, 150)", "Angle of view from the lower to the upper edge")      \
  P(zoom, number, "1", "", "(0, 100)",                                                                   \
    "1 shows everything, 2 half of it, from half as far; style crystal, left out: the crystal")          \
  P(aim, numbers, CF_NONE, "m", "3 of (-inf, inf)", "The place it looks at; left out: the middle")       \
  P(eye, numbers, CF_NONE, "m", "3 of (-inf, inf)", "The place it stands at, instead of turn and rise")  \
  P(focus, number, CF_NONE, "m", "(0, inf)", "Distance that is sharp; left out: that of aim")            \
  P(aperture, number, CF_NONE, "m", "[0, inf)", "Diameter of the lens: 0 makes everything sharp")        \
  P(shutter, number, "0", "s", "[0, inf)", "How long it is open: what moves is blurred along its way")

#define CF_RENDER_LIGHT_TABLE(P, R)                                                                        \
  P(turn, number, CF_NONE, "degree", "[-360, 360]", "Direction the main light comes from, as camera.turn") \
  P(rise, number, CF_NONE, "degree", "[-90, 90]", "Its height above the horizon")                          \
  P(strength, number, "1", "", "[0, inf)", "Times what suits the style")                                   \
  P(spread, number, CF_NONE, "degree", "[0, 80]", "Half of the angle that it fills: soft shadows")

#define CF_RENDER_TABLE(P, R)                                                                               \
  P(style, word, "auto", "", CF_WORDS(CF_RENDER_STYLE_WORDS),                                               \
    "field: a plane in colours with axes; ink: in a white tank; smoke: under lights; crystal: a flat one "  \
    "between two coloured lights; coral: a surface under water; mesh: in a studio; gel: translucent; "      \
    "particles: balls; cards: flakes and snow; auto: what suits the model")                                 \
  P(field, text, "", "", "",                                                                                \
    "What is shown, or colours a surface; left out: that of output.preview. Styles field, ink and smoke "   \
    "show `points` as "                                                                                     \
    "the density they have")                                                                                \
  P(surface, text, "", "", "",                                                                              \
    "The field whose surface is shown where the run wrote no mesh; left out: output.preview.field")         \
  P(level, number, "0.5", "", "(-inf, inf)", "The value of that field on the surface")                      \
  P(size, integers, CF_NONE, "", "2 of [16, 16384]",                                                        \
    "Width and height in pixels; left out: 1280 and 720, or with style field the shape of the plane")       \
  P(samples, integer, "16", "", "[1, 65536]", "Rays a pixel at most: noise falls with their root")          \
  P(noise, number, "0.01", "", "[0, 1]",                                                                    \
    "Where the noise is below that, in parts of white, a pixel takes no more rays; 0: all take all")        \
  P(range, numbers_or_auto, "auto", "", "2 of (-inf, inf)",                                                 \
    "Values at the ends of the colours, or of clear and densest; auto: of all frames that are shown")       \
  P(map, text, "", "", "", "The colour map; left out: what suits the style")                                \
  P(strength, number, CF_NONE, "", "(0, inf)",                                                              \
    "Ink, smoke: optical depth of a tenth of the box at the upper end of range; crystal: times the relief") \
  P(colour, numbers, CF_NONE, "", "3 of [0, 1]",                                                            \
    "Red, green, blue: what ink lets through, what smoke and surfaces send back")                           \
  P(background, numbers, CF_NONE, "", "3 of [0, 1]", "Red, green, blue of what lies behind")                \
  P(exposure, number, "0", "", "[-20, 20]", "Stops: 1 doubles the light")                                   \
  P(floor, flag, "true", "", "", "Surfaces and particles stand on a floor")                                 \
  P(contours, integer, "0", "", "[0, 100]", "Style field: lines of equal value")                            \
  P(arrows, text, "", "", "", "Style field: a vector field drawn as arrows over it")                        \
  P(plot, texts, CF_NONE, "", "", "Columns of metrics.csv, drawn as curves in a corner")                    \
  R(record, camera, cf_scene_camera, "Where it is seen from")                                               \
  R(record, light, cf_scene_light, "The main light")

typedef struct cf_scene_camera {
  CF_PARAM_MEMBERS(CF_RENDER_CAMERA_TABLE)
} cf_scene_camera;
typedef struct cf_scene_light {
  CF_PARAM_MEMBERS(CF_RENDER_LIGHT_TABLE)
} cf_scene_light;
typedef struct cf_scene_render {
  CF_PARAM_MEMBERS(CF_RENDER_TABLE)
} cf_scene_render;

#endif
