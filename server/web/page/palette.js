// SPDX-License-Identifier: MIT
// How colours are shown. The words of scenarios (red, blue, …) mean pure colours, which glare on a screen and which colour-blind eyes
// confuse; views show calm ones instead, whose lightness differs, too. All other colours are shown as written. sRGB, 0 to 1. The
// daemon's pictures use the same: server/render/palette.h.

const SHOWN = [
  [[1, 0, 0], [0.74, 0.20, 0.19]],        // red
  [[0, 0.8, 0], [0.20, 0.67, 0.31]],      // green
  [[0, 0, 1], [0.18, 0.44, 0.78]],        // blue
  [[1, 1, 0], [0.96, 0.85, 0.38]],        // yellow
  [[1, 0, 1], [0.76, 0.38, 0.60]],        // magenta
  [[0, 1, 1], [0.45, 0.80, 0.90]],        // cyan
  [[1, 0.55, 0], [0.90, 0.52, 0.18]],     // orange
  [[0.5, 0, 0.7], [0.37, 0.22, 0.50]],    // purple
  [[0.55, 0.27, 0.07], [0.52, 0.36, 0.24]],  // brown
  [[1, 0.6, 0.75], [0.92, 0.70, 0.76]],   // pink
  [[0.6, 1, 0], [0.64, 0.78, 0.30]],      // lime
  [[0, 0, 0.5], [0.16, 0.23, 0.43]],      // navy
  [[0, 0.5, 0.5], [0.16, 0.52, 0.53]],    // teal
  [[0.5, 0, 0], [0.48, 0.18, 0.21]],      // maroon
  [[1, 0.84, 0], [0.86, 0.70, 0.28]],     // gold
  [[0.56, 0, 1], [0.51, 0.38, 0.79]],     // violet
  [[0.2, 0.4, 0.9], [0.25, 0.46, 0.78]],  // of robots without a colour
];
const CLOSE = 1e-3;

const matches = (a, b) => a.every((part, i) => Math.abs(part - b[i]) < CLOSE);

/** The colour with which `rgb` is shown. */
export const shownColor = (rgb) => SHOWN.find(([written]) => matches(written, rgb))?.[1] ?? rgb;

const FLOOR = [0.85, 0.85, 0.85];  // of scenarios that give none

/** A floor's colour; one that the scenario does not give suits the theme. */
export const floorColor = (rgb, dark) => (!matches(rgb, FLOOR) ? shownColor(rgb) : dark ? [0.36, 0.385, 0.42] : [0.74, 0.76, 0.78]);
