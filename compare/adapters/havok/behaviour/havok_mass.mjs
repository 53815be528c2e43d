// Havok 1.3.14: the inverses of masses and moments of inertia are rounded, by up to 0.4 %. Momentum is kept with the rounded ones.
import {add, hk, sphere, steps, velocity} from './havok_world.mjs';

const show = (what, expected, found) => console.log(`${what}: expected ${expected}, found ${found.toFixed(6)}`);
const pairs = [1, 1.5, 2, 3, 5, 7, 10].map((mass, i) => ({mass, light: add(sphere(), 1, [0, 5 * i, 0], [2, 0, 0]), heavy: add(sphere(), mass, [1.1, 5 * i, 0], [0, 0, 0])}));
steps(60);
for (const {mass, light, heavy} of pairs) {
  const [v, w] = [velocity(light)[0], velocity(heavy)[0]];
  show(`1 kg at 2 m/s hits ${mass} kg: ratio of the masses by the changes of velocity`, mass, (2 - v) / w);
  show(`1 kg at 2 m/s hits ${mass} kg: momentum after it, kg m/s`, 2, v + mass * w);
}
for (const [index, moment] of [0.2, 0.3, 0.35, 0.45, 0.7].entries()) {
  const body = add(sphere(), 1, [0, 100 + 5 * index, 0], [0, 0, 0], 0, 0, [moment, moment, moment]);
  hk.HP_Body_ApplyAngularImpulse(body, [1, 0, 0]);
  show('moment of inertia by the spin after an angular impulse, kg m^2', moment, 1 / hk.HP_Body_GetAngularVelocity(body)[1][0]);
}
