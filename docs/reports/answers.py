"""Answers to the questions of `reproduce`, in sentences that follow from the figures.

Each function composes an answer from the results of its report, and returns sentences. The intervals decide which methods
are called better, worse or biased. A reason is given only if the effect that it explains was found.
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
    """Returns 1 if interval a is above interval b, -1 if it is below, 0 if they overlap."""
    return 1 if a["ci_low"] > b["ci_high"] else -1 if a["ci_high"] < b["ci_low"] else 0


class Curves:
    """Results of `converge`, found by the labels of the curves."""

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
        """Returns the ratio of the efficiencies of two curves."""
        return self.pairs[self.index[label], self.index[than]]

    def told(self, label, than):
        """Returns 1 if the first is more efficient, -1 if it is less efficient, 0 if no difference was found."""
        ratio = self.ratio(label, than)
        return 1 if ratio["ci_low"] > 1 else -1 if ratio["ci_high"] < 1 else 0

    def best(self, labels):
        """Returns the curve that is significantly more efficient than all others, or None."""
        found = [a for a in labels if all(self.told(a, b) > 0 for b in labels if b != a)]
        return found[0] if found else None

    def worst(self, labels):
        found = [a for a in labels if all(self.told(a, b) < 0 for b in labels if b != a)]
        return found[0] if found else None

    def top(self, labels):
        """Returns the curve with the highest efficiency, and all curves without a significant difference from it."""
        first = max(labels, key=lambda label: self[label]["efficiency"]["value"])
        return first, [a for a in labels if a == first or self.told(a, first) == 0]

    def error(self, label, point=-1):
        metrics = self[label]["points"][point]["metrics"]
        return metrics.get("local_relmse", metrics["relmse"])

    def seconds(self, label):
        return self[label]["points"][-1]["seconds"]

    def is_slow(self, label):
        """Returns whether the error falls more slowly than 1 / samples."""
        return self[label]["slope"]["ci_low"] > -1

    def biased(self, labels):
        return [label for label in labels if self[label]["biased"]]


def words_of(verdict):
    """Returns a verdict of the JSON in words for people."""
    return "no difference was found" if verdict == "not told apart" else verdict


def value_of(label):
    return label.partition("=")[2]


def name_of(label):
    return f"`{value_of(label)}`"


def winner(curves, labels, name=name_of):
    """Says which curve is the most efficient, and by how much."""
    best = curves.best(labels)
    if best is None:
        first, alike = curves.top(labels)
        others = [name(label) for label in alike if label != first]
        return f"{name(first)} has the highest efficiency. No significant difference from it was found for {listed(others)}."
    second = max((label for label in labels if label != best),
                 key=lambda label: curves[label]["efficiency"]["value"])
    return (f"{name(best)} is the most efficient, {span(curves.ratio(best, second))} times "
            f"as efficient as {name(second)}, the next.")


def bias_of(curves, labels, name=name_of):
    found = curves.biased(labels)
    if not found:
        return "No bias was found in any of them." if len(labels) > 2 else "No bias was found in either."
    return "More samples do not reduce the bias of " + listed(
        f"{name(label)} (relMSE {number(curves[label]['bias']['value'], 2)})" for label in found) + "."


def compared(curves, first, others):
    """Compares errors at the same number of samples."""
    order = {label: apart(curves.error(label), curves.error(first)) for label in others}
    said = []
    for sign in (-1, 1, 0):
        found = [name_of(label) for label in others if order[label] == sign]
        said += [difference(found, sign, name_of(first), "number of samples")] if found else []
    return said


def difference(found, sign, first, condition):
    """Says that these curves have less (sign -1), more (1) or about as much (0) error as the first one."""
    if sign == 0:
        return f"At the same {condition}, no difference of error from {first} was found for {listed(found)}."
    return (f"At the same {condition}, {listed(found)} {'has' if len(found) == 1 else 'have'} "
            f"{'less' if sign < 0 else 'more'} error than {first}.")


# --- converge -------------------------------------------------------------------------------------


def directions(results):
    curves = Curves(results)
    labels = list(curves.index)
    said = [winner(curves, labels)]
    if curves.best(labels) == "directions=bsdf":
        said.append("Directions chosen otherwise rarely reach the lamps by the narrow specular lobe.")
    slow = [name_of(label) for label in labels if curves.is_slow(label)]
    if slow:
        said.append(f"The error of {listed(slow)} falls more slowly than 1 / samples, because few "
                    "samples contribute most of it.")
    return said + [bias_of(curves, labels)]


def lights(results):
    curves = Curves(results)
    labels = list(curves.index)
    said = [winner(curves, labels)]
    worst = curves.worst(labels)
    if worst:
        said.append(f"{name_of(worst)} is the least efficient" + (
            ", because the most powerful lamp is the farthest." if worst == "light-choice=power" else "."))
    every = curves.seconds("light-choice=all")["value"] / curves.seconds("light-choice=uniform")["value"]
    return said + [f"Sampling all lights takes {number(every, 2)} times as long as sampling one."]


def depths(results):
    curves = Curves(results)
    roulette = [label for label in curves.index if label.startswith("roulette")]
    bounded = [label for label in curves.index if label.startswith("max-bounces")]
    first, alike = curves.top(roulette)
    said = [f"The efficiency is highest if roulette begins at bounce {value_of(first)}."]
    if len(alike) > 1:
        said.append("No significant difference from it was found for bounce "
                    + listed(value_of(label) for label in alike if label != first) + ".")
    others = [label for label in roulette if label not in alike]
    if others:
        said.append("The efficiency is significantly lower for bounce " + listed(value_of(label) for label in others)
                    + ".")
    biased = curves.biased(bounded)
    if biased:
        first, last = curves[biased[0]]["bias"]["value"], curves[biased[-1]]["bias"]["value"]
        said.append("A maximum depth makes the image biased: the bias is a relMSE of "
                    f"{number(first, 2)} at {value_of(biased[0])} bounce{'s' if value_of(biased[0]) != '1' else ''}, and "
                    f"{number(last, 2)} at {value_of(biased[-1])}.")
        free = [value_of(label) for label in bounded if label not in biased]
        said += [f"No bias was found at {listed(free)}."] if free else []
        stuck = [value_of(label) for label in biased
                 if curves[label]["bias"]["value"] > 0.5 * curves.error(label)["value"]]
        said += [f"At {listed(stuck)}, more than half of the error at the end is bias, so that more samples hardly "
                 "help."] if stuck else []
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
                f"as efficient as {names[alone]}, and {span(curves.ratio(both, off))} times as efficient as "
                f"{names[off]}."]
    else:
        said = [winner(curves, [both, alone, off], lambda label: names[label])]
    slow = [names[label] for label in (both, alone, off) if curves.is_slow(label)]
    if slow:
        said.append(f"The error of {listed(slow)} falls more slowly than 1 / samples, because few "
                    "samples contribute most of it.")
    return said + [bias_of(curves, list(curves.index), lambda label: names[label])]


def price(curves, label, first):
    """Returns error times processor time, divided by that of the first curve; lower is better. The intervals of the
    errors and of the time are taken to be independent."""
    parts = [curves.error(label), curves.error(first), curves[label]["processor_ratio"]]
    value = parts[0]["value"] / parts[1]["value"] * parts[2]["value"]
    half = math.hypot(*(math.log(part["ci_high"] / part["ci_low"]) / 2 for part in parts))
    return {"value": value, "ci_low": value * math.exp(-half), "ci_high": value * math.exp(half)}


def splits(results):
    curves = Curves(results)
    first, *others = list(curves.index)
    said = compared(curves, first, others)
    said.append(f"The processor time of a sample, relative to {name_of(first)}, is " + listed(
        f"{span(curves[label]['processor_ratio'])} with {name_of(label)}" for label in others) + ".")
    prices = {label: price(curves, label, first) for label in others}
    for sign in (-1, 1, 0):
        found = [name_of(label) for label in others
                 if (prices[label]["ci_low"] > 1) - (prices[label]["ci_high"] < 1) == sign]
        said += [difference(found, sign, name_of(first), "processor time")] if found else []
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
        said.append(f"At the same number of samples, {listed(halved)} have less than half of the error of {name}.")
    if steeper:
        said.append(f"The error of {listed(steeper)} falls faster with the number of samples than that of {name}.")
    if alike:
        said.append(f"No difference of efficiency from {name} was found for {listed(alike)}.")
    said.append(f"{listed(slower)} {'takes' if len(slower) == 1 else 'take'} more time than {name}." if slower else
                f"No sampler takes significantly more time than {name}.")
    said.append(winner(curves, [first, *others]))
    return said


def strata(results):
    curves = Curves(results)
    jitter, grid = "sampler=stratified", "sampler=grid"
    told = curves.told(grid, jitter)
    ratio = f"the grid is {span(curves.ratio(grid, jitter))} times as efficient as jittered strata"
    said = [{0: f"No difference was found: {ratio}.",
             1: f"Strata without jitter are more efficient: {ratio}.",
             -1: f"Strata with jitter are more efficient: {ratio}."}[told]]
    said.append(bias_of(curves, [jitter, grid]))
    if not curves.biased([grid]):
        said.append(f"The bias of the grid is below a relMSE of {number(curves[grid]['bias']['ci_high'], 2)}.")
    return said


def pixels(results):
    curves = Curves(results)
    first, *others = list(curves.index)
    name = name_of(first)
    said = compared(curves, first, others)
    least = min(curves.index, key=lambda label: curves.error(label)["value"])
    said.append(f"{name_of(least)} has the lowest error, {span(curves.error(least))}; the error of {name} is "
                f"{span(curves.error(first))}.")
    said.append(bias_of(curves, [first, *others]))
    return said


pixels_one = pixels


def whitted(results):
    curves = Curves(results)
    path, tree = "integrator=path", "integrator=whitted"
    said = []
    if curves.biased([tree]):
        said.append("Whitted's model leaves out diffuse light from other surfaces and caustics: a bias of "
                    f"{span(curves[tree]['bias'], 2)} relMSE, which more samples do not reduce.")
    else:
        said.append("No bias was found in Whitted's model.")
    time = apart(curves.seconds(tree), curves.seconds(path))
    said.append({1: "It takes more time than path tracing: ", -1: "It takes less time than path tracing: ",
                 0: "No difference of time was found: "}[time]
                + f"{span(curves.seconds(tree))} s instead of {span(curves.seconds(path))} s.")
    counts = [point["spp"] for point in curves[path]["points"]]
    fewer = [str(n) for k, n in enumerate(counts)
             if apart(curves.error(tree, k), curves.error(path, k)) < 0]
    said.append(f"It has the lower error only at {listed(fewer)} samples per pixel." if fewer else
                "It has the lower error at no number of samples.")
    return said


# --- bench ----------------------------------------------------------------------------------------


def samples(results):
    fits, other = [], []
    for variant in results["variants"][1:]:
        spp, ratio = float(value_of(variant["label"])), variant["frame"]["speed_ratio"]
        (fits if ratio["ci_low"] <= 1 / spp <= ratio["ci_high"] else other).append(variant)
    if not other:
        return ["The time is proportional to the number of samples: all intervals of the speed contain 1 / samples."]
    return ["The time is not proportional to the number of samples: " + listed(
        f"{v['label']} has {span(v['frame']['speed_ratio'])} of the speed" for v in other) + "."]


def steps_a_ray(variant, what):
    """Returns the nodes visited or primitives tested per ray, over closest-hit and shadow rays together."""
    rows = [row for row in variant["rows"] if row["nodes"]]
    return sum(row[what] for row in rows) / sum(row["items"] for row in rows)


def fewest(variants, name):
    """Says with which variants rays visit the fewest nodes and test the fewest primitives."""
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
    said = []
    for v in others:
        ratio, verdict = f"{span(v['frame']['speed_ratio'])} times the speed", v["frame"]["verdict"]
        said.append(f"No difference of speed was found between {name_of(v['label'])} and {name}: {ratio}."
                    if verdict == "not told apart" else f"{name_of(v['label'])} is {verdict} than {name}: {ratio}.")
    top = max(others, key=lambda v: v["frame"]["speed_ratio"]["value"])
    near = [name_of(v["label"]) for v in others
            if v is not top and apart(v["frame"]["speed_ratio"], top["frame"]["speed_ratio"]) == 0]
    if near:
        said.append(f"The intervals of {listed([name_of(top['label']), *near])} overlap.")
    return said + fewest(results["variants"], lambda v: name_of(v["label"])) + []


def leaves(results):
    first, *others = results["variants"]

    def name(variant):
        return f"`{variant['label']}`"

    said = fewest(results["variants"], name)
    for verdict in ("faster", "slower"):
        told = [v for v in others if v["frame"]["verdict"] == verdict]
        if told:
            said.append("These are " + verdict + f" than {name(first)}: " + listed(
                f"{name(v)} ({span(v['frame']['speed_ratio'])} times the speed)" for v in told) + ".")
    alike = [v for v in others if v["frame"]["verdict"] == "not told apart"]
    if alike:
        said.append(f"No difference of speed from {name(first)} was found for these, with their relative speeds: " + listed(
            f"{name(v)} ({span(v['frame']['speed_ratio'])})" for v in alike) + ".")
    return said


def frame(results):
    return f"Lampyris renders {number(results['variants'][0]['frame']['fps'], 2)} frames/s on a CPU driver."


def frame_10k(results):
    return ["A Radeon R9 280X was reported to render 40 frames/s of another scene with these numbers of pixels, "
            "bounces, samples and triangles, with another program.",
            frame(results)]


def frame_900k(results, fewer):
    this, that = results["variants"][0], fewer["variants"][0]
    triangles = this["bvh"]["triangles"] / that["bvh"]["triangles"]
    order = apart(this["frame"]["ms"], that["frame"]["ms"])
    return ["The report for the Radeon R9 280X is 18 frames/s.", frame(results),
            {1: "A frame takes longer", 0: "No difference of time was found", -1: "A frame takes less time"}[order]
            + f" with {number(triangles, 2)} times the triangles: "
            f"{span(this['frame']['ms'], 4)} ms instead of {span(that['frame']['ms'], 4)} ms."]


def frame_hd(results):
    frames = results["variants"][0]["frame"]["fps"]
    reach = "reaches" if frames >= 30 else "does not reach"
    return [f"A display of 30 frames/s needs a frame every 33.3 ms. Lampyris {reach} this on a CPU driver: "
            f"a frame takes {number(30 / frames, 2)} times as long ({number(frames, 2)} frames/s)."]
