/* Draws a document: the page of any study. compare/base/document.h describes its JSON. */
import { h, p, section, table } from './dom.js';
import { styles as stylesOf } from './engines.js';
import { digits, slug } from './format.js';
import { Plot, chips, hasPlots, plot, power } from './plots.js';

const byName = (rows) => stylesOf([...new Set(rows.map((row) => row.name))].map((name) => ({ name, engine: name.split(/[:@, ]/)[0] })));

/* A cell sorts by its number, if its text is one. `links`: text -> what it is a link to. */
const cell = (value, links) => {
  const made = typeof value === 'string' ? { text: value } : value, number = Number(made.text), to = links.get(made.text);
  return { ...made, value: made.text !== '' && Number.isFinite(number) ? number : undefined, children: to && h('a', { href: to }, made.text) };
};

/* A column of long texts is wide. */
function drawTable({ caption, columns, most, rows }, links) {
  const isWide = (i) => !columns[i].right && rows.some((row) => (row[i]?.text ?? row[i] ?? '').length > 40);
  return table({ caption, columns: columns.map((column, i) => ({ ...column, wide: isWide(i) })), most: most || 60, rows: rows.map((row) => row.filter((c) => c !== null).map((c) => cell(c, links))) });
}

const pairsOf = (row) => row.numbers.flatMap((x, i) => (i % 2 === 0 ? [{ name: row.name, x, y: row.numbers[i + 1] }] : []));

/* The points that no other is below and left of, by x. */
function frontOf(dots) {
  let least = Infinity;
  return [...dots].sort((a, b) => a.x - b.x || a.y - b.y).filter((d) => d.y < least && ((least = d.y), true));
}

/* Marks of each kind of plot. */
const kinds = {
  intervals: (rows, styles) => [
    Plot.ruleY(rows, { y: 'name', x1: (r) => r.numbers[0], x2: (r) => r.numbers[2], stroke: (r) => styles.get(r.name).colour, strokeWidth: 5, strokeOpacity: 0.5 }),
    Plot.dot(rows, { x: (r) => r.numbers[1], y: 'name', fill: (r) => styles.get(r.name).colour, r: 5 })],
  samples: (rows, styles) => {
    const dots = rows.flatMap((row) => row.numbers.map((x) => ({ name: row.name, x })));
    return [Plot.boxX(dots, { x: 'x', y: 'name', fill: (d) => styles.get(d.name).colour, fillOpacity: 0.2, r: 0 }), Plot.dot(dots, { x: 'x', y: 'name', stroke: (d) => styles.get(d.name).colour, r: 2.5 })];
  },
  points: (rows, styles) => {
    const dots = rows.flatMap(pairsOf);
    return [Plot.dot(dots, { x: 'x', y: 'y', stroke: (d) => styles.get(d.name).colour, r: 4 }), Plot.tip(dots, Plot.pointer({ x: 'x', y: 'y', title: (d) => `${d.name}\n${digits(d.x)}, ${digits(d.y)}` }))];
  },
  fronts: (rows, styles) => [...kinds.points(rows, styles), ...rows.map((row) => Plot.line(frontOf(pairsOf(row)), {
    x: 'x', y: 'y', stroke: styles.get(row.name).colour, strokeDasharray: styles.get(row.name).dash || undefined, strokeWidth: 2 }))],
  counts: (rows, styles) => rows.map((row) => Plot.line([[1, 0], ...row.numbers.map((x, i) => [x, i + 1]), [100, row.numbers.length]].filter(([x]) => x <= 100), {
    curve: 'step-after', stroke: styles.get(row.name).colour, strokeDasharray: styles.get(row.name).dash || undefined, strokeWidth: 2 })),
};

function drawPlot(block) {
  if (!hasPlots) return null;
  const styles = byName(block.rows), isStack = block.y === null;
  const rule = block.rule === null ? null : Plot.ruleX([block.rule], { strokeDasharray: '4 3', strokeWidth: 2 });
  const drawn = plot(block.caption, { width: 700, height: isStack ? 60 + 30 * block.rows.length : 300, ...(isStack ? { marginLeft: 150 } : {}),
    x: { label: block.x, grid: true, ...(isStack ? {} : { type: 'log', tickFormat: power }) }, y: isStack ? { label: null } : { label: block.y, grid: true, ...(block.kind === 'counts' ? {} : { type: 'log', tickFormat: power }) },
    marks: [rule, ...kinds[block.kind](block.rows, styles)] });
  return isStack ? drawn : [drawn, chips(block.rows.map((row) => row.name), styles)];
}

/* Items that follow each other are one list. */
function drawBlocks(blocks, links) {
  const parts = [];
  let list = null;
  for (const block of blocks) {
    if (block.item === undefined) list = null;
    if (block.item !== undefined) {
      if (list === null) parts.push(list = h('ul'));
      list.append(h('li', {}, block.item));
    } else if (block.text !== undefined) {
      parts.push(p(block.text));
    } else {
      parts.push(block.kind === undefined ? drawTable(block, links) : drawPlot(block));
    }
  }
  return parts;
}

export function documentPage(document, links = new Map()) {
  return { title: document.title, lead: '', parts: document.sections.map((part, i) => section(`${slug(part.title)}-${i}`, part.title, drawBlocks(part.blocks, links))) };
}
