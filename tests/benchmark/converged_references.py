#!/usr/bin/env python3
"""Rows of scenarios/catalogue/converged.c from ensembles of converged runs:

    plumb ensemble SCENARIO --dt 1/480 --members 16 --engine plumb:accurate \\
        --engine ode:quick,iterations=100 --engine bullet:si,iterations=100 --out DIR
    converged_references.py DIR/ensemble.json...

Two engines agree on a statistic if each one's median lies in the other's interval from the 5 % to the
95 % quantile, widened by 1 % of that median on either side, since less is not visible. Where at least
two agree there is a row. Its interval is the union of all engines' intervals: which of them is right
where others differ is not known, and no converged engine should be called wrong.

The scale is the larger of the median of all (of the two spreads, the larger one's) and ten times the
mean width of the engines' intervals, so that three standard deviations from the mean of a normal
distribution are 0.04. Rows go to standard output, with the engines that agree over each; what each engine has goes to standard error."""
import itertools
import json
import statistics
import sys

METRICS = ("mass_height", "run_out_p95", "spread_x", "spread_y", "energy_lost")


def quantile(values, q):
    """Between two order statistics: Hyndman and Fan 1996, definition 7."""
    ordered = sorted(values)
    place = q * (len(ordered) - 1)
    below = min(int(place), len(ordered) - 2)
    return ordered[below] + (place - below) * (ordered[below + 1] - ordered[below])


def interval(values):
    return quantile(values, 0.05), quantile(values, 0.95)


def agree(one, other):
    def near(median, values):
        low, high = interval(values)
        return low - 0.01 * abs(median) <= median <= high + 0.01 * abs(median)

    return near(statistics.median(one), other) and near(statistics.median(other), one)


def samples(study, metric):
    """Values by the index of the ensemble, of those of which every member ran to its end."""
    found = {}
    for index, ensemble in enumerate(study["ensembles"]):
        values = ensemble["observables"].get(metric, {}).get("values", [])
        if len(values) == study["members"]:
            found[index] = values
    return found


def largest_agreement(values):
    for size in range(len(values), 1, -1):
        for group in itertools.combinations(values, size):
            if all(agree(values[a], values[b]) for a, b in itertools.combinations(group, 2)):
                return group
    return ()


def typical(study, metric):
    """The median over all engines; of a spread the larger one of x and y."""
    names = ("spread_x", "spread_y") if metric.startswith("spread") else (metric,)
    medians = []
    for name in names:
        medians.append(
            statistics.median(v for values in samples(study, name).values() for v in values)
        )
    return max(abs(median) for median in medians)


def row(study, metric):
    values = samples(study, metric)
    names = [ensemble["label"] for ensemble in study["ensembles"]]
    scenario = study["ensembles"][0]["scenario"]
    for index, found in values.items():
        low, high = interval(found)
        print(
            f"{scenario} {metric}: {names[index]}: {low:.4g} .. {high:.4g}, "
            f"median {statistics.median(found):.4g}",
            file=sys.stderr,
        )
    group = largest_agreement(values)
    if not group:
        print(f"    no two engines agree on {metric}", file=sys.stderr)
        return
    intervals = [interval(found) for found in values.values()]
    low = min(bounds[0] for bounds in intervals)
    high = max(bounds[1] for bounds in intervals)
    width = statistics.mean(bounds[1] - bounds[0] for bounds in intervals)
    scale = max(typical(study, metric), 10 * width)
    print(f"    /* {', '.join(names[i].split(',')[0] for i in group)} */")
    print(
        f'    {{"{scenario}", PL_STATISTIC_{metric.upper()}, '
        f"{low:.4g}, {high:.4g}, {scale:.3g}}},"
    )


for path in sys.argv[1:]:
    with open(path, encoding="utf-8") as file:
        ensemble_study = json.load(file)
    for name in METRICS:
        row(ensemble_study, name)
