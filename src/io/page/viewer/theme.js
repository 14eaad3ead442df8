// SPDX-License-Identifier: BSD-3-Clause
// Light or dark: as the reader chose, else as the system is set.
const key = 'agrisee theme', system = matchMedia('(prefers-color-scheme: dark)');

function chosen() {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** `changed(dark)` is called at once, and at each change. */
export function makeTheme(button, changed) {
  let choice = chosen();
  function show() {
    const dark = choice ? choice === 'dark' : system.matches;
    document.documentElement.dataset.theme = dark ? 'dark' : 'light';
    button.textContent = dark ? 'Light' : 'Dark';
    changed(dark);
  }
  button.addEventListener('click', () => {
    choice = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    try {
      localStorage.setItem(key, choice);
    } catch { /* it lasts as long as the page */ }
    show();
  });
  system.addEventListener('change', show);
  show();
}
