// SPDX-License-Identifier: MIT
// What the pages of a class say: states of seats, orders of the teacher, and what students read.
import {plural, t} from './words.js';

const LANGUAGES = {__proto__: null, python: 'Python', matlab: 'MATLAB', octave: 'Octave', cpp: 'C++', telnet: 'telnet', page: t('the page')};
export const languageText = (language) => LANGUAGES[language?.toLowerCase()] ?? language ?? '';

/** [key, text]: the state of a seat in the wall's events. `moves`: its time goes on. The key chooses the colour. */
export function stateOf(seat, moves) {
  if (seat.daemon === 'failed') return ['crashed', t('crashed')];
  if (seat.daemon === 'asleep') return ['asleep', t('asleep')];
  if (seat.daemon === 'starting') return ['starting', t('starting')];
  if (seat.frozen) return ['frozen', t('frozen')];
  switch (seat.state) {
    case undefined: return ['starting', t('starting')];
    case 'waiting': return moves ? ['running', t('running')] : ['waiting', t('waits for its program')];
    case 'ended': return ['ended', seat.ended ? t('ended: {reason}', {reason: seat.ended}) : t('ended')];
    case 'running': return ['running', t('running')];
    case 'paused': return ['paused', t('paused')];
    default: return ['paused', seat.state];
  }
}

/** "now", "40 s", "12 min", "2 h": how long nothing has happened. */
export function idleText(seconds) {
  if (seconds < 10) return t('now');
  if (seconds < 60) return `${10 * Math.floor(seconds / 10)} s`;
  return seconds < 3600 ? `${Math.floor(seconds / 60)} min` : `${Math.floor(seconds / 3600)} h`;
}

const TROUBLES = {
  'its daemon crashed: it continues at the last recorded moment': t('Your simulation crashed: it continues at the last recorded moment'),
  'its daemon crashed again and again: the lesson was begun anew': t('Your simulation crashed again and again: the lesson was begun anew'),
};
/** The host's word for a trouble, as one tells it to the student. */
export const troubleText = (trouble) => TROUBLES[trouble] ?? trouble.replace(/^its daemon/, 'Your simulation');

const HOST_SAYS = [
  [/^hand up for 0 min$/, () => t('hand up just now')],
  [/^hand up for (\d+) min$/, (minutes) => t('hand up for {minutes} min', {minutes})],
  [/^its simulation has not answered for (\d+) s: Restart lesson ends it$/, (seconds) => t('its simulation has not answered for {seconds} s: Restart lesson ends it', {seconds})],
  [/^(\d+) resets within a minute$/, (count) => t('{count} resets within a minute', {count})],
  [/^nothing done for (\d+) min$/, (minutes) => t('nothing done for {minutes} min', {minutes})],
  [/^no seat '(.*)' with this PIN: both stand on the sheet that the teacher hands out$/, (name) => t('no seat \'{name}\' with this PIN: both stand on the sheet that the teacher hands out', {name})],
  [/^this is not the teacher's token: coopdyn host printed it when it started$/, () => t('this is not the teacher\'s token: coopdyn host printed it when it started')],
];
/** What the host says most often: why a seat needs help, why somebody is not let in. All else stays as it is. */
export function hostText(text) {
  for (const [pattern, said] of HOST_SAYS) {
    const found = pattern.exec(text);
    if (found) return said(found[1]);
  }
  return text;
}
/** An error as a sentence. */
export const sentenceOf = (error) => error && `${error[0].toUpperCase()}${error.slice(1)}.`;

/** "20261129-181523" as "18:15". */
export const whenText = (when) => when.replace(/^\d{8}-(\d\d)(\d\d).*$/, '$1:$2');

const KEPT = {'recording.run': t('the recording of your run'), 'program.py': t('your program'), 'output.txt': t('what it printed')};
/** What was handed in, in words. */
export const keptText = (files = []) => (files.length > 0 ? files.map((file) => KEPT[file] ?? file).join(', ') : t('nothing yet: run something first'));

/** The teacher's orders. `title` and `hint` of the button; `asks`: what happens, for the question before it is done to many;
 *  `text`: the question for the text that it needs. */
export const ORDERS = {
  freeze: {title: t('Freeze'), hint: t('The worlds stand still, and students may only watch'), done: t('stands still')},
  thaw: {title: t('Thaw'), hint: t('The worlds go on'), done: t('thawed')},
  take: {title: t('Take over'), hint: t('You drive; the student watches'), done: t('you drive'), asks: t('Their programs cannot drive until you give the seats back.')},
  give: {title: t('Give back'), hint: t('The student drives again'), done: t('given back')},
  reset: {title: t('Reset'), hint: t('The run begins again at zero'), done: t('is back at zero'), asks: t('Their runs begin again at zero.')},
  restart: {title: t('Restart lesson'), hint: t('Starts the simulation anew with the scenario of the lesson'), done: t('begins the lesson anew'),
    asks: t('Their simulations start anew with the scenario of the lesson. Their recordings stay.')},
  push: {title: t('Push scenario'), hint: t('Loads another scenario: a name, or a text'), done: t('told to load the scenario'),
    asks: t('It replaces the worlds that they have now.'), text: t('Name of a scenario, or its whole text')},
  message: {title: t('Message'), hint: t('Appears on the student’s page'), done: t('message sent'), text: t('Message')},
  lower_hand: {title: t('Lower hand'), hint: t('The question is answered'), done: t('hand lowered')},
  aside: {title: t('Put aside'), hint: t('Ends the simulation; it goes on where it was when somebody comes'), done: t('put aside'),
    asks: t('Their simulations end, and go on where they were when somebody comes.')},
  next: {title: t('Next'), hint: t('Everybody loads the next scenario of the lesson'), done: t('told to load the next scenario'),
    asks: t('It replaces the worlds that they have now.')},
};

/** "Ana Lima, Ben Okafor and 28 more". */
export function namesText(names, shown = 6) {
  if (names.length === 1) return names[0];
  if (names.length <= shown) return t('{names} and {last}', {names: names.slice(0, -1).join(', '), last: names.at(-1)});
  return t('{names} and {count} more', {names: names.slice(0, shown).join(', '), count: names.length - shown});
}
export const studentsText = (count) => plural(count, '{count} student', '{count} students');
