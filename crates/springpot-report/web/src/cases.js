/** @file The list of cases: which are shown, which is the solid one, and what went wrong. */

import { byId, h, title } from './dom.js';

export const MOST_SHOWN = 12;

export class CaseList {
  /** @param {any} app */
  constructor(app) {
    this.app = app;
    this.host = byId('cases');
    this.note = byId('cases-note');
    this.build();
    byId('cases-none').addEventListener('click', () => app.show([app.primaryIndex()]));
    byId('cases-all').addEventListener('click', () => app.show(app.data.cases.map((_, i) => i).slice(0, MOST_SHOWN)));
  }

  build() {
    const { app } = this, { data } = app;
    byId('cases-panel').hidden = data.cases.length < 2 && !data.cases.some((one) => one.error);
    this.rows = data.cases.map((one, i) => {
      const name = data.caseName(one);
      const box = h('input', { type: 'checkbox', 'aria-label': title(`Show ${name}`), onchange: () => app.toggleCase(i) });
      const swatch = h('span', { class: 'swatch', 'aria-hidden': 'true' });
      const pick = h('button', { class: 'pick', title: title(name), onclick: () => app.makePrimary(i) }, h('span', { class: 'text', text: name }));
      const state = one.status === 'done' ? null : h('span', { class: `state ${one.status}`, text: one.status });
      const error = one.error ? h('p', { class: 'error', text: one.error.length > 4000 ? `${one.error.slice(0, 4000)}…` : one.error }) : null;
      const node = h('li', {}, h('div', { class: 'row' }, box, swatch, pick, state), error);
      return { node, box, swatch, pick };
    });
    this.host.replaceChildren(...this.rows.map((row) => row.node));
    this.update();
  }

  update() {
    const { app } = this;
    this.rows.forEach(({ node, box, swatch, pick }, i) => {
      const on = app.shown.includes(i);
      box.checked = on;
      box.disabled = !on && app.shown.length >= MOST_SHOWN;
      swatch.style.background = app.caseColors[i] ?? 'transparent';
      swatch.classList.toggle('off', !on);
      node.classList.toggle('primary', i === app.primaryIndex());
      if (i === app.primaryIndex()) pick.setAttribute('aria-current', 'true');
      else pick.removeAttribute('aria-current');
    });
    const n = app.data.cases.length;
    byId('cases-same').hidden = app.shown.length < 2 || !app.sameMotion();
    this.note.textContent = n > MOST_SHOWN ? `${app.shown.length} of ${n} shown, ${MOST_SHOWN} at most` : `${app.shown.length} of ${n} shown`;
  }
}
