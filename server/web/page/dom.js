// SPDX-License-Identifier: MIT
// Small DOM helpers. Text is always inserted as text, never as markup.
import {t} from './words.js';

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

/** Sets a button's words beside its icon. */
export const setLabel = (id, text) => setText(byId(id).querySelector('span'), text);

/** An icon of the page's sheet (index.html). */
export function icon(name) {
  const [drawing, use] = ['svg', 'use'].map((tag) => document.createElementNS('http://www.w3.org/2000/svg', tag));
  drawing.setAttribute('class', 'icon');
  drawing.setAttribute('aria-hidden', 'true');
  use.setAttribute('href', `#i-${name}`);
  drawing.append(use);
  return drawing;
}

/** A button with an icon alone; `title` says what it does. */
export function iconButton(name, title, act) {
  const made = make('button', {type: 'button', class: 'small plain', title, 'aria-label': title}, icon(name));
  made.addEventListener('click', act);
  return made;
}

/** Sets the text only if it differs, to prevent flicker and keep selections. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

let nobodyMay = '';

/** From now on setOff() disables everything for this reason. */
export function disableAll(reason) { nobodyMay = reason; }

/** Disables a button or field with `reason` as its title; enables it, with `title`, if `reason` is empty. */
export function setOff(id, why, title = '') {
  const element = byId(id), reason = why || nobodyMay;
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

/** Shows a message for a while; `offer`, {text, act}: with a button. */
let forget;
export function say(text, isError = false, offer = null) {
  const line = byId('message'), button = byId('message-offer');
  line.textContent = text;
  line.classList.toggle('error', isError);
  if (button) button.hidden = !offer || !text;  // the wall offers nothing
  if (offer) {
    button.textContent = offer.text;
    button.onclick = () => {
      say('');
      offer.act();
    };
  }
  clearTimeout(forget);
  if (text) forget = setTimeout(() => say(''), isError || offer ? 20000 : 5000);
}

/** Asks before something that cannot be undone. Resolves to whether it shall be done. */
export function confirmed(question, yes, no = t('Cancel')) {
  return new Promise((resolve) => {
    const dialog = make('dialog', {class: 'question', 'aria-label': question}, make('form', {method: 'dialog'}, make('p', {}, question),
      make('div', {class: 'row'}, make('button', {value: 'no'}, no), make('button', {value: 'yes', class: 'danger'}, yes))));
    dialog.addEventListener('close', () => {
      dialog.remove();
      resolve(dialog.returnValue === 'yes');
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}
