/* The last parts of a report: words, fairness, metrics, provenance, licences. */
import { data, facts, folded, h, p, section, table } from './dom.js';

/* The keys of an object, sorted. */
export const once = (values) => Object.keys(values).filter(Boolean).sort();

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
  const pairs = ['Processor', 'System', 'Compiler', 'Flags', 'Plumb', 'Commit'].map((name) => [name, once(from[name]).join('; ')]);
  return section('provenance', 'Where the numbers come from', facts([...pairs, ['Started', from.first && (from.first === from.last ? from.first : `${from.first} to ${from.last}`)], ['Command', report.command && h('code', {}, report.command.join(' '))]]));
}

export function licences() {
  const found = Object.entries(data('licences') ?? {}).filter(([name]) => name !== '');
  if (found.length === 0) return null;
  return section('licences', 'Licences of bundled parts', p(`This page contains ${found.map(([name]) => name).join(', ')}.`, 'small'), folded('Licence texts', found.map(([name, text]) => [h('h3', {}, name), h('pre', {}, text)])));
}
