// SPDX-License-Identifier: MIT
// Makes the pictures of docs/class.md: COOPDYN_BINARY=build/release/coopdyn node tests/page/pictures.js
import {writeFileSync} from 'node:fs';
import {connect} from 'node:net';
import {setTimeout as sleep} from 'node:timers/promises';
import {closeBrowser, endAll, eventually, startBrowser, startClass} from './harness.js';

const DOCS = new URL('../../docs/', import.meta.url);
const NAMES = ['Ana Lima', 'Ben Okafor', 'Chiara Rossi', 'Dario Conti', 'Elif Yilmaz', 'Farid Haddad', 'Greta Berg', 'Hugo Martin', 'Ines Duarte',
  'Jonas Weber', 'Kaito Mori', 'Lena Novak', 'Mateo Ruiz', 'Nora Lind', 'Omar Said', 'Paula Costa', 'Rosa Marin', 'Tara Singh', 'Uma Patel', 'Xin Li'];
const LANGUAGES = ['python', 'python', 'matlab', 'python', 'telnet'];
const SEATS = NAMES.map((name, i) => ({seat: name.split(' ')[0].toLowerCase(), name, group: String(1 + i % 4)}));
const ASLEEP = ['omar', 'tara'];
const WAY_S = 12;  // driving time of the robots before the picture

const host = await startClass(SEATS, 'classroom', 'corridor', 'maze');
const port = Number(host.names.split(':').at(-1));
const post = (path, body, credential) => fetch(new URL(path, host.url), {method: 'POST', body: JSON.stringify(body),
  headers: {'Content-Type': 'application/json', Authorization: `Bearer ${credential}`}});
const tell = (name, seats, text) => post('wall/class/do', {do: name, seats, text}, host.token);

/** A student's program that drives. */
function drive({seat}, i) {
  const program = connect(port, '127.0.0.1');
  program.on('error', () => {});
  program.write(`SEAT ${seat} 7305 ${LANGUAGES[i % LANGUAGES.length]}\nOPEN /robot1/motors\nset_velocity ${0.15 + 0.03 * (i % 7)} ${0.35 - 0.09 * (i % 8)}\n`);
  return program;
}
const programs = SEATS.filter(({seat}) => !ASLEEP.includes(seat)).map(drive);

/** Writes a screenshot of a page as WebP. */
async function picture(page, name, quality) {
  const png = (await page.screenshot()).toString('base64');
  const blank = await (await page.context().browser().newContext()).newPage();
  const webp = await blank.evaluate(async ([source, how]) => {
    const image = new Image();
    image.src = `data:image/png;base64,${source}`;
    await image.decode();
    const canvas = Object.assign(document.createElement('canvas'), {width: image.width, height: image.height});
    canvas.getContext('2d').drawImage(image, 0, 0);
    return canvas.toDataURL('image/webp', how).split(',')[1];
  }, [png, quality]);
  writeFileSync(new URL(name, DOCS), Buffer.from(webp, 'base64'));
}

const open = async (width, height) => (await (await startBrowser()).newContext({viewport: {width, height}})).newPage();
const wall = await open(1760, 990);
await wall.goto(new URL(`wall/#token=${host.token}`, host.url).href);
await wall.waitForSelector('.tile');
await eventually(() => wall.evaluate(() => [...window.coopdyn.wall.tiles.values()].filter(({drawn}) => drawn > 3).length >= 18));
await sleep(1000 * WAY_S);
await post('s/kaito/class/hand', {up: true}, 'kaito:7305');
await tell('freeze', ['ben']);
await tell('take', ['elif']);
await post('wall/s/hugo/api/call', {module: '/simulation', line: 'set_mode lockstep'}, host.token);
await post('wall/s/ines/api/call', {module: '/simulation', line: 'pause'}, host.token);
await tell('message', ['ana'], 'Well done! Now let it stop in front of the red target.');
await eventually(() => wall.evaluate(() => document.querySelector('.tile').dataset.hand === 'true'));
await sleep(4000);
await picture(wall, 'wall.webp', 0.8);
await wall.close();

const ana = await open(1280, 800);
await ana.goto(host.url);
await ana.fill('#name', 'Ana Lima');
await ana.fill('#pin', '7305');
await ana.click('button');
await ana.waitForURL('**/s/ana/');
await ana.waitForSelector('#class-news:not([hidden])');
await ana.waitForFunction(() => window.coopdyn?.view.framesDrawn > 1 && document.querySelector('.card[open] .readings'));
await picture(ana, 'student.webp', 0.8);
await ana.close();

for (const program of programs) program.destroy();
await endAll();
await closeBrowser();
