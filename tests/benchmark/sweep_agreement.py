#!/usr/bin/env python3
"""How far two sweeps of the same plan agree: sweep_agreement.py ONE/sweep.json OTHER/sweep.json

Of all ratios of speed at matched error (at each one's best and as shipped), of error at matched cost, and
the means, in how many cells
the intervals of the two overlap, and in how many each value lies in the other's interval. A cell that
both engines reach in one sweep alone agrees in neither."""
import json
import sys


def cells(path):
    with open(path, encoding="utf-8") as file:
        sweep = json.load(file)
    found = {}
    for scene in sweep["scenes"]:
        for matched in scene["pairs"]:
            pair = (scene["name"], matched["first"], matched["second"])
            for at in matched["levels"]:
                found["speed", pair, at["level"]] = at["speed"]
                if "as_shipped" in at:
                    found["shipped", pair, at["level"]] = at["as_shipped"]["speed"]
            for at in matched["times"]:
                found["error", pair, at["time"]] = at["exactness"]
    for pair in sweep["pairs"]:
        for at in pair["levels"]:
            found["mean", (pair["first"], pair["second"]), at["level"]] = at["mean_speed"]
            if "as_shipped" in at:
                key = "mean as shipped", (pair["first"], pair["second"]), at["level"]
                found[key] = at["as_shipped"]["mean_speed"]
    return found


def has_interval(ratio):
    return ratio is not None and ratio["low"] is not None


one, other = cells(sys.argv[1]), cells(sys.argv[2])
totals = [0, 0, 0]
for kind in ("speed", "shipped", "error", "mean", "mean as shipped"):
    counts = [0, 0, 0]
    for key in one.keys() | other.keys():
        a, b = one.get(key), other.get(key)
        if key[0] != kind or (a is None and b is None):
            continue
        both = has_interval(a) and has_interval(b)
        overlap = both and a["low"] <= b["high"] and b["low"] <= a["high"]
        inside = both and a["low"] <= b["value"] <= a["high"] and b["low"] <= a["value"] <= b["high"]
        counts = [x + y for x, y in zip(counts, (1, overlap, inside))]
    totals = [x + y for x, y in zip(totals, counts)]
    print(f"{kind}: {counts[0]} cells, {counts[1]} overlap, {counts[2]} each in the other's")
print(
    f"all: {totals[0]} cells, {100 * totals[1] / totals[0]:.1f} % overlap, "
    f"{100 * totals[2] / totals[0]:.1f} % each in the other's"
)
