// What the programs about Havok share: a world without gravity, spheres of 1 m in it, and a floor.
import fs from 'node:fs';
import init from '@babylonjs/havok';

const wasm = import.meta.resolve('@babylonjs/havok').replace(/[^/]*$/, 'HavokPhysics.wasm');
export const hk = await init({wasmBinary: fs.readFileSync(new URL(wasm))});
export const world = hk.HP_World_Create()[1];
hk.HP_World_SetGravity(world, [0, 0, 0]);

/** A body without damping, always active, whose coefficients are those of its pair with another that has 1; mass 0: it is static. */
export function add(shape, mass, position, velocity, restitution = 0, friction = 0, inertia = [0.1, 0.1, 0.1]) {
  hk.HP_Shape_SetMaterial(shape, [friction, friction, restitution, hk.MaterialCombine.MULTIPLY, hk.MaterialCombine.MULTIPLY]);
  const body = hk.HP_Body_Create()[1];
  hk.HP_Body_SetShape(body, shape);
  hk.HP_Body_SetMotionType(body, mass > 0 ? hk.MotionType.DYNAMIC : hk.MotionType.STATIC);
  hk.HP_Body_SetQTransform(body, [position, [0, 0, 0, 1]]);
  hk.HP_Body_SetMassProperties(body, [[0, 0, 0], mass, inertia, [0, 0, 0, 1]]); // moments for a mass of 1
  hk.HP_Body_SetLinearDamping(body, 0);
  hk.HP_Body_SetLinearVelocity(body, velocity);
  hk.HP_World_AddBody(world, body, false);
  hk.HP_Body_SetActivationControl(body, hk.ActivationControl.ALWAYS_ACTIVE);
  return body;
}

export const sphere = () => hk.HP_Shape_CreateSphere([0, 0, 0], 0.5)[1];
export const floor = () => add(hk.HP_Shape_CreateBox([0, 0, -10], [0, 0, 0, 1], [200, 200, 20])[1], 0, [0, 0, 0], [0, 0, 0], 1, 1);
export const steps = (count, dt = 1 / 100) => Array.from({length: count}, () => hk.HP_World_SetIdealStepTime(world, dt) && hk.HP_World_Step(world, dt));
export const velocity = (body) => hk.HP_Body_GetLinearVelocity(body)[1];
