/* The later parts of a report: findings, where the home engine loses, settings, words, fairness, metrics. */
import { data, facts, folded, h, p, section, table } from './dom.js';

const link = (report, index) => ({ text: report.cases[index].name, value: index, children: h('a', { href: `#case-${index}` }, report.cases[index].name) });

export function findings(report) {
  const f = report.findings;
  if (!f.statement) return null;
  return section('findings', 'Findings', p(f.statement, 'lead'), p(f.adapters), p(f.read_back), p(f.origin),
    table({ caption: report.losses.home ? 'Runs of other engines that are not accurate' : 'Runs that are not accurate', columns: [{ name: 'case' }, { name: 'engine' }, { name: 'error' }, { name: 'what in the engine causes it', wide: true }, { name: 'what was varied, and what changed', wide: true }],
      rows: f.rows.map(([test, engine, error, , cause, evidence]) => [link(report, test), engine, error, cause, evidence]), most: 40 }));
}

/* Of the home engine: where it is worse than others, and which of its runs are not accurate. */
export function home(report) {
  const l = report.losses, f = report.findings;
  if (!l.home) return null;
  return section('losses', `Where ${l.home} loses`, p(l.statement, 'lead'),
    l.rows.length > 0 ? table({ caption: `Comparisons that ${l.home} loses`, columns: [{ name: 'case' }, { name: 'metric' }, { name: 'home' }, { name: 'value', right: true }, { name: 'best other' }, { name: 'value', right: true }, { name: 'ratio', right: true }],
      rows: l.rows.map(([test, ...rest]) => [link(report, test), ...rest]), most: 20 }) : null,
    folded('What is compared, and which differences count', p(l.rule)),
    f.home_statement ? [p(f.home_statement), table({ caption: `Runs of ${l.home} that are not accurate`, columns: [{ name: 'case' }, { name: 'engine' }, { name: 'error' }, { name: 'why', wide: true }, { name: 'what in the engine causes it', wide: true }, { name: 'what was varied, and what changed', wide: true }],
      rows: f.home_rows.map(([test, ...rest]) => [link(report, test), ...rest]), most: 20 })] : null);
}

export function stepping(report) {
  const rows = report.cases.flatMap((test, i) => test.cells.map((cell, k) => ({ cell, k, i })).filter(({ cell }) => cell && ['travel_error', 'value_error'].includes(test.primary_error) && cell.metrics.discrete_error?.[0] !== null && cell.metrics.discrete_error)
    .map(({ cell, k }) => [link(report, i), report.engines[k].name, cell.metrics.integrator?.[1] ?? 'not detected', { text: cell.metrics.reference_error[1], value: cell.metrics.reference_error[0] }, { text: cell.metrics.discrete_error[1], value: cell.metrics.discrete_error[0] }]));
  if (rows.length === 0) return null;
  return section('stepping', 'Time stepping and contact',
    p('The error against the right answer has two parts. A time-stepping rule has an error even where every force is right. Compared with the exact answer of the engine\'s own rule at the same step that part is gone, and the rest comes from contacts and friction. The rule is detected from the frames.'),
    table({ caption: 'Both errors of each run', columns: [{ name: 'case' }, { name: 'engine' }, { name: 'rule, as detected' }, { name: 'error against the right answer', right: true }, { name: 'against its own rule', right: true }], rows, most: 20 }));
}

export function settings(report) {
  return section('settings', 'Engines and their settings',
    p('Conformance is what plumb check-engine found of the engine and its adapter by small scenes that each catch one mistake, for the engine\'s very binary and the profile\'s default options. “Not verified” means that nothing is known: a deviation may be the adapter\'s.'),
    table({ caption: 'As recorded with the first run of each engine', columns: [{ name: 'engine' }, { name: 'version' }, { name: 'conformance', wide: true }, { name: 'settings', wide: true }], rows: report.engines.map((e) => [e.name, e.version, e.conformance, e.settings]) }));
}

export function words(report) {
  const here = [...new Set(report.engines.map((e) => e.engine))].filter((name) => report.words?.[name]);
  if (here.length === 0) return null;
  return section('words', 'What words mean in each engine',
    p('The same word is not the same thing in every engine. This is how the numbers of the scene and the options reach each of them, and what could not be mapped.'),
    table({ caption: 'Parameters and their mapping', columns: [{ name: 'word' }, ...here.map((name) => ({ name, wide: true }))], rows: Object.keys(report.words[here[0]]).map((word) => [word, ...here.map((e) => report.words[e][word] ?? '–')]), most: 12 }));
}

export function fairness() {
  return section('fairness', 'How it was measured',
    p('Every run is a process of its own, with limits on time and memory. A run in which the engine aborts, hangs or returns numbers that are not finite is shown like any other, with the output of its engine.'),
    p('No engine measures itself: the same code computes positions, penetration and energy for all, from poses and velocities. Iterations, residual and contacts are what an engine reports of itself; they mean different things to different engines.'),
    p('Time is the CPU time of the engine\'s step call alone. Over repeats, times and memory are medians; everything else must be the same in every repeat, and is marked where it is not. Differences of less than 10 % mean nothing: repeat runs (--repeat) before you trust larger ones.'),
    p('Accurate is a run that ended ok and whose primary error is within the bound of its case; inaccurate one whose error is larger; failed one that did not end ok, or in which a body moved in a way that nothing explains. “–” means that there is no number; its title says why.'));
}

export function metrics(list) {
  return section('metrics', 'Metrics', folded(`Definitions of ${list.length} metrics`, facts(list.map((m) => [
    [h('code', {}, m.name), ` ${[m.unit !== '1' && m.unit, m.direction, m.measured && 'measured'].filter(Boolean).join(', ')}`], m.definition]), 'long')));
}

export function provenance(report) {
  const from = report.provenance;
  const pairs = ['Processor', 'System', 'Compiler', 'Flags', 'Plumb', 'Commit'].map((name) => [name, from[name].join('; ')]);
  return section('provenance', 'Where the numbers come from', facts([...pairs, ['Started', from.first && (from.first === from.last ? from.first : `${from.first} to ${from.last}`)], ['Command', report.command && h('code', {}, report.command)]]));
}

export function licences() {
  const found = Object.entries(data('licences') ?? {}).filter(([name]) => name !== '');
  if (found.length === 0) return null;
  return section('licences', 'Licences of bundled parts', p(`This page contains ${found.map(([name]) => name).join(', ')}.`, 'small'), folded('Licence texts', found.map(([name, text]) => [h('h3', {}, name), h('pre', {}, text)])));
}
