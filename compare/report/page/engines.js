/* One colour and one line pattern for each engine configuration, the same in every picture: the hue is
 * the engine's, profiles differ in lightness and dashes. HUES has that of each built-in engine, by
 * its engine.json; six are those of Okabe and Ito 2008. */
const others = ['#4d4d4d', '#a6761d', '#1b7837', '#762a83'];
const dashes = ['', '6 3', '2 3', '8 3 2 3', '1 4'];

function shade(hex, part) {
  const target = part > 0 ? 255 : 0;
  const mixed = [1, 3, 5].map((i) => {
    const c = parseInt(hex.slice(i, i + 2), 16);
    return Math.round(c + (target - c) * Math.abs(part)).toString(16).padStart(2, '0');
  });
  return `#${mixed.join('')}`;
}

/* name -> {colour, dash}; engines: [{name, engine}], in any order, which has no effect. */
export function styles(engines) {
  const seen = {}, found = new Map();
  let spare = 0;
  for (const { name, engine } of [...engines].sort((a, b) => (a.name < b.name ? -1 : 1))) {
    const family = engine || name.split(':')[0];
    if (!(family in seen)) seen[family] = { hue: HUES[family] ?? others[spare++ % others.length], count: 0 };
    const k = seen[family].count++;
    found.set(name, { colour: shade(seen[family].hue, [0, 0.35, -0.35, 0.55, -0.5][k % 5]), dash: dashes[k % dashes.length] });
  }
  return found;
}
