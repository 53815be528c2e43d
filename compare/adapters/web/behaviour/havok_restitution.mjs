// Havok 1.3.14: a sphere bounces off a box with about 0.98 of its coefficient of restitution.
import {add, hk, sphere, steps, velocity} from './havok_world.mjs';

add(hk.HP_Shape_CreateBox([0, 0, -10], [0, 0, 0, 1], [200, 200, 20])[1], 0, [0, 0, 0], [0, 0, 0], 1);
const balls = [0.2, 0.5, 0.8, 1].map((e, i) => ({e, ball: add(sphere(), 1, [5 * i, 0, 0.63], [0, 0, -2], e)}));
steps(60);
for (const {e, ball} of balls) {
  console.log(`restitution ${e} at 2 m/s: expected ${2 * e} m/s, found ${velocity(ball)[2].toFixed(5)} m/s`);
}
