// cannon-es 0.20: what its bound on friction (cannon_friction.mjs) does to spheres that spin. On a floor the first steps of contact
// end the sliding, so that there is no friction after them; without gravity two spheres have none at all.
// In a folder with the package: node cannon_spin.mjs
import * as CANNON from 'cannon-es';

const MU = 0.35;

/** A world, and in it a sphere of 1 kg at 6 m/s whose surface slides backward, and another body. */
function start(gravity, speed, other) {
  const world = new CANNON.World({gravity: new CANNON.Vec3(0, 0, -gravity)});
  const material = new CANNON.Material();
  world.addContactMaterial(new CANNON.ContactMaterial(material, material, {friction: MU, restitution: 0}));
  const ball = new CANNON.Body({mass: 1, material, shape: new CANNON.Sphere(0.5), linearDamping: 0, angularDamping: 0,
    position: new CANNON.Vec3(0, 0, 0.5), velocity: new CANNON.Vec3(speed, 0, 0), angularVelocity: new CANNON.Vec3(0, -30, 0)});
  other.material = material;
  [ball, other].forEach((body) => world.addBody(body));
  return {world, ball};
}

const floor = start(9.81, 6, new CANNON.Body({mass: 0, shape: new CANNON.Plane()}));
for (let step = 1; step <= 8; ++step) {
  floor.world.step(1 / 240);
  const {x} = floor.ball.velocity;
  console.log(`floor, step ${step}: expected ${(6 - MU * 9.81 * step / 240).toFixed(3)} m/s, found ${x.toFixed(3)}; it slides at ${(x - 0.5 * floor.ball.angularVelocity.y).toFixed(3)} m/s`);
}
const pair = start(0, 2, new CANNON.Body({mass: 3, shape: new CANNON.Sphere(0.5), position: new CANNON.Vec3(1, 0, 0.5)}));
Array.from({length: 10}, () => pair.world.step(1 / 240));
console.log(`two spheres: expected the speed across the impact to be ${MU} of the change along it, found ${(Math.abs(pair.ball.velocity.z) / (2 - pair.ball.velocity.x)).toFixed(3)}`);
