// MuJoCo 3, the maintainers' WebAssembly build (npm @mujoco/mujoco), in double precision.
//
// The scene is written as MJCF. Contacts are soft by design, and there is no restitution: scenes with one are unsupported,
// as are meshes, which MuJoCo replaces by their convex hulls. MuJoCo takes the larger friction of two geoms; where a pair
// has another, the model has an element `pair` for it. A free joint keeps the angular velocity in the body's axes.
//
// MuJoCo leaves out contacts that do not fit into its memory, and starts again from the first state after one that is not
// finite or too large. It says so in warnings only. A step whose contacts or solver did not fit is made again with more
// memory; a state that is given up ends the run.
import {GaveUp, Unsupported, apart, describe, packageOf, serve} from './protocol.mjs';
import {applyForces, inverse, normalized, planePose, principalPose, principalVertices, rotate, solidOf, writeFrame} from './mechanics.mjs';
import loadMujoco from '@mujoco/mujoco';

const mujoco = await loadMujoco();
const {files} = packageOf('@mujoco/mujoco', 'mujoco.wasm');
const LEAST_FRICTION = 1e-5; // mjMINMU: smaller ones are raised
const MOST_MEMORY = 1024; // MiB
const CONES = ['pyramidal', 'elliptic'];
const SOLVERS = {default: 'Newton', recommended: 'Newton', cg: 'CG', pgs: 'PGS'};

/* ---- The model ---- */

const attributes = (values) => Object.entries(values).map(([key, value]) => ` ${key}="${Array.isArray(value) ? value.join(' ') : value}"`).join('');

function shapeOf(setup, body) {
  const {shape} = body;
  switch (shape.type) {
    case 'plane': {
      const {position, orientation} = planePose(shape);
      return {type: 'plane', size: [0, 0, 1], pos: position, quat: orientation};
    }
    case 'sphere':
      return {type: 'sphere', size: shape.radius};
    case 'box':
      return {type: 'box', size: shape.half_extents};
    case 'capsule':
    case 'cylinder':
      return {type: shape.type, size: [shape.radius, shape.half_height]};
    default:
      return {type: 'mesh', mesh: `solid${shape.solid}`};
  }
}

function geom(setup, body, index) {
  const friction = setup.friction[body.material][body.material];
  return `<geom${attributes({name: `g${index}`, condim: friction > 0 ? 3 : 1, friction: [friction, 0, 0], ...shapeOf(setup, body)})}/>`;
}

function bodyText(setup, body, index) {
  if (body.shape.type === 'plane') {
    return geom(setup, body, index);
  }
  const {position, orientation} = principalPose(setup, body);
  const inertial = body.static ? '' : `<freejoint name="j${index}"/><inertial${attributes({pos: [0, 0, 0], mass: body.mass, diaginertia: body.inertia})}/>`;
  return `<body${attributes({name: `b${index}`, pos: position, quat: orientation})}>${inertial}${geom(setup, body, index)}</body>`;
}

/** Elements for the pairs of bodies whose friction is not the larger one of their materials. */
function pairElements(setup) {
  const {bodies, friction} = setup;
  const lines = [];
  bodies.forEach((one, a) => bodies.slice(a + 1).forEach((two, k) => {
    const mu = friction[one.material][two.material];
    if (!(one.static && two.static) && mu !== Math.max(friction[one.material][one.material], friction[two.material][two.material])) {
      lines.push(`<pair${attributes({geom1: `g${a}`, geom2: `g${a + 1 + k}`, condim: mu > 0 ? 3 : 1, friction: [mu, mu, 0, 0, 0]})}/>`);
    }
  }));
  return lines.join('');
}

function modelText(setup, memory) {
  const {options} = setup;
  const solids = setup.solids.map((solid, index) => {
    const body = setup.bodies.find((b) => b.shape.solid === index);
    return body ? `<mesh${attributes({name: `solid${index}`, vertex: Array.from(principalVertices(solidOf(setup, body), Float64Array))})}/>` : '';
  });
  const option = attributes({timestep: setup.dt, gravity: setup.gravity, solver: SOLVERS[setup.profile], cone: CONES[options.cone], iterations: options.iterations,
    tolerance: options.tolerance, impratio: options.impratio, noslip_iterations: options.noslip_iterations});
  const global = attributes({solref: [options.solref_time, options.solref_damping], solimp: [options.solimp_dmin, options.solimp_dmax, options.solimp_width, 0.5, 2]});
  return `<mujoco><compiler angle="radian" boundmass="0" boundinertia="0" balanceinertia="false" inertiafromgeom="false" fusestatic="false" discardvisual="false"/>
<size memory="${memory}M"/><option${option}><flag${attributes({multiccd: options.multiccd ? 'enable' : 'disable', nativeccd: options.nativeccd ? 'enable' : 'disable'})}/></option>
<default><geom${global}/><pair${global}/></default><asset>${solids.join('')}</asset>
<worldbody>${setup.bodies.map((body, index) => bodyText(setup, body, index)).join('\n')}</worldbody><contact>${pairElements(setup)}</contact></mujoco>`;
}

function check(setup) {
  if (setup.bodies.some((body) => body.shape.type === 'mesh')) {
    throw new Unsupported('MuJoCo replaces a mesh by its convex hull');
  }
  if (setup.restitution.some((row) => row.some((e) => e > 0))) {
    throw new Unsupported('MuJoCo has no restitution');
  }
  if (setup.friction.some((row) => row.some((mu) => mu > 0 && mu < LEAST_FRICTION))) {
    throw new Unsupported(`MuJoCo's least friction is ${LEAST_FRICTION}`);
  }
}

/* ---- The scene ---- */

const {mjWARN_INERTIA, mjWARN_CONTACTFULL, mjWARN_CNSTRFULL, mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC} = mujoco.mjtWarning;
const FULL = [mjWARN_CONTACTFULL, mjWARN_CNSTRFULL];
const FATAL = [mjWARN_INERTIA, mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC];

/** The first of these kinds of warnings that there was, with the number that it is about; undefined: none. */
function warningOf(data, kinds) {
  const all = data.warning;
  return kinds.map(({value}) => {
    const warning = all.get(value); // a copy, to be deleted
    const {number, lastinfo} = warning;
    warning.delete();
    return {value, number, lastinfo};
  }).find(({number}) => number > 0);
}

function create(setup) {
  check(setup);
  let memory = Math.min(MOST_MEMORY, 16 + 2 * setup.bodies.length);
  let model = mujoco.MjModel.from_xml_string(modelText(setup, memory));
  let data = new mujoco.MjData(model);
  const kind = (name) => mujoco.mjtObj[name].value;
  const bodyOf = setup.bodies.map((_, i) => mujoco.mj_name2id(model, kind('mjOBJ_BODY'), `b${i}`));
  const indexOfGeom = new Map(setup.bodies.map((_, i) => [mujoco.mj_name2id(model, kind('mjOBJ_GEOM'), `g${i}`), i]));
  const jointOf = setup.bodies.map((b, i) => (b.static ? -1 : mujoco.mj_name2id(model, kind('mjOBJ_JOINT'), `j${i}`)));
  const position = jointOf.map((j) => (j < 0 ? -1 : model.jnt_qposadr[j]));
  const velocity = jointOf.map((j) => (j < 0 ? -1 : model.jnt_dofadr[j]));
  setup.bodies.forEach((body, i) => {
    if (!body.static) {
      const {orientation} = principalPose(setup, body);
      data.qvel.set(body.velocity, velocity[i]);
      data.qvel.set(rotate(inverse(normalized(orientation)), body.angular_velocity), velocity[i] + 3);
    }
  });
  while (!fits(() => mujoco.mj_forward(model, data))) {
    grow();
  }
  const pose = (i) => Array.from(data.qpos.subarray(position[i], position[i] + 7));
  let contacts = [];

  /** Calls work(), a call of MuJoCo; false: contacts or the solver did not fit into the memory, and the state is as before. */
  function fits(work) {
    try {
      work();
    } catch (error) {
      if (/mj_stackAlloc/.test(error.message)) {
        return false;
      }
      throw error;
    }
    return !apart(() => warningOf(data, FULL));
  }

  function grow() {
    if (memory >= MOST_MEMORY) {
      throw new Unsupported(`the contacts need more than ${MOST_MEMORY} MiB`);
    }
    memory = Math.min(MOST_MEMORY, 2 * memory);
    const [small, old] = [model, data];
    model = mujoco.MjModel.from_xml_string(modelText(setup, memory));
    data = new mujoco.MjData(model);
    mujoco.mj_copyState(model, old, data, mujoco.mjtState.mjSTATE_INTEGRATION.value);
    old.delete();
    small.delete();
  }

  function advance(number) {
    data.xfrc_applied.fill(0);
    applyForces(setup, number, (i) => pose(i).slice(3), (i, force, torque) => {
      const at = 6 * bodyOf[i];
      [...force, ...torque].forEach((value, k) => {
        data.xfrc_applied[at + k] += value;
      });
    });
    mujoco.mj_step2(model, data);
  }

  function checkState() {
    const warning = warningOf(data, FATAL);
    if (warning) {
      throw new GaveUp(`MuJoCo gave up its state: ${mujoco.mju_warningText(warning.value, warning.lastinfo)}`);
    }
  }

  /** What the solver of the present step worked with: before the positions move. */
  function record() {
    contacts = [];
    const force = new mujoco.DoubleBuffer(6);
    const all = data.contact; // a new object each time, to be deleted
    for (let i = 0; i < data.ncon; ++i) {
      const contact = all.get(i);
      if (contact.efc_address >= 0) {
        mujoco.mj_contactForce(model, data, i, force);
        const [f, frame] = [force.GetView(), contact.frame];
        const impulse = [0, 1, 2].map((k) => setup.dt * (f[0] * frame[k] + f[1] * frame[3 + k] + f[2] * frame[6 + k]));
        contacts.push(indexOfGeom.get(contact.geom1), indexOfGeom.get(contact.geom2), ...contact.pos, ...frame.subarray(0, 3), contact.dist, ...impulse);
      }
      contact.delete();
    }
    all.delete();
    force.delete();
  }

  return {
    step(number) {
      while (!(fits(() => mujoco.mj_step1(model, data)) && fits(() => advance(number)))) {
        grow();
      }
      apart(checkState);
      return {iterations: Math.max(0, ...data.solver_niter), contacts: data.ncon};
    },
    readFrame: (frame) => writeFrame(frame, setup, (i) => {
      if (setup.bodies[i].static) {
        return null;
      }
      const q = pose(i).slice(3);
      const v = Array.from(data.qvel.subarray(velocity[i], velocity[i] + 6));
      return [pose(i).slice(0, 3), q, v.slice(0, 3), rotate(q, v.slice(3))];
    }),
    readContacts() {
      record();
      return contacts;
    },
    settings: () => ({
      gravity: Array.from(model.opt.gravity), dt: model.opt.timestep,
      mass: setup.bodies.map((b, i) => (b.static ? 0 : model.body_mass[bodyOf[i]])),
      inertia: setup.bodies.map((b, i) => (b.static ? [0, 0, 0] : Array.from(model.body_inertia.subarray(3 * bodyOf[i], 3 * bodyOf[i] + 3)))),
      linear_damping: Math.max(0, ...model.dof_damping), angular_damping: Math.max(0, ...model.dof_damping),
    }),
    destroy() {
      data.delete();
      model.delete();
    },
  };
}

serve({...describe(mujoco.mj_versionString(), files), create});
