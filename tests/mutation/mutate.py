#!/usr/bin/env python3
"""Breaks the code in many small ways, and names the ways that no test notices.

    mutate.py run [--only 3,17] [--jobs N] [--slow]    tries mutations.json, prints what survived
    mutate.py draw COUNT SEED                          draws as many more at random, on standard output
    mutate.py check                                    each mutation still fits the code

One tree with all mutations is built in build/mutation; the variable PLUMB_MUTATION of the environment
activates one of them. The tests that reach the mutated code run, those of its folder first, until one fails.
The exit code is 1 where more than one mutation in twenty survives.
"""

import argparse
import concurrent.futures
import json
import os
import random
import re
import shutil
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.dirname(os.path.dirname(HERE))
LIST = os.path.join(HERE, "mutations.json")
BUILD = os.path.join(SOURCE, "build", "mutation")
TREE = os.path.join(BUILD, "tree")
HEADER = '#include "mutant.h"\n'
PERMITTED_SURVIVORS = 0.05
MOST_MUTATIONS = 4096  # as in mutant.c

# The first pattern that matches a file names the tests that are most likely to notice.
NEAR = (
    (r"^engine/src/(narrow_phase|broad_phase)", r"test_(engine_(collide|aabb|broad|pairs|cylinder|mesh|polytope)|gap)"),
    (r"^engine/src/(solver|sparse|problem)", r"test_(engine_(sweep|soft|direct|factor|pattern|residual|order|midpoint)|solver|contact_problem)"),
    (r"^engine/", r"test_(engine|contact)"),
    (r"^scenarios/catalogue/", r"test_(catalogue|pile|converged)"),
    (r"^scenarios/", r"test_(scene|obj|polyhedron|base|table|json|text|folding|fuzz)"),
    (r"^compare/adapters/", r"test_(adapter|process|mjcf|mismatch)"),
    (r"^compare/referee/geometry", r"test_gap"),
    (r"^compare/referee/", r"test_(referee|mechanics|islands|halving|series)"),
    (r"^compare/gate/", r"test_gate"),
    (r"^compare/studies/sweep", r"test_sweep"),
    (r"^compare/studies/", r"test_(ensemble|metamorphic|threshold|tune|budget|bisection)"),
    (r"^compare/report/", r"test_report"),
    (r"^compare/command/capture", r"test_(command_capture|problem_file)"),
    (r"^compare/results/", r"test_(results|resume)"),
    (r"^compare/runner/", r"test_(runner|execute|plan|recording|positions|faults|resource)"),
    (r"^compare/conformance/", r"test_conformance"),
)


def mutations():
    with open(LIST, encoding="utf-8") as file:
        return json.load(file)


def mutated_text(text, mutation):
    """The text with the mutation in it, or None where the original is not there exactly once."""
    if text.count(mutation["original"]) != 1:
        return None
    call = re.sub(r"\bM\(", f"PLUMB_MUTANT({mutation['id']}, ", mutation["mutant"])
    return text.replace(mutation["original"], call)


def mutate_files(listed, root):
    """Writes all mutations into the files below `root`. Returns those that do not fit."""
    misfits = []
    for path in sorted({m["file"] for m in listed}):
        with open(os.path.join(root, path), encoding="utf-8") as file:
            text = file.read()
        for mutation in (m for m in listed if m["file"] == path):
            changed = mutated_text(text, mutation)
            if changed is None:
                misfits.append(mutation)
            else:
                text = changed
        with open(os.path.join(root, path), "w", encoding="utf-8") as file:
            file.write(HEADER + text)
    return misfits


def make_tree(listed):
    shutil.rmtree(TREE, ignore_errors=True)
    os.makedirs(TREE)
    names = subprocess.run(["git", "ls-files", "-z"], cwd=SOURCE, capture_output=True, check=True).stdout
    for name in names.decode().split("\0")[:-1]:
        os.makedirs(os.path.dirname(os.path.join(TREE, name)), exist_ok=True)
        shutil.copy2(os.path.join(SOURCE, name), os.path.join(TREE, name))
    misfits = mutate_files(listed, TREE)
    if misfits:
        sys.exit("\n".join(f"{m['file']}: mutation {m['id']} does not fit the code" for m in misfits))
    shutil.copy2(os.path.join(HERE, "mutant.c"), TREE)


def build_tree():
    settings = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_C_FLAGS=-w -I{HERE}", f"-DCMAKE_CXX_FLAGS=-w -I{HERE}",
                    "-DPLUMB_ADAPTER_MODULES=OFF", "-DPLUMB_INSTALL=OFF", f"-DCMAKE_PROJECT_plumb_INCLUDE={HERE}/mutant.cmake"]
    for command in (["cmake", "-S", TREE, "-B", f"{BUILD}/built", *settings], ["cmake", "--build", f"{BUILD}/built"]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(done.stdout[-4000:] + done.stderr[-2000:])


def tests_of(folder):
    """The tests of a build folder: name, command, environment and folder of each."""
    listed = json.loads(subprocess.run(["ctest", "--test-dir", folder, "--show-only=json-v1"], capture_output=True,
                                       check=True).stdout)
    tests = []
    for test in listed["tests"]:
        properties = {p["name"]: p["value"] for p in test.get("properties", [])}
        tests.append({"name": test["name"], "command": test["command"], "slow": "slow" in properties.get("LABELS", []),
                      "environment": dict(e.split("=", 1) for e in properties.get("ENVIRONMENT", [])),
                      "folder": properties["WORKING_DIRECTORY"]})
    # Tests of the text of the code, and those that compile it again, fail whichever mutation is active.
    left_out = r"test_(format|layers|comments|tidy|documentation|mutation|two_builds|built_in_command)"
    return [t for t in tests if not re.match(left_out, t["name"])]


def passes(test, number, seconds, reached=None):
    environment = dict(os.environ, PLUMB_MUTATION=str(number), **test["environment"])
    if reached is not None:
        environment["PLUMB_MUTATIONS_REACHED"] = reached
    try:
        done = subprocess.run(test["command"], env=environment, cwd=test["folder"], stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        return False
    return done.returncode in (0, 77)


def explored(tests, jobs):
    """The tests that pass without a mutation, with the time that each takes and the mutations that it reaches."""
    def one(test):
        path = os.path.join(BUILD, f"reached.{test['name']}")
        with open(path, "wb") as file:
            file.truncate(MOST_MUTATIONS)
        begin = time.monotonic()
        passed = passes(test, 0, 600, path)
        with open(path, "rb") as file:
            reached = [number for number, flag in enumerate(file.read()) if flag]
        return dict(test, passed=passed, seconds=time.monotonic() - begin, reached=reached)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        found = list(pool.map(one, tests))
    for test in (t for t in found if not t["passed"]):
        print(f"{test['name']} fails without a mutation, and is left out", file=sys.stderr)
    return sorted((t for t in found if t["passed"]), key=lambda t: t["seconds"])


def catcher(mutation, tests):
    """The name of the first test that fails, or None, and how many tests reach the mutated code."""
    near = next((names for path, names in NEAR if re.search(path, mutation["file"])), "^$")
    reaching = [t for t in tests if mutation["id"] in t["reached"]]
    for test in sorted(reaching, key=lambda t: (t["slow"], not re.match(near, t["name"]))):
        if not passes(test, mutation["id"], 30 + 10 * test["seconds"]):
            return test["name"], len(reaching)
    return None, len(reaching)


def run(arguments):
    listed = mutations()
    make_tree(listed)
    build_tree()
    tests = [t for t in tests_of(f"{BUILD}/built") if arguments.slow or not t["slow"]]
    print(f"{len(listed)} mutations, {len(tests)} tests", flush=True)
    tests = explored(tests, arguments.jobs)
    chosen = [m for m in listed if not arguments.only or m["id"] in arguments.only]
    survivors = 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for mutation, (caught, reaching) in zip(chosen, pool.map(lambda m: catcher(m, tests), chosen)):
            survivors += caught is None
            fate = caught or f"SURVIVED {reaching} tests"
            print(f"{mutation['id']:4} {fate:32} {mutation['file']}: {mutation['about']}", flush=True)
    print(f"{len(chosen) - survivors} of {len(chosen)} caught")
    return 1 if survivors > PERMITTED_SURVIVORS * len(chosen) else 0


# ---- Drawing ----

# Comparisons are reversed: whether equal floating-point numbers count as less is seldom a difference.
OPERATORS = (("<=", ">"), (">=", "<"), ("==", "!="), ("!=", "=="), ("&&", "||"), ("||", "&&"), (" < ", " >= "), (" > ", " <= "),
             (" + ", " - "), (" - ", " + "), (" * ", " / "), (" / ", " * "))
# Statements of one line in a function's body, and the expression in them that is mutated.
SITES = (r"^ +(?:else )?if \((?P<e>.+)\) \{$", r"^ +return (?P<e>[^;]+);$", r"^ +(?:const )?(?:double|int|bool) \w+ = (?P<e>[^;,]+);$",
         r"^ +[\w.>\[\]-]+ [-+*/]?= (?P<e>[^;]+);$")
DELETED = r"^ {4,}(?P<s>\w[\w.>\[\]-]* [-+*/|]= [^;]+;|\w+\([^;]*\);)$"


def mutants_of(expression):
    """All ways to change one operator or number of the expression."""
    for old, new in OPERATORS:
        for found in re.finditer(re.escape(old), expression):
            if "->" in expression[max(0, found.start() - 1):found.end() + 1] or '"' in expression:
                continue
            yield expression[:found.start()] + new + expression[found.end():], f"{old.strip()} becomes {new.strip()}"
    for found in re.finditer(r"(?<![\w.])\d+(\.\d+)?(e-?\d+)?(?![\w.\]])", expression):
        number = found.group()
        changed = repr(float(number) * 1.1) if re.search(r"[.e]", number) else str(int(number) + 1)
        yield expression[:found.start()] + changed + expression[found.end():], f"{number} becomes {changed}"


def sites_of(path):
    """(original lines, mutant, about) of a file. The line must be there only once."""
    with open(os.path.join(SOURCE, path), encoding="utf-8") as file:
        text = file.read()
    for line in text.split("\n"):
        if text.count(line) != 1 or "static" in line or "sizeof" in line:
            continue
        found = next((m for m in (re.match(site, line) for site in SITES) if m), None)
        if found and "{" not in found["e"] and found["e"].count("(") == found["e"].count(")"):
            for changed, about in mutants_of(found["e"]):
                mutant = f"M({found['e']}, {changed})"
                yield line, line[:found.start("e")] + mutant + line[found.end("e"):], f"{found['e']}: {about}"
        deleted = re.match(DELETED, line)
        # What is not freed is for the sanitizers to find.
        if deleted and not re.search(r"free|destroy|close|decref|release|clear|assert|_exit", deleted["s"]):
            yield line, f"{line[:deleted.start('s')]}if (M(1, 0)) {deleted['s']}", f"{deleted['s']} is left out"


def modules_of_adapters():
    """The engines whose adapters are shared objects, which the mutants' build leaves out."""
    folder = os.path.join(SOURCE, "compare", "adapters")
    for name in os.listdir(folder):
        description = os.path.join(folder, name, "engine.json")
        if os.path.exists(description):
            with open(description, encoding="utf-8") as file:
                if json.load(file)["adapter"] == "module":
                    yield name


def draw(count, seed):
    generator = random.Random(seed)
    paths = subprocess.run(["git", "ls-files", "engine/src", "scenarios", "compare"], cwd=SOURCE, capture_output=True,
                           text=True, check=True).stdout.split()
    modules = "".join(f"|/{name}/" for name in modules_of_adapters())
    others = f"template/|behaviour/|scene_schema{modules}"
    paths = [p for p in paths if re.search(r"\.(c|cpp)$", p) and not re.search(others, p)]
    sizes = [os.path.getsize(os.path.join(SOURCE, p)) for p in paths]
    listed = mutations()
    number = max((m["id"] for m in listed), default=0)
    taken = {(m["file"], m["original"]) for m in listed}
    drawn = []
    while len(drawn) < count:
        path = generator.choices(paths, sizes)[0]
        sites = list(sites_of(path))
        if not sites:
            continue
        original, mutant, about = generator.choice(sites)
        if not any(file == path and (text in original or original in text) for file, text in taken):
            taken.add((path, original))
            number += 1
            drawn.append({"id": number, "file": path, "original": original, "mutant": mutant, "about": about})
    json.dump(drawn, sys.stdout, indent=1)
    print()
    return 0


def check():
    misfits = []
    for mutation in mutations():
        with open(os.path.join(SOURCE, mutation["file"]), encoding="utf-8") as file:
            if mutated_text(file.read(), mutation) is None:
                misfits.append(f"{mutation['file']}: mutation {mutation['id']} does not fit the code")
    print("\n".join(misfits) or f"{len(mutations())} mutations")
    return 1 if misfits else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    running = commands.add_parser("run")
    running.add_argument("--only", type=lambda text: [int(n) for n in text.split(",")])
    running.add_argument("--jobs", type=int, default=os.cpu_count())
    running.add_argument("--slow", action="store_true", help="also with the tests that take minutes")
    drawing = commands.add_parser("draw")
    drawing.add_argument("count", type=int)
    drawing.add_argument("seed", type=int)
    commands.add_parser("check")
    arguments = parser.parse_args()
    if arguments.command == "run":
        return run(arguments)
    return draw(arguments.count, arguments.seed) if arguments.command == "draw" else check()


if __name__ == "__main__":
    sys.exit(main())
