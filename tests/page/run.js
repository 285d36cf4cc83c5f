// SPDX-License-Identifier: MIT
// Runs the named test files, or all, in this process and one browser.
import {readdirSync} from 'node:fs';
import {after, describe} from 'node:test';
import {closeBrowser, endAll} from './harness.js';

const named = process.argv.slice(2);
const all = () => readdirSync(new URL('.', import.meta.url)).filter((name) => name.endsWith('.test.js')).sort();
for (const file of named.length > 0 ? named : all()) {
  describe(file, async () => {
    after(endAll);
    await import(`./${file}`);
  });
}
after(closeBrowser);
