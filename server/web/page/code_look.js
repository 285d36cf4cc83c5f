// SPDX-License-Identifier: MIT
// How text fields of CodeMirror look, in both themes.
import {EditorView} from '@codemirror/view';

export const LOOK = EditorView.theme({
  '&': {height: '100%', color: 'var(--ink)', backgroundColor: 'var(--field)', fontSize: '13px'},
  '.cm-scroller': {fontFamily: 'var(--mono)', lineHeight: '1.5'},
  '.cm-content': {caretColor: 'var(--ink)'},
  '.cm-cursor': {borderLeftColor: 'var(--ink)'},
  '&.cm-focused': {outline: '2px solid var(--accent)', outlineOffset: '-2px'},
  '&.cm-focused .cm-selectionBackground, .cm-selectionBackground': {backgroundColor: 'color-mix(in srgb, var(--accent) 25%, transparent) !important'},
  '.cm-gutters': {backgroundColor: 'var(--field)', color: 'var(--quiet)', borderRight: '1px solid var(--line)'},
  '.cm-activeLine': {backgroundColor: 'color-mix(in srgb, var(--accent) 7%, transparent)'},
  '.cm-tooltip': {backgroundColor: 'var(--raised)', color: 'var(--ink)', border: '1px solid var(--line)'},
  '.cm-tooltip.cm-completionInfo': {whiteSpace: 'pre-line'},
  '.cm-tooltip-autocomplete ul li[aria-selected]': {backgroundColor: 'var(--accent)', color: 'var(--on-accent)'},
  // Replaces CodeMirror's data: images, which the page's security policy forbids.
  '.cm-lintRange': {backgroundImage: 'none !important', textDecoration: 'underline wavy var(--bad)', textDecorationSkipInk: 'none'},
  '.cm-lintRange-warning': {textDecorationColor: 'var(--warn)'},
  '.cm-lint-marker': {content: 'normal !important', borderRadius: '50%', width: '0.7em', height: '0.7em', margin: '0.35em auto'},
  '.cm-lint-marker-error': {backgroundColor: 'var(--bad)'},
  '.cm-lint-marker-warning': {backgroundColor: 'var(--warn)'},
});
