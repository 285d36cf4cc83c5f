// SPDX-License-Identifier: MIT
// How many tiles of the wall stand in a row. Pure.

const BEST_ASPECT = 1.5;  // of a tile
const LEAST_HEIGHT_PX = 110, LEAST_WIDTH_PX = 150;
const SCROLLED_WIDTH_PX = 190;  // at least, of tiles that do not fit together

/** Columns and rows for `count` tiles in a room of this size, so that they are large and of good shape. `scrolls`: they do not fit. */
export function gridFor(count, width, height, gap) {
  let best = {columns: 1, rows: count, size: 0, scrolls: true};
  for (let columns = 1; columns <= count; ++columns) {
    const rows = Math.ceil(count / columns);
    const w = (width - gap * (columns - 1)) / columns, h = (height - gap * (rows - 1)) / rows;
    if (columns > 1 && (w < LEAST_WIDTH_PX || h < LEAST_HEIGHT_PX)) continue;
    if (h < LEAST_HEIGHT_PX) continue;
    const size = Math.min(w, h * BEST_ASPECT);
    if (size > best.size) best = {columns, rows, size, scrolls: false};
  }
  if (best.scrolls) best.columns = Math.max(1, Math.floor((width + gap) / (SCROLLED_WIDTH_PX + gap)));
  return best;
}
