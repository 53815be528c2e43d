// Havok 1.3.14: a free body at 5 mm/s stops, though it is always active and nothing damps it.
import {add, position, sphere, steps, velocity} from './havok_world.mjs';

const bodies = [0.005, 0.02, 0.05, 0.1].map((speed, i) => ({speed, body: add(sphere(), 1, [0, 5 * i, 0], [speed, 0, 0])}));
steps(400);
for (const {speed, body} of bodies) {
  console.log(`at ${speed} m/s, after 4 s: expected ${4 * speed} m, found ${position(body)[0].toPrecision(6)} m, at ${velocity(body)[0].toPrecision(6)} m/s`);
}
