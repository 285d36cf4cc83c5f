// SPDX-License-Identifier: MIT
// Small DOM helpers. Text is always inserted as text, never as markup.

/** The element with this id. */
export const byId = (id) => document.getElementById(id);

/** Makes an element with properties and children (nodes or texts). `class` and `data-*`/`aria-*` are attributes. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key === 'class' || key.includes('-')) element.setAttribute(key, value);
    else element[key] = value;
  }
  element.append(...children);
  return element;
}

/** Sets the text only if it differs, to prevent flicker and keep selections. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Disables a button or field with `reason` as its title; enables it, with `title`, if `reason` is empty. */
export function setOff(id, reason, title = '') {
  const element = byId(id);
  element.disabled = reason !== '';
  if (element.title !== (reason || title)) element.title = reason || title;
}

/** A number with `digits` decimals; ∞ or – if it is not finite. Also accepts the bridge's "inf" and "nan". */
export function showNumber(value, digits) {
  if (value === 'inf') return '∞';
  if (value === '-inf') return '−∞';
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace('-', '') : text.replace('-', '−');
}

/** Downloads `blob` as a file. */
export function saveFile(name, blob) {
  const link = make('a', {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Shows a message for a while. */
let forget;
export function say(text, isError = false) {
  const line = byId('message');
  line.textContent = text;
  line.classList.toggle('error', isError);
  clearTimeout(forget);
  if (text) forget = setTimeout(() => { line.textContent = ''; }, isError ? 20000 : 5000);
}
