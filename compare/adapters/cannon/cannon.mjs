// cannon-es (https://pmndrs.github.io/cannon-es): a JavaScript engine in double precision.
//
// Damping (0.01 as shipped) is off, and mass and inertia are those of the scene. A contact material for each pair of
// materials gives it its coefficients, with cannon's own stiffness and relaxation. The faces of a hull are polygons: cannon
// clips one face against another, and triangles of one face would each have their own contacts. cannon has no capsules,
// and its meshes collide with planes and spheres only. It leaves the gyroscopic torque out.
import {apart, describe, packageOf, serve} from './protocol.mjs';
import {applyForces, planePose, polygonsOf, principalPose, principalVertices, solidOf, writeFrame} from './mechanics.mjs';
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
  const pose = body.shape.type === 'plane' ? planePose(body.shape) : principalPose(setup, body);
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
    readFrame: (frame) => writeFrame(frame, setup, (index) => {
      const body = bodies[index];
      return [array(body.position), arrayOf(body.quaternion), array(body.velocity), array(body.angularVelocity)];
    }),
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

serve({...describe(version, files), create});
