/* Plots, each in a figure with a caption and download buttons. */
import * as Plot from '@observablehq/plot';
import { h, save, svg } from './dom.js';
import { digits, slug } from './format.js';

export const hasPlots = FULL; // set by bundle.cmake

/* A copy of a plot that stands on its own: with a background, and with the page's colours as they are. */
function standalone(svg) {
  const copy = svg.cloneNode(true);
  const { width, height } = svg.viewBox.baseVal;
  copy.setAttribute('xmlns', 'http://www.w3.org/2000/svg');
  copy.setAttribute('width', width);
  copy.setAttribute('height', height);
  copy.setAttribute('style', 'color:#222;background:#fff;font:10px system-ui,sans-serif');
  return new Blob([new XMLSerializer().serializeToString(copy)], { type: 'image/svg+xml' });
}

async function saveImage(svg, name) {
  const image = new Image(), url = URL.createObjectURL(standalone(svg));
  await new Promise((done, failed) => { image.onload = done; image.onerror = failed; image.src = url; });
  const canvas = h('canvas', { width: 3 * image.width, height: 3 * image.height });
  canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((blob) => save(blob, name));
  URL.revokeObjectURL(url);
}

/* A figure of a plot by its options (Observable Plot). */
export function plot(caption, options) {
  if (!hasPlots) return null;
  const drawn = Plot.plot({ width: 420, height: 230, marginLeft: 52, style: { fontSize: '11px' }, ...options });
  const svg = drawn.tagName === 'svg' ? drawn : drawn.querySelector('svg[viewBox]');
  svg.setAttribute('role', 'img');
  svg.setAttribute('aria-label', caption);
  for (const group of svg.querySelectorAll('g[aria-label]')) group.removeAttribute('aria-label');
  return h('figure', { class: 'plot' }, h('figcaption', {}, h('span', {}, caption),
    h('button', { type: 'button', title: `Save as SVG: ${caption}`, onclick: () => save(standalone(svg), `${slug(caption)}.svg`) }, 'SVG'),
    h('button', { type: 'button', title: `Save as PNG: ${caption}`, onclick: () => saveImage(svg, `${slug(caption)}.png`) }, 'PNG')), drawn);
}

/* Tick texts of a logarithmic axis. */
export const power = (value) => (value >= 0.01 && value < 1000 ? digits(value) : value.toExponential(0).replace('e+', 'e'));

/* The chips that say which colour and pattern is which engine. */
export function chips(names, styles) {
  return h('p', { class: 'small' }, names.map((name) => {
    const { colour, dash } = styles.get(name);
    const line = svg('line', { x1: 0, x2: 26, y1: 5, y2: 5, stroke: colour, 'stroke-width': 3, 'stroke-dasharray': dash });
    return h('span', { class: 'chip' }, svg('svg', { viewBox: '0 0 26 10', 'aria-hidden': 'true' }, line), name);
  }));
}

/* Lines over x, one for each engine: lines: [{name, x, y}]; a vertical cursor is moved by the returned
 * figure's `cursor(x)`. Values <= 0 are left out of a logarithmic axis. */
export function curves(caption, lines, styles, { log = true, xLabel = 'time (s)', unit = '' } = {}) {
  if (!hasPlots) return null;
  const marks = lines.map(({ name, x, y }) => Plot.line(x.map((t, i) => [t, log && !(y[i] > 0) ? NaN : y[i] ?? NaN]), {
    x: '0', y: '1', stroke: styles.get(name).colour, strokeDasharray: styles.get(name).dash || undefined, strokeWidth: 1.6 }));
  const dots = lines.flatMap(({ name, x, y }) => x.map((t, i) => ({ name, t, y: y[i] })).filter((d) => Number.isFinite(d.y) && (!log || d.y > 0)));
  const figure = plot(caption, { x: { label: xLabel }, y: { label: unit, grid: true, type: log ? 'log' : 'linear', nice: true, tickFormat: log ? power : undefined, ticks: 5 },
    marks: [...marks, Plot.tip(dots, Plot.pointer({ x: 't', y: 'y', title: (d) => `${d.name}\n${digits(d.t)} s: ${digits(d.y)} ${unit}`, maxRadius: 30 }))] });
  const scale = Plot.plot({ width: 420, height: 230, marginLeft: 52, marks, y: { type: log ? 'log' : 'linear', nice: true } }).scale('x');
  const line = svg('line', { class: 'cursor', y1: 20, y2: 200, stroke: 'currentColor', 'stroke-width': 1, opacity: 0.6 });
  figure.querySelector('svg').append(line);
  figure.cursor = (x) => { const at = scale.apply(x); line.setAttribute('x1', at); line.setAttribute('x2', at); };
  figure.cursor(lines[0]?.x[0] ?? 0);
  return figure;
}

export { Plot };
