/* A scene in three dimensions: its bodies, where they belong, contact points, and the camera. One WebGL
 * renderer draws for all panels, because a browser gives a page only a few. */
import * as T from 'three';
import { SVGRenderer } from 'three/addons/renderers/SVGRenderer.js';

export const has3d = FULL; // set by bundle.cmake

/* Shares of a body's size by which it is away from its place, and the colours from there on. */
export const errorSteps = [{ from: 0, colour: '#7fa3c2', text: 'under 1 %' }, { from: 0.01, colour: '#e9c46a', text: '1 to 10 %' },
  { from: 0.1, colour: '#e07b39', text: '10 to 100 %' }, { from: 1, colour: '#a4161a', text: 'more than its size' }];
export const depthSteps = [{ from: 0, colour: '#12355b', text: 'under 0.1 %' }, { from: 1e-3, colour: '#8338ec', text: '0.1 to 1 %' }, { from: 0.01, colour: '#ff006e', text: 'more than 1 % deep' }];
export const stepOf = (steps, share) => steps.findLast((s) => share >= s.from) ?? steps[0];

/* The largest distance of a point of the shape from its origin, m; 0 for a plane. */
export function sizeOf(scene, [kind, size]) {
  if (kind === 'plane') return 0;
  if (kind === 'box') return Math.hypot(...size);
  if (kind === 'hull' || kind === 'mesh') {
    const v = scene.polyhedra[size].vertices;
    let most = 0;
    for (let i = 0; i < v.length; i += 3) most = Math.max(most, Math.hypot(v[i], v[i + 1], v[i + 2]));
    return most;
  }
  return kind === 'sphere' ? size[0] : Math.hypot(size[0], size[1] + (kind === 'capsule' ? size[0] : 0));
}

function geometryOf(scene, [kind, size]) {
  if (kind === 'box') return new T.BoxGeometry(2 * size[0], 2 * size[1], 2 * size[2]);
  if (kind === 'sphere') return new T.SphereGeometry(size[0], 20, 12);
  if (kind === 'capsule') return new T.CapsuleGeometry(size[0], 2 * size[1], 6, 14).rotateX(Math.PI / 2);
  if (kind === 'cylinder') return new T.CylinderGeometry(size[0], size[0], 2 * size[1], 28).rotateX(Math.PI / 2);
  const { vertices, triangles } = scene.polyhedra[size];
  const points = new Float32Array(3 * triangles.length);
  triangles.forEach((vertex, i) => points.set(vertices.slice(3 * vertex, 3 * vertex + 3), 3 * i));
  const geometry = new T.BufferGeometry();
  geometry.setAttribute('position', new T.BufferAttribute(points, 3));
  geometry.computeVertexNormals();
  return geometry;
}

function placed(target, at, turn) {
  target.position.set(at[0], at[1], at[2]);
  target.quaternion.set(turn[1], turn[2], turn[3], turn[0]);
  return target;
}

/* The sphere around everything that a picture should hold: poses are arrays of 7 numbers a body. A
 * run that flew away does not make the picture of the others smaller. */
export function boundsOf(scene, runs) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const take = (body, at) => { const r = sizeOf(scene, body.shape); for (let k = 0; k < 3; ++k) { low[k] = Math.min(low[k], at[k] - r); high[k] = Math.max(high[k], at[k] + r); } };
  const moving = scene.bodies.filter((b) => b.shape[0] !== 'plane' && (!b.static || sizeOf(scene, b.shape) < 1e3));
  const dynamic = moving.filter((b) => !b.static);
  (dynamic.length > 0 ? dynamic : moving).forEach((b) => take(b, b.at));
  if (moving.length === 0) return { centre: [0, 0, 0], radius: 1, follow: false };
  scene.rests.forEach((r) => take(scene.bodies[r.body], r.at));
  const span = Math.max(...high.map((v, k) => v - low[k]), 1e-3);
  let seen = 0;
  const far = high.map((v, k) => [low[k] - 0.35 * span, v + 0.35 * span]);
  for (const poses of runs) {
    scene.bodies.forEach((body, i) => {
      const at = poses.slice(7 * i, 7 * i + 3);
      if (!body.static && at.every((v, k) => v > far[k][0] && v < far[k][1])) { take(body, at); seen += 1; }
    });
  }
  const centre = low.map((v, k) => (v + high[k]) / 2);
  return { centre, radius: Math.max(Math.hypot(...high.map((v, k) => v - low[k])) / 2, 1e-6), follow: runs.length > 0 && seen === 0 };
}

/* The same around the bodies of these poses, where all bodies fly away and the camera goes with them. */
export function boundsAt(bounds, scene, poses) {
  const moving = scene.bodies.flatMap((b, i) => (b.static ? [] : [i]));
  return bounds.follow ? { ...bounds, centre: [0, 1, 2].map((k) => moving.reduce((sum, i) => sum + poses[7 * i + k], 0) / moving.length) } : bounds;
}

/* A view direction that shows the longest side across: the camera stands at an angle to it. */
export function cameraFor(bounds, scene) {
  const camera = new T.PerspectiveCamera(28, 4 / 3, bounds.radius / 50, bounds.radius * 60);
  camera.up.set(...(scene.gravity.some((g) => g !== 0) ? scene.gravity.map((g) => -g / Math.hypot(...scene.gravity)) : [0, 0, 1]));
  return camera;
}

export function aim(camera, bounds, { turn = 0.55, tilt = 0.28, zoom = 1 }) {
  const d = (bounds.radius / Math.sin((camera.fov * Math.PI) / 360)) / zoom * 0.92;
  const up = camera.up, side = Math.abs(up.z) > 0.7 ? new T.Vector3(1, 0, 0) : new T.Vector3(0, 0, 1);
  const right = new T.Vector3().crossVectors(new T.Vector3().crossVectors(up, side), up).normalize();
  const front = new T.Vector3().crossVectors(right, up);
  const direction = right.multiplyScalar(Math.sin(turn) * Math.cos(tilt)).addScaledVector(front, Math.cos(turn) * Math.cos(tilt)).addScaledVector(up, Math.sin(tilt));
  camera.position.set(...bounds.centre).addScaledVector(direction, d);
  camera.near = Math.max(d - 4 * bounds.radius, d / 100);
  camera.far = d + 60 * bounds.radius;
  camera.lookAt(...bounds.centre);
  camera.updateProjectionMatrix();
}

/* What is drawn of one scene. `layers` are runs on top of each other, each with the colour of its
 * bodies or null for colours by error; instanced: fast, but not for SVG. */
export class Stage {
  constructor(scene, bounds, layers, { instanced = true, ghosts = true } = {}) {
    this.scene = scene;
    this.root = new T.Scene();
    this.root.add(new T.HemisphereLight(0xffffff, 0x8d8d84, 2.1));
    const sun = new T.DirectionalLight(0xffffff, 1.7);
    sun.position.set(2, -3, 5);
    this.root.add(sun);
    this.groups = this.grouped();
    this.bounds = bounds;
    this.ghosts = [];
    this.addStatic(bounds);
    if (ghosts) this.addGhosts();
    this.layers = layers.map((colour) => this.addLayer(colour, layers.length > 1 ? 0.42 : 1, instanced));
  }

  /* Dynamic bodies by equal shapes: [{geometry, bodies}]. */
  grouped() {
    const groups = new Map();
    this.scene.bodies.forEach((body, i) => {
      if (body.static || body.shape[0] === 'plane') return;
      const name = JSON.stringify(body.shape);
      if (!groups.has(name)) groups.set(name, { geometry: geometryOf(this.scene, body.shape), bodies: [] });
      groups.get(name).bodies.push(i);
    });
    return [...groups.values()];
  }

  addStatic(bounds) {
    const material = new T.MeshLambertMaterial({ color: 0xb9b7ae, side: T.DoubleSide });
    /* Seen from inside its body, a plane is clear: walls do not hide what they enclose. */
    const open = new T.MeshLambertMaterial({ color: 0xb9b7ae });
    for (const body of this.scene.bodies) {
      if (body.shape[0] === 'plane') {
        const [x, y, z, offset] = body.shape[1], normal = new T.Vector3(x, y, z), reach = 3 * bounds.radius;
        const ground = new T.Mesh(new T.CircleGeometry(reach, 64), open);
        ground.quaternion.setFromUnitVectors(new T.Vector3(0, 0, 1), normal);
        const centre = new T.Vector3(...bounds.centre);
        ground.position.copy(centre.addScaledVector(normal, offset - normal.dot(centre) - bounds.radius * 2e-3));
        if (ground.position.distanceTo(new T.Vector3(...bounds.centre)) < 3 * bounds.radius) this.root.add(ground);
      } else if (body.static) {
        this.root.add(placed(new T.Mesh(geometryOf(this.scene, body.shape), material), body.at, body.turn));
      }
    }
  }

  /* The edges of bodies where they belong, shown of those that are elsewhere. */
  addGhosts() {
    const material = new T.LineBasicMaterial({ color: 0x14804a });
    for (const rest of this.scene.rests.slice(0, 400)) {
      const body = this.scene.bodies[rest.body];
      if (body.static || body.shape[0] === 'plane') continue;
      const edges = new T.EdgesGeometry(geometryOf(this.scene, body.shape), 25);
      const lines = placed(new T.LineSegments(edges, material), rest.at, rest.turn ?? body.turn);
      this.ghosts.push({ body: rest.body, lines });
      this.root.add(lines);
    }
  }

  addLayer(colour, opacity, instanced) {
    const parts = this.groups.map(({ geometry, bodies }) => {
      const make = () => new T.MeshLambertMaterial({ flatShading: !geometry.attributes.uv, transparent: opacity < 1, opacity, color: colour ?? 0xffffff, depthWrite: opacity === 1 });
      if (instanced) {
        const mesh = new T.InstancedMesh(geometry, make(), bodies.length);
        mesh.frustumCulled = false;
        this.root.add(mesh);
        return { bodies, mesh };
      }
      const meshes = bodies.map(() => new T.Mesh(geometry, make()));
      this.root.add(...meshes);
      return { bodies, meshes };
    });
    return { parts, colour };
  }

  /* poses: 7 numbers a body of the scene. */
  place(layer, poses) {
    const target = new T.Object3D(), tint = new T.Color(), rest = new Map(this.scene.rests.map((r) => [r.body, r.at]));
    const share = (body) => (rest.has(body) ? Math.hypot(...rest.get(body).map((v, k) => poses[7 * body + k] - v)) / sizeOf(this.scene, this.scene.bodies[body].shape) : 0);
    for (const { body, lines } of this.ghosts) lines.visible = (layer > 0 && lines.visible) || share(body) >= errorSteps[1].from;
    for (const { bodies, mesh, meshes } of this.layers[layer].parts) {
      bodies.forEach((body, i) => {
        const at = poses.slice(7 * body, 7 * body + 3);
        placed(meshes ? meshes[i] : target, at, poses.slice(7 * body + 3, 7 * body + 7));
        if (this.layers[layer].colour === null) {
          tint.set(stepOf(errorSteps, share(body)).colour).multiplyScalar(0.86 + 0.14 * ((body * 7) % 5) / 4);
          if (meshes) meshes[i].material.color.copy(tint); else mesh.setColorAt(i, tint);
        }
        if (!meshes) { target.updateMatrix(); mesh.setMatrixAt(i, target.matrix); }
      });
      if (mesh) { mesh.instanceMatrix.needsUpdate = true; if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true; }
    }
  }

  /* contacts: [{at, depth}]; none hides the points. */
  contacts(points, bodySize) {
    if (!this.dots) {
      this.dots = new T.InstancedMesh(new T.SphereGeometry(this.bounds.radius * 0.014, 8, 6), new T.MeshBasicMaterial({ depthTest: false, transparent: true }), 400);
      this.dots.frustumCulled = false;
      this.dots.renderOrder = 2;
      this.root.add(this.dots);
    }
    const target = new T.Object3D(), tint = new T.Color();
    this.dots.count = Math.min(points.length, 400);
    points.slice(0, 400).forEach(({ at, depth }, i) => {
      target.position.set(...at);
      target.updateMatrix();
      this.dots.setMatrixAt(i, target.matrix);
      this.dots.setColorAt(i, tint.set(stepOf(depthSteps, depth / bodySize).colour));
    });
    this.dots.instanceMatrix.needsUpdate = true;
    if (this.dots.instanceColor) this.dots.instanceColor.needsUpdate = true;
  }

  dispose() {
    this.root.traverse((o) => { o.geometry?.dispose(); o.material?.dispose(); o.dispose?.(); });
  }
}

let shared;
function renderer() {
  if (shared === undefined) {
    try {
      shared = new T.WebGLRenderer({ antialias: true, alpha: true });
    } catch {
      shared = null;
    }
  }
  return shared;
}

export const canDraw = () => has3d && renderer() !== null;

/* Draws into a canvas of the page, at the size that it is shown at. */
export function draw(canvas, stage, camera, width = canvas.clientWidth || 300) {
  const gl = renderer(), dpr = Math.min(window.devicePixelRatio || 1, 2), height = Math.round((width * 3) / 4);
  if (gl === null) return;
  gl.setPixelRatio(dpr);
  gl.setSize(width, height, false);
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
  gl.render(stage.root, camera);
  canvas.width = gl.domElement.width;
  canvas.height = gl.domElement.height;
  canvas.getContext('2d').drawImage(gl.domElement, 0, 0);
}

/* The same as an SVG element. */
export function drawSvg(stage, camera, width, height) {
  const svg = new SVGRenderer();
  svg.setSize(width, height);
  svg.setQuality('high');
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
  svg.render(stage.root, camera);
  return svg.domElement;
}
