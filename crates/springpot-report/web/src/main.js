/** @license three.js: Copyright © 2010-2026 three.js authors, MIT License */
/** @file Starts the page from its data, and opens a small door for tests. */

import { App } from './app.js';
import { Data } from './data.js';
import { byId } from './dom.js';

/** @param {unknown} error */
function fail(error) {
  const bar = byId('error');
  bar.hidden = false;
  byId('error-text').textContent = `The page met an error: ${error instanceof Error ? error.message : String(error)}`.slice(0, 4000);
}

addEventListener('error', (event) => {
  // Browsers report this when a resize takes more than one round; nothing is lost.
  if (!/ResizeObserver/.test(event.message)) fail(event.error ?? event.message);
});
addEventListener('unhandledrejection', (event) => fail(event.reason));

/** What tests may ask and do. @param {App} app */
const door = (app) => ({
  data: app.data,
  seek: (t) => app.seek(t),
  time: () => app.player.time,
  row: () => (app.primary() ? app.primary().rowAt(app.player.time) : 0),
  play: () => app.player.toggle(true),
  pause: () => app.player.toggle(false),
  playing: () => app.player.playing,
  gripper: (i) => placed(app, i, (view) => (view.shared.scene.gripper ? Array.from(view.grip) : null)),
  body: (i, name) => placed(app, i, (view) => view.body(name)),
  line: (i, name) => placed(app, i, (view) => Array.from(view.elements.find((each) => each.name === name)?.line ?? [])),
  drawn: () => app.drawn,
  drawnGripper: (i) => Array.from(app.views.get(app.data.cases[i])?.grip ?? []),
  elementColor: (i, name) => placed(app, i, (view) => {
    const element = view.elements.find((each) => each.name === name);
    return element ? app.colors.map.hex[element.entry] : null;
  }),
  shown: () => [...app.shown],
  frame: () => app.stats.report(),
  clearFrame: () => app.stats.clear(),
  select: (name) => app.select(name),
  selected: () => app.selected,
  setColorMode: (mode) => app.setColorMode(mode),
  colorMode: () => app.colors.mode,
  beside: () => app.beside,
  dark: () => app.dark,
  speed: () => app.player.speed,
  camera: () => app.stage.camera.position.toArray(),
  turn: (side, up) => app.stage.turn(side, up),
  plots: () => app.plots.list.map((plot) => ({ ...plot.choice, frame: { ...plot.frame }, zoomed: plot.zoom !== null })),
  webgl: () => app.stage.renderer !== null,
});

/** A question about a case is answered for the present moment, also when it is not shown. */
function placed(app, i, ask) {
  const one = app.data.cases[i];
  if (!one) return null;
  const view = app.view(one);
  view.update(app.player.time, app.colors);
  return ask(view);
}

try {
  const data = new Data(JSON.parse(byId('data').textContent));
  byId('data').textContent = ''; // decoded: the text is not needed twice
  const app = new App(data);
  Object.defineProperty(window, 'springpot', { value: door(app) });
  document.documentElement.dataset.ready = 'true';
} catch (error) {
  fail(error);
}
