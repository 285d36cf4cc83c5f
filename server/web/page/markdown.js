// SPDX-License-Identifier: MIT
// A little Markdown as nodes of the page: paragraphs, lists, **bold**, *italic*, `code` and [links](https://…). No markup of
// the text itself reaches the page.
import {make} from './dom.js';

const INLINE = /`([^`]+)`|\*\*([^*]+)\*\*|\*([^*\s][^*]*)\*|\[([^\]]+)\]\((https?:\/\/[^\s)]+)\)/g;

/** The nodes of one line. */
function inline(text) {
  const nodes = [];
  let end = 0;
  for (const found of text.matchAll(INLINE)) {
    nodes.push(text.slice(end, found.index));
    const [all, code, bold, italic, label, address] = found;
    if (code) nodes.push(make('code', {}, code));
    else if (bold) nodes.push(make('strong', {}, bold));
    else if (italic) nodes.push(make('em', {}, italic));
    else nodes.push(make('a', {href: address, target: '_blank', rel: 'noreferrer'}, label));
    end = found.index + all.length;
  }
  return [...nodes, text.slice(end)].filter((node) => node !== '');
}

/** The elements of a text. */
export function markdown(text) {
  return text.split(/\n\s*\n/).filter((block) => block.trim()).map((block) => {
    const lines = block.split('\n');
    if (!lines.every((line) => line.startsWith('- '))) return make('p', {}, ...inline(lines.join(' ')));
    return make('ul', {}, ...lines.map((line) => make('li', {}, ...inline(line.slice(2)))));
  });
}
