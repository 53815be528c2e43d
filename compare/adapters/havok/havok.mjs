// Havok Physics, as Babylon.js ships it in WebAssembly (npm @babylonjs/havok), single precision.
//
// Bodies are always active; damping and speed limits are off. Havok's interface has no half-space: a plane is a box whose
// top is the plane and which covers the scene's bounds. Moments of inertia are handed over for a mass of 1. Applied
// forces are impulses before the step.
//
// Havok combines the coefficients of two materials by a rule. Where no rule gives all pairs theirs, a body is a container
// of several shapes (materials.mjs). Collision events have one point a pair, so that contacts are not reported, and the
// interface has no settings of the solver.
import {describe, packageOf, serve} from './protocol.mjs';
import {applyForces, halfDiagonal, middleOfPlane, principalPose, principalVertices, rotationFromZ, solidOf, writeFrame} from './mechanics.mjs';
import {colliderPlan, rules} from './materials.mjs';
import {readFileSync} from 'node:fs';
import initHavok from '@babylonjs/havok';

const {version, files} = packageOf('@babylonjs/havok', 'HavokPhysics.wasm');
const Havok = await initHavok({wasmBinary: readFileSync(files.at(-1))});
const NO_LIMIT = 1e9;
const IDENTITY = [0, 0, 0, 1];

/** The value of a call [result, value...], or the result alone. */
function done(returned) {
  const [result, value] = Array.isArray(returned) ? returned : [returned];
  if (result !== Havok.Result.RESULT_OK) {
    throw new Error(`Havok answered ${Object.keys(Havok.Result).find((key) => Havok.Result[key] === result)}`);
  }
  return value;
}

const quaternion = ([w, x, y, z]) => [x, y, z, w];
const fromQuaternion = ([x, y, z, w]) => [w, x, y, z];
const modes = {multiply: Havok.MaterialCombine.MULTIPLY, max: Havok.MaterialCombine.MAXIMUM, min: Havok.MaterialCombine.MINIMUM, average: Havok.MaterialCombine.ARITHMETIC_MEAN};
const ruleOf = (mode) => Object.keys(modes).find((rule) => modes[rule] === mode);

/** Calls use(address) with a copy of `numbers`, of four bytes each, in Havok's memory. */
function withCopy(numbers, use) {
  const at = Havok._malloc(numbers.byteLength);
  Havok.HEAPU8.set(new Uint8Array(numbers.buffer), at);
  const result = use(at);
  Havok._free(at);
  return result;
}

const hullOf = (vertices) => withCopy(vertices, (at) => done(Havok.HP_Shape_CreateConvexHull(at, vertices.length / 3)));

const meshOf = (vertices, corners) => withCopy(vertices, (at) => withCopy(corners, (cornersAt) =>
  done(Havok.HP_Shape_CreateMesh(at, vertices.length / 3, cornersAt, corners.length / 3))));

function shapeOf(setup, body) {
  const {shape} = body;
  switch (shape.type) {
    case 'plane':
      return done(Havok.HP_Shape_CreateBox([0, 0, -halfDiagonal(setup)], IDENTITY, Array(3).fill(2 * halfDiagonal(setup))));
    case 'sphere':
      return done(Havok.HP_Shape_CreateSphere([0, 0, 0], shape.radius));
    case 'box':
      return done(Havok.HP_Shape_CreateBox([0, 0, 0], IDENTITY, shape.half_extents.map((h) => 2 * h)));
    case 'capsule':
      return done(Havok.HP_Shape_CreateCapsule([0, 0, -shape.half_height], [0, 0, shape.half_height], shape.radius));
    case 'cylinder':
      return done(Havok.HP_Shape_CreateCylinder([0, 0, -shape.half_height], [0, 0, shape.half_height], shape.radius));
    case 'mesh':
      return meshOf(principalVertices(solidOf(setup, body)), Int32Array.from(solidOf(setup, body).triangles.flat()));
    default:
      return hullOf(principalVertices(solidOf(setup, body)));
  }
}

/** The shapes of a body, one for each collider of the plan, and the one that holds them. */
function collidersOf(setup, body, plan) {
  const colliders = plan.of(body.material).map((c) => {
    const shape = shapeOf(setup, body);
    done(Havok.HP_Shape_SetMaterial(shape, [c.friction, c.friction, c.restitution, modes[plan.rule.friction], modes[plan.rule.restitution]]));
    done(Havok.HP_Shape_SetFilterInfo(shape, [c.member, c.meets]));
    return {material: c.material, shape};
  });
  if (colliders.length === 1) {
    return {colliders, whole: colliders[0].shape};
  }
  const whole = done(Havok.HP_Shape_CreateContainer());
  colliders.forEach(({shape}) => done(Havok.HP_Shape_AddChild(whole, shape, [[0, 0, 0], IDENTITY, [1, 1, 1]])));
  return {colliders, whole};
}

function addBody(world, setup, body, plan) {
  const {position, orientation} = body.shape.type === 'plane'
    ? {position: middleOfPlane(setup, body.shape), orientation: rotationFromZ(body.shape.normal)} : principalPose(setup, body);
  const {colliders, whole} = collidersOf(setup, body, plan);
  const id = done(Havok.HP_Body_Create());
  done(Havok.HP_Body_SetShape(id, whole));
  done(Havok.HP_Body_SetMotionType(id, body.static ? Havok.MotionType.STATIC : Havok.MotionType.DYNAMIC));
  done(Havok.HP_Body_SetQTransform(id, [position, quaternion(orientation)]));
  if (!body.static) {
    done(Havok.HP_Body_SetMassProperties(id, [[0, 0, 0], body.mass, body.inertia.map((i) => i / body.mass), IDENTITY]));
    done(Havok.HP_Body_SetLinearDamping(id, 0));
    done(Havok.HP_Body_SetAngularDamping(id, 0));
    done(Havok.HP_Body_SetLinearVelocity(id, body.velocity));
    done(Havok.HP_Body_SetAngularVelocity(id, body.angular_velocity));
  }
  done(Havok.HP_World_AddBody(world, id, false));
  if (!body.static) {
    done(Havok.HP_Body_SetActivationControl(id, Havok.ActivationControl.ALWAYS_ACTIVE));
  }
  return {id, colliders, whole};
}

function create(setup) {
  const plan = colliderPlan(setup, ['multiply', 'max', 'min', 'average'], 30);
  const world = done(Havok.HP_World_Create());
  done(Havok.HP_World_SetGravity(world, setup.gravity));
  done(Havok.HP_World_SetIdealStepTime(world, setup.dt));
  done(Havok.HP_World_SetSpeedLimit(world, NO_LIMIT, NO_LIMIT));
  const bodies = setup.bodies.map((body) => addBody(world, setup, body, plan));
  const poseOf = (index) => {
    const [x, q] = done(Havok.HP_Body_GetQTransform(bodies[index].id));
    return {x, q: fromQuaternion(q)};
  };
  return {
    step(number) {
      applyForces(setup, number, (index) => poseOf(index).q, (index, force, torque) => {
        const {id} = bodies[index];
        done(Havok.HP_Body_ApplyImpulse(id, poseOf(index).x, force.map((f) => f * setup.dt)));
        done(Havok.HP_Body_ApplyAngularImpulse(id, torque.map((t) => t * setup.dt)));
      });
      done(Havok.HP_World_Step(world, setup.dt));
      return {};
    },
    readFrame: (frame) => writeFrame(frame, setup, (index) => {
      const [{x, q}, {id}] = [poseOf(index), bodies[index]];
      return [x, q, done(Havok.HP_Body_GetLinearVelocity(id)), done(Havok.HP_Body_GetAngularVelocity(id))];
    }),
    settings() {
      const each = (read, still) => bodies.map(({id}, i) => (setup.bodies[i].static ? still : read(id)));
      const properties = each((id) => done(Havok.HP_Body_GetMassProperties(id)), null);
      return {
        mass: properties.map((p) => p?.[1] ?? 0), inertia: properties.map((p) => p?.[2].map((i) => i * p[1]) ?? [0, 0, 0]),
        linear_damping: Math.max(0, ...each((id) => done(Havok.HP_Body_GetLinearDamping(id)), 0)),
        angular_damping: Math.max(0, ...each((id) => done(Havok.HP_Body_GetAngularDamping(id)), 0)),
      };
    },
    pair(a, b) {
      const meeting = (index, other) => done(Havok.HP_Shape_GetMaterial(bodies[index].colliders
        .find(({material}) => material === null || material === setup.bodies[other].material).shape));
      const [one, two] = [meeting(a, b), meeting(b, a)];
      return {friction: rules[ruleOf(one[3])].combine(one[1], two[1]), restitution: rules[ruleOf(one[4])].combine(one[2], two[2])};
    },
    destroy() {
      bodies.forEach(({id, colliders, whole}) => {
        Havok.HP_World_RemoveBody(world, id);
        Havok.HP_Body_Release(id);
        [...new Set([whole, ...colliders.map(({shape}) => shape)])].forEach((shape) => Havok.HP_Shape_Release(shape));
      });
      Havok.HP_World_Release(world);
    },
  };
}

serve({...describe(version, files), create});
