/* The JSON of a study that has no document: every array of objects as a table, the rest as facts. */
import { facts, section, table } from './dom.js';
import { digits } from './format.js';

const show = (value) => (value === null || value === undefined ? '–' : typeof value === 'number' ? digits(value) : typeof value === 'object' ? JSON.stringify(value) : String(value));
const cell = (value) => ({ text: show(value), value: typeof value === 'number' || value === null ? value : undefined });

/* A table of an array of objects: a column for each key with plain values. */
function plain(caption, rows) {
  const found = [...new Set(rows.flatMap((row) => Object.keys(row).filter((k) => row[k] === null || typeof row[k] !== 'object')))];
  return table({ caption, columns: found.map((name) => ({ name: name.replaceAll('_', ' '), right: rows.some((r) => typeof r[name] === 'number') })), rows: rows.map((row) => found.map((k) => cell(row[k]))), most: 60 });
}

export function study(kind, study) {
  const arrays = Object.entries(study).filter(([, v]) => Array.isArray(v) && v.length > 0 && typeof v[0] === 'object' && v[0] !== null);
  return { title: `Plumb: ${kind}`, lead: '', parts: [section('facts', kind, facts(Object.entries(study).filter(([, v]) => v === null || typeof v !== 'object').map(([k, v]) => [k.replaceAll('_', ' '), show(v)]))),
    ...arrays.map(([key, rows]) => section(key, key.replaceAll('_', ' '), plain(key, rows)))] };
}
