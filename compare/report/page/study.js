/* Pages of the other studies: ensembles as distributions; the rest as tables of their JSON. */
import { facts, h, p, section, table } from './dom.js';
import { styles as stylesOf } from './engines.js';
import { digits, plural } from './format.js';
import { Plot, chips, hasPlots, plot } from './plots.js';

const show = (value) => (value === null || value === undefined ? '–' : typeof value === 'number' ? digits(value) : typeof value === 'object' ? JSON.stringify(value) : String(value));
const cell = (value) => ({ text: show(value), value: typeof value === 'number' || value === null ? value : undefined });

/* A table of an array of objects: a column for each key with plain values. */
function plain(caption, rows, keys) {
  const found = keys ?? [...new Set(rows.flatMap((row) => Object.keys(row).filter((k) => row[k] === null || typeof row[k] !== 'object')))];
  return table({ caption, columns: found.map((name) => ({ name: name.replaceAll('_', ' '), right: rows.some((r) => typeof r[name] === 'number') })), rows: rows.map((row) => found.map((k) => cell(row[k]))), most: 60 });
}

const byLabel = (rows) => stylesOf([...new Set(rows)].map((name) => ({ name, engine: name.split(':')[0] })));
const groups = (rows, key) => Map.groupBy ? Map.groupBy(rows, key) : rows.reduce((m, r) => m.set(key(r), [...(m.get(key(r)) ?? []), r]), new Map());

function ensemble(study) {
  const items = study.ensembles, styles = byLabel(items.map((e) => e.name)), apart = study.comparisons.filter((c) => c.verdict === 'told apart');
  const name = (i) => items[i].name;
  const parts = [section('verdict', apart.length === 0 ? 'No difference is significant' : `${plural(apart.length, 'difference')} of ${study.comparisons.length} ${apart.length === 1 ? 'is' : 'are'} significant`,
    h('ul', {}, apart.map((c) => h('li', {}, c.finding))), p(`${study.members} members each, displaced by at most ${digits(study.jitter)} of a body's size; permutation test of the energy distance, corrected by Holm, significant below ${digits(study.significance)}.`))];
  for (const [problem, found] of groups(items, (e) => `${e.scenario}`)) {
    const observables = [...new Set(found.flatMap((e) => Object.keys(e.observables)))];
    parts.push(section(`ensemble-${parts.length}`, problem, chips(found.map((e) => e.name), styles), h('div', { class: 'plots' }, observables.map((key) => {
      const dots = found.flatMap((e) => (e.observables[key]?.values ?? []).map((value) => ({ name: e.name, value })));
      return hasPlots && dots.length > 0 ? plot(`${key}: each member, and quartiles`, { marginLeft: 150, height: 60 + 34 * found.length, x: { label: found.find((e) => e.observables[key])?.observables[key].unit ?? '', grid: true }, y: { label: null },
        marks: [Plot.boxX(dots, { x: 'value', y: 'name', fill: (d) => styles.get(d.name).colour, fillOpacity: 0.2, r: 0 }), Plot.dot(dots, Plot.dodgeY ? { x: 'value', y: 'name', stroke: (d) => styles.get(d.name).colour, r: 2.5 } : {})] }) : null;
    })),
    table({ caption: 'Ensembles', columns: [{ name: 'ensemble' }, { name: 'members', right: true }, { name: 'horizon (s)', right: true }, { name: 'outcomes', wide: true }, ...observables.map((k) => ({ name: k.replaceAll('_', ' '), right: true }))],
      rows: found.map((e) => [e.name, e.results, { text: e.horizon?.time === null ? e.horizon.reason ?? '–' : digits(e.horizon?.time), value: e.horizon?.time ?? null }, Object.entries(e.outcomes).filter(([, n]) => n > 0).map(([k, n]) => `${n} ${k}`).join(', '),
        ...observables.map((k) => { const o = e.observables[k]; return o ? { text: `${digits(o.mean)} ± ${digits(o.standard_deviation)} ${o.unit}`, value: o.mean } : '–'; })]) })));
  }
  parts.push(section('comparisons', 'All comparisons', table({ caption: 'Two ensembles and an observable', columns: [{ name: 'first' }, { name: 'second' }, { name: 'observable' }, { name: 'energy distance', right: true }, { name: 'p', right: true }, { name: 'p, corrected', right: true }, { name: 'verdict' }],
    rows: study.comparisons.map((c) => [name(c.a), name(c.b), c.observable, cell(c.energy_distance), cell(c.p), cell(c.p_corrected), c.verdict]), most: 60 })));
  return { title: 'Plumb: ensembles', lead: `${plural(items.length, 'ensemble')} of ${study.members} members`, parts };
}

/* Every array of objects as a table, the rest as facts. */
function other(kind, study) {
  const arrays = Object.entries(study).filter(([, v]) => Array.isArray(v) && v.length > 0 && typeof v[0] === 'object' && v[0] !== null);
  return { title: `Plumb: ${kind}`, lead: '', parts: [section('facts', kind, facts(Object.entries(study).filter(([, v]) => v === null || typeof v !== 'object').map(([k, v]) => [k.replaceAll('_', ' '), show(v)]))),
    ...arrays.map(([key, rows]) => section(key, key.replaceAll('_', ' '), plain(key, rows)))] };
}

export function study(kind, json) {
  const pages = { ensemble };
  return kind in pages ? pages[kind](json) : other(kind, json);
}
