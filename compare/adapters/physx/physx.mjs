// PhysX 5, single precision, built to WebAssembly by npm's physx-js-webidl.
//
// Sleeping, stabilization, angular damping (0.05 as shipped) and the limit of angular speed are off, and the gyroscopic
// torque is on. Capsules and cylinders have their axis along x, and are turned; a cylinder is a convex core without a
// margin. A static mesh is a triangle mesh. A moving one needs the graphics processor: it is unsupported.
//
// PhysX combines the coefficients of two materials by a rule. Where no rule gives all pairs theirs, a body has several
// shapes (materials.mjs). Contact reports have the normal part of an impulse only, so that contacts are points. They are
// read within the step. That is not counted as its time; what PhysX itself does to prepare reports is.
import {apart, describe, packageOf, serve, Unsupported} from './protocol.mjs';
import {applyForces, planePose, principalPose, principalVertices, solidOf, writeFrame} from './mechanics.mjs';
import {colliderPlan, rules} from './materials.mjs';
import {readFileSync} from 'node:fs';
import initPhysX from 'physx-js-webidl';

// The package is built for browsers and refuses node by name. Nothing in it needs a browser but the loading of its
// WebAssembly, which is given to it.
const {files} = packageOf('physx-js-webidl', 'physx-js-webidl.wasm');
const wasm = files.at(-1);
const {versions} = process;
globalThis.window = globalThis;
Object.defineProperty(process, 'versions', {value: {}, configurable: true});
const Px = await initPhysX({wasmBinary: readFileSync(wasm)});
Object.defineProperty(process, 'versions', {value: versions});
const VERSION = Px.PHYSICS_VERSION;
const NO_LIMIT = 1e9;
const GYROSCOPIC_FORCES = 1 << 10; // PxRigidBodyFlag::eENABLE_GYROSCOPIC_FORCES, which the package has no name for

const foundation = Px.CreateFoundation(VERSION, new Px.PxDefaultAllocator(), new Px.PxDefaultErrorCallback());
const scale = new Px.PxTolerancesScale();
const physics = Px.CreatePhysics(VERSION, foundation, scale);
const shapeFlags = new Px.PxShapeFlags(Px.PxShapeFlagEnum.eSIMULATION_SHAPE);
const array = ({x, y, z}) => [x, y, z];
const arrayOf = ({w, x, y, z}) => [w, x, y, z];
const xToZ = [Math.SQRT1_2, 0, -Math.SQRT1_2, 0];

/** Calls use(object) and frees the object. */
function using(object, use) {
  const result = use(object);
  Px.destroy(object);
  return result;
}

const withVector = ([x, y, z], use) => using(new Px.PxVec3(x, y, z), use);
const withPose = (position, [w, x, y, z], use) => withVector(position, (p) => using(new Px.PxQuat(x, y, z, w), (q) => using(new Px.PxTransform(p, q), use)));

const modes = {average: 'eAVERAGE', min: 'eMIN', multiply: 'eMULTIPLY', max: 'eMAX'};
const modeOf = (rule) => Px.PxCombineModeEnum[modes[rule]];
const ruleOf = (mode) => Object.keys(modes).find((rule) => modeOf(rule) === mode);

/** A copy of the corners of a solid for PhysX, to which `desc` then refers. */
function pointsOf(desc, vertices) {
  const points = new Px.Vector_PxVec3();
  for (let i = 0; i < vertices.length; i += 3) {
    withVector(vertices.subarray(i, i + 3), (v) => points.push_back(v));
  }
  desc.points.count = points.size();
  desc.points.stride = 12;
  desc.points.data = points.data();
  return points;
}

function hullOf(vertices) {
  const desc = new Px.PxConvexMeshDesc();
  const points = pointsOf(desc, vertices);
  desc.flags = new Px.PxConvexFlags(Px.PxConvexFlagEnum.eCOMPUTE_CONVEX);
  const mesh = using(new Px.PxCookingParams(scale), (params) => Px.CreateConvexMesh(params, desc));
  [desc, points].forEach((made) => Px.destroy(made));
  return using(new Px.PxMeshScale(), (unit) => new Px.PxConvexMeshGeometry(mesh, unit));
}

function meshOf(vertices, corners) {
  const desc = new Px.PxTriangleMeshDesc();
  const points = pointsOf(desc, vertices);
  const indices = new Px.PxArray_PxU32();
  corners.forEach((i) => indices.pushBack(i));
  desc.triangles.count = corners.length / 3;
  desc.triangles.stride = 12;
  desc.triangles.data = indices.begin();
  const mesh = using(new Px.PxCookingParams(scale), (params) => Px.CreateTriangleMesh(params, desc));
  [desc, points, indices].forEach((made) => Px.destroy(made));
  return using(new Px.PxMeshScale(), (unit) => using(new Px.PxMeshGeometryFlags(0), (flags) => new Px.PxTriangleMeshGeometry(mesh, unit, flags)));
}

/** The geometry of a body, and how it is turned in its principal frame. */
function geometryOf(setup, body) {
  const {shape} = body;
  switch (shape.type) {
    case 'plane':
      return {geometry: new Px.PxPlaneGeometry(), turn: xToZ};
    case 'sphere':
      return {geometry: new Px.PxSphereGeometry(shape.radius)};
    case 'box':
      return {geometry: new Px.PxBoxGeometry(...shape.half_extents)};
    case 'capsule':
      return {geometry: new Px.PxCapsuleGeometry(shape.radius, shape.half_height), turn: xToZ};
    case 'cylinder':
      return {geometry: using(new Px.PxConvexCoreCylinder(2 * shape.half_height, shape.radius), (core) => Px.PxConvexCoreGeometryFactory.prototype.createFromCylinder(core, 0)), turn: xToZ};
    case 'mesh':
      if (!body.static) {
        throw new Unsupported(`PhysX has no moving meshes without a graphics processor: body "${body.name}"`);
      }
      return {geometry: meshOf(principalVertices(solidOf(setup, body)), solidOf(setup, body).triangles.flat())};
    default:
      return {geometry: hullOf(principalVertices(solidOf(setup, body)))};
  }
}

function addBody(scene, setup, body, plan, index) {
  const {options} = setup;
  const pose = body.shape.type === 'plane' ? planePose(body.shape) : principalPose(setup, body);
  const actor = withPose(pose.position, pose.orientation, (t) => (body.static ? physics.createRigidStatic(t) : physics.createRigidDynamic(t)));
  const {geometry, turn = [1, 0, 0, 0]} = geometryOf(setup, body);
  const colliders = plan.of(body.material).map((c) => {
    const material = physics.createMaterial(c.friction, c.friction, c.restitution);
    material.setFrictionCombineMode(modeOf(plan.rule.friction));
    material.setRestitutionCombineMode(modeOf(plan.rule.restitution));
    const shape = physics.createShape(geometry, material, true, shapeFlags);
    withPose([0, 0, 0], turn, (t) => shape.setLocalPose(t));
    using(new Px.PxFilterData(c.material === null ? 0 : body.material, c.material ?? 0, index, 0), (data) => shape.setSimulationFilterData(data));
    shape.setContactOffset(options.contact_offset);
    actor.attachShape(shape);
    return {material: c.material, stored: material};
  });
  if (!body.static) {
    actor.setMass(body.mass);
    withVector(body.inertia, (inertia) => actor.setMassSpaceInertiaTensor(inertia));
    withVector(body.velocity, (v) => actor.setLinearVelocity(v));
    withVector(body.angular_velocity, (w) => actor.setAngularVelocity(w));
    actor.setLinearDamping(0);
    actor.setAngularDamping(0);
    actor.setMaxAngularVelocity(NO_LIMIT);
    actor.setSleepThreshold(0);
    actor.setStabilizationThreshold(0);
    actor.setRigidBodyFlag(GYROSCOPIC_FORCES, true);
    actor.setSolverIterationCounts(options.iterations, options.velocity_iterations);
  }
  scene.addActor(actor);
  return {actor, colliders};
}

/** Lets two shapes meet where each is the one for the other's material, and asks for their contacts. */
function filter() {
  const made = new Px.PassThroughFilterShaderImpl();
  const flags = Px.PxPairFlagEnum;
  made.filterShader = (attributes0, own0, wanted0, index0, w03, attributes1, own1, wanted1) => {
    made.outputPairFlags = flags.eSOLVE_CONTACT | flags.eDETECT_DISCRETE_CONTACT | flags.eNOTIFY_TOUCH_FOUND |
      flags.eNOTIFY_TOUCH_PERSISTS | flags.eNOTIFY_CONTACT_POINTS;
    return own0 === wanted1 && own1 === wanted0 ? Px.PxFilterFlagEnum.eDEFAULT : Px.PxFilterFlagEnum.eKILL;
  };
  return made;
}

function create(setup) {
  const {options} = setup;
  const plan = colliderPlan(setup, ['multiply', 'max', 'min', 'average']);
  let contacts = [];
  const points = new Px.Vector_PxContactPairPoint(64);
  const listener = new Px.PxSimulationEventCallbackImpl();
  listener.onConstraintBreak = listener.onWake = listener.onSleep = listener.onTrigger = () => {};
  listener.onContact = (headerAt, pairsAt, count) => apart(() => {
    const pairs = Px.wrapPointer(pairsAt, Px.PxContactPair);
    for (let i = 0; i < count; ++i) {
      const pair = Px.NativeArrayHelpers.prototype.getContactPairAt(pairs, i);
      const [one, two] = [pair.get_shapes(0), pair.get_shapes(1)].map((s) => s.getSimulationFilterData().word2);
      const found = pair.extractContacts(points.data(), 64);
      for (let k = 0; k < found; ++k) {
        const point = points.at(k); // its normal points from the second shape to the first
        contacts.push(two, one, ...array(point.position), ...array(point.normal), point.separation);
      }
    }
  });
  const desc = new Px.PxSceneDesc(scale);
  const shader = filter();
  withVector(setup.gravity, (g) => {
    desc.gravity = g;
  });
  desc.simulationEventCallback = listener;
  desc.cpuDispatcher = Px.DefaultCpuDispatcherCreate(0);
  desc.solverType = setup.profile === 'tgs' || setup.profile === 'recommended' ? Px.PxSolverTypeEnum.eTGS : Px.PxSolverTypeEnum.ePGS;
  desc.bounceThresholdVelocity = options.restitution_threshold;
  Px.setupPassThroughFilterShader(desc, shader);
  const scene = physics.createScene(desc);
  Px.destroy(desc);
  const bodies = setup.bodies.map((body, index) => addBody(scene, setup, body, plan, index));

  return {
    step(number) {
      contacts = [];
      applyForces(setup, number, (index) => arrayOf(bodies[index].actor.getGlobalPose().q), (index, force, torque) => {
        withVector(force, (f) => bodies[index].actor.addForce(f));
        withVector(torque, (t) => bodies[index].actor.addTorque(t));
      });
      scene.simulate(setup.dt);
      scene.fetchResults(true);
      return {iterations: options.iterations + options.velocity_iterations};
    },
    readFrame: (frame) => writeFrame(frame, setup, (index) => {
      const {actor} = bodies[index];
      const {p, q} = actor.getGlobalPose();
      const velocities = setup.bodies[index].static ? [[0, 0, 0], [0, 0, 0]] : [array(actor.getLinearVelocity()), array(actor.getAngularVelocity())];
      return [array(p), arrayOf(q), ...velocities];
    }),
    readContacts: () => contacts,
    settings() {
      const each = (read, still) => bodies.map(({actor}, i) => (setup.bodies[i].static ? still : read(actor)));
      return {
        gravity: array(scene.getGravity()), mass: each((a) => a.getMass(), 0), inertia: each((a) => array(a.getMassSpaceInertiaTensor()), [0, 0, 0]),
        linear_damping: Math.max(0, ...each((a) => a.getLinearDamping(), 0)), angular_damping: Math.max(0, ...each((a) => a.getAngularDamping(), 0)),
      };
    },
    pair(a, b) {
      const meeting = (index, other) => bodies[index].colliders
        .find(({material}) => material === null || material === setup.bodies[other].material).stored;
      const [one, two] = [meeting(a, b), meeting(b, a)];
      const higher = (read) => ruleOf(Math.max(read(one), read(two)));
      return {
        friction: rules[higher((m) => m.getFrictionCombineMode())].combine(one.getDynamicFriction(), two.getDynamicFriction()),
        restitution: rules[higher((m) => m.getRestitutionCombineMode())].combine(one.getRestitution(), two.getRestitution()),
      };
    },
    destroy() {
      bodies.forEach(({actor}) => actor.release());
      scene.release();
      [listener, shader, points].forEach((object) => Px.destroy(object));
    },
  };
}

const {bounceThresholdVelocity} = new Px.PxSceneDesc(scale);

serve({
  ...describe(`${VERSION >> 24}.${(VERSION >> 16) & 255}.${(VERSION >> 8) & 255}`, files, {restitution_threshold: bounceThresholdVelocity}),
  create,
});
