"""my_engine: a process engine for Plumb (plumb.engine/1), here spheres and half-spaces by sequential impulses."""
import json, math, sys, time
HELLO = {"protocol": "plumb.engine/1", "name": "my_engine", "version": "0.1", "runtime": "python",
         "description": "spheres and half-spaces, by sequential impulses", "integrator": "semi-implicit Euler",
         "capabilities": ["plane", "sphere", "restitution"], "contacts": ["points", "impulses"], "reads": ["settings"],
         "options": [{"name": "iterations", "value": 100, "min": 1, "max": 1e6, "integer": True, "help": "sweeps a step"}]}

def dot(a, b): return sum(x * y for x, y in zip(a, b))
def add(a, s, b): return [x + s * y for x, y in zip(a, b)]  # a + s b
class World:  # positions, velocities and inverse masses, in the scene's order
    def __init__(self, scene):
        self.scene, self.bodies, self.contacts = scene, scene["bodies"], []
        self.x = [body["position"] for body in self.bodies]
        self.v = [body["velocity"] for body in self.bodies]
        self.w = [0 if body["static"] else 1 / body["mass"] for body in self.bodies]

    def contact(self, a, b):  # of the plane or sphere a and the sphere b: the gap, and the normal from a to b
        first, radius = self.bodies[a]["shape"], self.bodies[b]["shape"]["radius"]
        if first["type"] == "plane": return dot(first["normal"], self.x[b]) - first["offset"] - radius, first["normal"]
        offset = add(self.x[b], -1, self.x[a])
        return math.hypot(*offset) - first["radius"] - radius, [c / math.hypot(*offset) for c in offset]

    def step(self):
        dt, self.contacts = self.scene["dt"], []
        for a, b in ((a, b) for a in range(len(self.x)) for b in range(len(self.x)) if self.w[a] + self.w[b] > 0):
            is_plane = [self.bodies[i]["shape"]["type"] == "plane" for i in (a, b)]
            if is_plane[1] or (b <= a and not is_plane[0]): continue
            gap, n = self.contact(a, b)
            approach = dot(n, add(self.v[a], -1, self.v[b]))
            bounce = self.scene["restitution"][self.bodies[a]["material"]][self.bodies[b]["material"]] * approach
            if gap < 2 * abs(approach) * dt + 1e-3:  # it bounces, or closes its gap and undoes a fifth of its overlap
                speed = bounce if bounce > 0 and gap < approach * dt else -max(gap, 0) / dt - 0.2 * min(gap, 0) / dt
                point = add(self.x[b], -self.bodies[b]["shape"]["radius"], n)
                self.contacts.append({"a": a, "b": b, "n": n, "gap": gap, "point": point, "speed": speed, "p": 0})
        self.v = [add(v, dt if w else 0, self.scene["gravity"]) for v, w in zip(self.v, self.w)]
        for c in self.contacts * int(self.scene["options"]["iterations"]):
            a, b, before = c["a"], c["b"], c["p"]
            error = c["speed"] - dot(c["n"], add(self.v[b], -1, self.v[a]))
            c["p"] = max(0, before + error / (self.w[a] + self.w[b]))
            self.v[a] = add(self.v[a], (before - c["p"]) * self.w[a], c["n"])
            self.v[b] = add(self.v[b], (c["p"] - before) * self.w[b], c["n"])
        self.x = [add(x, dt, v) for x, v in zip(self.x, self.v)]

    def state(self):
        return {"frame": [n for body, x, v in zip(self.bodies, self.x, self.v) for n in (*x, *body["orientation"], *v, 0, 0, 0)],
                "contacts": [n for c in self.contacts for n in (c["a"], c["b"], *c["point"], *c["n"], c["gap"], *add([0, 0, 0], c["p"], c["n"]))]}

for request in map(json.loads, sys.stdin):
    kind, answer = request["request"], {"id": request["id"]}
    if kind == "create":
        world = World(request)
        answer["settings"] = {"gravity": request["gravity"], "mass": [1 / w if w else 0 for w in world.w]}
    elif kind == "step":
        start = time.process_time()
        world.step()
        answer["cpu"] = time.process_time() - start
        answer.update(world.state())
    else:
        answer.update(HELLO if kind == "hello" else world.state() if kind == "frame" else {} if kind == "destroy" else {"error": "unknown request"})
    print(json.dumps(answer), flush=True)
