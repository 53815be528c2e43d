/* A recorded run (plumb.recording/1): poses and contacts at a time, and curves. */
import { data } from './dom.js';

async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const plain = new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer());
  let at = 0;
  return () => {
    let value = 0, scale = 1, byte;
    do { byte = plain[at++]; value += (byte & 127) * scale; scale *= 128; } while (byte >= 128);
    return value % 2 === 0 ? value / 2 : -(value + 1) / 2;
  };
}

export class Recording {
  /* The recording of a run with this hash; null where the page has none, or one that is damaged. */
  static load(run, scene) {
    return Recording.read(run, scene).catch(() => null);
  }

  static async read(run, scene) {
    const json = run ? data(`recording-${run}`) : null;
    if (json === null || json.schema !== 'plumb.recording/1' || json.bodies !== scene.bodies.length) return null;
    const made = new Recording();
    const { step, position_unit: u, orientation_unit: w } = json.frames, frames = step.length;
    made.times = step.map((s) => s * json.dt);
    made.moving = json.moving;
    made.count = json.bodies;
    made.end = json.steps * json.dt;
    made.bound = json.frames.error_bound;
    made.curves = json.curves ?? { step: [] };
    made.curveTimes = made.curves.step.map((s) => s * json.dt);
    made.start = scene.bodies.flatMap((b) => [...b.at, ...b.turn]);
    made.values = new Float32Array(frames * made.moving.length * 7);
    const next = await unpack(json.frames.data);
    made.moving.forEach((_, body) => {
      for (let channel = 0; channel < 7; ++channel) {
        for (let f = 0, sum = 0; f < frames; ++f) {
          sum += next();
          made.values[(f * made.moving.length + body) * 7 + channel] = sum * (channel < 3 ? u : w);
        }
      }
    });
    made.contactFrames = json.contacts ? await Recording.contacts(json, step) : null;
    return made;
  }

  static async contacts(json, step) {
    const { frame, depth_unit: d, force_unit: n } = json.contacts, u = json.frames.position_unit;
    const next = await unpack(json.contacts.data);
    return frame.map((index) => {
      const count = next();
      const column = (unit, delta) => { let sum = 0; return Array.from({ length: count }, () => { const v = next(); sum = delta ? sum + v : v; return sum * unit; }); };
      const [x, y, z, depth, force] = [column(u, true), column(u, true), column(u, true), column(d, false), column(n ?? 0, false)];
      return { time: step[index] * json.dt, points: x.map((_, i) => ({ at: [x[i], y[i], z[i]], depth: depth[i], force: force[i] })) };
    });
  }

  /* 7 numbers a body of the scene at a time (s), straight between two frames. */
  at(time) {
    const poses = this.start.slice(), n = this.moving.length * 7;
    let k = 0;
    while (k + 2 < this.times.length && this.times[k + 1] < time) ++k;
    const last = Math.min(k + 1, this.times.length - 1), span = this.times[last] - this.times[k];
    const part = span > 0 ? Math.min(Math.max((time - this.times[k]) / span, 0), 1) : 0;
    this.moving.forEach((body, i) => {
      const q = [];
      for (let c = 0; c < 7; ++c) {
        const a = this.values[k * n + 7 * i + c], b = this.values[last * n + 7 * i + c];
        q.push(a + part * (b - a));
      }
      const length = Math.hypot(q[3], q[4], q[5], q[6]) || 1;
      for (let c = 0; c < 7; ++c) poses[7 * body + c] = c < 3 ? q[c] : q[c] / length;
    });
    return poses;
  }

  /* The contact points of the last recorded frame up to a time; null where the engine reports none. */
  contactsAt(time) {
    return this.contactFrames === null ? null : (this.contactFrames.findLast((f) => f.time <= time + 1e-9)?.points ?? []);
  }
}
