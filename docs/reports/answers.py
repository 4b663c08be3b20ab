"""Answers to the questions of `reproduce`, in words that follow from the figures.

An answer is made of the results of its report. What is said to be better, worse, biased or alike is what
the intervals say; a reason is given only where what it explains was found. Each returns sentences.
"""

import math

# --- figures --------------------------------------------------------------------------------------


def number(value, digits=3):
    text = f"{value:.{digits}g}"
    return str(round(float(text))) if "e+" in text else text


def span(interval, digits=3):
    """"2.11 [1.82, 2.44]"."""
    return (f"{number(interval['value'], digits)} [{number(interval['ci_low'], digits)}, "
            f"{number(interval['ci_high'], digits)}]")


def listed(words):
    words = list(words)
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def apart(a, b):
    """Whether two intervals have nothing in common: 1 where a is above b, -1 below, 0 neither."""
    return 1 if a["ci_low"] > b["ci_high"] else -1 if a["ci_high"] < b["ci_low"] else 0


class Curves:
    """Results of `converge`, by the words of a curve's label."""

    def __init__(self, results):
        self.list = results["curves"]
        self.pairs = {}
        for pair in results["pairs"]:
            ratio = pair["efficiency_ratio"]
            self.pairs[pair["curve"], pair["than"]] = ratio
            self.pairs[pair["than"], pair["curve"]] = {
                "value": 1 / ratio["value"], "ci_low": 1 / ratio["ci_high"],
                "ci_high": 1 / ratio["ci_low"]}
        self.index = {curve["label"]: i for i, curve in enumerate(self.list)}

    def __getitem__(self, label):
        return self.list[self.index[label]]

    def ratio(self, label, than):
        """Of efficiencies."""
        return self.pairs[self.index[label], self.index[than]]

    def told(self, label, than):
        """1: more efficient, -1: less, 0: not told apart."""
        ratio = self.ratio(label, than)
        return 1 if ratio["ci_low"] > 1 else -1 if ratio["ci_high"] < 1 else 0

    def best(self, labels):
        """The one that is told more efficient than all others, or None."""
        found = [a for a in labels if all(self.told(a, b) > 0 for b in labels if b != a)]
        return found[0] if found else None

    def worst(self, labels):
        found = [a for a in labels if all(self.told(a, b) < 0 for b in labels if b != a)]
        return found[0] if found else None

    def top(self, labels):
        """The one of most efficiency, and what is not told apart from it."""
        first = max(labels, key=lambda label: self[label]["efficiency"]["value"])
        return first, [a for a in labels if a == first or self.told(a, first) == 0]

    def error(self, label, point=-1):
        metrics = self[label]["points"][point]["metrics"]
        return metrics.get("local_relmse", metrics["relmse"])

    def seconds(self, label):
        return self[label]["points"][-1]["seconds"]

    def is_slow(self, label):
        """Whether the error falls more slowly than with 1 / samples."""
        return self[label]["slope"]["ci_low"] > -1

    def biased(self, labels):
        return [label for label in labels if self[label]["biased"]]


def value_of(label):
    return label.partition("=")[2]


def name_of(label):
    return f"`{value_of(label)}`"


def winner(curves, labels, name=name_of):
    """Which is the most efficient, and by how much."""
    best = curves.best(labels)
    if best is None:
        first, alike = curves.top(labels)
        others = [name(label) for label in alike if label != first]
        return f"{name(first)} has the highest efficiency, not told apart from {listed(others)}."
    second = max((label for label in labels if label != best),
                 key=lambda label: curves[label]["efficiency"]["value"])
    return (f"{name(best)} is the most efficient, {span(curves.ratio(best, second))} times "
            f"{name(second)}, the next.")


def bias_of(curves, labels, name=name_of):
    found = curves.biased(labels)
    if not found:
        return "No bias was found in any of them." if len(labels) > 2 else "No bias was found in either."
    return "Biased, which no number of samples mends: " + listed(
        f"{name(label)} by {number(curves[label]['bias']['value'], 2)}" for label in found) + "."


def compared(curves, first, others):
    """Errors at the same samples."""
    order = {label: apart(curves.error(label), curves.error(first)) for label in others}
    said = []
    for sign, words in ((-1, "less error than"), (1, "more error than"), (0, "an error not told apart from that of")):
        found = [name_of(label) for label in others if order[label] == sign]
        if found:
            said.append(f"{listed(found)} {'has' if len(found) == 1 else 'have'} {words} {name_of(first)} "
                        "at the same samples.")
    return said


# --- converge -------------------------------------------------------------------------------------


def directions(results):
    curves = Curves(results)
    labels = list(curves.index)
    said = [winner(curves, labels)]
    if curves.best(labels) == "directions=bsdf":
        said.append("Other directions rarely meet the lamps in the mirror's.")
    slow = [name_of(label) for label in labels if curves.is_slow(label)]
    if slow:
        said.append(f"The error of {listed(slow)} falls more slowly than with 1 / samples: few samples "
                    "carry it.")
    return said + [bias_of(curves, labels)]


def lights(results):
    curves = Curves(results)
    labels = list(curves.index)
    said = [winner(curves, labels)]
    worst = curves.worst(labels)
    if worst:
        said.append(f"{name_of(worst)} is the least efficient" + (
            ", for the strongest lamp is the farthest." if worst == "light-choice=power" else "."))
    every = curves.seconds("light-choice=all")["value"] / curves.seconds("light-choice=uniform")["value"]
    return said + [f"All lights take {number(every, 2)} times as long as one."]


def depths(results):
    curves = Curves(results)
    roulette = [label for label in curves.index if label.startswith("roulette")]
    bounded = [label for label in curves.index if label.startswith("max-bounces")]
    first, alike = curves.top(roulette)
    said = [f"Roulette is best begun at {value_of(first)} bounces; not told apart from that: "
            + listed(value_of(label) for label in alike if label != first) + "."
            if len(alike) > 1 else f"Roulette is best begun at {value_of(first)} bounces."]
    others = [label for label in roulette if label not in alike]
    if others:
        said.append("Told worse: " + listed(value_of(label) for label in others) + ".")
    biased = curves.biased(bounded)
    if biased:
        first, last = curves[biased[0]]["bias"]["value"], curves[biased[-1]]["bias"]["value"]
        said.append(f"A maximum depth biases: by {number(first, 2)} at {value_of(biased[0])} bounce"
                    f"{'s' if value_of(biased[0]) != '1' else ''}, by {number(last, 2)} at "
                    f"{value_of(biased[-1])}.")
        free = [value_of(label) for label in bounded if label not in biased]
        said += [f"No bias was found at {listed(free)}."] if free else []
        stuck = [value_of(label) for label in biased
                 if curves[label]["bias"]["value"] > 0.5 * curves.error(label)["value"]]
        said += [f"More than half of the error at the end is bias at {listed(stuck)}: more samples hardly "
                 "help there."] if stuck else []
    else:
        said.append("No bias was found at any maximum depth.")
    return said


def nee(results):
    curves = Curves(results)
    both, alone, off = "nee=on mis=power", "nee=on mis=none", "nee=off"
    names = {both: "Light sampling combined with BSDF sampling", alone: "light sampling alone",
             off: "BSDF sampling alone"}
    if curves.best([both, alone, off]) == both:
        said = [f"{names[both]} is the most efficient: {span(curves.ratio(both, alone))} times "
                f"{names[alone]}, {span(curves.ratio(both, off))} times {names[off]}."]
    else:
        said = [winner(curves, [both, alone, off], lambda label: names[label])]
    slow = [names[label] for label in (both, alone, off) if curves.is_slow(label)]
    if slow:
        said.append(f"The error of {listed(slow)} falls more slowly than with 1 / samples, as fireflies "
                    "make it.")
    return said + [bias_of(curves, list(curves.index), lambda label: names[label])]


def price(curves, label, first):
    """Error times processor time, over that of the first: below 1 it gains. The intervals of the errors and of the time
    are taken to be independent."""
    parts = [curves.error(label), curves.error(first), curves[label]["processor_ratio"]]
    value = parts[0]["value"] / parts[1]["value"] * parts[2]["value"]
    half = math.hypot(*(math.log(part["ci_high"] / part["ci_low"]) / 2 for part in parts))
    return {"value": value, "ci_low": value * math.exp(-half), "ci_high": value * math.exp(half)}


def splits(results):
    curves = Curves(results)
    first, *others = list(curves.index)
    said = compared(curves, first, others)
    said.append("A sample takes " + listed(f"{span(curves[label]['processor_ratio'])} times the processor time with "
                                           f"{name_of(label)}" for label in others) + ".")
    prices = {label: price(curves, label, first) for label in others}
    for sign, words in ((-1, "a gain"), (1, "a loss"), (0, "not told apart")):
        found = [name_of(label) for label in others
                 if (prices[label]["ci_low"] > 1) - (prices[label]["ci_high"] < 1) == sign]
        if found:
            said.append(f"For the same processor time, {listed(found)} {'is' if len(found) == 1 else 'are'} {words} "
                        f"against {name_of(first)}.")
    return said + [bias_of(curves, [first, *others])]


def samplers(results):
    curves = Curves(results)
    first, *others = list(curves.index)
    halved = [name_of(label) for label in others
              if curves.error(label)["ci_high"] < 0.5 * curves.error(first)["ci_low"]]
    steeper = [name_of(label) for label in others
               if curves[label]["slope"]["ci_high"] < curves[first]["slope"]["ci_low"]]
    alike = [name_of(label) for label in others if curves.told(label, first) == 0]
    slower = [name_of(label) for label in others
              if apart(curves.seconds(label), curves.seconds(first)) > 0]
    name = name_of(first)
    said = []
    if halved:
        said.append(f"{listed(halved)} have less than half of the error of {name} at the same samples.")
    if steeper:
        said.append(f"The error of {listed(steeper)} falls faster with samples.")
    if alike:
        said.append(f"{listed(alike)} and {name} are not told apart.")
    said.append(f"More time than {name} is taken by {listed(slower)}." if slower else
                f"None takes more time than {name}, as far as the intervals tell.")
    said.append(winner(curves, [first, *others]))
    return said


def strata(results):
    curves = Curves(results)
    jitter, grid = "sampler=stratified", "sampler=grid"
    told = curves.told(grid, jitter)
    ratio = f"{span(curves.ratio(grid, jitter))} of the efficiency"
    said = [{0: f"Not told apart: the grid has {ratio}.",
             1: f"Without jitter: the grid has {ratio}.",
             -1: f"With jitter: the grid has {ratio}."}[told]]
    said.append(bias_of(curves, [jitter, grid]))
    if not curves.biased([grid]):
        said.append(f"That of the grid is below {number(curves[grid]['bias']['ci_high'], 2)}.")
    return said


def pixels(results):
    curves = Curves(results)
    first, *others = list(curves.index)
    name = name_of(first)
    said = compared(curves, first, others)
    least = min(curves.index, key=lambda label: curves.error(label)["value"])
    said.append(f"The least error is that of {name_of(least)}: {span(curves.error(least))}, that of {name} "
                f"{span(curves.error(first))}.")
    said.append(bias_of(curves, [first, *others]))
    return said


pixels_one = pixels


def whitted(results):
    curves = Curves(results)
    path, tree = "integrator=path", "integrator=whitted"
    said = []
    if curves.biased([tree]):
        said.append("Diffuse light from other surfaces and caustics: a bias of "
                    f"{span(curves[tree]['bias'], 2)}, which no number of samples removes.")
    else:
        said.append("What it leaves out was not found as bias.")
    time = apart(curves.seconds(tree), curves.seconds(path))
    said.append({1: "It takes more time: ", -1: "It saves time: ", 0: "It saves no time that is told apart: "}[time]
                + f"{span(curves.seconds(tree))} instead of {span(curves.seconds(path))} seconds.")
    counts = [point["spp"] for point in curves[path]["points"]]
    fewer = [str(n) for k, n in enumerate(counts)
             if apart(curves.error(tree, k), curves.error(path, k)) < 0]
    said.append(f"Its error is the smaller one at {listed(fewer)} samples a pixel only." if fewer else
                "Its error is the smaller one nowhere.")
    return said


# --- bench ----------------------------------------------------------------------------------------


def samples(results):
    fits, other = [], []
    for variant in results["variants"][1:]:
        spp, ratio = float(value_of(variant["label"])), variant["frame"]["speed_ratio"]
        (fits if ratio["ci_low"] <= 1 / spp <= ratio["ci_high"] else other).append(variant)
    if not other:
        return ["Time is proportional to samples, within the intervals."]
    return ["Time is not proportional to samples: " + listed(
        f"{v['label']} has {span(v['frame']['speed_ratio'])} of the speed" for v in other) + "."]


def steps_a_ray(variant, what):
    """Nodes visited or primitives tested, by rays for the nearest hit and shadow rays together."""
    rows = [row for row in variant["rows"] if row["nodes"]]
    return sum(row[what] for row in rows) / sum(row["items"] for row in rows)


def fewest(variants, name):
    """Which have the least of what rays do."""
    said = []
    for what, verb in (("nodes", "visits"), ("primitives", "tests")):
        least = min(variants, key=lambda v: steps_a_ray(v, what))
        most = max(variants, key=lambda v: steps_a_ray(v, what))
        said.append(f"A ray {verb} the fewest {what} with {name(least)}, {number(steps_a_ray(least, what))}, "
                    f"and the most with {name(most)}, {number(steps_a_ray(most, what))}.")
    return said


def bvh(results):
    first, *others = results["variants"]
    name = name_of(first["label"])
    said = ["Against " + name + ": " + listed(
        f"{name_of(v['label'])} is {v['frame']['verdict']}, {span(v['frame']['speed_ratio'])} times the speed"
        for v in others) + "."]
    top = max(others, key=lambda v: v["frame"]["speed_ratio"]["value"])
    near = [name_of(v["label"]) for v in others
            if v is not top and apart(v["frame"]["speed_ratio"], top["frame"]["speed_ratio"]) == 0]
    if near:
        said.append(f"The intervals of {listed([name_of(top['label']), *near])} overlap.")
    return said + fewest(results["variants"], lambda v: name_of(v["label"])) + ["See also docs/performance.md."]


def leaves(results):
    first, *others = results["variants"]

    def name(variant):
        return f"`{variant['label']}`"

    said = fewest(results["variants"], name)
    for verdict in ("faster", "slower"):
        told = [v for v in others if v["frame"]["verdict"] == verdict]
        if told:
            said.append(f"Than {name(first)} {verdict}: " + listed(
                f"{name(v)}, {span(v['frame']['speed_ratio'])} times the speed" for v in told) + ".")
    alike = [v for v in others if v["frame"]["verdict"] == "not told apart"]
    if alike:
        said.append(f"Not told apart from {name(first)}: " + listed(
            f"{name(v)}, {span(v['frame']['speed_ratio'])}" for v in alike) + ".")
    return said


def frame(results):
    return f"Here it is {number(results['variants'][0]['frame']['fps'], 2)}, on a CPU driver."


def frame_10k(results):
    return ["A Radeon R9 280X was reported with 40 frames/s for a frame of these numbers on another scene.",
            frame(results)]


def frame_900k(results, fewer):
    this, that = results["variants"][0], fewer["variants"][0]
    triangles = this["bvh"]["triangles"] / that["bvh"]["triangles"]
    order = apart(this["frame"]["ms"], that["frame"]["ms"])
    return ["Reported for that card: 18 frames/s.", frame(results),
            f"With {number(triangles, 2)} times the triangles a frame takes " + {
                1: "longer: ", 0: "a time that is not told apart: ", -1: "less time: "}[order]
            + f"{span(this['frame']['ms'], 4)} instead of {span(that['frame']['ms'], 4)} ms."]


def frame_hd(results):
    frames = results["variants"][0]["frame"]["fps"]
    reach = "That is reached here" if frames >= 30 else "Here it takes " + number(30 / frames, 2) + " times as long"
    return [f"A display of 30 frames/s wants it in 33.3 ms. {reach}: {number(frames, 2)} frames/s."]
