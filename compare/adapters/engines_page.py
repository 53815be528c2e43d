"""Prints ENGINES.md: its text up to the mark, and the tables of the engines' descriptions: engines_page.py >PAGE."""
import json
import pathlib

ADAPTERS = pathlib.Path(__file__).parent
MARK = "<!-- What follows is written by adapters/engines_page.py from adapters/NAME/engine.json. -->\n"
RUNS = {"linked": "linked", "module": "a shared object that is loaded when it is asked for", "script": "run by node"}


def package_of(engine):
    if "npm" in engine:
        return f"npm: {engine['npm']} {engine['npm_version']}"
    packages = [package["package"] for package in engine.get("debian", ())]
    return f"Debian: {', '.join(packages)}" if packages else "this repository"


def print_table(heads, rows):
    print("", "| " + " | ".join(heads) + " |", "|" + "---|" * len(heads), sep="\n")
    for row in rows:
        print("| " + " | ".join(row) + " |")


def main():
    text = (ADAPTERS.parent / "ENGINES.md").read_text(encoding="utf-8")
    engines = [json.loads(path.read_text(encoding="utf-8")) for path in ADAPTERS.glob("*/engine.json")]
    engines.sort(key=lambda engine: engine["place"])
    print(text[: text.index(MARK)] + MARK + "\n## Adapters")
    print_table(
        ["engine", "`--engine`", "package", "adapter"],
        [
            [
                f"[{engine['title']}](adapters/{engine['name']})",
                f"`{engine['name']}`",
                package_of(engine),
                f"{engine['language']}, {RUNS[engine['adapter']]}",
            ]
            for engine in engines
        ],
    )
    for word in engines[0]["words"]:
        print(f"\n## {word.capitalize()}")
        print_table(["engine", "meaning"], [[engine["title"], engine["words"][word]] for engine in engines])


main()
