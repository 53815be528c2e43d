#!/usr/bin/env python3
"""Runs every command that a Markdown page prints, and fails where one does not work as printed.

    run_documentation.py PLUMB SOURCE BUILD PAGE...

Commands are the lines of ```sh blocks, the lines after "$ " of ```console blocks, and code spans that begin
with "plumb ". All commands of a page run in their order in one directory, which has links
to the files of the repository's root, with plumb on the PATH; those of the pages that plumb new-engine writes
run in a folder that it made. A command whose engine is absent counts as not run. A block
```LANGUAGE NAME is written to the file NAME there. Commands that take minutes get further arguments that
reduce them; the few that cannot run inside a test are only checked for existence.

In a ```console block, a command exits with 0, or with the number below "$ echo $?" after it. What stands below a
command that is not reduced must be in its output, in that order: "..." stands for what is left out, and numbers,
plurals and spaces may differ.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

# The first pattern that matches a command adds these arguments to it.
REDUCED = (
    (r"^plumb sweep (--suite canonical|wall-collapse )", "--duration 0.1 --timeout 2 --repeat 1 --vary dt=1/60"),
    (r"^plumb sweep .*--suite", "--duration 0.1 --timeout 5 --engine plumb --engine ode"),
    (r"^plumb compare .*--suite", "--duration 0.1 --timeout 1"),
    (r"^plumb (compare|sweep|metamorphic) (?!compare/examples/)", "--duration 0.1"),
    (r"^plumb run (pile|blocks) ", "--duration 0.02"),
    (r"^plumb tune ", "--budget 40 --duration 0.5"),
    (r"^plumb ensemble ", "--duration 0.2"),
    (r"^plumb threshold ", "--timeout 20"),
    # The page of the template has the same engine run all checks.
    (r"^plumb check-engine 'exec:python3 (my-engine/)?engine.py'", "--check gravity --check repeats"),
)
# Pages whose commands are short, and never reduced.
AS_PRINTED = ("compare/examples/README.md",)
# A search that follows measured costs ends at other settings each time.
OUTPUT_VARIES = re.compile(r"^plumb tune ")
# What a test cannot run: the file or the preset must exist.
NOT_RUN = (
    (r"^\./(compare|tests)/run\b", "this installs packages and builds; .ci/run runs it"),
    (r"^\./compare/state\b", "this takes half an hour"),
    (r"^plumb check-engine jolt", "test_web_engines_slow checks the engines from npm"),
    (r"^cmake --workflow", "this builds once more"),
    (r"^tests/(analysis|mutation|fuzz)/", "this builds once more, and takes minutes"),
    (r"(contact_problems.sh|solve_benchmark .*/\*.json)", "this takes minutes; test_solve_benchmark runs two problems"),
    (r"^tests/benchmark/cost_by_size", "this takes a quarter of an hour"),
    (r"^plumb (threshold|sweep) .*--cpu-limit 20 --timeout 90", "this takes minutes; compare/state runs it"),
    (r"^compare/packaging/release\b", "this builds once more; test_packages_slow makes packages"),
    (r"^sudo apt-get install \./packages/", "tests/packaging/bare_debian installs the packages"),
    (r"^man plumb", "tests/packaging/bare_debian installs the packages"),
    (r"^tests/packaging/bare_debian", "this installs a Debian"),
    (r"^RENEW=yes ctest", "this replaces a file of the source"),
    (r"^plumb view state/runs", "compare/state makes that folder"),
)
# Pages that plumb new-engine writes, and how.
TEMPLATES = {
    "compare/template/README.md": [],
    "compare/template/process/process_README.md": ["--process"],
}
# List commands that have run: their output does not depend on the page.
LISTED = set()
ABSENT = re.compile(rb"engine \S+ is absent|the program was not found|No module named 'pandas'")
PLACEHOLDER = re.compile(r"\.\.\.|…|\b[A-Z]{2,}\b|mine\.so")


class Command(str):
    """A command as printed, its exit code if the page says it, and the lines printed below it."""

    def __new__(cls, text):
        command = super().__new__(cls, text)
        command.code = None
        command.output = []
        return command


def commands(text):
    """(line number, kind, command or (file name, contents)) of a page, in order."""
    lines = text.split("\n")
    i = 0
    while i < len(lines):
        fence = re.match(r"^\s*```(\S*)\s*(\S*)", lines[i])
        if fence and fence.group(1):
            first = i + 1
            i += 1
            while not lines[i].lstrip().startswith("```"):
                i += 1
            block = lines[first:i]
            language, name = fence.groups()
            if name:
                yield first + 1, "file", (name, "\n".join(block) + "\n")
            elif language in ("sh", "console"):
                yield from commands_of_block(block, first + 1, language)
        elif fence:
            i += 1
            while not lines[i].lstrip().startswith("```"):
                i += 1
        else:
            for span in re.findall(r"`(plumb [a-z-]+ [^-`][^`]*)`", lines[i]):
                if not PLACEHOLDER.search(span):
                    yield i + 1, "command", Command(span)
        i += 1


def commands_of_block(block, number, language):
    found = []
    joined = ""
    asked = False
    for offset, line in enumerate(block):
        if language == "console":
            if not line.startswith("$ "):
                if asked:
                    found[-1][2].code = int(line)
                elif found:
                    found[-1][2].output.append(line)
                asked = False
                continue
            line = line[2:]
            asked = line == "echo $?"
            if asked:
                continue
        joined += line.rstrip("\\") if line.endswith("\\") else line
        if line.endswith("\\"):
            continue
        command = re.sub(r"\s+#\s.*$", "", joined).strip()
        joined = ""
        if command:
            found.append((number + offset, "command", Command(command)))
    return found


def comparable(text):
    """The text in words apart by one space each, every number, unit of time and plural of a count the same."""
    numbers = re.sub(r"\d+(\.\d+)?(e[-+]?\d+)?( [nµm]?s\b)?", "0", text)
    return " ".join(re.sub(r"\b0 (\w+?)s\b", r"0 \1", numbers).split())


def missing_output(command, printed):
    """The first part between "..." of what a page shows that the command did not print; else None."""
    rest = comparable(printed)
    for part in re.split(r"^\.\.\.$", "\n".join(command.output), flags=re.MULTILINE):
        wanted = comparable(part)
        place = rest.find(wanted)
        if place < 0:
            return part.strip()
        rest = rest[place + len(wanted):]
    return None


def prepared(command):
    """The command with its reduction, and how the shell shall call it."""
    for pattern, arguments in REDUCED:
        if re.search(pattern, command.replace("mpirun -n 2 ", "").replace("parallel ", "")):
            head, mark, tail = command.partition(" > ")
            if ":::" in head:
                head, mark, tail = command.partition(" :::")
            return f"{head} {arguments}{mark}{tail}"
    return command


def run_page(page, source, build, environment):
    failures = count = 0
    with open(os.path.join(source, page), encoding="utf-8") as file:
        text = file.read()
    folder = tempfile.mkdtemp()
    if page in TEMPLATES:
        subprocess.run(["plumb", "new-engine", folder, "--name", "my_engine", *TEMPLATES[page]], env=environment,
                       check=True, stdout=subprocess.DEVNULL)
    for name in os.listdir(source) if page not in TEMPLATES else ():
        if not name.startswith(".") and not name.startswith("build") and name != "report":
            os.symlink(os.path.join(source, name), os.path.join(folder, name))
    os.mkdir(os.path.join(folder, "build"))
    os.symlink(build, os.path.join(folder, "build", "tests"))
    for number, kind, what in commands(text):
        where = f"{page}:{number}"
        if kind == "file":
            with open(os.path.join(folder, what[0]), "w", encoding="utf-8") as file:
                file.write(what[1])
            continue
        reason = next((why for pattern, why in NOT_RUN if re.search(pattern, what)), None)
        program = what.split()[0]
        if reason is not None:
            print(f"{where}: not run, {reason}: {what}")
            if program.startswith("./") and not os.access(os.path.join(source, program), os.X_OK):
                print(f"{where}: {program} does not exist")
                failures += 1
            continue
        if program in ("parallel", "mpirun") and shutil.which(program) is None:
            print(f"{where}: not run, {program} is not installed")
            continue
        command = what if page in AS_PRINTED else prepared(what)
        if command in LISTED:
            continue
        if command.startswith("plumb list"):
            LISTED.add(command)
        begin = time.monotonic()
        done = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, check=False)
        absent = ABSENT.search(done.stdout) if done.returncode != 0 else None
        if absent:
            print(f"{where}: not run, {absent.group().decode()}: {what}")
            continue
        count += 1
        print(f"{where}: {time.monotonic() - begin:.1f} s: {command}", flush=True)
        # A run whose outcome is not ok has worked: engines with their default settings do collapse. So has a
        # search that is reduced to less than its target needs.
        may_fail = command.startswith("plumb run") or (command != what and command.startswith("plumb tune"))
        expected = (what.code,) if what.code is not None else (0, 3) if may_fail else (0,)
        printed = done.stdout.decode(errors="replace")
        if done.returncode not in expected:
            failures += 1
            print(f"{where}: exit {done.returncode} of: {command}\n{printed[-1500:]}")
        elif command == what and not OUTPUT_VARIES.search(command):
            missing = missing_output(what, printed)
            if missing is not None:
                failures += 1
                print(f"{where}: the page shows\n{missing}\nbut this was printed:\n{printed[-4000:]}")
    shutil.rmtree(folder)
    return count, failures


def main():
    plumb, source, build, *pages = sys.argv[1:]
    programs = tempfile.mkdtemp()
    os.symlink(plumb, os.path.join(programs, "plumb"))
    # Debug: what a page has cmake build need not be optimised.
    environment = dict(os.environ, CMAKE_GENERATOR="Ninja", PATH=f"{programs}:{build}:{os.environ['PATH']}", NO_COLOR="1",
                       COLUMNS="120", BROWSER="true", SOURCE=source, BUILD=build, CMAKE_BUILD_TYPE="Debug", OMPI_ALLOW_RUN_AS_ROOT="1",
                       OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    total = failures = 0
    for page in pages:
        count, failed = run_page(page, source, build, environment)
        total += count
        failures += failed
    shutil.rmtree(programs)
    print(f"{total} commands ran, {failures} failed")
    return 1 if failures or total == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
