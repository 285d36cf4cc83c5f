// SPDX-License-Identifier: MIT
// A text field for scenarios: CodeMirror with completion and marks. It lives in a shadow root, which allows its own styles.
import {acceptCompletion, autocompletion, completionKeymap} from '@codemirror/autocomplete';
import {defaultKeymap, history, historyKeymap, isolateHistory} from '@codemirror/commands';
import {lintGutter, lintKeymap, setDiagnostics} from '@codemirror/lint';
import {EditorState} from '@codemirror/state';
import {Decoration, drawSelection, EditorView, highlightActiveLine, keymap, lineNumbers, MatchDecorator, ViewPlugin} from '@codemirror/view';
import {LOOK} from './code_look.js';
import {GRAMMAR, kindOf, TEMPLATES} from './grammar.js';
import {t} from './words.js';

const SECTION = /^\s*\[([^\]]*)\]?/;

const colored = (regexp, className) => {
  const matcher = new MatchDecorator({regexp, decoration: Decoration.mark({class: className})});
  return ViewPlugin.define((view) => ({
    decorations: matcher.createDeco(view),
    update(update) { this.decorations = matcher.updateDeco(update, this.decorations); },
  }), {decorations: (plugin) => plugin.decorations});
};

/** The kind of the section at position `at`; empty before the first. */
function sectionAt(state, at) {
  for (let line = state.doc.lineAt(at).number; line > 0; --line) {
    const found = SECTION.exec(state.doc.line(line).text);
    if (found) return kindOf(found[1]);
  }
  return '';
}

/** Completions for the word before the cursor. `names`: {robots, worlds}. `validFor`: as long as the word matches it, typing
 *  narrows the list at once; otherwise the list cannot be chosen from until it is asked for again. */
export function completionsAt(context, names) {
  const line = context.state.doc.lineAt(context.pos), before = line.text.slice(0, context.pos - line.from);
  if (/[#;]/.test(before)) return null;
  if (/^\s*(\[[\w-]*)?$/.test(before) && (before.includes('[') || sectionAt(context.state, line.from) === '')) {
    const from = line.from + (before.indexOf('[') < 0 ? before.length : before.indexOf('['));
    return {from, validFor: /^\[?[\w-]*$/, options: TEMPLATES.map(([name, first]) => ({label: `[${name}]`, type: 'class', apply: `[${name}]\n${first}\n`, detail: first.split('\n')[0]}))};
  }
  const words = GRAMMAR[sectionAt(context.state, context.pos)];
  if (!words) return null;
  const key = /^\s*([\w-]*)$/.exec(before);
  if (key) {
    if (key[1] === '' && !context.explicit) return null;
    return {from: context.pos - key[1].length, validFor: /^[\w-]*$/, options: Object.entries(words).map(([label, [help, example]]) =>
      ({label, type: 'property', info: `${help}\n${example}`, apply: `${label.padEnd(9)} `}))};
  }
  const value = /^\s*([\w-]+)\s+([\w.-]*)$/.exec(before);
  if (!value) return null;
  const kind = sectionAt(context.state, context.pos);
  const choices = value[1] === 'file' ? names.worlds
    : value[1] === 'type' && (kind === 'ROBOT' || kind === 'SWARM') ? names.robots : words[value[1]]?.[2];
  if (!choices) return null;
  return {from: context.pos - value[2].length, validFor: /^[\w.-]*$/, options: choices.map((label) => ({label, type: 'enum'}))};
}

const SCENARIO_LOOK = EditorView.theme({
  '.section': {color: 'var(--accent)', fontWeight: '650'},
  '.comment, .comment *': {color: 'var(--quiet) !important', fontStyle: 'italic'},
  '.key': {color: 'var(--good)'},
});

export class CodeView {
  #view;

  constructor(host, text, names, onChange) {
    const root = host.attachShadow({mode: 'open'});
    const state = EditorState.create({doc: text, extensions: [
      LOOK, SCENARIO_LOOK, lineNumbers(), history(), drawSelection(), highlightActiveLine(), lintGutter(),
      colored(/^\s*\[[^\]]*\]/gm, 'section'), colored(/(^|\s)[#;].*$/gm, 'comment'), colored(/^\s*[A-Za-z_]\w*(?=\s)/gm, 'key'),
      autocompletion({override: [(context) => completionsAt(context, names)], icons: false, interactionDelay: 0}),
      keymap.of([{key: 'Tab', run: acceptCompletion}, ...completionKeymap, ...lintKeymap, ...historyKeymap, ...defaultKeymap]),
      EditorView.contentAttributes.of({'aria-label': t('Text of the scenario'), spellcheck: 'false'}),
      EditorView.updateListener.of((update) => { if (update.docChanged) onChange(); }),
    ]});
    this.#view = new EditorView({state, parent: root, root});
  }

  get text() { return this.#view.state.doc.toString(); }
  get view() { return this.#view; }

  /** Replaces the text; undo restores the previous one. */
  replace(text) {
    this.#view.dispatch({changes: {from: 0, to: this.#view.state.doc.length, insert: text}, selection: {anchor: 0}, scrollIntoView: true,
      annotations: isolateHistory.of('full')});  // a separate undo step, however soon after another change
  }

  /** Marks lines: [{line, severity, text}]. */
  mark(diagnostics) {
    const {doc} = this.#view.state;
    this.#view.dispatch(setDiagnostics(this.#view.state, diagnostics.map(({line: number, severity, text}) => {
      const line = doc.line(Math.min(Math.max(1, number), doc.lines));
      return {from: line.from + (/^\s*/.exec(line.text)[0].length % (line.length + 1)), to: line.to, severity, message: text};
    })));
  }
}
