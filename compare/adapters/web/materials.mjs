// Coefficients of pairs of materials for engines that store one for each body and combine the two by a rule.
import {Unsupported} from './protocol.mjs';

/** Rules by which engines combine two coefficients, and how one follows from the pair's and the other. */
export const rules = {
  multiply: {combine: (a, b) => a * b, own: Math.sqrt, other: (pair, one) => (one === 0 ? 1 : pair / one)},
  max: {combine: Math.max, own: (pair) => pair, other: (pair) => pair},
  min: {combine: Math.min, own: (pair) => pair, other: (pair) => pair},
  average: {combine: (a, b) => (a + b) / 2, own: (pair) => pair, other: (pair, one) => 2 * pair - one},
};

/** The pairs of materials whose bodies can touch, as arrays [a, b] with a <= b. */
function touching(setup) {
  const count = setup.friction.length;
  const moving = Array(count).fill(0);
  const fixed = Array(count).fill(0);
  setup.bodies.forEach((body) => (body.static ? fixed : moving)[body.material]++);
  const pairs = [];
  for (let a = 0; a < count; ++a) {
    for (let b = a; b < count; ++b) {
      const meets = a === b ? moving[a] > 1 || (moving[a] && fixed[a]) : (moving[a] && moving[b] + fixed[b]) || (fixed[a] && moving[b]);
      if (meets) {
        pairs.push([a, b]);
      }
    }
  }
  return pairs;
}

/** Values of all materials that give every pair its coefficient by the rule; null: there are none. */
function solve(matrix, pairs, rule) {
  const values = Array(matrix.length).fill(null);
  const settle = () => {
    for (let changed = true; changed;) {
      changed = false;
      for (const [a, b] of pairs) {
        for (const [known, open] of [[a, b], [b, a]]) {
          if (values[known] !== null && values[open] === null) {
            values[open] = rule.other(matrix[a][b], values[known]);
            changed = true;
          }
        }
      }
    }
  };
  pairs.filter(([a, b]) => a === b).forEach(([a]) => {
    values[a] = rule.own(matrix[a][a]);
  });
  settle();
  // What is left touches only other materials: one of them may be chosen.
  for (const [a, b] of pairs) {
    if (values[a] === null) {
      values[a] = rule.own(matrix[a][b]);
      settle();
    }
  }
  const close = (x, y) => Math.abs(x - y) <= 1e-12 * Math.abs(y);
  const right = pairs.every(([a, b]) => close(rule.combine(values[a], values[b]), matrix[a][b]));
  return right && values.every((v) => v === null || v >= 0) ? values.map((v) => v ?? 0) : null;
}

/**
 * What an engine that stores one coefficient for each collider, and combines two by one of the rules `names`, needs for
 * `what`, 'friction' or 'restitution': {rule, values}, a value for each material. null: no rule gives all pairs theirs.
 */
export function combined(setup, what, names) {
  const pairs = touching(setup);
  for (const name of names) {
    const values = solve(setup[what], pairs, rules[name]);
    if (values) {
      return {rule: name, values};
    }
  }
  return null;
}

/**
 * The colliders that a body of a material needs, each {material, member, meets, friction, restitution}. Where rules of
 * combining give all pairs their coefficients it is one, which meets all others. Otherwise a body has a collider for each
 * material that it can touch, with the coefficients of that pair, and bits that let it meet the colliders that the other has
 * for it. A body that can touch nothing has one that meets nothing.
 * `friction` and `restitution` are what the collider stores under `rule.friction` and `rule.restitution`. An engine that can
 * compare materials themselves needs no bits.
 */
export function colliderPlan(setup, names, bits = Infinity) {
  const friction = combined(setup, 'friction', names);
  const restitution = combined(setup, 'restitution', ['max', ...names]);
  const all = 2 ** bits - 1;
  if (friction && restitution) {
    return {
      rule: {friction: friction.rule, restitution: restitution.rule},
      of: (material) => [{material: null, member: all, meets: all, friction: friction.values[material], restitution: restitution.values[material]}],
    };
  }
  const pairs = touching(setup);
  const groups = new Map();
  const key = (material, other) => `${material} ${other}`;
  for (const [a, b] of pairs) {
    groups.set(key(a, b), groups.size);
    if (a !== b) {
      groups.set(key(b, a), groups.size);
    }
  }
  if (groups.size > bits) {
    throw new Unsupported(`no rule that combines two materials gives all pairs of this scene their coefficients, and the ${pairs.length} pairs that can touch need ${groups.size} groups of colliders; there are ${bits}`);
  }
  const colliderFor = (material, other) => ({
    material: other, member: 2 ** groups.get(key(material, other)), meets: 2 ** groups.get(key(other, material)),
    friction: setup.friction[material][other], restitution: setup.restitution[material][other],
  });
  return {
    rule: {friction: 'max', restitution: 'max'},
    of: (material) => {
      const others = setup.friction.map((_, other) => other).filter((other) => groups.has(key(material, other)));
      return others.length > 0 ? others.map((other) => colliderFor(material, other)) : [{material, member: 0, meets: 0, friction: 0, restitution: 0}];
    },
  };
}
