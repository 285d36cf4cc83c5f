// SPDX-License-Identifier: MIT
// Reads the texts out of the page's sources: those that words.js translates, and those that look as if it should. A simple scan
// of tokens, not a parser: it knows strings, templates, comments, regular expressions and brackets.
import {readdirSync, readFileSync} from 'node:fs';

export const PAGE = new URL('../../server/web/page/', import.meta.url);
export const read = (name) => readFileSync(new URL(name, PAGE), 'utf8');
const named = (pattern) => readdirSync(PAGE).filter((name) => pattern.test(name));

/** What a reader sees among the arguments of a function: from the first to the last. */
const SEEN = {make: [2, Infinity], setText: [1, 1], setLabel: [1, 1], say: [0, 0], '#say': [0, 0], confirmed: [0, 2], setOff: [1, 2], iconButton: [1, 1], addTool: [0, 1],
  append: [0, Infinity], prepend: [0, Infinity], replaceChildren: [0, Infinity], button: [1, 2]};
const SEEN_KEYS = /(?:^|[\s{,])(?:title|placeholder|alt|'aria-label'|textContent|text)\s*[:=]\s*$/;
const SEEN_PROPERTIES = /\.(?:title|placeholder|alt|textContent|innerText)\s*=\s*$/;

const unescaped = (text) => text.replace(/\\u([\da-f]{4})/gi, (_, code) => String.fromCharCode(parseInt(code, 16)))
  .replace(/\\(.)/g, (_, char) => ({n: '\n', t: '\t', r: '\r'}[char] ?? char));

/** The tokens of a script: {kind: 'text', value, at} for strings and parts of templates, {kind: 'mark', value, at} for brackets and
 *  commas, 'code' for all else. */
function tokens(source) {
  const found = [], templates = [];
  let at = 0;
  const template = (from) => {  // up to its end or the next ${
    let end = from;
    while (source[end] !== '`' && !(source[end] === '$' && source[end + 1] === '{')) end += source[end] === '\\' ? 2 : 1;
    found.push({kind: 'text', value: unescaped(source.slice(from, end)), at: from, template: true});
    if (source[end] === '`') return end + 1;
    templates.push(0);
    found.push({kind: 'mark', value: '${', at: end});
    return end + 2;
  };
  while (at < source.length) {
    const char = source[at], rest = source.slice(at, at + 2);
    if (rest === '//') at = (source.indexOf('\n', at) + source.length + 1) % (source.length + 1) || source.length;
    else if (rest === '/*') at = source.indexOf('*/', at) + 2;
    else if (char === '\'' || char === '"') {
      let end = at + 1;
      while (source[end] !== char) end += source[end] === '\\' ? 2 : 1;
      found.push({kind: 'text', value: unescaped(source.slice(at + 1, end)), at});
      at = end + 1;
    } else if (char === '`') {
      at = template(at + 1);
    } else if (char === '/' && /(?:^|[(,=:[!&|?{};\n]|return|=>)\s*$/.test(source.slice(Math.max(0, at - 20), at))) {
      let end = at + 1, inClass = false;
      for (; inClass || source[end] !== '/'; ++end) {
        if (source[end] === '\\') ++end;
        else if (source[end] === '[') inClass = true;
        else if (source[end] === ']') inClass = false;
      }
      at = end + 1;
    } else if (char === '}' && templates.at(-1) === 0) {
      templates.pop();
      found.push({kind: 'mark', value: '}', at});
      at = template(at + 1);
    } else {
      if (templates.length > 0 && char === '{') ++templates[templates.length - 1];
      if (templates.length > 0 && char === '}') --templates[templates.length - 1];
      if ('()[]{},'.includes(char)) found.push({kind: 'mark', value: char, at});
      ++at;
    }
  }
  return found;
}

/** Words of a text that somebody could read: not a name of a class, a command or a unit. */
const isWords = (text) => /\p{L}{2}/u.test(text) && !/^[\s\d.,:;·×/|°²−–()-]*(?:m|s|ms|kg|N|W|rad|cm|rad\/s|m\/s|m\/s²|N m|rtf)?[\s)]*$/u.test(text);
const isSentence = (text) => /^\s*[A-Z][a-z]+(?:$|[\s:,.!?])/.test(text) || /[A-Za-z]{2,}[:;,]? [a-z]{2,} [a-z]/.test(text);

/** {keys, loose}: the texts that t() and plural() look up in a script, and [line, text] of those that a reader sees without. */
export function textsOf(name, source = read(name)) {
  const keys = new Set(), loose = [], open = [];
  for (const {kind, value, at, template} of tokens(source)) {
    const top = open.at(-1);
    if (kind === 'mark' && '([{${'.includes(value)) {
      const [, callee = ''] = value === '(' ? /([#\w$]+)$/.exec(source.slice(Math.max(0, at - 40), at)) ?? [] : [];
      open.push({bracket: value, callee, argument: 0});
    } else if (kind === 'mark' && value === ',') {
      if (top) ++top.argument;
    } else if (kind === 'mark') {
      open.pop();
    } else if (top?.callee === 't' && top.argument === 0 && !template) {
      keys.add(value);
    } else if (top?.callee === 'plural' && (top.argument === 1 || top.argument === 2)) {
      keys.add(value);
    } else if (isWords(value)) {
      const before = source.slice(Math.max(0, at - 60), at).replace(/`$/, '');
      const call = open.findLast(({bracket, callee}) => bracket === '(' && callee !== '');
      const inner = open.slice(open.indexOf(call) + 1).every(({bracket}) => bracket !== '{');
      const [first, last] = SEEN[call?.callee] ?? [1, 0];
      const seen = (inner && call?.argument >= first && call?.argument <= last) || SEEN_KEYS.test(before) || SEEN_PROPERTIES.test(before);
      if (seen || isSentence(value)) loose.push([source.slice(0, at).split('\n').length, value]);
    }
  }
  return {keys: [...keys], loose};
}

/** The scripts of the page, without the tables of texts. */
export const scripts = () => named(/\.js$/).filter((name) => !/^words_/.test(name));
export const documents = () => named(/\.html$/);
export const styles = () => named(/\.css$/);

/** The texts of an HTML file, as words.js translates them: not inside translate="no". */
export function textsOfHtml(name, source = read(name)) {
  const texts = new Set(), off = [];
  const html = source.replace(/<!--.*?-->/gs, '').replace(/<svg hidden>.*?<\/svg>/s, '');
  for (const [, end, tag, attributes, text] of html.matchAll(/<(\/?)([\w!]+)([^>]*)>([^<]*)/g)) {
    const isVoid = /^(?:input|img|br|meta|link|path|rect|circle|use|!doctype)$/.test(tag) || attributes.endsWith('/');
    if (end) off.pop();
    const isOff = off.at(-1) === true || /translate="no"/.test(attributes);
    if (!end && !isVoid) off.push(isOff);
    if (!end && !isOff) for (const [, value] of attributes.matchAll(/\s(?:title|aria-label|placeholder|alt)="([^"]*)"/g)) texts.add(value.trim());
    if (off.at(-1) !== true) texts.add(text.trim());
  }
  // A command is an example of the protocol.
  return [...texts].map((text) => text.replace(/\s+/g, ' ')).filter((text) => /\p{L}{2}/u.test(text) && !/^[a-z]+_[a-z]/.test(text));
}

/** The table of a language: {English: text or [one, many]}. */
export const tableOf = async (language) => (await import(new URL(`words_${language}.js`, PAGE))).default;
