// Havok 1.3.14: friction acts with about 0.1 % more or less than its coefficient, which reads back as it was set.
import {add, floor, hk, sphere, steps, velocity, world} from './havok_world.mjs';

hk.HP_World_SetGravity(world, [0, 0, -10]);
floor();
const balls = [0.1, 0.2, 0.35, 0.5, 0.8].map((mu, i) => {
  const shape = sphere();
  const ball = add(shape, 2, [0, 5 * i, 0.5], [6, 0, 0], 0, mu);
  hk.HP_Body_SetAngularVelocity(ball, [0, -30, 0]); // it slides all the time
  return {mu, ball, read: hk.HP_Shape_GetMaterial(shape)[1][0]};
});
steps(60, 1 / 240);
const before = balls.map(({ball}) => velocity(ball)[0]);
steps(60, 1 / 240);
balls.forEach(({mu, ball, read}, i) => {
  const found = (before[i] - velocity(ball)[0]) / (10 * 60 / 240);
  console.log(`coefficient ${mu}, which reads ${read.toFixed(7)}: found ${found.toFixed(6)}, ${(100 * (found / mu - 1)).toFixed(2)} %`);
});
