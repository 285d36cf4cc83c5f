// SPDX-License-Identifier: MIT
// The task of the scenario, [TASK]: its text, hints that open one after the other, and what is worth points. It stands first under
// Lesson and, while that is shown, above the editor of Program.
import {byId, make, setText} from './dom.js';
import {markdown} from './markdown.js';
import {t} from './words.js';

const HOMES = ['panel-robots', 'panel-program'];

export class Task {
  #key = '';

  constructor() {
    // These events do not bubble.
    byId('panels').addEventListener('shown', ({target}) => { if (HOMES.includes(target.id)) target.prepend(byId('task-box')); }, true);
  }

  /** Fetches the task anew when the world is another one. */
  async update({scenario, revision}) {
    const key = `${scenario} ${revision}`;
    if (key === this.#key) return;
    this.#key = key;
    const answer = await fetch('api/scene').catch(() => null);
    if (answer?.ok) {
      const {task} = await answer.json();
      if (key === this.#key) this.#show(task);
    } else {
      this.#key = '';  // the next status asks again
    }
    byId('panel-robots').removeAttribute('data-waits');
  }

  #show(task) {
    const box = byId('task-box');
    box.hidden = !task;
    if (!task) return;
    setText(byId('task-title'), task.title || t('Task'));
    const opened = byId('task-text').dataset.task === JSON.stringify(task) ? byId('task-hints').querySelectorAll('[open]').length : 0;
    byId('task-text').dataset.task = JSON.stringify(task);
    byId('task-text').replaceChildren(...markdown(task.text));
    byId('task-worth').hidden = task.counts.length === 0;
    byId('task-hints').replaceChildren(...task.hints.map((hint, i) => this.#hint(hint, i, opened)));
    byId('task-counts').replaceChildren(...task.counts.map((line) => make('li', {}, ...markdown(line).flatMap((one) => [...one.childNodes]))));
  }

  /** A hint can be opened when the one before it has been. */
  #hint(text, i, opened) {
    const hint = make('details', {hidden: i > opened, open: i < opened}, make('summary', {}, t('Hint {number}', {number: i + 1})), ...markdown(text));
    hint.addEventListener('toggle', () => {
      const next = hint.nextElementSibling;
      if (hint.open && next) next.hidden = false;
    });
    return hint;
  }
}
