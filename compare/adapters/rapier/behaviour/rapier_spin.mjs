// Rapier 0.21: a free body that spins about a principal axis gains angular velocity, without a torque.
// In a folder with the package: node rapier_spin.mjs
import RAPIER from '@dimforge/rapier3d-compat';

await RAPIER.init();
const world = new RAPIER.World({x: 0, y: 0, z: 0});
world.timestep = 1 / 100;
const turn = {w: 0.8, x: 0, y: -0.6, z: 0}; // the body's third axis points along (-0.96, 0, 0.28)
const [x, z] = [-0.96, 0.28];
const body = world.createRigidBody(RAPIER.RigidBodyDesc.dynamic().setRotation(turn).setAngvel({x: 2 * x, y: 0, z: 2 * z}).setCanSleep(false)
  .setAdditionalMassProperties(2, {x: 0, y: 0, z: 0}, {x: 0.2, y: 0.3, z: 0.4}, {w: 1, x: 0, y: 0, z: 0}));
let step = 0;
for (const second of [1, 2, 4, 8, 16, 32]) {
  for (; step < 100 * second; ++step) {
    world.step();
  }
  const {x: wx, y: wy, z: wz} = body.angvel();
  console.log(`after ${second} s: expected 2 rad/s, found ${Math.hypot(wx, wy, wz)}`);
}
