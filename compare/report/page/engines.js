/* One colour and one line pattern for each engine configuration, the same in every picture: the hue is
 * the engine's, profiles differ in lightness and dashes. The hues are those of Okabe and Ito 2008. */
const hues = { plumb: '#0072b2', ode: '#d55e00', bullet: '#009e73', mujoco: '#cc79a7', jolt: '#e69f00', dart: '#56b4e9' };
const others = ['#8a6d00', '#7f5fc4', '#5b7083', '#b0413e', '#2a8f9e', '#946b2d'];
const dashes = ['', '6 3', '2 3', '8 3 2 3', '1 4'];

function shade(hex, part) {
  const target = part > 0 ? 255 : 0;
  const mixed = [1, 3, 5].map((i) => {
    const c = parseInt(hex.slice(i, i + 2), 16);
    return Math.round(c + (target - c) * Math.abs(part)).toString(16).padStart(2, '0');
  });
  return `#${mixed.join('')}`;
}

/* name -> {colour, dash}; engines: [{name, engine}]. */
export function styles(engines) {
  const seen = {}, found = new Map();
  let spare = 0;
  for (const { name, engine } of engines) {
    const family = engine || name.split(':')[0];
    if (!(family in seen)) seen[family] = { hue: hues[family] ?? others[spare++ % others.length], count: 0 };
    const k = seen[family].count++;
    found.set(name, { colour: shade(seen[family].hue, [0, 0.35, -0.35, 0.55, -0.5][k % 5]), dash: dashes[k % dashes.length] });
  }
  return found;
}
