/* Elements, tables and downloads. Every text goes into the page as a text node, never as markup. */

/* An element with properties and children; children are elements, texts, arrays or null. */
export function h(name, properties = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (key === 'class') element.className = value;
    else if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
    else if (key in element && key !== 'style' && key !== 'list') element[key] = value;
    else element.setAttribute(key, value);
  }
  add(element, children);
  return element;
}

/* An element of a picture. */
export function svg(name, attributes, ...children) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return add(element, children);
}

export function add(element, children) {
  for (const child of [children].flat(Infinity)) {
    if (child !== null && child !== undefined && child !== '') element.append(child);
  }
  return element;
}

export const p = (text, style) => (text ? h('p', { class: style }, text) : null);

export function section(id, title, ...children) {
  return h('section', { id, 'aria-labelledby': `${id}-title` }, h('h2', { id: `${id}-title` }, title), children);
}

export function folded(summary, ...children) {
  return h('details', {}, h('summary', {}, summary), children);
}

/* A definition list of [name, value] pairs; pairs without a value are left out. */
export function facts(pairs, style) {
  const shown = pairs.filter(([, value]) => value !== undefined && value !== null && value !== '');
  return shown.length === 0 ? null : h('dl', { class: style }, shown.map(([name, value]) => [h('dt', {}, name), h('dd', {}, value)]));
}

/* What a cell sorts by: its value, else the number that its text begins with, else its text. */
function key(cell) {
  if (cell.value !== undefined) return cell.value;
  return cell.text;
}

function compare(a, b) {
  const x = key(a), y = key(b);
  const missing = (x === null || x === undefined || Number.isNaN(x)) - (y === null || y === undefined || Number.isNaN(y));
  if (missing !== 0) return { order: missing, fixed: true };
  return { order: typeof x === 'number' && typeof y === 'number' ? x - y : String(x).localeCompare(String(y), 'en', { numeric: true }) };
}

/* A sortable table. columns: [{name, right, title, wide}]; rows: arrays of texts or of
 * {text, value, style, title, children}, the first cell of a row is its heading. At most `most` rows are
 * shown at first. */
export function table({ caption, columns, rows, style, most = 0 }) {
  const body = h('tbody');
  const cells = rows.map((row) => row.map((cell) => (cell !== null && typeof cell === 'object' ? cell : { text: cell ?? '' })));
  let shown = most === 0 ? cells.length : Math.min(most, cells.length);
  const draw = () => body.replaceChildren(...cells.slice(0, shown).map((row) => h('tr', {}, row.map((cell, i) => {
    const kind = [cell.style, columns[i]?.right ? 'n' : '', columns[i]?.wide ? 'wide' : ''].filter(Boolean).join(' ');
    return h(i === 0 ? 'th' : 'td', { class: kind, title: cell.title || undefined, scope: i === 0 ? 'row' : undefined }, cell.children ?? String(cell.text ?? ''));
  }))));
  const heads = columns.map((column, i) => {
    const head = h('th', { scope: 'col', class: column.right ? 'n' : '' });
    head.append(h('button', { type: 'button', title: column.title || `Sort by ${column.name}`, onclick: () => {
      const rising = head.getAttribute('aria-sort') !== 'ascending';
      heads.forEach((other) => other.removeAttribute('aria-sort'));
      head.setAttribute('aria-sort', rising ? 'ascending' : 'descending');
      cells.sort((a, b) => { const c = compare(a[i], b[i]); return c.fixed || rising ? c.order : -c.order; });
      draw();
    } }, column.lines ? column.name.split(/(?<=:)/).flatMap((part) => [part, h('wbr')]) : column.name));
    return head;
  });
  draw();
  const more = shown < cells.length
    ? h('button', { type: 'button', onclick: (event) => { shown = cells.length; draw(); event.target.remove(); } }, `Show all ${cells.length} rows`) : null;
  return [h('div', { class: 'scroll', tabIndex: 0, role: 'region', 'aria-label': caption || 'table' },
    h('table', { class: style }, caption ? h('caption', {}, caption) : null, h('thead', {}, h('tr', {}, heads)), body)), more];
}

/* Hands a blob to the reader as a file. */
export function save(blob, name) {
  const link = h('a', { href: URL.createObjectURL(blob), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/* The JSON of a script element; null where there is none. */
export function data(id) {
  const element = document.getElementById(id);
  return element === null ? null : JSON.parse(element.textContent);
}

/* Calls `fill` once when the element comes near the window, or at the event `fill`. */
export function whenNear(element, fill) {
  let done = false;
  const once = () => { if (!done) { done = true; observer.disconnect(); fill(); } };
  const observer = new IntersectionObserver((entries) => { if (entries.some((e) => e.isIntersecting)) once(); }, { rootMargin: '600px' });
  observer.observe(element);
  element.addEventListener('fill', once);
}
