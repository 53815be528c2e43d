// Jolt Physics, the maintainer's WebAssembly build in single precision (npm jolt-physics).
//
// Sleeping, damping (0.05 as shipped) and the limits of speed are off, and the gyroscopic torque is on. Boxes, cylinders
// and hulls keep their size: Jolt rounds their edges by the convex radius. Capsules and cylinders have their axis along y,
// and are turned. A static mesh is a surface of oriented triangles. A moving mesh collides with convex shapes, but neither
// with planes nor with meshes: it is unsupported.
//
// The contact listener gives every pair of bodies its coefficients, and records the contacts of the first sub-step: those of
// later ones are not of the poses before the step. Recording is not counted as the step's time. Jolt's interface has contact
// points, but not the impulses that the solver found.
import {apart, describe, packageOf, serve, Unsupported} from './protocol.mjs';
import {applyForces, halfDiagonal, middleOfPlane, principalPose, principalVertices, solidOf, writeFrame} from './mechanics.mjs';
import initJolt from 'jolt-physics/wasm-compat';

const Jolt = await initJolt();
const {version, files} = packageOf('jolt-physics/wasm-compat');

const STATIC_LAYER = 0;
const MOVING_LAYER = 1;
const NO_LIMIT = 1e9;

const vec3 = ([x, y, z]) => new Jolt.Vec3(x, y, z);
const rvec3 = ([x, y, z]) => new Jolt.RVec3(x, y, z);
const quat = ([w, x, y, z]) => new Jolt.Quat(x, y, z, w);
const array = (v) => [v.GetX(), v.GetY(), v.GetZ()];
const arrayOf = (q) => [q.GetW(), q.GetX(), q.GetY(), q.GetZ()];

/** Calls use(made...) and frees what was made. */
function using(made, use) {
  const result = use(...made);
  made.forEach((object) => Jolt.destroy(object));
  return result;
}

function built(settings) {
  const result = settings.Create();
  if (result.HasError()) {
    throw new Error(result.GetError().c_str());
  }
  return result.Get();
}

/** A shape whose settings have its axis along y, turned to z. */
function turned(settings) {
  return using([new Jolt.Vec3(0, 0, 0), quat([Math.SQRT1_2, Math.SQRT1_2, 0, 0])],
    (origin, turn) => built(new Jolt.RotatedTranslatedShapeSettings(origin, turn, settings)));
}

function hullOf(vertices, radius) {
  const settings = new Jolt.ConvexHullShapeSettings();
  for (let i = 0; i < vertices.length; i += 3) {
    using([vec3(vertices.subarray(i, i + 3))], (v) => settings.mPoints.push_back(v));
  }
  settings.mMaxConvexRadius = radius;
  return built(settings);
}

function meshOf(setup, body) {
  const vertices = principalVertices(solidOf(setup, body));
  const list = new Jolt.TriangleList();
  for (const corners of solidOf(setup, body).triangles) {
    using(corners.map((i) => vec3(vertices.subarray(3 * i, 3 * i + 3))), (a, b, c) => using([new Jolt.Triangle(a, b, c)], (triangle) => list.push_back(triangle)));
  }
  return built(new Jolt.MeshShapeSettings(list, new Jolt.PhysicsMaterialList()));
}

function shapeOf(setup, body) {
  const {shape} = body;
  const radius = setup.options.convex_radius;
  switch (shape.type) {
    case 'plane':
      return using([vec3(shape.normal)], (n) => using([new Jolt.Plane(n, -shape.offset)], (plane) => new Jolt.PlaneShape(plane, null, Math.hypot(...middleOfPlane(setup, shape)) + halfDiagonal(setup))));
    case 'sphere':
      return new Jolt.SphereShape(shape.radius);
    case 'box':
      return using([vec3(shape.half_extents)], (half) => new Jolt.BoxShape(half, Math.min(radius, ...shape.half_extents)));
    case 'capsule':
      return turned(new Jolt.CapsuleShapeSettings(shape.half_height, shape.radius));
    case 'cylinder':
      return turned(new Jolt.CylinderShapeSettings(shape.half_height, shape.radius, Math.min(radius, shape.half_height, shape.radius)));
    case 'mesh':
      if (!body.static) {
        throw new Unsupported(`Jolt has no moving meshes: body "${body.name}"`);
      }
      return meshOf(setup, body);
    default:
      return hullOf(principalVertices(solidOf(setup, body)), radius);
  }
}

/** An object that runs Jolt: two layers, in which static bodies do not meet each other. */
function interfaceFor(count) {
  const settings = new Jolt.JoltSettings();
  const pairs = new Jolt.ObjectLayerPairFilterTable(2);
  pairs.EnableCollision(STATIC_LAYER, MOVING_LAYER);
  pairs.EnableCollision(MOVING_LAYER, MOVING_LAYER);
  const layers = new Jolt.BroadPhaseLayerInterfaceTable(2, 2);
  for (const layer of [STATIC_LAYER, MOVING_LAYER]) {
    using([new Jolt.BroadPhaseLayer(layer)], (broad) => layers.MapObjectToBroadPhaseLayer(layer, broad));
  }
  settings.mObjectLayerPairFilter = pairs;
  settings.mBroadPhaseLayerInterface = layers;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 2, pairs, 2);
  settings.mMaxBodies = count + 16;
  settings.mMaxBodyPairs = 64 * count + 1024;
  settings.mMaxContactConstraints = 32 * count + 1024;
  const made = new Jolt.JoltInterface(settings);
  Jolt.destroy(settings);
  return made;
}

function addBody(bodies, setup, body) {
  const {position, orientation} = principalPose(setup, body);
  const shape = shapeOf(setup, body);
  const settings = using([rvec3(position), quat(orientation)], (x, q) => new Jolt.BodyCreationSettings(shape, x, q,
    body.static ? Jolt.EMotionType_Static : Jolt.EMotionType_Dynamic, body.static ? STATIC_LAYER : MOVING_LAYER));
  settings.mAllowSleeping = false;
  settings.mApplyGyroscopicForce = true;
  settings.mLinearDamping = 0;
  settings.mAngularDamping = 0;
  settings.mMaxLinearVelocity = NO_LIMIT;
  settings.mMaxAngularVelocity = NO_LIMIT;
  if (!body.static) {
    using([vec3(body.velocity), vec3(body.angular_velocity)], (v, w) => {
      settings.mLinearVelocity = v;
      settings.mAngularVelocity = w;
    });
  }
  const made = bodies.CreateBody(settings);
  Jolt.destroy(settings);
  if (!body.static) {
    const motion = made.GetMotionProperties();
    motion.SetInverseMass(1 / body.mass);
    using([vec3(body.inertia.map((i) => 1 / i)), quat([1, 0, 0, 0])], (inverse, axes) => motion.SetInverseInertia(inverse, axes));
  }
  bodies.AddBody(made.GetID(), Jolt.EActivation_Activate);
  return made;
}

function create(setup) {
  const {options} = setup;
  const jolt = interfaceFor(setup.bodies.length);
  const system = jolt.GetPhysicsSystem();
  const settings = system.GetPhysicsSettings();
  using([vec3(setup.gravity)], (g) => system.SetGravity(g));
  settings.mNumVelocitySteps = options.iterations;
  settings.mNumPositionSteps = options.position_iterations;
  settings.mBaumgarte = options.baumgarte;
  settings.mPenetrationSlop = options.slop;
  settings.mSpeculativeContactDistance = options.speculative_distance;
  settings.mMinVelocityForRestitution = options.restitution_threshold;
  system.SetPhysicsSettings(settings);
  const bodies = setup.bodies.map((body) => addBody(system.GetBodyInterface(), setup, body));
  const indexOf = new Map(bodies.map((body, index) => [Jolt.getPointer(body), index]));
  let contacts = [];
  let isFirst = true;

  const clock = new Jolt.PhysicsStepListenerJS();
  clock.OnStep = (contextAt) => {
    isFirst = Jolt.wrapPointer(contextAt, Jolt.PhysicsStepListenerContext).mIsFirstStep;
  };
  system.AddStepListener(clock);

  const listener = new Jolt.ContactListenerJS();
  const record = (a, b, manifold) => {
    const normal = array(manifold.mWorldSpaceNormal);
    for (let i = 0; i < manifold.mRelativeContactPointsOn1.size(); ++i) {
      const p = array(manifold.GetWorldSpaceContactPointOn1(i));
      const q = array(manifold.GetWorldSpaceContactPointOn2(i));
      const separation = normal.reduce((sum, n, k) => sum + n * (q[k] - p[k]), 0);
      contacts.push(a, b, ...p.map((x, k) => (x + q[k]) / 2), ...normal, separation);
    }
  };
  const found = (first, second, manifoldAt, settingsAt) => {
    const [a, b] = [indexOf.get(first), indexOf.get(second)];
    const [one, two] = [setup.bodies[a].material, setup.bodies[b].material];
    const manifold = Jolt.wrapPointer(manifoldAt, Jolt.ContactManifold);
    const contact = Jolt.wrapPointer(settingsAt, Jolt.ContactSettings);
    contact.mCombinedFriction = setup.friction[one][two];
    contact.mCombinedRestitution = setup.restitution[one][two];
    if (isFirst) {
      apart(() => record(a, b, manifold));
    }
  };
  listener.OnContactValidate = () => Jolt.ValidateResult_AcceptAllContactsForThisBodyPair;
  listener.OnContactAdded = found;
  listener.OnContactPersisted = found;
  listener.OnContactRemoved = () => {};
  system.SetContactListener(listener);

  const moving = (index) => !setup.bodies[index].static;
  return {
    step(number) {
      contacts = [];
      applyForces(setup, number, (index) => arrayOf(bodies[index].GetRotation()), (index, force, torque) => {
        using([vec3(force), vec3(torque)], (f, t) => {
          bodies[index].AddForce(f);
          bodies[index].AddTorque(t);
        });
      });
      jolt.Step(setup.dt, options.collision_steps);
      return {iterations: options.iterations * options.collision_steps};
    },
    readFrame: (frame) => writeFrame(frame, setup, (index) => {
      const body = bodies[index];
      return [array(body.GetPosition()), arrayOf(body.GetRotation()), array(body.GetLinearVelocity()), array(body.GetAngularVelocity())];
    }),
    readContacts: () => contacts,
    settings() {
      const inverse = (value) => (value > 0 ? 1 / value : 0);
      const each = (read) => bodies.map((body, index) => (moving(index) ? read(body.GetMotionProperties()) : null));
      const worst = (values) => Math.max(0, ...values.filter((v) => v !== null));
      return {
        gravity: array(system.GetGravity()), substeps: options.collision_steps,
        mass: each((m) => inverse(m.GetInverseMass())).map((m) => m ?? 0),
        inertia: each((m) => array(m.GetInverseInertiaDiagonal()).map(inverse)).map((i) => i ?? [0, 0, 0]),
        linear_damping: worst(each((m) => m.GetLinearDamping())), angular_damping: worst(each((m) => m.GetAngularDamping())),
      };
    },
    destroy() {
      const all = system.GetBodyInterface();
      bodies.forEach((body) => {
        all.RemoveBody(body.GetID());
        all.DestroyBody(body.GetID());
      });
      Jolt.destroy(jolt);
      Jolt.destroy(listener);
      Jolt.destroy(clock);
    },
  };
}

serve({...describe(version, files), create});
