/** @file Play, step, slider, speed, loop and the marks of events. */

import { byId, h, setText, title } from './dom.js';
import { fixed, number } from './format.js';
import { speeds } from './player.js';

const MOST_MARKS = 120;

export class Transport {
  /** @param {any} app */
  constructor(app) {
    this.app = app;
    const { player } = app;
    this.slider = byId('time');
    this.play = byId('play');
    this.readout = byId('clock');
    this.marks = byId('marks');
    this.speed = byId('speed');
    this.loop = byId('loop');
    this.slider.addEventListener('input', () => app.seek(Number(this.slider.value)));
    this.play.addEventListener('click', () => player.toggle());
    byId('back').addEventListener('click', () => player.step(-1));
    byId('on').addEventListener('click', () => player.step(1));
    this.loop.addEventListener('click', () => this.setLoop(!player.loop));
    this.speed.addEventListener('change', () => { player.speed = Number(this.speed.value); });
    byId('live').addEventListener('click', () => app.setLive(!app.live));
    this.shown = NaN;
    this.said = 0;
  }

  setLoop(on) {
    this.app.player.loop = on;
    this.loop.setAttribute('aria-pressed', String(on));
  }

  /** Speeds to choose from. */
  speeds() {
    const { player } = this.app, own = player.speed;
    this.speed.replaceChildren(...speeds(own).map((v) => h('option', { value: String(v), text: `${number(v, 2)}×`, selected: v === own })));
  }

  /** @param {number} by +1 or −1 */
  faster(by) {
    const { options, selectedIndex } = this.speed;
    this.speed.selectedIndex = Math.min(Math.max(selectedIndex + by, 0), options.length - 1);
    this.app.player.speed = Number(this.speed.value);
    this.app.say(`Speed ${options[this.speed.selectedIndex].text}`);
  }

  /** The span of time changed, or the events. */
  fit() {
    const { player } = this.app, span = player.end - player.start;
    Object.assign(this.slider, { min: String(player.start), max: String(player.end), step: 'any' });
    this.slider.disabled = !(span > 0);
    // As many digits as rows are apart.
    const one = this.app.primary(), apart = one && one.rows > 1 ? span / (one.rows - 1) : span;
    this.digits = apart >= 0.5 ? 0 : Math.min(Math.max(Math.ceil(-Math.log10(apart || 0.1) + 0.3), 2), 6);
    this.total = fixed(player.end, Math.min(this.digits, 3));
    this.readout.style.setProperty('--chars', String(fixed(player.end, this.digits).length + this.total.length + 5));
    const events = (one?.events ?? []).slice(0, MOST_MARKS);
    this.marks.replaceChildren(...events.map(({ name, t }) => {
      const mark = h('button', { class: 'mark', title: title(`${name}, t = ${number(t)} s`), 'aria-label': title(`Go to ${name} at ${number(t)} s`), onclick: () => this.app.seek(t) }, h('span', { text: name }));
      mark.style.left = `${span > 0 ? (100 * (t - player.start)) / span : 0}%`;
      return mark;
    }));
    this.marks.hidden = !events.length;
    this.tidy();
    this.shown = NaN;
  }

  /** Names that would lie on each other are left out; their ticks stay. */
  tidy() {
    let free = -Infinity;
    const width = this.marks.clientWidth;
    const marks = [...this.marks.children].sort((a, b) => parseFloat(a.style.left) - parseFloat(b.style.left));
    for (const mark of marks) {
      const at = (parseFloat(mark.style.left) / 100) * width, name = mark.firstChild;
      name.hidden = false;
      mark.classList.toggle('left', at > 0.75 * width);
      const w = name.offsetWidth, from = at > 0.75 * width ? at - w - 6 : at;
      name.hidden = from < free;
      if (!name.hidden) free = Math.max(at, from + w) + 10;
    }
  }

  update() {
    const { player } = this.app, t = player.time;
    if (this.playing !== player.playing) {
      this.playing = player.playing;
      this.play.setAttribute('aria-label', player.playing ? 'Pause' : 'Play');
      this.play.title = player.playing ? 'Pause (space)' : 'Play (space)';
      this.play.dataset.on = String(player.playing);
      this.said = -1;
    }
    if (t !== this.shown) {
      this.shown = t;
      this.slider.value = String(t);
      const span = player.end - player.start;
      this.slider.style.setProperty('--share', span > 0 ? `${(100 * (t - player.start)) / span}%` : '0%');
      setText(this.readout, `${fixed(t, this.digits)} / ${this.total} s`);
    }
    // Once in a while, and when it comes to rest, for those who listen.
    const now = performance.now();
    if (this.said === -1 || now - this.said > 1500) {
      const one = this.app.primary();
      this.slider.setAttribute('aria-valuetext', one ? `${fixed(t, this.digits)} s, row ${one.rowAt(t) + 1} of ${one.rows}` : 'no rows');
      this.said = now;
    }
  }
}
