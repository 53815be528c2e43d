// cannon-es (https://pmndrs.github.io/cannon-es): a JavaScript engine in double precision.
//
// Damping (0.01 as shipped) is off, and mass and inertia are those of the scene. A contact material for each pair of
// materials gives it its coefficients, with cannon's own stiffness and relaxation. The faces of a hull are polygons: cannon
// clips one face against another, and triangles of one face would each have their own contacts. cannon has no capsules,
// and its meshes collide with planes and spheres only. It leaves the gyroscopic torque out.
import {apart, packageOf, serve} from './protocol.mjs';
import {applyForces, polygonsOf, principalPose, principalVertices, rotationFromZ, solidOf, writeState} from './mechanics.mjs';
import * as CANNON from 'cannon-es';

const {version, files} = packageOf('cannon-es');

const vector = (v) => new CANNON.Vec3(...v);
const quaternion = ([w, x, y, z]) => new CANNON.Quaternion(x, y, z, w);
const array = ({x, y, z}) => [x, y, z];
const arrayOf = ({w, x, y, z}) => [w, x, y, z];

function addShape(setup, body, made) {
  const {shape} = body;
  switch (shape.type) {
    case 'plane':
      made.addShape(new CANNON.Plane());
      break;
    case 'sphere':
      made.addShape(new CANNON.Sphere(shape.radius));
      break;
    case 'box':
      made.addShape(new CANNON.Box(vector(shape.half_extents)));
      break;
    case 'cylinder': // its axis is y, and it is a prism
      made.addShape(new CANNON.Cylinder(shape.radius, shape.radius, 2 * shape.half_height, setup.options.cylinder_sides), new CANNON.Vec3(),
        quaternion([Math.SQRT1_2, Math.SQRT1_2, 0, 0]));
      break;
    default: {
      const solid = solidOf(setup, body);
      const flat = principalVertices(solid, Float64Array);
      const vertices = solid.vertices.map((_, i) => vector(flat.subarray(3 * i, 3 * i + 3)));
      made.addShape(new CANNON.ConvexPolyhedron({vertices, faces: polygonsOf(solid)}));
    }
  }
}

function makeBody(setup, body, materials) {
  const isPlane = body.shape.type === 'plane';
  const pose = isPlane ? {position: body.shape.normal.map((n) => n * body.shape.offset), orientation: rotationFromZ(body.shape.normal)} : principalPose(setup, body);
  const made = new CANNON.Body({
    mass: body.static ? 0 : body.mass, material: materials[body.material], linearDamping: 0, angularDamping: 0, allowSleep: false,
    position: vector(pose.position), quaternion: quaternion(pose.orientation),
    velocity: vector(body.velocity), angularVelocity: vector(body.angular_velocity),
  });
  addShape(setup, body, made);
  if (!body.static) {
    made.inertia.copy(vector(body.inertia));
    made.invInertia.copy(vector(body.inertia.map((i) => 1 / i)));
    made.updateInertiaWorld(true);
  }
  return made;
}

function create(setup) {
  const {options} = setup;
  const world = new CANNON.World({gravity: vector(setup.gravity), allowSleep: false});
  world.solver.iterations = options.iterations;
  world.solver.tolerance = options.tolerance;
  const materials = setup.friction.map(() => new CANNON.Material());
  materials.forEach((one, a) => materials.slice(a).forEach((two, k) => {
    world.addContactMaterial(new CANNON.ContactMaterial(one, two, {
      friction: setup.friction[a][a + k], restitution: setup.restitution[a][a + k],
      contactEquationStiffness: options.stiffness, contactEquationRelaxation: options.relaxation,
    }));
  }));
  const bodies = setup.bodies.map((body) => makeBody(setup, body, materials));
  bodies.forEach((body) => world.addBody(body));
  const indexOf = new Map(bodies.map((body, index) => [body.id, index]));
  let before = [];

  return {
    step(number) {
      before = apart(() => bodies.map((body) => array(body.position)));
      applyForces(setup, number, (index) => arrayOf(bodies[index].quaternion), (index, force, torque) => {
        bodies[index].force.vadd(vector(force), bodies[index].force);
        bodies[index].torque.vadd(vector(torque), bodies[index].torque);
      });
      world.step(setup.dt);
      return {iterations: options.iterations, contacts: world.contacts.length};
    },
    readFrame(frame) {
      bodies.forEach((body, index) => {
        const asked = setup.bodies[index];
        if (asked.shape.type === 'plane') {
          writeState(frame, setup, index, asked.position, asked.orientation, [0, 0, 0], [0, 0, 0]);
        } else {
          writeState(frame, setup, index, array(body.position), arrayOf(body.quaternion), array(body.velocity), array(body.angularVelocity));
        }
      });
    },
    readContacts() {
      if (before.length === 0) {
        return [];
      }
      return world.contacts.filter((c) => c.enabled).flatMap((c) => {
        const [a, b] = [indexOf.get(c.bi.id), indexOf.get(c.bj.id)];
        const onA = array(c.ri).map((r, k) => before[a][k] + r);
        const onB = array(c.rj).map((r, k) => before[b][k] + r);
        const normal = array(c.ni);
        const separation = normal.reduce((sum, n, k) => sum + n * (onB[k] - onA[k]), 0);
        return [a, b, ...onA.map((x, k) => (x + onB[k]) / 2), ...normal, separation];
      });
    },
    settings: () => ({
      gravity: array(world.gravity), mass: bodies.map((body) => body.mass), substeps: 1,
      inertia: bodies.map((body, i) => (setup.bodies[i].static ? [0, 0, 0] : array(body.invInertia).map((v) => 1 / v))),
      linear_damping: Math.max(...bodies.map((b, i) => (setup.bodies[i].static ? 0 : b.linearDamping))),
      angular_damping: Math.max(...bodies.map((b, i) => (setup.bodies[i].static ? 0 : b.angularDamping))),
    }),
    pair(a, b) {
      const material = world.getContactMaterial(bodies[a].material, bodies[b].material);
      return {friction: material.friction, restitution: material.restitution};
    },
  };
}

serve({
  name: 'cannon',
  version,
  description: 'cannon-es: spring-damper contacts, by Gauss-Seidel (SPOOK)',
  runtime: 'javascript',
  precision: 'double',
  integrator: 'semi-implicit Euler',
  gyroscopic: 'none',
  capabilities: ['friction', 'restitution', 'rotation', 'forces', 'plane', 'sphere', 'box', 'cylinder', 'hull'],
  contacts: ['points'],
  files,
  reads: ['settings', 'pairs'],
  profiles: [
    {name: 'default', help: 'as shipped', in_default_comparison: true, step_code: 'world.step({});'},
    {name: 'recommended', help: "as cannon-es's demo of a tower of blocks, Jenga, has it", in_default_comparison: true, step_code: 'world.step({});',
      values: {iterations: 50, stiffness: 5e6}},
  ],
  sources: [
    {profile: 'recommended', text: 'left as it is: relaxation, which is 3 there too, and sleep, which is off for every engine. The author of cannon.js advises it for stacks: "A slowly moving body will fall asleep, and then it won\'t move at all until something wakes it up" (https://github.com/schteppe/cannon.js/issues/348)'},
    {profile: 'recommended', option: 'iterations', text: '"The more iterations, the more correct simulation" (cannon-es documentation, GSSolver, https://pmndrs.github.io/cannon-es/docs/classes/GSSolver.html); the number is that of its demo Jenga (https://github.com/pmndrs/cannon-es/blob/master/examples/jenga.html)'},
    {profile: 'recommended', option: 'stiffness', text: '"Contact stiffness - use to make softer/harder contacts": contactEquationStiffness = 5e6 of the same demo'},
  ],
  options: [
    {name: 'iterations', value: 10, min: 1, max: 100000, integer: true, help: 'sweeps over the equations, at most', code: 'world.solver.iterations = {};',
      tune: {profiles: ['default'], min: 1, max: 500, logarithmic: true}},
    {name: 'tolerance', value: 1e-7, min: 0, max: 1, help: 'sweeps end when they change the forces by less', code: 'world.solver.tolerance = {};'},
    {name: 'stiffness', value: 1e7, min: 1, max: 1e12, unit: 'N/m', help: 'of contacts', code: 'contactMaterial.contactEquationStiffness = {};',
      tune: {profiles: ['default'], min: 1e6, max: 1e10, logarithmic: true}},
    {name: 'relaxation', value: 3, min: 0, max: 1000, help: 'time steps in which a contact relaxes', code: 'contactMaterial.contactEquationRelaxation = {};',
      tune: {profiles: ['default'], min: 1, max: 20, logarithmic: true}},
    {name: 'cylinder_sides', value: 32, min: 3, max: 1000, integer: true, help: 'of the prism that stands for a cylinder', code: 'new CANNON.Cylinder(r, r, h, {});'},
  ],
  create,
});
