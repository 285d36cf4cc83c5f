// SPDX-License-Identifier: MIT
// A text field for Python: CodeMirror with colours and indentation. It lives in a shadow root, which allows its own styles.
import {autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap} from '@codemirror/autocomplete';
import {defaultKeymap, history, historyKeymap, indentWithTab, isolateHistory} from '@codemirror/commands';
import {python} from '@codemirror/lang-python';
import {bracketMatching, HighlightStyle, indentOnInput, indentUnit, syntaxHighlighting} from '@codemirror/language';
import {lintGutter, setDiagnostics} from '@codemirror/lint';
import {Annotation, EditorState} from '@codemirror/state';
import {drawSelection, EditorView, highlightActiveLine, highlightSpecialChars, keymap, lineNumbers} from '@codemirror/view';
import {tags} from '@lezer/highlight';
import {LOOK} from './code_look.js';
import {t} from './words.js';

const ours = Annotation.define();  // changes that are not the student's
const COLOURS = syntaxHighlighting(HighlightStyle.define([
  {tag: tags.comment, color: 'var(--quiet)', fontStyle: 'italic'},
  {tag: [tags.keyword, tags.operatorKeyword, tags.controlKeyword, tags.definitionKeyword, tags.moduleKeyword, tags.bool, tags.null], color: 'var(--accent)', fontWeight: '600'},
  {tag: [tags.string, tags.special(tags.string)], color: 'var(--good)'},
  {tag: tags.number, color: 'var(--warn)'},
  {tag: tags.invalid, color: 'var(--bad)'},
]));

export class PythonView {
  #view;

  /** `onChange`: the student has changed the text. */
  constructor(host, text, readOnly, onChange) {
    const root = host.attachShadow({mode: 'open'});
    const state = EditorState.create({doc: text, extensions: [
      LOOK, COLOURS, lineNumbers(), history(), drawSelection(), highlightActiveLine(), highlightSpecialChars(), lintGutter(), python(), indentUnit.of('    '), EditorState.tabSize.of(4),
      indentOnInput(), bracketMatching(), closeBrackets(), autocompletion({icons: false}),
      keymap.of([...closeBracketsKeymap, ...completionKeymap, ...historyKeymap, ...defaultKeymap, indentWithTab]),
      EditorState.readOnly.of(readOnly),
      EditorView.contentAttributes.of({'aria-label': t('Your program. Escape, then Tab, leaves the field'), spellcheck: 'false'}),
      EditorView.updateListener.of((update) => {
        if (update.docChanged && !update.transactions.some((one) => one.annotation(ours))) onChange();
      }),
    ]});
    this.#view = new EditorView({state, parent: root, root});
  }

  get text() { return this.#view.state.doc.toString(); }
  get view() { return this.#view; }

  /** Replaces the text, which is not the student's change; undo restores the previous one. */
  replace(text) {
    text = text.replace(/\r\n?/g, '\n');  // as the document counts
    const {head} = this.#view.state.selection.main;
    this.#view.dispatch({changes: {from: 0, to: this.#view.state.doc.length, insert: text}, selection: {anchor: Math.min(head, text.length)},
      annotations: [ours.of(true), isolateHistory.of('full')]});
  }

  /** Marks a line with what went wrong there; 0: none. */
  mark(number, text) {
    const {doc} = this.#view.state;
    const line = number > 0 && number <= doc.lines ? doc.line(number) : null;
    this.#view.dispatch(setDiagnostics(this.#view.state, line ? [{from: line.from + (/^\s*/.exec(line.text)[0].length % (line.length + 1)), to: line.to, severity: 'error', message: text}] : []));
  }

  /** Goes to a line. */
  show(number) {
    const line = this.#view.state.doc.line(Math.min(Math.max(1, number), this.#view.state.doc.lines));
    this.#view.dispatch({selection: {anchor: line.from, head: line.to}, effects: EditorView.scrollIntoView(line.from, {y: 'center'})});
    this.#view.focus();
  }
}
