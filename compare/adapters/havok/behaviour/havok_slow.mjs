// Havok 1.3.14: a free body slower than about 0.1 m/s loses 0.31 m/s in each second, at every step, though it is always active and
// nothing damps it. A force on a slow body therefore gains too little speed.
import {add, hk, sphere, steps, velocity} from './havok_world.mjs';

const free = [0.005, 0.05, 0.1, 0.12, 0.2, 1].map((speed, i) => ({speed, body: add(sphere(), 1, [0, 5 * i, 0], [speed, 0, 0])}));
for (const count of [1, 10, 40]) {
  steps(count);
  free.forEach(({speed, body}) => console.log(`free at ${speed} m/s, ${count} steps of 0.01 s later: ${velocity(body)[0].toFixed(6)} m/s`));
}
const pushed = add(sphere(), 1, [0, 100, 0], [0, 0, 0]);
for (let step = 1; step <= 5; ++step) {
  const before = velocity(pushed)[0];
  hk.HP_Body_ApplyImpulse(pushed, hk.HP_Body_GetQTransform(pushed)[1][0], [0.01, 0, 0]);
  steps(1);
  console.log(`1 N on 1 kg for 0.01 s, step ${step}: expected 0.01 m/s more, found ${(velocity(pushed)[0] - before).toFixed(6)}`);
}
