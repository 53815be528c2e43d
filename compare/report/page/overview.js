/* The first screen: a sentence for each engine, the matrix of engines and scenarios, how runs differ. */
import { h, p, section, table } from './dom.js';
import { digits, number, plural } from './format.js';
import { Plot, hasPlots, plot, power } from './plots.js';
import { smallest, stills } from './replay.js';
import { boundsOf } from './scene3d.js';

export const metric = (cell, name) => { const value = cell?.metrics?.[name]?.[0]; return typeof value === 'number' ? value : null; };
export const errorOf = (cell) => metric(cell, 'reference_error');
export const timeOf = (cell) => metric(cell, 'time_per_step');

/* The decade of the error over the bound as a colour: 0 to 2 within the bound, 3 to 5 beyond it. */
export function decade(test, cell) {
  const error = errorOf(cell);
  if (cell.style === 'bad') return 'failed';
  if (cell.style === 'none' || cell.style === undefined) return 'none';
  if (cell.style === 'ok') return error === null || !(error > 1e-6 * test.bound) ? 'd0' : error > 1e-2 * test.bound ? 'd2' : 'd1';
  return error === null ? 'd4' : error > 100 * test.bound ? 'd5' : error > 10 * test.bound ? 'd4' : 'd3';
}

const marks = { ok: '■', poor: '▲', bad: '✖', none: '–' };

/* How far the dynamic body that moved farthest ended from its start, m; null where it is not known. */
function moved(test, cell) {
  if (!test.scene || !cell.final) return null;
  return Math.max(0, ...test.scene.bodies.map((b, i) => (b.static ? 0 : Math.hypot(...b.at.map((v, k) => cell.final[7 * i + k] - v)))));
}

/* What is wrong, in two or three words, where the numbers alone do not show it. */
export function remark(test, cell) {
  const depth = metric(cell, 'penetration_max');
  if (cell.style !== 'ok' && cell.style !== 'none' && moved(test, cell) === 0) return 'never moves';
  if (test.scene && depth > 0.1 * smallest(test.scene)) return `${digits(depth, 2)} m deep`;
  return '';
}

/* Times of engines in WebAssembly or an interpreter are shown, and not ranked with those of native ones. */
export const rankedTime = (report, test, index) => (report.engines[index].runtime ? null : timeOf(test.cells[index]));
export const fastest = (report, test) => Math.min(...test.cells.map((c, i) => (c?.style === 'ok' ? rankedTime(report, test, i) ?? Infinity : Infinity)));

/* How far a run of a scene without an expected result is from its converged reference: {distance,
 * differs}; null where there is none. */
function fromReference(report, test, name) {
  const bodies = report.reference?.cases?.find((c) => c.name === test.scenario && c.known)?.bodies ?? [];
  const found = bodies.flatMap((b) => b.configurations.filter((c) => c.label === name));
  return found.length === 0 ? null : { distance: Math.max(...found.map((c) => c.final_distance ?? 0)), differs: found.some((c) => c.differs_from !== null) };
}

function matrixCell(report, test, index, least) {
  const cell = test.cells[index], judged = cell && cell.style === undefined ? fromReference(report, test, report.engines[index].name) : null;
  if (cell === null) return { text: '', style: 'none', value: null, title: 'not run' };
  if (judged !== null) {
    return { style: judged.differs ? 'd4' : 'd1', value: judged.distance, title: `ends ${number(judged.distance, 'm')} from the converged reference`,
      children: [h('span', { class: 'mark', 'aria-label': judged.differs ? 'differs' : 'agrees', role: 'img' }, judged.differs ? marks.poor : marks.ok), h('span', { class: 'word' }, `${digits(judged.distance, 2)} m`), h('small', {}, judged.differs ? 'differs' : 'agrees')] };
  }
  const error = errorOf(cell), time = timeOf(cell), said = remark(test, cell);
  const word = cell.style === 'bad' ? cell.verdict.replace(/^failed: /, '') : cell.style === 'none' ? 'none' : '';
  const mark = cell.style === undefined ? '○' : marks[cell.style];
  const ranked = rankedTime(report, test, index) !== null;
  const cost = time === null || cell.style === 'none' ? '' : !ranked ? `${number(time, 's')}*` : Number.isFinite(least) ? `×${digits(time / least, 2)}` : number(time, 's');
  return {
    style: decade(test, cell), value: error ?? (cell.style === 'bad' ? Infinity : null),
    title: [cell.verdict, cell.why, `${test.primary_error ?? 'no reference'}: ${cell.metrics.reference_error?.[1] ?? '–'}`, time === null ? '' : `${number(time, 's')} a step`].filter(Boolean).join('\n'),
    children: [h('span', { class: 'mark', 'aria-label': cell.verdict, role: 'img' }, mark), h('span', { class: 'word' }, word || (error === null ? '' : digits(error, 2))),
      h('small', {}, [said || (word && error !== null ? digits(error, 2) : ''), cost].filter(Boolean).flatMap((text) => [h('span', {}, text), ' ']), '\u00a0')] };
}

const verdicts = ['accurate', 'inaccurate', 'failed', 'not judged', 'unsupported'];
const verdictOf = (cell) => ({ ok: 'accurate', poor: 'inaccurate', bad: 'failed', none: 'unsupported' })[cell.style] ?? 'not judged';

/* The engines that were run with the counts of their verdicts: the most accurate first, then the fewest failed, then the fewest inaccurate. */
function ranking(report) {
  const engines = report.engines.map(({ name }, index) => {
    const cells = report.cases.map((test) => test.cells[index]).filter((cell) => cell !== null);
    return { name, index, total: cells.length, counts: Object.fromEntries(verdicts.map((verdict) => [verdict, cells.filter((cell) => verdictOf(cell) === verdict).length])) };
  });
  const order = (a, b) => b.counts.accurate - a.counts.accurate || a.counts.failed - b.counts.failed || a.counts.inaccurate - b.counts.inaccurate || (a.name < b.name ? -1 : 1);
  return engines.filter(({ total }) => total > 0).sort(order);
}

function sentences(report, engines) {
  return h('ul', { class: 'sentences' }, engines.map(({ name, index, total, counts }) => {
    const rest = verdicts.slice(1).filter((k) => counts[k] > 0).map((k) => `${counts[k]} ${k}`);
    const odd = report.cases.map((test) => test.cells[index] && remark(test, test.cells[index])).filter(Boolean);
    const still = odd.filter((text) => text === 'never moves').length, deep = odd.length - still;
    const said = [still > 0 ? `nothing moves in ${still}` : '', deep > 0 ? `deep overlaps in ${deep}` : ''].filter(Boolean);
    return h('li', {}, h('b', {}, name), ` is accurate in ${counts.accurate} of ${total}`, rest.length > 0 ? ` (${rest.join(', ')})` : '', said.length > 0 ? `; ${said.join(', ')}` : '', '.');
  }));
}

function matrix(report) {
  const columns = [{ name: 'scenario', title: 'sort by scenario' }, ...report.engines.map((e) => ({ name: e.name, right: true, lines: true })), { name: 'bound', right: true, title: 'the largest error of an accurate run' }];
  const rows = report.cases.map((test, i) => {
    const least = fastest(report, test);
    return [{ text: test.name, value: i, title: test.title, children: h('a', { href: `#case-${i}` }, test.name) }, ...test.cells.map((_, k) => matrixCell(report, test, k, least)),
      { text: test.bound_text ?? '–', value: test.bound ?? null, title: [test.primary_error, test.bound_reason].filter(Boolean).join(': ') }];
  });
  return table({ caption: 'Error of each engine in each scenario; below it the time of a step, relative to the fastest accurate run', columns, rows, style: 'matrix', most: 60 });
}

function legend() {
  const key = (style, mark, text) => h('span', {}, h('span', { class: `key ${style}` }, mark), text);
  return h('p', { class: 'legend' }, h('span', {}, 'error over the bound:'), key('d0', '■', '≤ 1e-6'), key('d1', '■', '≤ 0.01'), key('d2', '■', '≤ 1: accurate'),
    key('d3', '▲', '> 1'), key('d4', '▲', '> 10'), key('d5', '▲', '> 100: inaccurate'), key('failed', '✖', 'failed'), key('none', '–', 'unsupported or not run'), h('span', {}, '×: time of a step, of the fastest accurate native run; *: in WebAssembly or an interpreter, not ranked'));
}

/* How differently the runs of a case ended: the largest distance along an axis between a body's places,
 * of the scene's size. */
function spread(test) {
  if (!test.scene) return 0;
  const finals = test.cells.filter((c) => c?.final && ['ok', 'collapsed'].includes(c.outcome)).map((c) => c.final);
  const { radius } = boundsOf(test.scene, []);
  let most = 0;
  test.scene.bodies.forEach((body, i) => {
    for (let k = 0; k < 3 && !body.static; ++k) {
      const values = finals.map((f) => f[7 * i + k]);
      most = Math.max(most, Math.max(...values) - Math.min(...values));
    }
  });
  return most / radius;
}

/* The case whose engines disagree most, in pictures: of those in which many bodies move anywhere, if
 * there is one, because a heap shows it best. */
function disagreement(report) {
  const found = report.cases.map((test, index) => ({ test, index, by: spread(test), many: test.scene?.bodies.filter((b) => !b.static).length > 20 && test.scene.rests.length === 0 }))
    .map((c) => ({ ...c, by: c.by > 0.05 && c.many ? c.by + 1e6 : c.by })).filter((c) => c.by > 0.05).sort((a, b) => b.by - a.by)[0];
  if (found === undefined) return null;
  const runs = report.engines.map((engine, i) => ({ name: engine.name, cell: found.test.cells[i] })).filter((r) => r.cell?.final)
    .map((r) => ({ ...r, label: [r.cell.verdict, remark(found.test, r.cell)].filter(Boolean).join(', ') }));
  const pictures = stills(found.test.scene, runs);
  return pictures === null ? null : [h('h3', {}, 'How ', h('a', { href: `#case-${found.index}` }, found.test.name), ' ends: the engines differ most here'), pictures];
}

function speedError(report, styles) {
  const dots = report.cases.flatMap((test) => {
    const least = fastest(report, test);
    return test.cells.map((cell, i) => ({ test, cell, name: report.engines[i].name, x: (rankedTime(report, test, i) ?? NaN) / least, y: Math.max(errorOf(cell) ?? NaN, 1e-12 * (test.bound ?? NaN)) / test.bound }));
  }).filter((d) => d.cell !== null && Number.isFinite(d.x) && d.x > 0 && Number.isFinite(d.y) && d.y > 0);
  if (!hasPlots || dots.length < 2) return null;
  const shapes = { ok: 'square', poor: 'triangle', bad: 'times' };
  return plot('Error against time: one mark a scenario and engine', { width: 900, height: 330,
    x: { type: 'log', label: 'time of a step, relative to the fastest accurate run →', tickFormat: power }, y: { type: 'log', label: '↑ error over the acceptance bound', tickFormat: power, grid: true },
    symbol: { domain: ['ok', 'poor', 'bad'], range: ['square', 'triangle', 'times'] },
    marks: [Plot.ruleY([1], { strokeDasharray: '4 3' }), Plot.text([[Math.max(...dots.map((d) => d.x)), 1]], { text: () => 'bound', dy: -7, textAnchor: 'end' }),
      Plot.dot(dots, { x: 'x', y: 'y', stroke: (d) => styles.get(d.name).colour, symbol: (d) => (d.cell.style in shapes ? d.cell.style : 'poor'), r: 4 }),
      Plot.tip(dots, Plot.pointer({ x: 'x', y: 'y', title: (d) => `${d.name}\n${d.test.name}\nerror ${d.cell.metrics.reference_error[1]}, ${number(timeOf(d.cell), 's')} a step\n${d.cell.spec ?? ''}` }))] });
}

export function overview(report, styles) {
  const reference = report.reference?.sentences ?? [];
  const engines = ranking(report);
  const judged = engines.some(({ counts }) => counts.accurate + counts.inaccurate + counts.failed > 0);
  const part = section('overview', `${plural(report.cases.length, 'scenario')}, ${plural(report.engines.length, 'engine configuration')}`,
    sentences(report, engines),
    reference.length > 0 ? h('ul', { class: 'sentences reference' }, reference.map((s) => h('li', {}, `${s}.`))) : null,
    judged || reference.length > 0 ? null : p('No run was judged: the scenes state no expected result.', 'note'),
    report.several_hosts ? h('p', { class: 'warn' }, 'These runs come from several machines: their times cannot be compared with each other.') : null,
    report.disagrees ? h('p', { class: 'warn' }, 'Some repeats of the same run differ where they should agree. Their scenarios say which.') : null,
    matrix(report), legend());
  const pictures = h('div');
  part.append(pictures);
  setTimeout(() => { const made = disagreement(report); if (made) pictures.append(...made); }, 0);
  const scatter = speedError(report, styles);
  if (scatter) part.append(scatter);
  return part;
}
