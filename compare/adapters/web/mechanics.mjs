// What adapters share: rotations, the principal frames of hulls and meshes, faces of hulls, and applied forces.
//
// Quaternions are [w, x, y, z], body to world, and need not be exactly unit. The principal frame of a body is at its
// centre of mass, along its principal axes. It differs from the shape's frame for hulls and meshes only.

/** Hamilton's product a b: the rotation b, then the rotation a. */
export function product(a, b) {
  return [
    a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
    a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
    a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3],
    a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1],
  ];
}

/** The rotation that undoes q. */
export const inverse = (q) => [q[0], -q[1], -q[2], -q[3]];

export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** The vector v, in body axes, in world axes. */
export function rotate(q, v) {
  const [w, x, y, z] = q;
  const s = 2 / (w * w + x * x + y * y + z * z);
  return [
    (1 - s * (y * y + z * z)) * v[0] + s * (x * y - w * z) * v[1] + s * (x * z + w * y) * v[2],
    s * (x * y + w * z) * v[0] + (1 - s * (x * x + z * z)) * v[1] + s * (y * z - w * x) * v[2],
    s * (x * z - w * y) * v[0] + s * (y * z + w * x) * v[1] + (1 - s * (x * x + y * y)) * v[2],
  ];
}

/** The rotation that turns the z axis to the unit vector `to`. */
export function rotationFromZ(to) {
  return to[2] < -0.999999 ? [0, 1, 0, 0] : normalized([1 + to[2], -to[1], to[0], 0]);
}

export function normalized(v) {
  const length = Math.hypot(...v);
  return v.map((x) => x / length);
}

/** The solid of a body that is a hull or a mesh; undefined for the others. */
export const solidOf = (setup, body) => setup.solids[body.shape.solid];

/** The vertices of a solid in its principal frame, m: a typed array of three numbers each. */
export function principalVertices(solid, Numbers = Float32Array) {
  const back = inverse(solid.axes);
  return Numbers.from(solid.vertices.flatMap((v) => rotate(back, v.map((x, k) => x - solid.centre[k]))));
}

/** Corners within this share of a hull's radius of a plane lie in it: rounding of coordinates. */
const FLATNESS = 1e-9;

/**
 * The faces of a hull as polygons: indices of vertices, counter-clockwise from outside. A face consists of all triangles
 * whose corners lie in one plane. The largest one that is left founds the next face: thin ones have poor normals.
 */
export function polygonsOf(solid) {
  const difference = (i, j) => solid.vertices[i].map((x, k) => x - solid.vertices[j][k]);
  const flatness = FLATNESS * Math.max(...solid.vertices.map((v) => Math.hypot(...v.map((x, k) => x - solid.centre[k]))));
  const polygons = [];
  let left = solid.triangles.map((t) => ({corners: t, area: cross(difference(t[1], t[0]), difference(t[2], t[0]))}))
    .sort((a, b) => Math.hypot(...b.area) - Math.hypot(...a.area));
  while (left.length > 0) {
    const [founder] = left;
    const normal = normalized(founder.area);
    const lies = (other) => other === founder || (dot(normal, other.area) >= 0 &&
      other.corners.every((i) => Math.abs(dot(normal, difference(i, founder.corners[0]))) <= flatness));
    polygons.push(borderOf(left.filter(lies).map(({corners}) => corners)));
    left = left.filter((other) => !lies(other));
  }
  return polygons;
}

/** The polygon around triangles: the edges whose reverse belongs to none of them. */
function borderOf(triangles) {
  const edges = triangles.flatMap(([a, b, c]) => [[a, b], [b, c], [c, a]]);
  const names = new Set(edges.map(String));
  const next = new Map(edges.filter(([from, to]) => !names.has(`${to},${from}`)));
  const polygon = [];
  for (let [corner] = next.keys(); next.has(corner); polygon.push(corner)) {
    const to = next.get(corner);
    next.delete(corner);
    corner = to;
  }
  if (next.size > 0) {
    throw new Error('a face of a hull has no single border: a hull of corners alone, none of them within 1e-9 of a face, has');
  }
  return polygon;
}

/** Where a plane is, as a frame whose z axis is its normal: {position, orientation}. */
export const planePose = ({normal, offset}) => ({position: normal.map((n) => n * offset), orientation: rotationFromZ(normal)});

/** Where the principal frame of a body is at the start: {position, orientation}. */
export function principalPose(setup, body) {
  const solid = solidOf(setup, body);
  if (!solid) {
    return {position: body.position, orientation: body.orientation};
  }
  const offset = rotate(body.orientation, solid.centre);
  return {
    position: body.position.map((x, k) => x + offset[k]),
    orientation: product(body.orientation, solid.axes),
  };
}

/**
 * Writes the states of all bodies into a frame. stateOf(index) is that of a body's principal frame in the world, an array of
 * position, orientation, velocity and angular velocity. Where it is null, and for a plane, the body rests where the scene has it.
 */
export function writeFrame(frame, setup, stateOf) {
  setup.bodies.forEach((body, index) => {
    const state = body.shape.type === 'plane' ? null : stateOf(index);
    let [x, q, v, w] = state ?? [body.position, body.orientation, [0, 0, 0], [0, 0, 0]];
    const solid = state && solidOf(setup, body);
    if (solid) {
      q = product(q, inverse(solid.axes));
      const offset = rotate(q, solid.centre);
      x = x.map((value, k) => value - offset[k]);
    }
    frame.set([...x, ...q, ...v, ...w], 13 * index);
  });
}

/**
 * Calls apply(body index, force, torque), both in world axes and about the centre of mass, for each force that acts in
 * step `number`. orientationOf(index) is the present orientation of a body's principal frame.
 */
export function applyForces(setup, number, orientationOf, apply) {
  const time = (number - 1) * setup.dt;
  const slack = 1e-6 * setup.dt;
  setup.bodies.forEach((body, index) => {
    for (const f of body.static ? [] : body.forces) {
      if (time + slack < f.from || (f.until !== null && time + slack >= f.until)) {
        continue;
      }
      let {force, at} = f;
      if (f.frame === 'body') {
        const solid = solidOf(setup, body);
        const q = orientationOf(index);
        const ownAxes = solid ? product(q, inverse(solid.axes)) : q;
        force = rotate(ownAxes, force);
        at = rotate(ownAxes, at);
      }
      apply(index, force, cross(at, force));
    }
  });
}

/** Half the length of the diagonal of the scene's bounds, m. */
export const halfDiagonal = ({lower, upper}) => Math.hypot(...upper.map((x, k) => x - lower[k])) / 2;

/** The point of a plane that is nearest to the middle of the scene's bounds, m. */
export function middleOfPlane({lower, upper}, {normal, offset}) {
  const middle = upper.map((x, k) => (x + lower[k]) / 2);
  const height = normal.reduce((sum, n, k) => sum + n * middle[k], -offset);
  return middle.map((x, k) => x - height * normal[k]);
}
