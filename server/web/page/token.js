// SPDX-License-Identifier: MIT
// The token of this browser tab, kept over reloads until the tab is closed.

const KEY = 'coopdyn-token';

/** The token in the address, else the one kept by keepToken(), else empty. */
export function rememberedToken() {
  const given = new URLSearchParams(location.search).get('token');
  if (given) return given.trim();
  try {
    return sessionStorage.getItem(KEY) ?? '';
  } catch {  // no session storage
    return '';
  }
}

/** Keeps a token that the daemon accepted ('' forgets it) and removes it from the address, which projectors show. */
export function keepToken(token) {
  try {
    if (token) sessionStorage.setItem(KEY, token);
    else sessionStorage.removeItem(KEY);
  } catch {
    return;  // keep it in the address
  }
  const address = new URL(location.href);
  if (!address.searchParams.has('token')) return;
  address.searchParams.delete('token');
  history.replaceState(null, '', address);
}
