"""A process engine for Plumb in Python's standard library: spheres and half-spaces, by sequential impulses.

Replace World by calls to your engine. The protocol is plumb.engine/1; `plumb check-engine 'exec:python3 engine.py'` tests it."""
import json
import math
import sys
import time

HELLO = {"protocol": "plumb.engine/1", "name": "toy-python", "version": "0.1", "runtime": "python",
         "description": "spheres and half-spaces, by sequential impulses", "integrator": "semi-implicit Euler",
         "capabilities": ["plane", "sphere", "restitution"], "contacts": ["points", "impulses"], "reads": ["settings"],
         "options": [{"name": "iterations", "value": 100, "min": 1, "max": 1e6, "integer": True, "help": "sweeps a step"}]}

def dot(a, b): return sum(x * y for x, y in zip(a, b))
def along(a, s, b): return [x + s * y for x, y in zip(a, b)]  # a + s b

class World:
    """All that belongs to one scene. Positions, velocities and inverse masses are lists in the scene's order."""

    def __init__(self, scene):
        self.scene, self.contacts = scene, []
        self.x = [body["position"] for body in scene["bodies"]]
        self.v = [body["velocity"] for body in scene["bodies"]]
        self.w = [0 if body["static"] else 1 / body["mass"] for body in scene["bodies"]]

    def gap(self, a, b):
        """Separation of the plane or sphere a and the sphere b, and the unit normal from a to b."""
        first, radius = self.scene["bodies"][a]["shape"], self.scene["bodies"][b]["shape"]["radius"]
        if first["type"] == "plane":
            return dot(first["normal"], self.x[b]) - first["offset"] - radius, first["normal"]
        offset = along(self.x[b], -1, self.x[a])
        distance = math.hypot(*offset)
        return distance - first["radius"] - radius, [c / distance for c in offset]

    def collide(self, dt):
        """Pairs that may touch within the step, with the speed at which each has to separate."""
        bodies, self.contacts = self.scene["bodies"], []
        for a, first in enumerate(bodies):
            for b, second in enumerate(bodies):
                planes = first["shape"]["type"] == "plane", second["shape"]["type"] == "plane"
                if self.w[a] + self.w[b] == 0 or planes[1] or (b <= a and not planes[0]):
                    continue
                gap, normal = self.gap(a, b)
                approach = -dot(normal, along(self.v[b], -1, self.v[a]))
                if gap < 2 * abs(approach) * dt + 1e-3:
                    bounce = self.scene["restitution"][first["material"]][second["material"]] * approach
                    target = bounce if gap < approach * dt and bounce > 0.1 else -max(gap, 0) / dt - 0.2 * min(gap, 0) / dt
                    self.contacts.append({"a": a, "b": b, "n": normal, "gap": gap, "target": target, "p": 0})

    def step(self):
        dt = self.scene["dt"]
        self.collide(dt)
        self.v = [along(v, dt if w else 0, self.scene["gravity"]) for v, w in zip(self.v, self.w)]
        for _ in range(int(self.scene["options"]["iterations"])):
            for c in self.contacts:
                a, b, n = c["a"], c["b"], c["n"]
                speed = dot(n, along(self.v[b], -1, self.v[a]))
                before, c["p"] = c["p"], max(0, c["p"] + (c["target"] - speed) / (self.w[a] + self.w[b]))
                self.v[a] = along(self.v[a], -(c["p"] - before) * self.w[a], n)
                self.v[b] = along(self.v[b], (c["p"] - before) * self.w[b], n)
        points = [along(self.x[c["b"]], -self.scene["bodies"][c["b"]]["shape"]["radius"], c["n"]) for c in self.contacts]
        self.reported = [n for c, point in zip(self.contacts, points)
                         for n in (c["a"], c["b"], *point, *c["n"], c["gap"], *along([0, 0, 0], c["p"], c["n"]))]
        self.x = [along(x, dt, v) for x, v in zip(self.x, self.v)]
        return {"iterations": self.scene["options"]["iterations"], "contacts": len(self.contacts)}

    def state(self):
        bodies = self.scene["bodies"]
        return [n for body, x, v in zip(bodies, self.x, self.v)
                for n in (*x, *body["orientation"], *v, *body["angular_velocity"])]

    def settings(self):
        return {"gravity": self.scene["gravity"], "mass": [1 / w if w else 0 for w in self.w]}

world = None
for line in sys.stdin:
    request = json.loads(line)
    answer = {"id": request["id"]}
    if request["request"] == "hello":
        answer.update(HELLO)
    elif request["request"] == "create":
        world = World(request)
        answer["settings"] = world.settings()
    elif request["request"] == "frame":
        answer["frame"] = world.state()
    elif request["request"] == "step":
        start = time.process_time()
        stats = world.step()
        answer.update(cpu=time.process_time() - start, stats=stats, frame=world.state(), contacts=world.reported)
    elif request["request"] != "destroy":
        answer["error"] = "unknown request"
    print(json.dumps(answer), flush=True)
