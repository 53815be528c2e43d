/* The replay of a case: all engines side by side and on top of each other, with one time slider. */
import { h } from './dom.js';
import { digits } from './format.js';
import { Recording } from './recording.js';
import { Stage, aim, boundsAt, boundsOf, cameraFor, canDraw, draw, depthSteps, errorSteps, sizeOf } from './scene3d.js';

/* The poses that the run ended with, for runs without a recording; null: none. */
export function finalPoses(cell, scene) {
  return cell?.final && cell.final.length === 7 * scene.bodies.length ? cell.final : null;
}

export const smallest = (scene) => Math.min(...scene.bodies.filter((b) => !b.static && b.shape[0] !== 'plane').map((b) => sizeOf(scene, b.shape)), Infinity);

/* Dragging turns all panels, the wheel with Ctrl and the keys + and - zoom. */
function steer(canvas, view, redraw) {
  let from = null;
  canvas.addEventListener('pointerdown', (e) => { from = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
  canvas.addEventListener('pointerup', () => { from = null; });
  canvas.addEventListener('pointermove', (e) => {
    if (from === null) return;
    view.turn -= (e.clientX - from[0]) * 0.01;
    view.tilt = Math.min(Math.max(view.tilt + (e.clientY - from[1]) * 0.01, -1.5), 1.5);
    from = [e.clientX, e.clientY];
    redraw();
  });
  canvas.addEventListener('wheel', (e) => { if (e.ctrlKey) { e.preventDefault(); view.zoom *= Math.exp(-e.deltaY / 300); redraw(); } }, { passive: false });
}

/* runs: [{name, cell, label}]; onTime is called with each new time. Returns {element, ready}. */
export function replay(scene, runs, styles, onTime) {
  const element = h('div', { class: 'replay' });
  if (!canDraw()) {
    element.append(h('p', { class: 'note' }, 'There is no replay: this browser has no WebGL, or the page was built without three.'));
    return { element, recordings: Promise.resolve(runs.map(() => null)) };
  }
  const recordings = Promise.all(runs.map(({ cell }) => Recording.load(cell.run, scene)));
  recordings.then((found) => build(element, scene, runs, found, styles, onTime));
  return { element, recordings };
}

function build(element, scene, runs, found, styles, onTime) {
  const shown = runs.map((run, i) => ({ ...run, recording: found[i], final: finalPoses(run.cell, scene) })).filter((r) => r.recording !== null || r.final !== null);
  if (shown.length === 0) {
    element.append(h('p', { class: 'note' }, 'No run of this case has left poses.'));
    return;
  }
  const calm = shown.filter((r) => r.final !== null && r.cell.outcome === 'ok').map((r) => r.final);
  const bounds = boundsOf(scene, calm), camera = cameraFor(bounds, scene), view = { turn: 0.55, tilt: 0.28, zoom: 1 };
  const end = Math.max(...shown.map((r) => r.recording?.end ?? 0)), size = smallest(scene);
  const posesAt = (run, time) => run.recording?.at(time) ?? run.final;
  const panels = shown.map((run) => ({ runs: [run], stage: new Stage(scene, bounds, [null]), canvas: h('canvas', { role: 'img', 'aria-label': `${run.name}: ${run.label}` }),
    caption: [h('b', {}, run.name), ' ', run.label, run.recording ? null : ' (end only: no recording)'] }));
  if (shown.length > 1) {
    panels.unshift({ runs: shown, stage: new Stage(scene, bounds, shown.map((r) => styles.get(r.name).colour)), canvas: h('canvas', { role: 'img', 'aria-label': 'all engines on top of each other' }),
      caption: [h('b', {}, 'all engines'), ' on top of each other, in their colours', scene.rests.length > 0 ? '; green edges: where bodies belong' : ''] });
  }
  let time = end, playing = null;
  const slider = h('input', { type: 'range', min: 0, max: 1000, value: 1000, 'aria-label': 'time' });
  const readout = h('output', {}, '');
  const showContacts = h('input', { type: 'checkbox', checked: false });
  const speed = h('select', { 'aria-label': 'speed' }, [0.1, 0.25, 0.5, 1, 2, 4].map((s) => h('option', { value: String(s), selected: s === 1 }, `${s}×`)));
  const redraw = () => {
    for (const panel of panels) {
      aim(camera, boundsAt(bounds, scene, posesAt(panel.runs[0], time)), view);
      panel.runs.forEach((run, i) => panel.stage.place(i, posesAt(run, time)));
      const single = panel.runs.length === 1 ? panel.runs[0].recording : null;
      if (single !== null || panel.stage.dots) panel.stage.contacts(showContacts.checked && single ? single.contactsAt(time) ?? [] : [], size);
      draw(panel.canvas, panel.stage, camera);
    }
    readout.textContent = `${digits(time, 4)} s`;
    slider.value = end > 0 ? (1000 * time) / end : 0;
    element.dataset.time = time;
    onTime(time);
  };
  const go = (to) => { time = Math.min(Math.max(to, 0), end); redraw(); };
  const stop = () => { cancelAnimationFrame(playing); playing = null; button.textContent = '▶ Play'; };
  const play = () => {
    let last = performance.now();
    if (time >= end) time = 0;
    button.textContent = '⏸ Pause';
    const frame = (now) => {
      go(time + ((now - last) / 1000) * Number(speed.value));
      last = now;
      if (time < end && playing !== null) playing = requestAnimationFrame(frame); else stop();
    };
    playing = requestAnimationFrame(frame);
  };
  const button = h('button', { type: 'button', class: 'play', onclick: () => (playing === null ? play() : stop()) }, '▶ Play');
  const stride = end > 0 ? end / 120 : 0;
  const step = (by) => { stop(); go(time + by * stride); };
  slider.addEventListener('input', () => { stop(); go((slider.value / 1000) * end); });
  showContacts.addEventListener('change', redraw);
  element.append(
    h('div', { class: 'controls', onkeydown: (e) => {
      if (e.target === slider) return;
      if (e.key === 'ArrowRight') step(1); else if (e.key === 'ArrowLeft') step(-1);
      else if (e.key === '+' || e.key === '-') { view.zoom *= e.key === '+' ? 1.2 : 1 / 1.2; redraw(); }
    } },
    end > 0 ? [button, h('button', { type: 'button', title: 'a step back', onclick: () => step(-1) }, '‹ step'), h('button', { type: 'button', title: 'a step on', onclick: () => step(1) }, 'step ›'), slider, readout, speed] : h('span', { class: 'note' }, 'The runs were not recorded: this is how they ended.'),
    h('label', { class: 'small' }, showContacts, ' contact points'),
    h('button', { type: 'button', onclick: () => { Object.assign(view, { turn: 0.55, tilt: 0.28, zoom: 1 }); redraw(); } }, 'Reset view')),
    h('div', { class: 'panels' }, panels.map((panel) => h('figure', { class: 'panel' }, panel.canvas, h('figcaption', {}, panel.caption)))),
    h('p', { class: 'legend' }, scene.rests.length > 0 ? ['Bodies by their distance from where they belong, of their size: ', errorSteps.map((s) => h('span', {}, h('span', { class: 'key', style: `background:${s.colour}` }, '\u00a0'), s.text))] : null,
      h('span', {}, 'Contacts by depth, of the smallest body: '), depthSteps.map((s) => h('span', {}, h('span', { class: 'key', style: `background:${s.colour}` }, '\u00a0'), s.text)),
      h('span', {}, 'Drag to turn, Ctrl and wheel to zoom.')));
  panels.forEach(({ canvas }) => steer(canvas, view, redraw));
  new ResizeObserver(() => { if (playing === null) redraw(); }).observe(element);
  redraw();
}

/* Still pictures of how runs ended, one canvas a run, for the first screen. */
export function stills(scene, runs) {
  if (!canDraw()) return null;
  const shown = runs.filter((r) => finalPoses(r.cell, scene) !== null);
  const bounds = boundsOf(scene, shown.filter((r) => r.cell.outcome === 'ok').map((r) => r.cell.final));
  const camera = cameraFor(bounds, scene);
  return h('div', { class: 'strip' }, shown.map((run) => {
    const canvas = h('canvas', { role: 'img', 'aria-label': `how the bodies end: ${run.name}, ${run.label}` });
    const stage = new Stage(scene, bounds, [null]);
    stage.place(0, run.cell.final);
    aim(camera, boundsAt(bounds, scene, run.cell.final), { zoom: 1.15 });
    draw(canvas, stage, camera, 260);
    stage.dispose();
    return h('figure', { class: 'panel' }, canvas, h('figcaption', {}, h('b', {}, run.name), ` ${run.label}`));
  }));
}
