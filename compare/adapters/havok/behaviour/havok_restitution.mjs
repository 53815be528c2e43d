// Havok 1.3.14: without gravity a sphere leaves a box with e (v - 9.81 m/s^2 times the time step), not e v, at every speed v.
import {add, floor, sphere, steps, velocity} from './havok_world.mjs';

floor();
let place = 0;
for (const dt of [1 / 60, 1 / 100, 1 / 240]) {
  for (const [e, speed] of [[0.5, 1.5], [0.5, 5], [1, 1], [1, 2], [1, 8]]) {
    const ball = add(sphere(), 1, [0, 5 * place++ - 50, 0.5 + 3.5 * speed * dt], [0, 0, -speed], e);
    steps(20, dt);
    const found = velocity(ball)[2];
    console.log(`step ${dt.toFixed(5)} s, e = ${e}, ${speed} m/s: expected ${e * speed} m/s, found ${found.toFixed(5)}; (v - found / e) / step = ${((speed - found / e) / dt).toFixed(3)} m/s^2`);
  }
}
