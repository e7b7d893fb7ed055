/** @file Keyboard: the list that the help shows is the list that works. */

import { byId, h } from './dom.js';

/** @param {any} app @returns {{keys: string, does: string, match: (event: KeyboardEvent) => boolean, act: (event: KeyboardEvent) => void}[]} */
const shortcuts = (app) => {
  const key = (...names) => (event) => names.includes(event.key.length === 1 ? event.key.toLowerCase() : event.key);
  const { player } = app;
  return [
    { keys: 'Space', does: 'play or pause', match: key(' '), act: () => player.toggle() },
    { keys: '← →', does: 'one row back or on (with shift: ten)', match: key('ArrowLeft', 'ArrowRight'), act: (event) => player.step((event.key === 'ArrowLeft' ? -1 : 1) * (event.shiftKey ? 10 : 1)) },
    { keys: 'Home End', does: 'to the start or the end', match: key('Home', 'End'), act: (event) => app.seek(event.key === 'Home' ? player.start : player.end) },
    { keys: '+ −', does: 'faster or slower', match: key('+', '=', '-', '−'), act: (event) => app.transport.faster(event.key === '+' || event.key === '=' ? 1 : -1) },
    { keys: '1 … 9', does: 'show or hide a case', match: (event) => /^[1-9]$/.test(event.key), act: (event) => app.toggleCase(Number(event.key) - 1) },
    { keys: 'C', does: 'colours: force or stored energy', match: key('c'), act: () => app.setColorMode(app.colors.mode === 'force' ? 'stored' : 'force') },
    { keys: 'G', does: 'overlay or side by side', match: key('g'), act: () => app.setBeside(!app.beside) },
    { keys: 'L', does: 'light or dark', match: key('l'), act: () => app.setDark(!app.dark) },
    { keys: 'A D W S', does: 'turn the view', match: key('a', 'd', 'w', 's'), act: (event) => { const k = event.key.toLowerCase(); app.stage.turn(k === 'a' ? 0.12 : k === 'd' ? -0.12 : 0, k === 'w' ? 0.1 : k === 's' ? -0.1 : 0); app.wake(); } },
    { keys: 'R', does: 'reset the view', match: key('r'), act: () => app.resetView() },
    { keys: '?', does: 'this help', match: key('?'), act: () => app.help() },
  ];
};

const POINTER = [
  ['3D: drag', 'turn; right button or two fingers move, wheel or pinch zooms'],
  ['3D: click', 'choose an element; double click resets the view'],
  ['Plot: click, drag', 'go to that moment'],
  ['Plot: wheel, pinch', 'zoom (over an axis: that axis; alt: both); double click resets'],
  ['Plot: shift or right drag', 'move'],
];

/** @param {any} app */
export function listen(app) {
  const list = shortcuts(app);
  byId('help-keys').replaceChildren(...list.map(({ keys, does }) => h('tr', {}, h('th', { scope: 'row' }, ...keys.split(' ').map((name) => (name === '…' ? ' … ' : h('kbd', { text: name })))), h('td', { text: does }))));
  byId('help-pointer').replaceChildren(...POINTER.map(([what, does]) => h('tr', {}, h('th', { scope: 'row', text: what }), h('td', { text: does }))));
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const at = /** @type {HTMLElement} */ (event.target), tag = at.tagName;
    if (document.querySelector('dialog[open]')) return;
    const slider = tag === 'INPUT' && /** @type {HTMLInputElement} */ (at).type === 'range';
    const box = tag === 'INPUT' && /** @type {HTMLInputElement} */ (at).type === 'checkbox';
    if ((tag === 'INPUT' && !slider && !box) || tag === 'TEXTAREA' || tag === 'SELECT' || at.isContentEditable) return;
    // A control that has the focus keeps its own keys.
    if (event.key === ' ' && (tag === 'BUTTON' || tag === 'SUMMARY' || tag === 'A' || box)) return;
    if (at.getAttribute('role') === 'separator' && event.key.startsWith('Arrow')) return;
    const found = list.find(({ match }) => match(event));
    if (!found) return;
    event.preventDefault();
    found.act(event);
  });
}
