// SPDX-License-Identifier: MIT
// A long list of which only the rows near the visible part exist. Rows are equally high, but for a few.

const MARGIN_PX = 300;  // beyond the visible part
const SHORT = 64;       // rows, of which all exist

export class VirtualList {
  #root;
  #rowOf;
  #count = 0;
  #shown = [0, 0];
  #usual_px = 40;
  #tall = new Map();  // rows of another height, by number: px more than usual

  /** `rowOf(number)`: the element of a row, the same each time while it is shown. */
  constructor(root, rowOf) {
    this.#root = root;
    this.#rowOf = rowOf;
  }

  /** Shows `count` rows, whose heights are unknown. */
  reset(count) {
    this.#count = count;
    this.#tall.clear();
  }

  set count(count) { this.#count = count; }

  /** Where row `number` begins, px from the upper end. */
  #top(number) {
    let top = number * this.#usual_px;
    for (const [row, more] of this.#tall) top += row < number ? more : 0;
    return top;
  }

  /** The first row whose end is below `y`. */
  #at(y) {
    let low = 0, high = this.#count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.#top(middle + 1) > y) high = middle;
      else low = middle + 1;
    }
    return low;
  }

  /** Shows the rows near the visible part, after each scroll and change; the numbers of the first, and of the one after the last. */
  place() {
    const box = this.#root.getBoundingClientRect();
    if (box.width === 0) return this.#shown;  // in a hidden tab
    const all = this.#count <= SHORT, first = all ? 0 : this.#at(-box.top - MARGIN_PX);
    const end = all ? this.#count : Math.min(this.#count, this.#at(innerHeight - box.top + MARGIN_PX) + 1);
    const rows = [];
    for (let number = first; number < end; ++number) rows.push(this.#rowOf(number));
    const wanted = new Set(rows);
    for (const child of [...this.#root.children]) if (!wanted.has(child)) child.remove();
    rows.forEach((row, i) => { if (this.#root.children[i] !== row) this.#root.insertBefore(row, this.#root.children[i] ?? null); });
    const heights = rows.map((row) => row.getBoundingClientRect().height);
    this.#usual_px = heights.length > 0 ? Math.min(...heights) : this.#usual_px;
    heights.forEach((height, i) => {
      if (height - this.#usual_px > 1) this.#tall.set(first + i, height - this.#usual_px);
      else this.#tall.delete(first + i);
    });
    this.#root.style.paddingTop = `${this.#top(first)}px`;
    this.#root.style.paddingBottom = `${Math.max(0, this.#top(this.#count) - this.#top(end))}px`;
    return this.#shown = [first, end];
  }

  /** Scrolls to row `number`. */
  reveal(number) {
    const box = this.#root.getBoundingClientRect();
    let scroller = this.#root.parentElement;
    while (scroller && !(scroller.scrollHeight > scroller.clientHeight && /auto|scroll/.test(getComputedStyle(scroller).overflowY))) scroller = scroller.parentElement;
    (scroller ?? document.scrollingElement).scrollBy(0, box.top + this.#top(number) - innerHeight / 3);
  }
}
