// Havok 1.3.14: masses count to about three digits. A sphere of 1 kg hits one of m kg head on, at 2 m/s, without restitution.
import {add, sphere, steps, velocity} from './havok_world.mjs';

const pairs = [1, 1.5, 2, 3, 5, 7, 10].map((mass, i) => ({mass, light: add(sphere(), 1, [0, 5 * i, 0], [2, 0, 0]), heavy: add(sphere(), mass, [1.1, 5 * i, 0], [0, 0, 0])}));
steps(60);
for (const {mass, light, heavy} of pairs) {
  const found = (2 - velocity(light)[0]) / velocity(heavy)[0];
  console.log(`ratio of the masses by the changes of velocity: expected ${mass}, found ${found.toFixed(6)}`);
}
