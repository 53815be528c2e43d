/* One case: replay, what it is, a table of engines, curves, deviations, how to run it again, metrics. */
import { add, facts, folded, h, p, section, table } from './dom.js';
import { digits, number } from './format.js';
import { errorOf, fastest, metric, remark, timeOf } from './overview.js';
import { chips, curves, plot, Plot, hasPlots, power } from './plots.js';
import { replay } from './replay.js';

const kinds = [
  ['rest_error', 'Position error: farthest body from where it belongs', 'm', true],
  ['penetration', 'Penetration: deepest overlap', 'm', true],
  ['kinetic_energy', 'Kinetic energy', 'J', true],
  ['energy', 'Total energy, relative to the start', 'J', false],
  ['iterations', 'Iterations, as the engine reports them', '', false],
  ['residual', 'Residual, as the engine reports it', '', true],
  ['contact_force', 'Contact force, summed over contacts', 'N', false]];

const badge = (cell) => h('span', { class: `badge ${cell.style ?? ''}` }, cell.verdict);

function engineTable(report, test, runs) {
  const least = fastest(report, test), runtimeOf = (name) => report.engines.find((e) => e.name === name).runtime;
  const of = (cell, name) => ({ text: cell.metrics[name]?.[1] ?? '–', value: metric(cell, name), title: cell.metrics[name]?.[2] });
  /* CPU time, and the elapsed time of an engine that is asked for several threads. */
  const timeCell = (name, cell) => {
    const cpu = of(cell, 'time_per_step'), wall = of(cell, 'wall_time_per_step');
    return report.engines.find((e) => e.name === name).threads > 1 ? { ...cpu, text: `${cpu.text}, wall ${wall.text}` } : cpu;
  };
  return table({ caption: `${test.name}: each engine`,
    columns: [{ name: 'engine' }, { name: 'verdict' }, { name: 'error', right: true }, { name: 'time a step', right: true }, { name: 'relative', right: true, title: 'to the fastest accurate native run' }, { name: 'deepest overlap', right: true }, { name: 'energy gained', right: true }, { name: 'iterations', right: true }, { name: 'why', wide: true }],
    rows: runs.map(({ name, cell }) => [name, { text: cell.verdict, children: [badge(cell), cell.repeats ? h('span', { class: 'small' }, ` ${cell.repeats} repeats`) : null] }, of(cell, 'reference_error'), timeCell(name, cell),
      { text: runtimeOf(name) ? `in ${runtimeOf(name)}` : Number.isFinite(least) && timeOf(cell) !== null ? `×${digits(timeOf(cell) / least)}` : '–', value: timeOf(cell) }, of(cell, 'penetration_max'), of(cell, 'energy_gain'), of(cell, 'iterations_mean'),
      [remark(test, cell), cell.why, cell.why?.includes(cell.note) ? '' : cell.note, cell.disagrees ? 'repeats differ' : ''].filter(Boolean).join('; ')]) });
}

/* The final distance of each body from its rest, for every run. */
function deviations(test, runs) {
  if (!test.scene || test.scene.rests.length === 0) return null;
  const shown = runs.filter((r) => r.cell.final);
  const away = (cell) => test.scene.rests.map((rest) => Math.hypot(...rest.at.map((v, k) => cell.final[7 * rest.body + k] - v)));
  const all = shown.map((r) => away(r.cell));
  const rows = test.scene.rests.map((rest, i) => [test.scene.bodies[rest.body].name, ...all.map((d) => ({ text: number(d[i], 'm'), value: d[i] }))]);
  return folded(`Final deviations of ${rows.length} ${rows.length === 1 ? 'body' : 'bodies'}`,
    table({ caption: 'Distance of each body from where it belongs at the end', columns: [{ name: 'body' }, ...shown.map((r) => ({ name: r.name, right: true }))], rows, most: 30 }));
}

function rawMetrics(report, runs) {
  const rows = report.metrics.filter((m) => runs.some((r) => m.name in r.cell.metrics))
    .map((m) => [{ text: m.name, title: m.definition }, ...runs.map((r) => { const [value, text, note] = r.cell.metrics[m.name] ?? [null, '–', 'does not apply']; return { text, value, title: note || undefined }; })]);
  return folded('All metrics', table({ caption: 'Every metric of every run; a title says its spread, or why it has no value', columns: [{ name: 'metric' }, ...runs.map((r) => ({ name: r.name, right: true }))], rows }));
}

function outputs(runs) {
  const said = runs.filter((r) => r.cell.output);
  return said.length === 0 ? null : folded('What engines printed', said.map((r) => [h('h3', {}, r.name), h('pre', {}, r.cell.output)]));
}

function again(test, runs) {
  return folded('Settings, and how to run it again',
    table({ caption: 'Parameters', columns: [{ name: 'parameter' }, { name: 'value', right: true }, { name: 'meaning', wide: true }], rows: test.params }),
    h('pre', {}, [test.again, ...runs.map((r) => `  --engine '${(r.cell.spec ?? r.name).replaceAll("'", "'\\''")}'`)].join(' \\\n')));
}

function plotCurves(loaded, styles) {
  const figures = [];
  for (const [key, caption, unit, log] of kinds) {
    const lines = loaded.filter((r) => r.recording?.curves[key]?.some((v) => v !== null && v !== 0))
      .map((r) => ({ name: r.name, x: r.recording.curveTimes, y: r.recording.curves[key] }));
    if (lines.length > 0) figures.push(curves(caption, lines, styles, { log, unit }));
  }
  return figures.filter(Boolean);
}

/* An error without a path over time: a dot for each run. */
function errorPlot(test, runs, styles) {
  const dots = runs.filter((r) => errorOf(r.cell) > 0);
  if (!hasPlots || dots.length === 0) return null;
  return plot(`${test.primary_error}, of all engines`, { marginLeft: 130, x: { type: 'log', label: `${test.unit && test.unit !== '1' ? test.unit : 'relative'}`, tickFormat: power, grid: true }, y: { label: null },
    marks: [test.bound ? Plot.ruleX([test.bound], { strokeDasharray: '4 3' }) : null, Plot.dot(dots, { x: (r) => errorOf(r.cell), y: 'name', fill: (r) => styles.get(r.name).colour, r: 5 })] });
}

function fill(body, report, test, styles) {
  const runs = report.engines.map((engine, i) => ({ name: engine.name, cell: test.cells[i] })).filter((r) => r.cell !== null)
    .map((r) => ({ ...r, label: [r.cell.verdict, r.cell.metrics.reference_error?.[1], remark(test, r.cell)].filter((t) => t && t !== '–').join(', ') }));
  const figures = [], plots = h('div', { class: 'plots' });
  if (test.scene) {
    const { element, recordings } = replay(test.scene, runs, styles, (time) => figures.forEach((f) => f.cursor(time)));
    body.append(element);
    recordings.then((found) => {
      figures.push(...plotCurves(runs.map((r, i) => ({ ...r, recording: found[i] })), styles));
      figures.forEach((f) => f.cursor(Math.max(...found.map((r) => r?.end ?? 0))));
      plots.append(...figures);
    });
  } else {
    body.append(h('p', { class: 'note' }, `No pictures: ${test.scene_error}.`));
  }
  const said = report.reference?.cases?.find((c) => c.name === test.scenario);
  add(body, [
    said ? h('ul', {}, said.sentences.map((s) => h('li', {}, `${s}.`))) : null,
    p(test.description ?? 'A scene that is not in the catalogue.'),
    facts([['Right answer', test.reference && h('span', { class: 'formula' }, test.reference)], ['Source', test.source], ['Expected', test.expected],
      ['Accurate', test.bound_text && [h('code', {}, test.primary_error), ` of at most ${test.bound_text}`, test.bound_reason ? `: ${test.bound_reason}` : '']], ['Valid', test.validity], ['Provokes', test.provokes], ['Users reported', test.symptom && `${test.symptom} (${test.threads})`]]),
    engineTable(report, test, runs), chips(runs.map((r) => r.name), styles)]);
  const errors = errorPlot(test, runs, styles);
  if (errors) plots.append(errors);
  add(body, [plots, deviations(test, runs), again(test, runs), outputs(runs), rawMetrics(report, runs)]);
}

/* The section is filled when it comes near the window. */
export function scenario(report, index, styles, whenNear) {
  const test = report.cases[index], body = h('div', { style: 'min-height:900px' });
  const part = section(`case-${index}`, test.title ? `${test.name}: ${test.title}` : test.name, body);
  whenNear(part, () => { body.removeAttribute('style'); fill(body, report, test, styles); });
  return part;
}
