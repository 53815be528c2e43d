#!/usr/bin/env python3
"""Kills plumb at random moments, resumes it, and counts what was lost, doubled or left running.

    kill_and_resume.py PLUMB MEANS KILLS [SEED]

MEANS is jobs (plumb compare --jobs 2), parallel (GNU parallel over plumb sweep --shard I/3) or mpirun (plumb
sweep under mpirun -n 3). Works in the current folder. SIGKILL goes in turn to one of plumb's own processes,
to all of them, and to the process group with whatever started them. After each kill no process of the call
may be left, and every line of results that was there must still be there, whole, once. When a study comes to
its end its runs must be those of the plan, each once; the next kill then meets a new study. Exit code: 0 well,
1 something was lost, doubled or left, 77 the means are not installed.
"""

import glob
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import uuid

SCENES = ["free-fall", "bounce", "tower", "--set", "n=3", "--duration", "0.2", "--engine", "plumb", "--engine",
          "plumb:fast"]
SWEEP = ["sweep", *SCENES, "--vary", "dt=1/60,1/120", "--repeat", "8"]
MEANS = {
    "jobs": ["PLUMB", "compare", *SCENES, "--repeat", "16", "--jobs", "2", "--no-recordings", "--out", "kept"],
    "parallel": ["parallel", "--will-cite", "--jobs", "3", "PLUMB", *SWEEP, "--out", "kept", "--shard", "{}/3"],
    "mpirun": ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", "3", "PLUMB", *SWEEP, "--out", "kept"],
}
LEFT_WITHIN = 10  # s: a process that is killed is gone by then, also on a busy machine


def fail(text):
    sys.exit(f"kill_and_resume: {text}")


def read(path):
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError:
        return b""


def marked(marker):
    """The processes with the marker in their environment: pid -> parent's pid. A zombie has none."""
    found = {}
    for name in os.listdir("/proc"):
        if name.isdigit() and marker in read(f"/proc/{name}/environ"):
            status = read(f"/proc/{name}/stat").rpartition(b")")[2].split()
            if len(status) > 1 and status[0] != b"Z":
                found[int(name)] = int(status[1])
    return found


def is_plumb(pid, plumb):
    try:
        return os.path.samefile(f"/proc/{pid}/exe", plumb)
    except OSError:
        return False


def commands(processes, plumb):
    """plumb's own processes, not those of its runs."""
    own = [pid for pid in processes if is_plumb(pid, plumb)]
    return [pid for pid in own if processes[pid] not in own]


def kill(pid):
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def lines():
    """Whole lines of results, in all files of the study."""
    found = []
    for path in sorted(glob.glob("kept/results.jsonl") + glob.glob("kept/shard-*/results.jsonl")):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        found += text[: text.rfind("\n") + 1].splitlines()
    return found


def runs():
    names = [json.loads(line)["run"] for line in lines()]
    if len(names) != len(set(names)):
        fail("a run was doubled")
    return set(names)


def main():
    plumb, means, kills = os.path.abspath(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    seed = int(sys.argv[4]) if len(sys.argv) > 4 else int(time.time())
    if means != "jobs" and shutil.which(means) is None:
        print(f"{means} is not installed")
        sys.exit(77)
    print(f"{means}, seed {seed}")
    draw = random.Random(seed)
    marker = f"PLUMB_KILLED={uuid.uuid4()}"
    key, value = marker.split("=")
    environment = {name: text for name, text in os.environ.items()
                   if not name.startswith(("SLURM_", "OMPI_", "PMIX_", "PMI_"))}
    environment |= {key: value, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    call = [plumb if word == "PLUMB" else word for word in MEANS[means]]
    tail = [":::", "1", "2", "3"] if means == "parallel" else []

    def start(resume):
        with open("log", "w", encoding="utf-8") as log:
            return subprocess.Popen(call + (["--resume"] if resume else []) + tail, env=environment, stdout=log,
                                    stderr=log, stdin=subprocess.DEVNULL, start_new_session=True)

    # The plan, by a study that nothing disturbs, and how long that takes.
    begin = time.monotonic()
    if start(False).wait() != 0:
        fail(f"the study fails undisturbed: {read('log').decode()}")
    length = time.monotonic() - begin
    plan = runs()
    shutil.rmtree("kept")
    if len(plan) < 90:
        fail(f"the study has {len(plan)} runs, expected 90 or more")

    done = ended = cuts = 0
    before = set()
    while done < kills:
        process = start(os.path.exists("kept"))
        time.sleep(draw.uniform(0.02, 0.6 * length))
        found = marked(marker.encode())
        own = commands(found, plumb)
        if process.poll() is None and own:
            way = done % 3
            if way == 0:
                kill(draw.choice(own))
            elif way == 1:
                for pid in own:
                    kill(pid)
            else:
                os.killpg(process.pid, signal.SIGKILL)
            done += 1
        # What was not killed comes to its end by itself; runs die with the command that made them.
        process.wait()
        deadline = time.monotonic() + LEFT_WITHIN + 3 * length
        while marked(marker.encode()) and time.monotonic() < deadline:
            time.sleep(0.01)
        left = marked(marker.encode())
        if left:
            for pid in left:
                kill(pid)
            fail(f"{len(left)} processes are left")
        cuts += any(not read(path).endswith(b"\n") for path in glob.glob("kept/**/results.jsonl", recursive=True)
                    if read(path))
        now = set(lines())
        if not before <= now:
            fail(f"{len(before - now)} results were lost")
        before = now
        if not runs() <= plan:
            fail("a run is not of the plan")
        if done == kills or runs() == plan:
            if start(True).wait() != 0:
                fail(f"a resumed study fails: {read('log').decode()}")
            if runs() != plan:
                fail(f"{len(plan - runs())} runs of the plan are missing at the end")
            if not before <= set(lines()):
                fail("a result was lost at the end")
            shutil.rmtree("kept")
            before = set()
            ended += 1
    print(f"{done} kills, {ended} studies of {len(plan)} runs came to their end, {cuts} times a line was cut: "
          "0 results lost, 0 doubled, 0 processes left")


main()
