/* Begins the page: its header, contents and theme, and what is in its data. */
import { data, h, whenNear } from './dom.js';
import { styles as stylesOf } from './engines.js';
import { plural } from './format.js';
import * as about from './about.js';
import { overview } from './overview.js';
import { scenario } from './scenario.js';
import { catalogue } from './catalogue.js';
import { documentPage } from './document.js';
import { study } from './study.js';
import { figure } from './figure.js';

const main = document.getElementById('main');

function theme() {
  const dark = window.matchMedia('(prefers-color-scheme: dark)');
  const set = (name) => { document.documentElement.dataset.theme = name; button.textContent = name === 'dark' ? '☀ Light' : '☾ Dark'; };
  const button = h('button', { type: 'button', id: 'theme', onclick: () => set(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark') }, '');
  set(dark.matches ? 'dark' : 'light');
  return button;
}

function header(title, lead) {
  document.title = title;
  document.getElementById('top').append(h('h1', {}, title), h('span', { class: 'note' }, lead), h('span', { class: 'spacer' }), theme());
}

/* Links to all sections; those of `inner` are one level down, folded where they are many. */
function contents(parts, inner, innerTitle) {
  const item = (part) => h('li', {}, h('a', { href: `#${part.id}` }, part.querySelector('h2').textContent.split(': ')[0]));
  const list = h('ol', {}, parts.map((part) => (part === inner[0]
    ? h('li', {}, h('details', { open: window.innerWidth > 900 && inner.length <= 60 }, h('summary', {}, `${innerTitle} (${inner.length})`), h('ol', {}, inner.map(item))))
    : inner.includes(part) ? null : item(part))));
  const wide = window.innerWidth > 900;
  document.getElementById('contents').append(wide ? list : h('details', {}, h('summary', {}, 'Contents'), list));
}

/* Fills sections one after the other while the reader looks at the first, so that the page can be
 * printed whole. */
function fillLater(cases) {
  let next = 0;
  const one = () => {
    cases[next++].dispatchEvent(new Event('fill'));
    if (next < cases.length) setTimeout(one, 300);
  };
  setTimeout(one, 1500);
}

function report(all) {
  const styles = stylesOf(all.engines);
  const from = all.provenance;
  header('Plumb report', [plural(all.runs, 'run'), (from.last ?? '').slice(0, 10), `plumb ${about.once(from.Plumb).join(', ')}`].filter(Boolean).join(' · '));
  if (all.cases.length === 0) {
    main.append(h('p', {}, 'There are no results.'));
    return;
  }
  const cases = all.cases.map((_, i) => scenario(all, i, styles, whenNear));
  const said = documentPage(all.document, new Map(all.cases.map((test, i) => [test.name, `#case-${i}`])));
  const parts = [overview(all, styles), ...cases, ...said.parts, about.words(all), about.fairness(), about.metrics(all.metrics), about.provenance(all), about.licences()].filter(Boolean);
  main.append(...parts);
  contents(parts, cases, 'Scenarios');
  if (cases.length <= 40) fillLater(cases);
}

function begin() {
  const all = data('data');
  main.replaceChildren();
  if (all.kind === 'report' && location.hash.startsWith('#figure=')) {
    figure(all, main);
  } else if (all.kind === 'report') {
    report(all);
  } else {
    const made = all.kind === 'catalogue' ? catalogue(all.study, whenNear) : all.kind === 'document' ? documentPage(all.study) : study(all.kind, all.study);
    header(made.title, made.lead);
    const parts = [...made.parts, about.licences()].filter(Boolean);
    main.append(...parts);
    contents(parts, made.inner ?? [], made.innerTitle ?? '');
  }
  const only = location.hash.match(/^#only=(.*)$/)?.[1]; // one section alone, for a link or a picture
  if (only !== undefined) main.querySelectorAll(':scope>section').forEach((part) => { part.hidden = part.id !== only; });
  document.documentElement.dataset.ready = 'yes';
  if (location.hash.length > 1 && only === undefined) document.getElementById(location.hash.slice(1))?.scrollIntoView();
}

begin();
