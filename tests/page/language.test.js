// SPDX-License-Identifier: MIT
// The languages of the page: its tables of texts, and what one sees in another language than English.
import assert from 'node:assert/strict';
import {afterEach, test} from 'node:test';
import {endAll, eventually, newPage, openClassroom, startClass, startDaemon} from './harness.js';
import {documents, read, scripts, styles, tableOf, textsOf, textsOfHtml} from './texts.js';

afterEach(endAll);  // a page that stays open draws on, which slows the tests after it

const LANGUAGES = ['de', 'es', 'pt'];
const USED = new Set([...documents().flatMap((name) => textsOfHtml(name)), ...scripts().flatMap((name) => textsOf(name).keys)]);
const places = (text) => [...text.matchAll(/\{\w+\}/g)].map(([place]) => place).sort().join();

/** What looks like a text and is none: names of products, keys and colours, text of scenarios, shaders, styles. By file. */
const NO_TEXTS = {
  'class_words.js': /^(Python|Octave|its daemon crashed.*|Your simulation)$/, 'console.js': /^(Tab|MATLAB|Python|telnet)$/, 'console_copy.js': /^(Inf|Python)$/, 'lines.js': /^Python$/,
  'code_look.js': /(solid|wavy) var\(|^\.cm-/, 'contact_shadows.js': /^\nvarying|^\nattribute/, 'floor.js': /^\nfloat/, 'stage.js': /^(varying|uniform) /,
  'grammar.js': /^(title Reach|text Do not|hint Turn|counts 2 points|controller diffuse|supervisor referee)/, 'gallery.js': /^\[WORLD\]/, 'plain.js': /^\n?(uniform|varying|attribute) /,
  'plots.js': /^(CSV|PNG)$/, 'controls.js': /^coopdyn $/, 'dropped.js': /^(Files|robot)$/, 'recordings.js': /^(Bearer |Enter|Escape)$/, 'strip.js': /^ended$/,
  'wall.js': /^(Escape|lower_hand)$/, 'wall_tile.js': /^(asleep|thaw|freeze)$/, 'world.js': /^insert: $/, 'handles.js': /^translate$/,
};
const KEYS = /^(Enter|Escape|Tab|Home)$/;

for (const language of LANGUAGES) {
  test(`each text of the page is in the table of ${language}, with the same places, and no other is`, async () => {
    const table = await tableOf(language);
    assert.deepEqual([...USED].filter((text) => !Object.hasOwn(table, text)), [], 'without a translation');
    assert.deepEqual(Object.keys(table).filter((text) => !USED.has(text)), [], 'used nowhere');
    for (const [text, said] of Object.entries(table)) {
      for (const form of [said].flat()) assert.equal(places(form), places(text), `${text}: ${form}`);
      assert.ok([said].flat().every((form) => form.trim() === form && form !== ''), text);
    }
  });
}

test('the tables have their texts in the same order', async () => {
  const [first, ...others] = await Promise.all(LANGUAGES.map(async (language) => Object.keys(await tableOf(language))));
  for (const other of others) assert.deepEqual(other, first);
});

test('no script shows a text that is not translated', () => {
  for (const name of scripts()) {
    const loose = textsOf(name).loose.filter(([, text]) => !NO_TEXTS[name]?.test(text) && !KEYS.test(text));
    assert.deepEqual(loose, [], `${name}: put it into t('…'), or into NO_TEXTS`);
  }
});

test('what scripts look up or compare is not translated', () => {
  for (const name of scripts()) assert.doesNotMatch(read(name), /(?:byId|querySelector\w*|closest|Listener|getContext|Event)\(t\(|[=!]== t\(|case t\(/, name);
});

test('no style shows a text', () => {
  for (const name of styles()) {
    for (const [, text] of read(name).matchAll(/content:\s*"([^"]*)"/g)) assert.doesNotMatch(text, /\p{L}{2}/u, `${name}: use attr()`);
  }
});

test('the scan finds texts wherever one shows them', () => {
  const found = (source) => textsOf('', source).loose.map(([, text]) => text);
  assert.deepEqual(found('make(\'p\', {class: \'quiet\'}, \'none\', t(\'one\'), on ? \'two\' : `${t(\'three\')} four`);'), ['none', 'two', ' four']);
  assert.deepEqual(found('make(\'a\', {title: \'tip\', \'aria-label\': `tip ${n}`, id: \'tip\'});'), ['tip', 'tip ']);
  assert.deepEqual(found('button.textContent = \'saved\'; setText(line, `at ${time}`); say(\'gone\', true); setOff(id, \'why\', t(\'no\'));'), ['saved', 'at ', 'gone', 'why']);
  assert.deepEqual(found('// make(1, {}, \'no\')\nconst word = /\'no text/; return `Load ${word}`;'), ['Load ']);
  assert.deepEqual(textsOf('', 't(on ? \'a b\' : \'c\', {d: \'e\'}); plural(n, \'{count} f\', \'{count} g\', {h})').keys, ['a b', 'c', '{count} f', '{count} g']);
});

test('the scan of HTML finds texts and attributes, except those that are not to be translated', () => {
  const html = '<p title="a tip">some <b translate="no" title="no">no</b> more<br>end</p><svg hidden><title>no</title></svg><input placeholder="set_mode x" aria-label="heard">';
  assert.deepEqual(textsOfHtml('', html).sort(), ['a tip', 'end', 'heard', 'more', 'some']);
});

/** What an open page shows in English although its language has another text for it: in texts, titles and labels, of hidden elements,
 *  too. Not in what scenarios, robots and the daemon say. */
async function leftInEnglish(page, language) {
  const table = await tableOf(language);
  const shown = await page.evaluate(() => {
    const texts = new Set();
    const foreign = '#task-text, #task-hints details > :not(summary), #task-counts, .thumb, #events, #latest, #console-log, #plot-values, [translate="no"]';
    for (const element of document.querySelectorAll('body, body *')) {
      if (element.closest(foreign)) continue;
      for (const name of ['title', 'aria-label', 'placeholder', 'alt']) texts.add(element.getAttribute(name) ?? '');
      for (const {nodeType, data} of element.childNodes) if (nodeType === Node.TEXT_NODE) texts.add(data);
    }
    return [document.title, ...texts].map((text) => text.trim().replace(/\s+/g, ' ')).filter(Boolean);
  });
  const escaped = (text) => text.replace(/[.*+?^$()|[\]\\]/g, '\\$&');
  const patterns = Object.entries(table).filter(([text, said]) => said !== text && text.replace(/\{\w+\}|\P{L}/gu, '').length > 3)
    .map(([text]) => new RegExp(`^${escaped(text).replace(/\{\w+\}/g, '.+')}$`));
  return shown.filter((text) => patterns.some((pattern) => pattern.test(text)) && !Object.values(table).flat().includes(text));
}

/** Texts that one sees cut off at the edge of the window or of a box that does not scroll; those with … at their end are so by intent. */
const clipped = (page) => page.evaluate(() => {
  const cut = [], width = document.documentElement.clientWidth;
  for (const element of document.querySelectorAll('body *')) {
    const own = [...element.childNodes].filter((node) => node.nodeType === Node.TEXT_NODE && node.data.trim());
    if (own.length === 0 || !element.checkVisibility({visibilityProperty: true}) || element.closest('svg, select')) continue;
    let left = 0, right = width;
    for (let at = element; at && at !== document.documentElement; at = at.parentElement) {
      const style = getComputedStyle(at), box = at.getBoundingClientRect();
      if (style.textOverflow === 'ellipsis' && at === element) right = Infinity;
      if (/auto|scroll/.test(style.overflowX) && at.id !== 'tabs') right = Infinity;
      if (right === Infinity) break;
      if (style.overflowX !== 'visible') [left, right] = [Math.max(left, box.left), Math.min(right, box.right)];
    }
    for (const node of own) {
      const range = document.createRange();
      range.selectNodeContents(node);
      const box = range.getBoundingClientRect();
      if (box.width > 0 && right !== Infinity && (box.right > right + 1 || box.left < left - 1)) cut.push(`${node.data.trim()}: ${Math.round(box.left)} to ${Math.round(box.right)} of ${Math.round(right)}`);
    }
  }
  const strip = document.getElementById('strip-end')?.getBoundingClientRect();
  return strip && strip.right > width + 1 ? [...cut, `the strip ends at ${strip.right}`] : cut;
});

const TABS = ['robots', 'world', 'arena', 'plots', 'runs', 'text', 'cost'];
/** Opens a tab with all that can be unfolded in it. */
async function unfold(page, tab) {
  await page.click(`#tab-${tab}`);
  await page.evaluate((id) => {
    for (const box of document.querySelectorAll(`#panel-${id} details`)) box.open = true;
    document.getElementById('console-box').open = true;
  }, tab);
}

test('a browser in German shows the page in German, in all tabs', async () => {
  const {page} = await openClassroom({webgl: true, locale: 'de-AT'});
  assert.equal(await page.getAttribute('html', 'lang'), 'de');
  assert.equal(await page.textContent('#reset span'), 'Zurücksetzen');
  await page.waitForFunction(() => window.coopdyn.marks && window.coopdyn.handles);
  for (const tab of TABS) {
    await unfold(page, tab);
    if (tab === 'world') await page.click('#things button:has-text("BOX_1")');
    if (tab === 'robots') await page.waitForSelector('.instrument figcaption:not(:empty)', {state: 'attached'});
    if (tab === 'cost') await page.waitForSelector('#cost-table tbody tr');
    if (tab === 'text') await page.waitForFunction(() => window.coopdyn.editor.report);
    assert.deepEqual(await leftInEnglish(page, 'de'), [], tab);
  }
});

test('in no language a text is cut off, on a phone and on a projector', async () => {
  const {page} = await openClassroom({locale: 'de-DE'});
  for (const language of LANGUAGES) {
    await Promise.all([page.waitForEvent('load'), language === 'de' ? page.reload() : page.selectOption('#language', language)]);
    await page.waitForFunction(() => window.coopdyn && /^[\d.]+ s$/.test(document.getElementById('time').textContent));
    assert.equal(await page.getAttribute('html', 'lang'), language);
    for (const [width, height] of [[390, 844], [1024, 768]]) {
      await page.setViewportSize({width, height});
      for (const tab of TABS) {
        await unfold(page, tab);
        if (tab === 'cost') await page.waitForSelector('#cost-table tbody tr');
        assert.deepEqual(await clipped(page), [], `${language}, ${width}×${height}, ${tab}`);
        assert.ok(await page.$eval('#state', (state) => state.scrollWidth <= state.clientWidth + 1), `the state, ${language}, ${width}×${height}`);
      }
    }
  }
  await page.evaluate(() => localStorage.removeItem('coopdyn-language'));
});

for (const locale of ['de-DE', 'en-US', 'es-ES', 'pt-BR']) {
  test(`the run's buttons are in one row on a projector, ${locale}`, async () => {
    const {page} = await openClassroom({locale});
    const [first, last] = [await page.locator('#run').boundingBox(), await page.locator('#stop-all').boundingBox()];
    assert.ok(Math.abs(first.y - last.y) < 5, `${first.y} ${last.y}`);
  });

  test(`mode, step and speed stand side by side on a projector, ${locale}`, async () => {
    const {page} = await openClassroom({locale});
    const tight = await page.$$eval('.times label, #panel-robots', (parts) =>
      parts.filter((part) => part.scrollWidth > part.clientWidth).map((part) => part.id || part.textContent));
    assert.deepEqual(tight, []);
  });

  test(`on a phone the list Show is whole, and the strip cuts no word, ${locale}`, async () => {
    const {page} = await openClassroom({locale, webgl: true});
    await page.setViewportSize({width: 390, height: 844});
    await page.waitForSelector('#show-list label:nth-child(8)', {state: 'attached'});
    await page.click('#show > summary');
    const [frame, list] = [await page.locator('#view-frame').boundingBox(), await page.locator('#show-list').boundingBox()];
    assert.ok(list.x >= frame.x && list.y >= frame.y && list.x + list.width <= frame.x + frame.width, JSON.stringify([frame, list]));
    const cut = await page.$$eval('#mode, #time, #rtf, #state, #show-list', (parts) =>
      parts.filter((part) => part.checkVisibility() && part.scrollWidth > part.clientWidth + 1).map(({id}) => id));
    assert.deepEqual(cut, []);
    await page.click('#show > summary');
  });
}

test('a chosen language is kept when the page is opened again', async () => {
  const {daemon, page} = await openClassroom();
  assert.equal(await page.textContent('#tab-world'), 'World');
  await Promise.all([page.waitForEvent('load'), page.selectOption('#language', 'es')]);
  await eventually(async () => await page.textContent('#tab-world') === 'Mundo');
  await page.goto(daemon.url);
  await eventually(async () => await page.textContent('#tab-world') === 'Mundo');
  assert.equal(await page.inputValue('#language'), 'es');
  await page.evaluate(() => localStorage.removeItem('coopdyn-language'));
});

test('a browser in the Portuguese of Brazil gets Portuguese', async () => {
  const {page} = await openClassroom({locale: 'pt-BR'});
  assert.equal(await page.getAttribute('html', 'lang'), 'pt');
  assert.equal(await page.textContent('#tab-runs'), 'Gravações');
});

test('an unknown language gets English, which loads no table', async () => {
  const daemon = await startDaemon('classroom', '--no-render');
  const page = await newPage({locale: 'fr-FR'});
  const asked = [];
  page.on('request', (request) => { if (/words_/.test(request.url())) asked.push(request.url()); });
  await page.goto(daemon.url);
  await page.waitForFunction(() => window.coopdyn);
  assert.equal(await page.getAttribute('html', 'lang'), 'en');
  assert.equal(await page.textContent('#tab-world'), 'World');
  assert.deepEqual(asked, []);
});

test('the page appears only in its language, or in English if the table cannot be loaded', async () => {
  const daemon = await startDaemon('classroom', '--no-render');
  const page = await newPage({locale: 'de-DE'});
  // However long it has waited already: after seconds without a table the page appears.
  const opacity = () => page.evaluate(() => {
    for (const appearance of document.body.getAnimations()) appearance.currentTime = 0;
    return getComputedStyle(document.body).opacity;
  });
  let release;
  const held = new Promise((resolve) => { release = resolve; });
  await page.route('**/words_de-*.js', async (route) => {
    await held;
    await route.continue();
  });
  const asked = page.waitForRequest('**/words_de-*.js');
  await page.goto(daemon.url, {waitUntil: 'commit'});
  await asked;
  assert.equal(await page.textContent('#run span'), 'Run');
  assert.notEqual(await opacity(), '1');
  release();
  await page.waitForFunction(() => getComputedStyle(document.body).opacity === '1');
  assert.equal(await page.textContent('#run span'), 'Start');
  await page.unrouteAll();
  await page.route('**/words_de-*.js', (route) => route.abort());
  await page.goto(daemon.url);
  await page.waitForFunction(() => window.coopdyn && getComputedStyle(document.body).opacity === '1');
  assert.equal(await page.textContent('#run span'), 'Run');
  page.mistakes.length = 0;  // the browser tells of the request that failed
});

test('a class is in German, from the login to the wall', async () => {
  const host = await startClass([{seat: 'ana', name: 'Ana Lima', group: '1'}, {seat: 'ben', name: 'Ben Okafor', group: '2'}, {seat: 'cleo', name: 'Cleo Rossi'}], 'classroom', 'corridor');
  const ana = await newPage({locale: 'de-DE'}), wall = await newPage({locale: 'de-DE'});
  await ana.goto(host.url);
  await eventually(async () => await ana.textContent('h1') === 'Willkommen in der Klasse');
  await ana.waitForFunction(() => document.activeElement.id === 'name');  // the browser gives the focus with the first picture
  assert.deepEqual(await leftInEnglish(ana, 'de'), []);
  await ana.fill('#name', 'Ana Lima');
  await ana.fill('#pin', '0000');
  await ana.press('#pin', 'Enter');
  await eventually(async () => /^Kein Platz „ana“ mit dieser PIN/.test(await ana.textContent('#answer')));
  ana.mistakes.length = 0;  // the browser tells of the request that was refused
  await ana.fill('#pin', '7305');
  await ana.click('button');
  await ana.waitForURL('**/s/ana/');
  await ana.waitForFunction(() => window.coopdyn && document.getElementById('class-hand'));
  await ana.click('#tab-program');
  await ana.waitForFunction(() => window.coopdyn.program?.code);
  assert.deepEqual(await leftInEnglish(ana, 'de'), [], 'seat');
  for (const language of LANGUAGES) {
    if (language !== 'de') await Promise.all([ana.waitForEvent('load'), ana.selectOption('#language', language)]);
    await ana.waitForFunction((wanted) => document.documentElement.lang === wanted && document.getElementById('class-hand'), language);
    for (const [width, height] of [[390, 844], [1024, 768]]) {
      await ana.setViewportSize({width, height});
      assert.deepEqual(await clipped(ana), [], `seat, ${language}, ${width}×${height}`);
    }
  }
  await ana.evaluate(() => localStorage.removeItem('coopdyn-language'));
  await ana.click('#class-hand');
  await wall.goto(new URL('wall/', host.url).href);
  await wall.waitForSelector('#unlock:not([hidden])');
  assert.deepEqual(await leftInEnglish(wall, 'de'), [], 'before the wall');
  await wall.fill('#token', 'x'.repeat(24));
  await wall.press('#token', 'Enter');
  await eventually(async () => /^Das ist nicht das Token der Lehrkraft/.test(await wall.textContent('#unlock-answer')));
  wall.mistakes.length = 0;
  await wall.fill('#token', host.token);
  await wall.press('#token', 'Enter');
  await wall.waitForSelector('.tile[data-seat="ana"][data-hand="true"]');
  assert.match(await wall.textContent('#counts'), /3 Plätze.*1 Hand oben.*2 ruhen/);
  await wall.click('.tile[data-seat="ana"] .name');
  await wall.waitForSelector('#panel dd');
  assert.deepEqual(await leftInEnglish(wall, 'de'), [], 'wall');
  assert.match(await wall.textContent('#panel .why'), /^Hand gerade gehoben$/);
  assert.ok((await wall.locator('#panel .why').boundingBox()).height > 20, 'is not squeezed');
  for (const [width, height] of [[390, 844], [1024, 768]]) {
    await wall.setViewportSize({width, height});
    assert.deepEqual(await clipped(wall), [], `wall, ${width}×${height}`);
  }
  await wall.click('#panel .close');
  await wall.click('[data-does="message"]');
  assert.equal(await wall.textContent('#ask h2'), 'Nachricht: 3 Plätze');
  assert.deepEqual(await leftInEnglish(wall, 'de'), [], 'question');
});

test('numbers and places are put into the texts, in one or many', async () => {
  const {plural, t} = await import('../../server/web/page/words.js');
  assert.equal(t('saved {name}', {name: '{name} {x}'}), 'saved {name} {x}');
  assert.equal(plural(1, '{count} student', '{count} students'), '1 student');
  assert.equal(plural(0, '{count} student', '{count} students'), '0 students');
});
