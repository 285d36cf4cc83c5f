// SPDX-License-Identifier: MIT
// The token of this browser tab, kept over reloads until the tab is closed.

const KEY = 'coopdyn-token';

/** From the address, else the one that opened this page before; else empty. */
export function rememberedToken() {
  const given = new URLSearchParams(location.search).get('token');
  if (given) return given.trim();
  try {
    return sessionStorage.getItem(KEY) ?? '';
  } catch {  // the browser keeps nothing
    return '';
  }
}

/** Keeps a token that the daemon took, or with '' none, and takes it out of the address: projectors show that. */
export function keepToken(token) {
  try {
    if (token) sessionStorage.setItem(KEY, token);
    else sessionStorage.removeItem(KEY);
  } catch {
    return;  // then the address has to keep it
  }
  const address = new URL(location.href);
  if (!address.searchParams.has('token')) return;
  address.searchParams.delete('token');
  history.replaceState(null, '', address);
}
