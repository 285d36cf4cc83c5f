// SPDX-License-Identifier: MIT
// Small helpers for the page. Text always goes in as text, never as markup.

/** The element with this id. */
export const byId = (id) => document.getElementById(id);

/** Makes an element: properties, then children (nodes or texts). `class` and `data-*`/`aria-*` are attributes. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key === 'class' || key.includes('-')) element.setAttribute(key, value);
    else element[key] = value;
  }
  element.append(...children);
  return element;
}

/** Sets the text only if it differs, so that nothing flickers and selections stay. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Switches a button or field off, with the reason as its title; on, with `title`, if there is none. */
export function setOff(id, reason, title = '') {
  const element = byId(id);
  element.disabled = reason !== '';
  if (element.title !== (reason || title)) element.title = reason || title;
}

/** A number with `digits` decimals; ∞ and – for what is not finite. Takes the bridge's "inf" and "nan" too. */
export function showNumber(value, digits) {
  if (value === 'inf') return '∞';
  if (value === '-inf') return '−∞';
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace('-', '') : text.replace('-', '−');
}

/** Gives the person a file to keep. */
export function saveFile(name, blob) {
  const link = make('a', {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Says something to the person, for a while. */
let forget;
export function say(text, isError = false) {
  const line = byId('message');
  line.textContent = text;
  line.classList.toggle('error', isError);
  clearTimeout(forget);
  if (text) forget = setTimeout(() => { line.textContent = ''; }, isError ? 20000 : 5000);
}
