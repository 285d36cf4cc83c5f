// SPDX-License-Identifier: MIT
// The language of the page. The English texts in the code and in the HTML are the keys of a table for each other language,
// words_LANGUAGE.js, which is loaded before any other module runs.

const KEPT = 'coopdyn-language';
const TABLES = {en: null, de: () => import('./words_de.js'), pt: () => import('./words_pt.js'), es: () => import('./words_es.js')};
const TEXTS = ['title', 'aria-label', 'placeholder', 'alt'];  // attributes that are read or heard

const known = (name) => Object.hasOwn(TABLES, name);

/** The language kept in this browser, else the first of the browser's that there is, else English. */
function chosenLanguage() {
  try {
    const kept = localStorage.getItem(KEPT);
    if (known(kept)) return kept;
  } catch { /* no storage: as the browser says */ }
  return (globalThis.navigator?.languages ?? []).map((tag) => tag.toLowerCase().split('-')[0]).find(known) ?? 'en';
}

/** 'en', 'de', 'pt' or 'es'. */
export const language = globalThis.document ? chosenLanguage() : 'en';

const table = await TABLES[language]?.().then((made) => made.default).catch(() => null) ?? {};  // without its table, the page is in English

/** `text` in the page's language, with `values` in the places of {name}. Where a language has two forms for what is one text in English,
 *  `values.count` chooses. */
export function t(text, values) {
  const found = table[text] ?? text;
  const said = Array.isArray(found) ? found[(values?.count ?? 1) === 1 ? 0 : 1] : found;
  return values ? said.replace(/\{(\w+)\}/g, (place, name) => values[name] ?? place) : said;
}

/** t() of the text for one or for many; {count} is among the values. */
export const plural = (count, one, many, values = {}) => t(count === 1 ? one : many, {count, ...values});

/** Translates the texts and attributes of an element, except inside translate="no". */
function translate(element) {
  if (element.getAttribute('translate') === 'no') return;
  for (const name of TEXTS) {
    if (element.hasAttribute(name)) element.setAttribute(name, t(element.getAttribute(name)));
  }
  for (const node of element.childNodes) {
    const text = node.nodeType === Node.TEXT_NODE ? node.data.trim().replace(/\s+/g, ' ') : '';
    if (text) node.data = `${/^\s*/.exec(node.data)[0]}${t(text)}${/\s*$/.exec(node.data)[0]}`;
    else if (node.nodeType === Node.ELEMENT_NODE) translate(node);
  }
}

/** The list of languages: a choice is kept, and the page opens again in it. */
function listenToChoice() {
  const select = document.getElementById('language');
  if (!select) return;
  select.value = language;
  select.addEventListener('change', () => {
    try { localStorage.setItem(KEPT, select.value); } catch { return; }  // it could not be kept
    location.reload();
  });
}

if (globalThis.document) {
  document.documentElement.lang = language;
  if (language !== 'en') translate(document.documentElement);
  document.documentElement.removeAttribute('data-words');  // which hides the page
  listenToChoice();
}
