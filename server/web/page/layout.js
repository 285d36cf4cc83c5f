// SPDX-License-Identifier: MIT
// The sidebar's tabs, its width, and light or dark.
import {byId, icon, make} from './dom.js';
import {t} from './words.js';

const LEAST_PX = 272;
const STEP_PX = 24;
const panels = () => [...byId('panels').children];
const remembered = (key) => { try { return localStorage.getItem(key); } catch { return null; } };
const remember = (key, value) => { try { localStorage.setItem(key, value); } catch { /* kept until the page closes */ } };

/** The element of a sidebar tab, made on first use. It receives the events `shown` and `hidden`. */
export function tab(id, title) {
  const there = byId(`panel-${id}`);
  if (there) return there;
  const panel = make('section', {id: `panel-${id}`, class: 'tab-panel', role: 'tabpanel', 'aria-labelledby': `tab-${id}`, hidden: true});
  const button = make('button', {type: 'button', id: `tab-${id}`, role: 'tab', 'aria-controls': panel.id, 'aria-selected': 'false', tabIndex: -1}, icon(id), title);
  button.addEventListener('click', () => showTab(id));
  byId('tabs').append(button);
  byId('panels').append(panel);
  return panel;
}

/** Whether a tab is the shown one. */
export const isShown = (id) => byId(`panel-${id}`)?.hidden === false;

export function showTab(id) {
  if (!byId(`panel-${id}`)) return;
  const before = panels().find((panel) => !panel.hidden);
  for (const panel of panels()) {
    const chosen = panel.id === `panel-${id}`;
    const button = byId(panel.id.replace('panel', 'tab'));
    panel.hidden = !chosen;
    button.setAttribute('aria-selected', String(chosen));
    button.tabIndex = chosen ? 0 : -1;
    if (chosen) button.scrollIntoView({block: 'nearest', inline: 'nearest'});
  }
  if (before?.id === `panel-${id}`) return;
  before?.dispatchEvent(new Event('hidden'));
  byId(`panel-${id}`).dispatchEvent(new Event('shown'));
}

/** Arrow keys move between tabs, as in any list of tabs. */
function listenToTabs() {
  for (const button of byId('tabs').children) button.addEventListener('click', () => showTab(button.id.slice('tab-'.length)));
  byId('tabs').addEventListener('keydown', (event) => {
    const all = [...byId('tabs').children], at = all.indexOf(document.activeElement);
    const next = {ArrowRight: at + 1, ArrowLeft: at - 1 + all.length, Home: 0, End: all.length - 1}[event.key];
    if (next === undefined || at < 0) return;
    event.preventDefault();
    const button = all[next % all.length];
    showTab(button.id.slice('tab-'.length));
    button.focus();
  });
}

/** The mouse and arrow keys move the bar between view and sidebar. */
function listenToSplitter() {
  const splitter = byId('splitter');
  const widen = (width) => {
    const most = Math.max(LEAST_PX, 0.6 * innerWidth);
    const chosen = Math.round(Math.min(most, Math.max(LEAST_PX, width)));
    document.documentElement.style.setProperty('--side', `${chosen}px`);
    remember('coopdyn-side', chosen);
  };
  const width = () => byId('panels').getBoundingClientRect().width;
  splitter.addEventListener('pointerdown', (event) => splitter.setPointerCapture(event.pointerId));
  splitter.addEventListener('pointermove', (event) => {
    if (splitter.hasPointerCapture(event.pointerId)) widen(document.documentElement.clientWidth - event.clientX - 8);
  });
  splitter.addEventListener('keydown', ({key}) => {
    if (key === 'ArrowLeft') widen(width() + STEP_PX);
    if (key === 'ArrowRight') widen(width() - STEP_PX);
  });
  splitter.addEventListener('dblclick', () => {
    document.documentElement.style.removeProperty('--side');
    remember('coopdyn-side', '');
  });
  const kept = Number(remembered('coopdyn-side'));
  if (kept) widen(kept);
}

/** The system's theme, light, or dark. `document` receives the event `theme`. */
export function listenToTheme() {
  const themes = {'': t('Auto'), light: t('Light'), dark: t('Dark')};
  const button = byId('theme');
  const show = (theme) => {
    if (theme) document.documentElement.dataset.theme = theme;
    else delete document.documentElement.dataset.theme;
    button.textContent = themes[theme];
    remember('coopdyn-theme', theme);
    document.dispatchEvent(new Event('theme'));
  };
  button.addEventListener('click', () => {
    const names = Object.keys(themes), at = names.indexOf(document.documentElement.dataset.theme ?? '');
    show(names[(at + 1) % names.length]);
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => document.dispatchEvent(new Event('theme')));
  const kept = remembered('coopdyn-theme') ?? '';
  show(kept in themes ? kept : '');
}

export function startLayout() {
  listenToTabs();
  listenToSplitter();
  listenToTheme();
}
