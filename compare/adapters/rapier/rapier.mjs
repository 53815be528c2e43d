// Rapier 0.21 (https://rapier.rs), the maintainers' WebAssembly build; with the argument `deterministic` the build that
// gives the same bits on every processor.
//
// Rapier divides a step into `iterations` sub-steps (numSolverIterations), each of which integrates positions. Sleeping is
// off; damping is off as shipped. Colliders have no density: mass and inertia are those of the scene. Capsules and
// cylinders have their axis along y, and are turned. A mesh is a surface of oriented triangles; Rapier's fix of internal edges
// keeps flat parts from being rough.
//
// Rapier combines the coefficients of two colliders by a rule. Where no rule gives all pairs of materials theirs, a body
// has several colliders of the same shape (materials.mjs).
//
// Contacts have points only: friction impulses are along tangents that the JavaScript interface does not give.
import {apart, describe, packageOf, serve} from './protocol.mjs';
import {applyForces, principalPose, principalVertices, product, rotate, solidOf, writeFrame} from './mechanics.mjs';
import {colliderPlan, rules} from './materials.mjs';

const isDeterministic = process.argv[2] === 'deterministic';
const name = isDeterministic ? '@dimforge/rapier3d-deterministic-compat' : '@dimforge/rapier3d-compat';
const {default: RAPIER} = await import(name);
await RAPIER.init();
const {files} = packageOf(name);

const vector = ([x, y, z]) => ({x, y, z});
const quaternion = ([w, x, y, z]) => ({w, x, y, z});
const array = ({x, y, z}) => [x, y, z];
const arrayOf = ({w, x, y, z}) => [w, x, y, z];

const Rule = RAPIER.CoefficientCombineRule;
const ruleOf = {average: Rule.Average, min: Rule.Min, multiply: Rule.Multiply, max: Rule.Max};
const nameOf = Object.fromEntries(Object.entries(ruleOf).map(([key, value]) => [value, key]));
const yToZ = [Math.SQRT1_2, Math.SQRT1_2, 0, 0];

function colliderOf(setup, body) {
  const {shape} = body;
  switch (shape.type) {
    case 'plane': {
      const [x, y, z] = shape.normal.map((n) => n * shape.offset);
      return new RAPIER.ColliderDesc(new RAPIER.HalfSpace(vector(shape.normal))).setTranslation(x, y, z);
    }
    case 'sphere':
      return RAPIER.ColliderDesc.ball(shape.radius);
    case 'box':
      return RAPIER.ColliderDesc.cuboid(...shape.half_extents);
    case 'capsule':
      return RAPIER.ColliderDesc.capsule(shape.half_height, shape.radius).setRotation(quaternion(yToZ));
    case 'cylinder':
      return RAPIER.ColliderDesc.cylinder(shape.half_height, shape.radius).setRotation(quaternion(yToZ));
    case 'mesh':
      return RAPIER.ColliderDesc.trimesh(principalVertices(solidOf(setup, body)), Uint32Array.from(solidOf(setup, body).triangles.flat()),
        RAPIER.TriMeshFlags.FIX_INTERNAL_EDGES | RAPIER.TriMeshFlags.ORIENTED);
    default:
      return RAPIER.ColliderDesc.convexHull(principalVertices(solidOf(setup, body)));
  }
}

function addBody(world, setup, body, plan) {
  const {position, orientation} = principalPose(setup, body);
  const desc = (body.static ? RAPIER.RigidBodyDesc.fixed() : RAPIER.RigidBodyDesc.dynamic())
    .setTranslation(...position).setRotation(quaternion(orientation));
  if (!body.static) {
    desc.setLinvel(...body.velocity).setAngvel(vector(body.angular_velocity)).setCanSleep(false)
      .setAdditionalMassProperties(body.mass, vector([0, 0, 0]), vector(body.inertia), quaternion([1, 0, 0, 0]));
  }
  const made = world.createRigidBody(desc);
  const colliders = plan.of(body.material).map((c) => ({
    material: c.material,
    collider: world.createCollider(colliderOf(setup, body).setDensity(0)
      .setFriction(c.friction).setFrictionCombineRule(ruleOf[plan.rule.friction])
      .setRestitution(c.restitution).setRestitutionCombineRule(ruleOf[plan.rule.restitution])
      .setCollisionGroups(c.member * 2 ** 16 + c.meets).setContactSkin(setup.options.contact_skin), made),
  }));
  made.recomputeMassPropertiesFromColliders();
  return {made, colliders, isStatic: body.static, turn: /capsule|cylinder/.test(body.shape.type) ? yToZ : [1, 0, 0, 0]};
}

function create(setup) {
  const plan = colliderPlan(setup, ['multiply', 'max', 'min', 'average'], 16);
  const world = new RAPIER.World(vector(setup.gravity));
  const {options} = setup;
  world.timestep = setup.dt;
  world.profilerEnabled = true;
  world.numSolverIterations = options.iterations;
  world.numInternalPgsIterations = options.pgs_iterations;
  world.integrationParameters.contact_natural_frequency = options.contact_frequency;
  world.integrationParameters.normalizedAllowedLinearError = options.allowed_error;
  world.integrationParameters.normalizedPredictionDistance = options.prediction;
  const bodies = setup.bodies.map((body) => addBody(world, setup, body, plan));
  const indexOf = new Map(bodies.flatMap(({colliders}, index) => colliders.map(({collider}) => [collider.handle, index])));
  let before = [];
  const orientationOf = (index) => arrayOf(bodies[index].made.rotation());

  /** Calls visit(a, b, manifold, flipped) for each manifold with a < b; flipped: its first collider is that of b. */
  function eachManifold(visit) {
    bodies.forEach(({colliders}, a) => colliders.forEach(({collider}) => {
      world.contactPairsWith(collider, (other) => {
        const b = indexOf.get(other.handle);
        if (a < b) {
          world.contactPair(collider, other, (manifold, flipped) => visit(a, b, manifold, flipped));
        }
      });
    }));
  }

  /** A point of a collider in the world, where its body was before the last step. */
  function pointBefore(index, local) {
    const {colliders, isStatic, turn} = bodies[index];
    const [{collider}] = colliders;
    const pose = isStatic ? {x: array(collider.translation()), q: arrayOf(collider.rotation())}
      : {x: before[index].x, q: product(before[index].q, turn)};
    const offset = rotate(pose.q, array(local));
    return pose.x.map((value, k) => value + offset[k]);
  }

  return {
    step(number) {
      before = apart(() => bodies.map(({made}) => ({x: array(made.translation()), q: arrayOf(made.rotation())})));
      bodies.forEach(({made}) => {
        made.resetForces(false);
        made.resetTorques(false);
      });
      applyForces(setup, number, orientationOf, (index, force, torque) => {
        bodies[index].made.addForce(vector(force), true);
        bodies[index].made.addTorque(vector(torque), true);
      });
      world.step();
      return {iterations: options.iterations * options.pgs_iterations, time_collide: 1e-3 * world.timingCollisionDetection(),
        time_solve: 1e-3 * world.timingSolver()};
    },
    readFrame: (frame) => writeFrame(frame, setup, (index) => {
      const {made} = bodies[index];
      return [array(made.translation()), arrayOf(made.rotation()), array(made.linvel()), array(made.angvel())];
    }),
    readContacts() {
      const contacts = [];
      if (before.length === 0) {
        return contacts;
      }
      eachManifold((a, b, manifold, flipped) => {
        const normal = array(manifold.normal()).map((n) => (flipped ? -n : n));
        if (normal.every((n) => n === 0)) { // meshes have such manifolds, without a meaning
          return;
        }
        for (let i = 0; i < manifold.numContacts(); ++i) {
          const distance = manifold.contactDist(i);
          if (distance < options.prediction) {
            const onFirst = pointBefore(flipped ? b : a, manifold.localContactPoint1(i));
            const half = (flipped ? -0.5 : 0.5) * distance;
            contacts.push(a, b, ...onFirst.map((x, k) => x + half * normal[k]), ...normal, distance);
          }
        }
      });
      return contacts;
    },
    settings() {
      const moving = (index, value) => (setup.bodies[index].static ? 0 : value);
      const damping = (read) => Math.max(0, ...bodies.map(({made}) => read(made)));
      return {
        gravity: array(world.gravity), dt: world.timestep, substeps: world.numSolverIterations,
        mass: bodies.map(({made}, i) => moving(i, made.mass())),
        inertia: bodies.map(({made}, i) => array(made.principalInertia()).map((value) => moving(i, value))),
        linear_damping: damping((made) => made.linearDamping()), angular_damping: damping((made) => made.angularDamping()),
      };
    },
    pair(a, b) {
      const meeting = (index, other) => bodies[index].colliders
        .find(({material}) => material === null || material === setup.bodies[other].material).collider;
      const [one, two] = [meeting(a, b), meeting(b, a)];
      return {
        friction: rules[nameOf[Math.max(one.frictionCombineRule(), two.frictionCombineRule())]].combine(one.friction(), two.friction()),
        restitution: rules[nameOf[Math.max(one.restitutionCombineRule(), two.restitutionCombineRule())]].combine(one.restitution(), two.restitution()),
      };
    },
    destroy: () => world.free(),
  };
}

const shipped = new RAPIER.IntegrationParameters();
const hello = describe(RAPIER.version(), files, {
  iterations: shipped.numSolverIterations,
  pgs_iterations: shipped.numInternalPgsIterations,
  allowed_error: shipped.normalizedAllowedLinearError,
  prediction: shipped.normalizedPredictionDistance,
});
if (isDeterministic) {
  hello.name = 'rapier-deterministic';
  hello.profiles[1].in_default_comparison = false;
}
serve({...hello, substeps: shipped.numSolverIterations, create});
