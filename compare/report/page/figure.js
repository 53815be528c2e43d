/* A picture for a paper: #figure=SCENARIO;t=SECONDS;format=svg. All engines side by side at one time. */
import { h, svg } from './dom.js';
import { Recording } from './recording.js';
import { finalPoses } from './replay.js';
import { Stage, aim, boundsAt, boundsOf, cameraFor, draw, drawSvg } from './scene3d.js';

const WIDTH = 320, HEIGHT = 240, CAPTION = 34;

const text = (x, y, content, size, weight) => svg('text', { x, y, 'font-size': size, 'font-weight': weight, 'font-family': 'system-ui,Helvetica,Arial,sans-serif', fill: '#111' }, content);

function picture(stage, camera, format) {
  if (format === 'svg') return drawSvg(stage, camera, WIDTH, HEIGHT);
  const canvas = h('canvas');
  draw(canvas, stage, camera, 2 * WIDTH);
  return svg('image', { href: canvas.toDataURL(), width: WIDTH, height: HEIGHT });
}

export async function figure(report, main) {
  const asked = new URLSearchParams(location.hash.slice(1).replaceAll(';', '&'));
  const index = Number(asked.get('figure')), test = report.cases[index], format = asked.get('format') ?? 'svg';
  document.body.classList.add('figure');
  const runs = [];
  for (const [i, engine] of report.engines.entries()) {
    const cell = test.cells[i], recording = cell && await Recording.load(cell.run, test.scene);
    const at = asked.has('t') ? Number(asked.get('t')) : recording?.end ?? 0;
    const poses = recording?.at(at) ?? (asked.has('t') ? null : finalPoses(cell, test.scene));
    if (poses) runs.push({ name: engine.name, cell, poses });
  }
  const bounds = boundsOf(test.scene, runs.filter((r) => r.cell.outcome === 'ok').map((r) => r.poses)), camera = cameraFor(bounds, test.scene);
  const columns = Math.min(runs.length, 4), rows = Math.ceil(runs.length / 4);
  const size = [columns * (WIDTH + 10), rows * (HEIGHT + CAPTION + 10)];
  const whole = svg('svg', { xmlns: 'http://www.w3.org/2000/svg', width: size[0], height: size[1], viewBox: `0 0 ${size[0]} ${size[1]}`, id: 'figure' });
  runs.forEach((run, i) => {
    const stage = new Stage(test.scene, bounds, [null], { instanced: format !== 'svg' });
    stage.place(0, run.poses);
    aim(camera, boundsAt(bounds, test.scene, run.poses), { zoom: 1.1 });
    const part = picture(stage, camera, format);
    const x = (i % 4) * (WIDTH + 10), y = Math.floor(i / 4) * (HEIGHT + CAPTION + 10);
    if (format === 'svg') { part.setAttribute('x', 0); part.setAttribute('y', 0); }
    whole.append(svg('g', { transform: `translate(${x} ${y})` }, part, text(4, HEIGHT + 14, run.name, 13, 600), text(4, HEIGHT + 29, `${run.cell.verdict}${run.cell.metrics.reference_error ? `, ${run.cell.metrics.reference_error[1]}` : ''}`, 11, 400)));
    stage.dispose();
  });
  main.append(whole);
  document.documentElement.dataset.figure = `${size[0]}x${size[1]}`;
  const page = h('style', {}, `@page{size:${size[0]}px ${size[1]}px;margin:0}@media print{body.figure main svg{display:block}}`);
  document.head.append(page);
}
