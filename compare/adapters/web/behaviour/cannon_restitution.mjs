// cannon-es 0.20: a ball does not leave with its coefficient of restitution, but with what the relaxation of the contact leaves of it.
// In a folder with the package: node cannon_restitution.mjs
import * as CANNON from 'cannon-es';

for (const relaxation of [1, 3, 10, 100]) {
  const world = new CANNON.World({gravity: new CANNON.Vec3(0, 0, 0)});
  const material = new CANNON.Material();
  world.addContactMaterial(new CANNON.ContactMaterial(material, material, {friction: 0, restitution: 0.5, contactEquationRelaxation: relaxation}));
  const ball = new CANNON.Body({mass: 1, material, shape: new CANNON.Sphere(0.5), linearDamping: 0,
    position: new CANNON.Vec3(0, 0, 0.513), velocity: new CANNON.Vec3(0, 0, -2)});
  world.addBody(new CANNON.Body({mass: 0, material, shape: new CANNON.Plane()}));
  world.addBody(ball);
  for (let i = 0; i < 20; ++i) {
    world.step(1 / 100);
  }
  console.log(`relaxation ${relaxation}: expected 1 m/s, found ${ball.velocity.z.toFixed(5)}`);
}
