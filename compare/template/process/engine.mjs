// my_engine: a process engine for Plumb (plumb.engine/1), here spheres and half-spaces by sequential impulses.
// Plumb's process protocol is described in compare/adapters/process/PROTOCOL.md of its repository.
import fs from 'node:fs';

const HELLO = {
  protocol: 'plumb.engine/1', name: 'my_engine', version: '0.1', runtime: 'javascript',
  description: 'spheres and half-spaces, by sequential impulses', integrator: 'semi-implicit Euler',
  capabilities: ['plane', 'sphere', 'restitution'], contacts: ['points', 'impulses'], reads: ['settings'],
  options: [{name: 'iterations', value: 100, min: 1, max: 1e6, integer: true, help: 'sweeps a step'}],
};

const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const add = (a, s, b) => a.map((x, k) => x + s * b[k]); // a + s b

/** All that belongs to one scene. Arrays are in the scene's order. */
class World {
  constructor(scene) {
    this.scene = scene;
    this.bodies = scene.bodies;
    this.x = scene.bodies.map((body) => body.position);
    this.v = scene.bodies.map((body) => body.velocity);
    this.w = scene.bodies.map((body) => (body.static ? 0 : 1 / body.mass));
    this.contacts = [];
  }

  /** The gap between the plane or sphere a and the sphere b, and the normal from a to b. */
  between(a, b) {
    const [first, {radius}] = [this.bodies[a].shape, this.bodies[b].shape];
    if (first.type === 'plane') {
      return [dot(first.normal, this.x[b]) - first.offset - radius, first.normal];
    }
    const offset = add(this.x[b], -1, this.x[a]);
    const distance = Math.hypot(...offset);
    return [distance - first.radius - radius, offset.map((c) => c / distance)];
  }

  /** Adds the contact of two bodies that may touch within the step, with the speed at which they have to separate. */
  collide(a, b) {
    const isPlane = (i) => this.bodies[i].shape.type === 'plane';
    if (this.w[a] + this.w[b] === 0 || isPlane(b) || (b <= a && !isPlane(a))) {
      return;
    }
    const {dt, restitution} = this.scene;
    const [gap, normal] = this.between(a, b);
    const approach = dot(normal, add(this.v[a], -1, this.v[b]));
    const bounce = restitution[this.bodies[a].material][this.bodies[b].material] * approach;
    if (gap < 2 * Math.abs(approach) * dt + 1e-3) {
      const speed = bounce > 0 && gap < approach * dt ? bounce : (-Math.max(gap, 0) - 0.2 * Math.min(gap, 0)) / dt;
      this.contacts.push({a, b, normal, gap, speed, impulse: 0, point: add(this.x[b], -this.bodies[b].shape.radius, normal)});
    }
  }

  step() {
    const {dt, gravity, options} = this.scene;
    this.contacts = [];
    this.x.forEach((_, a) => this.x.forEach((__, b) => this.collide(a, b)));
    this.v = this.v.map((v, i) => add(v, this.w[i] > 0 ? dt : 0, gravity));
    for (let sweep = 0; sweep < options.iterations; ++sweep) {
      for (const c of this.contacts) {
        const error = c.speed - dot(c.normal, add(this.v[c.b], -1, this.v[c.a]));
        const before = c.impulse;
        c.impulse = Math.max(0, before + error / (this.w[c.a] + this.w[c.b]));
        this.v[c.a] = add(this.v[c.a], (before - c.impulse) * this.w[c.a], c.normal);
        this.v[c.b] = add(this.v[c.b], (c.impulse - before) * this.w[c.b], c.normal);
      }
    }
    this.x = this.x.map((x, i) => add(x, dt, this.v[i]));
  }

  state() {
    return {
      frame: this.bodies.flatMap((body, i) => [...this.x[i], ...body.orientation, ...this.v[i], 0, 0, 0]),
      contacts: this.contacts.flatMap((c) => [c.a, c.b, ...c.point, ...c.normal, c.gap, ...c.normal.map((n) => c.impulse * n)]),
    };
  }
}

/** CPU time of this process, s. */
const cpuSeconds = () => 1e-6 * (process.cpuUsage().user + process.cpuUsage().system);

let world = null;
const handlers = {
  hello: () => HELLO,
  create(request) {
    world = new World(request);
    return {settings: {gravity: request.gravity, mass: world.w.map((w) => (w > 0 ? 1 / w : 0))}};
  },
  frame: () => world.state(),
  step() {
    const start = cpuSeconds();
    world.step();
    return {cpu: cpuSeconds() - start, ...world.state()};
  },
  destroy: () => ({}),
};

/* One request a line, one answer a line. fs.readSync waits for the next piece of standard input. */
const piece = Buffer.alloc(1 << 16);
const decoder = new TextDecoder();
let rest = '';
for (let length = fs.readSync(0, piece); length > 0; length = fs.readSync(0, piece)) {
  const lines = (rest + decoder.decode(piece.subarray(0, length), {stream: true})).split('\n');
  rest = lines.pop();
  for (const request of lines.map((line) => JSON.parse(line))) {
    const answer = handlers[request.request]?.(request) ?? {error: 'unknown request'};
    process.stdout.write(`${JSON.stringify({id: request.id, ...answer})}\n`);
  }
}
