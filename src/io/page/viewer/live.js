// SPDX-License-Identifier: BSD-3-Clause
// A scan that still runs writes its page after every view; this page then loads itself anew, and looks as it did before.
import { el } from './data.js';

const kEvery = 2000, kSilent = 120;  // ms at least between two pages; seconds without a new view that are worth a word
const key = 'agrisee ' + location.pathname;

/** What is kept from one page to the next; nothing where the browser keeps nothing. */
export function recall() {
  try {
    const kept = JSON.parse(sessionStorage.getItem(key));
    sessionStorage.removeItem(key);
    return kept && typeof kept === 'object' ? kept : null;
  } catch {
    return null;
  }
}

/** `keep()` gives what is to be kept, or null while the page must not be taken away (while it is dragged, say). */
export function follow(node, keep) {
  let waiting = true;
  const button = el('button', { type: 'button', 'aria-pressed': 'true', onclick: () => { waiting = !waiting; say(); } }), text = el('span');
  const age = () => (Date.now() - Date.parse(document.lastModified)) / 1000;
  function say() {
    button.setAttribute('aria-pressed', String(waiting));
    button.textContent = waiting ? 'Pause' : 'Follow';
    text.textContent = age() > kSilent ? `No new view for ${Math.round(age() / 60)} min: the scan was interrupted, or waits. ` : waiting ? 'The scan is running. ' : 'The scan is running; this page stays as it is. ';
  }
  node.hidden = false;
  node.append(text, button);
  say();
  setInterval(() => {
    say();
    const kept = waiting && keep();
    if (!kept) return;
    try {
      sessionStorage.setItem(key, JSON.stringify(kept));
    } catch { /* then the next page looks like a new one */ }
    location.reload();
  }, Math.max(kEvery, 3 * performance.now()));  // a slow machine does not spend all its time on loading
}
