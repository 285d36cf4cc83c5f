// SPDX-License-Identifier: MIT
// The teacher's orders: asks where that is due, sends them to the host, shows errors.
import {namesText, ORDERS, studentsText} from './class_words.js';
import {byId, make, say} from './dom.js';
import {post} from './host_events.js';
import {t} from './words.js';

/** Asks in the dialog. Resolves to the text entered (empty if none is asked for), or null. */
function ask({title, about, whom, field, value = '', options = [], act, danger}) {
  const dialog = byId('ask'), form = dialog.firstElementChild;
  const input = field && make('textarea', {id: 'ask-text', rows: field === ORDERS.message.text ? 3 : 2, value, required: true, spellcheck: field === ORDERS.message.text});
  const go = make('button', {value: 'go', class: danger ? 'primary danger-fill' : 'primary'}, act);
  const choices = options.map((name) => {
    const choice = make('button', {type: 'button', class: 'small'}, name);
    choice.addEventListener('click', () => { input.value = name; input.focus(); });
    return choice;
  });
  form.replaceChildren(
    make('h2', {}, title), ...(about ? [make('p', {}, about)] : []), make('p', {class: 'whom'}, whom),
    ...(input ? [make('label', {}, field, input)] : []), ...(choices.length > 0 ? [make('div', {class: 'choices'}, ...choices)] : []),
    make('div', {class: 'row'}, make('button', {value: 'no', formNoValidate: true}, t('Cancel')), go));
  input?.addEventListener('keydown', (event) => {
    if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) form.requestSubmit(go);
  });
  dialog.returnValue = '';
  dialog.showModal();
  (input ?? go).focus();
  return new Promise((done) => dialog.addEventListener('close', () => {
    done(dialog.returnValue === 'go' ? input?.value.trim() ?? '' : null);
  }, {once: true}));
}

/** Carries out order `name` for `seats` ({seat, name}); `all`: for everybody of the class, "seats" is then not sent. */
export async function order(name, seats, {all = false, text = null, about = '', scenarios = []} = {}) {
  const {title, asks = '', text: field, done} = ORDERS[name];
  const many = all || seats.length > 1;
  if (many && seats.length === 0) return;
  const names = namesText(seats.map((seat) => seat.name));
  if ((many && asks && text === null) || (field && text === null)) {
    text = await ask({title: many ? `${title}: ${studentsText(seats.length)}` : `${title}: ${names}`, about: about || (many ? asks : ''),
      whom: many ? t('It meets {names}.', {names}) : '', field, options: scenarios, act: name === 'message' ? t('Send') : title, danger: many && Boolean(asks)});
    if (text === null) return;
  }
  const {error} = await post('class/do', {do: name, ...(all ? {} : {seats: seats.map(({seat}) => seat)}), ...(text ? {text} : {})});
  say(error ? `${title}: ${error}` : `${many ? studentsText(seats.length) : names}: ${done}`, Boolean(error));
}

/** Names of scenarios that a seat which runs can load. */
export async function scenariosOf(seats) {
  const running = seats.find(({daemon}) => daemon === 'running');
  if (!running) return [];
  const answer = await fetch(`s/${running.seat}/api/scenarios`).catch(() => null);
  return answer?.ok ? answer.json() : [];
}
