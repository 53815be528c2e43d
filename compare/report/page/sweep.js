/* Speed against error: fronts, speed at the same error, error at the same cost, performance profiles. */
import { folded, h, p, section, table } from './dom.js';
import { styles as stylesOf } from './engines.js';
import { digits, number, plural, ratio } from './format.js';
import { Plot, chips, hasPlots, plot, power } from './plots.js';

const ratioText = (r) => (r === null ? '–' : r.low === null ? ratio(r.value) : `${ratio(r.value)} (${digits(r.low)} to ${digits(r.high)})`);
const ratioCell = (r) => ({ text: ratioText(r), value: r?.value ?? null });
const settingsOf = (point) => (point ? `${point.label}, dt = ${digits(point.dt)} s` : '–');
const errorText = (value, unit) => number(value, unit);

function front(study, scene, styles, all) {
  const points = study.points.filter((q) => q.scene === all && q.state === 'ok' && q.cost > 0 && q.error > 0);
  if (!hasPlots || points.length === 0) return null;
  const whole = scene.curves.filter((c) => study.engines[c.engine].all_profiles);
  const marks = whole.map((c) => Plot.line(c.front.map((i) => study.points[i]), { x: 'cost', y: 'error', stroke: styles.get(study.engines[c.engine].name).colour, strokeDasharray: styles.get(study.engines[c.engine].name).dash || undefined, strokeWidth: 2 }));
  const failed = study.points.filter((q) => q.scene === all && q.state === 'failed');
  return plot(`${scene.name}: ${scene.primary_error} over CPU time for a simulated second`, { width: 700, height: 330, marginLeft: 60,
    x: { type: 'log', label: 'CPU time for a simulated second (s) →', tickFormat: power, grid: true }, y: { type: 'log', label: `↑ ${scene.primary_error}${scene.unit ? ` (${scene.unit})` : ''}`, tickFormat: power, grid: true },
    marks: [...marks, Plot.dot(points, { x: 'cost', y: 'error', fill: (q) => styles.get(study.engines[q.engine].name).colour, r: 3, fillOpacity: (q) => (whole.some((c) => c.front.includes(study.points.indexOf(q))) ? 1 : 0.35) }),
      Plot.tip(points, Plot.pointer({ x: 'cost', y: 'error', title: (q) => `${q.label}\ndt = ${digits(q.dt)} s\nerror ${errorText(q.error, scene.unit)}\n${digits(q.cost)} s CPU a second` })),
      failed.length > 0 ? Plot.text([`${plural(failed.length, 'point')} failed`], { frameAnchor: 'top-right' }) : null] });
}

function profilePlot(study, profile, styles) {
  if (!hasPlots || profile.scenes === 0) return null;
  const lines = profile.engines.filter((e) => e.ratios.length > 0).map((e) => ({ name: study.engines[e.engine].name, steps: [[1, 0], ...e.ratios.map((r, i) => [r, (i + 1) / profile.scenes]), [100, e.ratios.length / profile.scenes]].filter(([x]) => x <= 100) }));
  if (lines.length === 0) return null;
  return plot(`${profile.all_profiles ? 'Engines' : 'Profiles'}, at an error of at most ${power(profile.level)}: ${profile.scenes} scenes`, { x: { type: 'log', domain: [1, 100], label: 'factor of the cost of the fastest →' }, y: { domain: [0, 1], label: '↑ share of scenes solved', grid: true },
    marks: lines.map((l) => Plot.line(l.steps, { curve: 'step-after', stroke: styles.get(l.name)?.colour, strokeDasharray: styles.get(l.name)?.dash || undefined, strokeWidth: 2 })) });
}

function costs(study, scene) {
  const curves = scene.curves.filter((c) => !study.engines[c.engine].as_shipped);
  return table({ caption: 'Cost at error: least CPU time for a simulated second', columns: [{ name: 'engine' }, ...study.levels.map((l) => ({ name: `≤ ${power(l)}`, right: true })), { name: 'settings tried', right: true }, { name: 'failed', right: true }],
    rows: curves.map((c) => [study.engines[c.engine].name, ...c.cost_at_level.map((v, k) => ({ text: v === null ? '–' : number(v, 's'), value: v, title: v === null ? 'not reached with the settings that were tried' : settingsOf(study.points[c.cheapest_at_level[k]]) })), c.settings, c.failed]) });
}

function errors(study, scene) {
  return table({ caption: 'Error at cost: least error of the points up to that CPU time', columns: [{ name: 'engine' }, ...study.times.map((t) => ({ name: number(t, 's'), right: true }))],
    rows: scene.curves.filter((c) => study.engines[c.engine].all_profiles).map((c) => [study.engines[c.engine].name, ...c.most_exact_at_time.map((i) => (i === null ? '–' : { text: errorText(study.points[i].error, scene.unit), value: study.points[i].error, title: settingsOf(study.points[i]) }))]) });
}

function pairs(study, scene) {
  const rows = scene.pairs.flatMap((d) => d.levels.filter((l) => l.reached !== 'neither').map((l) => [`${study.engines[d.first].name} / ${study.engines[d.second].name}`, { text: power(l.level), value: l.level }, l.reached, ratioCell(l.speed), settingsOf(study.points[l.first_point]), settingsOf(study.points[l.second_point])]));
  return rows.length === 0 ? null : table({ caption: 'Speed of the first over the second at the same error', columns: [{ name: 'pair' }, { name: 'error ≤', right: true }, { name: 'reached by' }, { name: 'speed', right: true }, { name: 'settings of the first', wide: true }, { name: 'of the second', wide: true }], rows, most: 20 });
}

function allPoints(study, index, unit) {
  const rows = study.points.filter((q) => q.scene === index).map((q) => [q.label, { text: digits(q.dt), value: q.dt }, q.state, { text: number(q.cost, 's'), value: q.cost ?? null }, { text: errorText(q.error, unit), value: q.error ?? null }, q.reason ?? '']);
  return folded(`All ${rows.length} points`, table({ caption: 'Every point', columns: [{ name: 'configuration' }, { name: 'dt (s)', right: true }, { name: 'state' }, { name: 'CPU time for a second', right: true }, { name: 'error', right: true }, { name: 'reason', wide: true }], rows, most: 40 }));
}

export function sweep(study) {
  const styles = stylesOf([...new Map(study.engines.map((e) => [e.name, { name: e.name, engine: e.name.split(':')[0] }])).values()]);
  const whole = study.engines.filter((e) => e.all_profiles).map((e) => e.name);
  const inner = study.scenes.map((scene, i) => section(`scene-${i}`, scene.name, front(study, scene, styles, i), chips(whole.filter((n) => scene.curves.some((c) => study.engines[c.engine].name === n)), styles), costs(study, scene), errors(study, scene), pairs(study, scene), allPoints(study, i, scene.unit)));
  const means = study.pairs.flatMap((q) => q.levels.filter((l) => l.both + l.first_only + l.second_only > 0).map((l) => [`${study.engines[q.first].name} / ${study.engines[q.second].name}`, { text: power(l.level), value: l.level }, ratioCell(l.mean_speed), l.both, l.first_only, l.second_only, l.neither]));
  const orders = study.orders.map((o) => [study.scenes[o.scene].name, study.engines[o.engine].name, o.finding, { text: digits(o.order), value: o.order }, `${digits(o.dt_low)} to ${digits(o.dt_high)} s`]);
  const losses = study.losses.map((l) => [study.scenes[l.scene].name, { text: power(l.level), value: l.level }, settingsOf(study.points[l.first_point]), settingsOf(study.points[l.second_point]), ratioCell(l.speed), l.within_noise ? 'within noise' : '']);
  const parts = [
    section('profiles', 'Performance profiles', p('The share of scenes that an engine solves to an error within a factor of the cost of the fastest engine that does (Dolan and Moré 2002).'),
      p(study.unverified, 'note'), p(study.warning, 'warn'),
      h('div', { class: 'plots' }, study.profiles.filter((q) => q.all_profiles).map((q) => profilePlot(study, q, styles))), chips(whole, styles)),
    ...inner,
    means.length > 0 ? section('means', 'Speed at the same error, over all scenes', p('The geometric mean over the scenes that both solve to the error, of the cheapest settings of each that were run; the range holds 95 % of bootstrap replicates.'),
      table({ caption: 'Speed of the first over the second', columns: [{ name: 'pair' }, { name: 'error ≤', right: true }, { name: 'mean speed', right: true }, { name: 'both', right: true }, { name: 'first only', right: true }, { name: 'second only', right: true }, { name: 'neither', right: true }], rows: means, most: 30 })) : null,
    orders.length > 0 ? section('orders', 'Order of convergence', p('The slope of the logarithm of error over that of the time step, over runs that differ in the time step alone.'),
      table({ caption: 'Orders', columns: [{ name: 'scene' }, { name: 'engine' }, { name: 'finding' }, { name: 'order', right: true }, { name: 'time steps' }], rows: orders, most: 30 })) : null,
    losses.length > 0 ? section('losses', `Where ${study.home} loses`, p(study.statement, 'lead'), table({ caption: 'Levels of error at which another engine is cheaper', columns: [{ name: 'scene' }, { name: 'error ≤', right: true }, { name: 'home', wide: true }, { name: 'other', wide: true }, { name: 'speed', right: true }, { name: '' }], rows: losses, most: 30 })) : null,
    section('method', 'How speed and error are weighed',
      p(`A point is an engine with its options at a time step on a scene. Its cost is the CPU time of the engine's steps alone for a second of simulated time, the median over its repeats; its error is the scenario's primary error, and an error below ${power(study.error_floor)} counts as that. A point of which any repeat or change was not ok has failed and has no numbers.`),
      p('A front has the points of an engine for which no other of its points is both cheaper and as exact. Nothing is extrapolated.'),
      p(`The ranges hold 95 % of ${study.draws} bootstrap replicates, in which the repeats of each point are drawn with replacement, by a fixed seed.`))];
  return { title: 'Plumb: speed against error', lead: `${plural(study.runs, 'run')}, ${plural(study.points.length, 'point')} on ${plural(study.scenes.length, 'scene')}`, parts: parts.filter(Boolean), inner, innerTitle: 'Scenes' };
}
