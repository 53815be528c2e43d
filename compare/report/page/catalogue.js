/* The catalogue: each scenario with its scene, right answer, source and parameters. */
import { facts, h, p, section, table } from './dom.js';
import { digits } from './format.js';
import { Stage, aim, boundsOf, cameraFor, canDraw, draw } from './scene3d.js';

function picture(s, scene) {
  if (!canDraw()) return null;
  const canvas = h('canvas', { role: 'img', 'aria-label': `${s.name} at the start` });
  const bounds = boundsOf(scene, []), camera = cameraFor(bounds, scene), stage = new Stage(scene, bounds, [null], { ghosts: false });
  stage.place(0, scene.bodies.flatMap((b) => [...b.at, ...b.turn]));
  aim(camera, bounds, {});
  draw(canvas, stage, camera, 360);
  stage.dispose();
  return h('figure', { class: 'panel', style: 'max-width:360px' }, canvas, h('figcaption', {}, `${scene.bodies.length} bodies, ${digits(scene.duration)} s in steps of ${digits(scene.dt)} s`));
}

export function catalogue({ scenarios, suites, scenes, metrics }, whenNear) {
  const unit = (u) => (u === '1' ? '' : ` ${u}`);
  const inner = scenarios.map((s, i) => {
    const place = h('div', { style: 'min-height:290px' });
    const part = section(s.name, `${s.name}: ${s.title}`, place, p(s.description),
      facts([['Right answer', h('span', { class: 'formula' }, s.reference)], ['Source', s.source], ['Expected', s.expected], ['Valid', s.validity], ['Provokes', s.provokes],
        ['Users reported', s.symptom && `${s.symptom} (${s.threads})`],
        ['Threshold', s.threshold && `holds ${s.threshold.holds} a critical ${s.threshold.param}: ${s.threshold.formula ?? 'no closed form'}`],
        ['Judged by', [h('code', {}, s.primary_error), `: ${metrics.find((m) => m.name === s.primary_error).definition}`]],
        ['Accurate', `up to ${digits(s.acceptance.bound)}${unit(s.acceptance.unit)}: ${s.acceptance.reason}`], ['Needs', s.needs.join(', ')], ['Suites', suites.filter((suite) => suite.scenarios.some((entry) => entry.split(' ')[0] === s.name)).map((suite) => suite.name).join(', ')]]),
      table({ caption: `Parameters of ${s.name}`, columns: [{ name: 'parameter' }, { name: 'default', right: true }, { name: 'range' }, { name: 'unit' }, { name: 'meaning', wide: true }],
        rows: s.params.map((q) => [q.name, { text: digits(q.default), value: q.default }, `${digits(q.min)} to ${digits(q.max)}${q.integer ? ', whole' : ''}`, q.unit, q.help]) }));
    whenNear(part, () => { place.removeAttribute('style'); const made = picture(s, scenes[i]); if (made) place.append(made); });
    return part;
  });
  return { title: 'Plumb: the catalogue', lead: `${scenarios.length} scenarios: what is built, what the right answer is, and where that is from`, parts: inner, inner, innerTitle: 'Scenarios' };
}
