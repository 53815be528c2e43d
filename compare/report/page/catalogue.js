/* The catalogue: each scenario with its scene, right answer, source and parameters. */
import { facts, h, p, section, table } from './dom.js';
import { digits } from './format.js';
import { Stage, aim, boundsOf, cameraFor, canDraw, draw } from './scene3d.js';

function picture(s) {
  if (!s.scene || !canDraw()) return null;
  const canvas = h('canvas', { role: 'img', 'aria-label': `${s.name} at the start` });
  const bounds = boundsOf(s.scene, []), camera = cameraFor(bounds, s.scene), stage = new Stage(s.scene, bounds, [null], { ghosts: false });
  stage.place(0, s.scene.bodies.flatMap((b) => [...b.at, ...b.turn]));
  aim(camera, bounds, {});
  draw(canvas, stage, camera, 360);
  stage.dispose();
  return h('figure', { class: 'panel', style: 'max-width:360px' }, canvas, h('figcaption', {}, `${s.scene.bodies.length} bodies, ${digits(s.scene.duration)} s in steps of ${digits(s.scene.dt)} s`));
}

export function catalogue({ scenarios }, whenNear) {
  const unit = (u) => (u === '1' ? '' : ` ${u}`);
  const inner = scenarios.map((s) => {
    const place = h('div', { style: 'min-height:290px' });
    const part = section(s.name, `${s.name}: ${s.title}`, place, p(s.description),
      facts([['Right answer', h('span', { class: 'formula' }, s.reference)], ['Source', s.source], ['Expected', s.expected], ['Valid', s.validity], ['Provokes', s.provokes],
        ['Users reported', s.symptom && `${s.symptom} (${s.threads})`],
        ['Threshold', s.threshold && `holds ${s.threshold.holds_below ? 'below' : 'above'} a critical ${s.threshold.param}: ${s.threshold.formula}`],
        ['Judged by', s.judged_by && [h('code', {}, s.judged_by.metric), `: ${s.judged_by.definition}`]],
        ['Accurate', s.judged_by && `up to ${digits(s.judged_by.bound)}${unit(s.judged_by.unit)}: ${s.judged_by.reason}`], ['Needs', s.needs.join(', ')], ['Suites', s.suites.join(', ')]]),
      table({ caption: `Parameters of ${s.name}`, columns: [{ name: 'parameter' }, { name: 'default', right: true }, { name: 'range' }, { name: 'unit' }, { name: 'meaning', wide: true }],
        rows: s.params.map((q) => [q.name, { text: digits(q.value), value: q.value }, `${digits(q.min)} to ${digits(q.max)}${q.integer ? ', whole' : ''}`, q.unit, q.help]) }));
    whenNear(part, () => { place.removeAttribute('style'); const made = picture(s); if (made) place.append(made); });
    return part;
  });
  return { title: 'Plumb: the catalogue', lead: `${scenarios.length} scenarios: what is built, what the right answer is, and where that is from`, parts: inner, inner, innerTitle: 'Scenarios' };
}
