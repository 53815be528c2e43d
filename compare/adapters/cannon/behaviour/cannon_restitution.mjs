// cannon-es 0.20: bodies do not leave with their coefficient of restitution, but with what the relaxation of the contact and the
// depth leave of it at which it is found. In a folder with the package: node cannon_restitution.mjs
import * as CANNON from 'cannon-es';

/** The coefficient of restitution, of 0.5, with which a sphere of 1 kg and another body part that touch after `apart` steps. */
function found(other, direction, speed, relaxation, apart) {
  const world = new CANNON.World();
  const material = new CANNON.Material();
  world.addContactMaterial(new CANNON.ContactMaterial(material, material, {friction: 0, restitution: 0.5, contactEquationRelaxation: relaxation}));
  const ball = new CANNON.Body({mass: 1, material, shape: new CANNON.Sphere(0.5), linearDamping: 0,
    position: direction.scale(0.5 + apart * speed / 240), velocity: direction.scale(-speed)});
  other.material = material;
  [ball, other].forEach((body) => world.addBody(body));
  Array.from({length: 20}, () => world.step(1 / 240));
  return ball.velocity.vsub(other.velocity).dot(direction) / speed;
}

const [x, z] = [new CANNON.Vec3(1, 0, 0), new CANNON.Vec3(0, 0, 1)];
const floor = () => new CANNON.Body({mass: 0, shape: new CANNON.Plane()});
const sphere = () => new CANNON.Body({mass: 3, shape: new CANNON.Sphere(0.5), linearDamping: 0, position: new CANNON.Vec3(-0.5, 0, 0)});
for (const [relaxation, apart] of [[1, 0.65], [3, 0.65], [3, 0.25], [10, 0.65], [100, 0.65]]) {
  const values = [found(floor(), z, 1.5, relaxation, apart), found(floor(), z, 5, relaxation, apart), found(sphere(), x, 2, relaxation, apart)];
  console.log(`relaxation ${relaxation}, found ${(1 - apart).toFixed(2)} steps deep; floor at 1.5 m/s, floor at 5 m/s, sphere at 2 m/s: expected 0.5, found ${values.map((e) => e.toFixed(5)).join(', ')}`);
}
