// cannon-es 0.20: the bound on friction is mu times gravity times a mass for each contact point, whatever the normal force,
// and counts as an impulse a step: at 1/60 s it is 60 times too large. In a folder with the package: node cannon_friction.mjs
import * as CANNON from 'cannon-es';

/** The deceleration of a body of 1 kg that slides at 5 m/s on a floor with mu = 0.001, pressed onto it by `force`, m/s^2. */
function deceleration(shape, dt, gravity, force) {
  const world = new CANNON.World({gravity: new CANNON.Vec3(0, 0, -gravity)});
  const material = new CANNON.Material();
  world.addContactMaterial(new CANNON.ContactMaterial(material, material, {friction: 0.001, restitution: 0}));
  const body = new CANNON.Body({mass: 1, material, shape, linearDamping: 0, fixedRotation: true,
    position: new CANNON.Vec3(0, 0, 0.5), velocity: new CANNON.Vec3(5, 0, 0)});
  world.addBody(new CANNON.Body({mass: 0, material, shape: new CANNON.Plane()}));
  world.addBody(body);
  for (let i = 0; i < 1 / dt; ++i) {
    body.force.z -= force;
    world.step(dt);
  }
  return 5 - body.velocity.x;
}

const [box, sphere] = [new CANNON.Box(new CANNON.Vec3(0.5, 0.5, 0.5)), new CANNON.Sphere(0.5)];
const show = (what, expected, found) => console.log(`${what}: expected ${expected} m/s^2, found ${found.toFixed(4)}`);
show('sphere, gravity 10, step 1/60 s', 0.01, deceleration(sphere, 1 / 60, 10, 0));
show('sphere, gravity 10, step 1/240 s', 0.01, deceleration(sphere, 1 / 240, 10, 0));
show('sphere, gravity 10, pressed by 10 N more', 0.02, deceleration(sphere, 1 / 60, 10, 10));
show('sphere, no gravity, pressed by 10 N', 0.01, deceleration(sphere, 1 / 60, 0, 10));
show('box, gravity 10, four contact points', 0.01, deceleration(box, 1 / 60, 10, 0));
