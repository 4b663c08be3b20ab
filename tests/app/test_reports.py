"""Tests docs/reports: the commands run, the tables contain the results, and the sentences follow from them.

test_reports.py PROGRAM
"""

import copy
import importlib.machinery
import importlib.util
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
REPRODUCE = ROOT / "docs/reports/reproduce"
PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())


sys.dont_write_bytecode = True
sys.path.insert(0, str(REPRODUCE.parent))
import answers  # noqa: E402

loader = importlib.machinery.SourceFileLoader("reproduce", str(REPRODUCE))
reproduce = importlib.util.module_from_spec(importlib.util.spec_from_loader("reproduce", loader))
loader.exec_module(reproduce)


def exchanged(results):
    """Returns the results with the labels of the first and the last curve or variant exchanged; if there is
    only one, with ten times its speed."""
    if "variants" in results and len(results["variants"]) == 1:
        frame = results["variants"][0]["frame"]
        frame["fps"] *= 10
        frame["ms"] = {key: value / 10 for key, value in frame["ms"].items()}
        return results
    if "variants" in results:
        ratios = [variant["frame"]["speed_ratio"] for variant in results["variants"]]
        verdicts = {1: "faster", -1: "slower", 0: "not told apart"}
        for variant, ratio in zip(results["variants"][1:], reversed(ratios[1:])):
            ratio = {"value": 1 / ratio["value"], "ci_low": 1 / ratio["ci_high"],
                     "ci_high": 1 / ratio["ci_low"]}
            sign = (ratio["ci_low"] > 1) - (ratio["ci_high"] < 1)
            variant["frame"].update(speed_ratio=ratio, verdict=verdicts[sign])
        return results
    first, last = results["curves"][0], results["curves"][-1]
    first["label"], last["label"] = last["label"], first["label"]
    return results


# --- words against figures ------------------------------------------------------------------------
# What each sentence says, found by its words, and whether the figures say so; by means of its own.
# A sentence that is not here fails: whoever writes one says here what it rests on.

ONE = r"(?:`[^`]+`|[lL]ight sampling(?: alone| combined with BSDF sampling)|BSDF sampling alone)"
NAME = rf"({ONE})"
LIST = rf"({ONE}(?:(?:, | and ){ONE})*)"
NUMBER = r"([\d.e+-]+)"


class Figures:
    """Results of `converge`, found by the words that sentences use for the curves."""

    TECHNIQUES = {"light sampling combined with bsdf sampling": "nee=on mis=power",
                  "light sampling alone": "nee=on mis=none", "bsdf sampling alone": "nee=off"}

    def __init__(self, results):
        self.curves = {curve["label"]: curve for curve in results["curves"]}
        self.labels = list(self.curves)
        self.processor = {x: c["processor_ratio"] for x, c in self.curves.items() if c.get("processor_ratio")}
        self.ratios = {}
        for pair in results["pairs"]:
            a, b, r = self.labels[pair["curve"]], self.labels[pair["than"]], pair["efficiency_ratio"]
            self.ratios[a, b] = (r["value"], r["ci_low"], r["ci_high"])
            self.ratios[b, a] = (1 / r["value"], 1 / r["ci_high"], 1 / r["ci_low"])

    def label(self, name):
        name = name.strip("` ")
        found = [x for x in self.labels if x.partition("=")[2] == name]
        return found[0] if found else self.TECHNIQUES[name.lower()]

    def listed(self, names):
        return [self.label(name) for name in re.split(", | and ", names)]

    def better(self, a, b):
        return (self.ratios[a, b][1] > 1) - (self.ratios[a, b][2] < 1)

    def others(self, label):
        return [x for x in self.labels if x != label]

    def error(self, label, point=-1):
        metrics = self.curves[label]["points"][point]["metrics"]
        return metrics.get("local_relmse", metrics["relmse"])

    def seconds(self, label):
        return self.curves[label]["points"][-1]["seconds"]

    def slope(self, label):
        return self.curves[label]["slope"]

    def biased(self):
        return [x for x in self.labels if self.curves[x]["biased"]]


def above(a, b, factor=1):
    return a["ci_low"] > factor * b["ci_high"]


def same(text, value):
    return float(text) == 0 and value == 0 or abs(float(text) / value - 1) < 0.06


def is_winner(f, name, low, second, *_):
    a, b = f.label(name), f.label(second)
    top = max(f.others(a), key=lambda x: f.curves[x]["efficiency"]["value"])
    return all(f.better(a, x) > 0 for x in f.others(a)) and b == top and same(low, f.ratios[a, b][0])


def is_leader(f, name, names):
    a = f.label(name)
    return (not any(all(f.better(x, y) > 0 for y in f.others(x)) for x in f.labels) and
            f.curves[a]["efficiency"]["value"] == max(c["efficiency"]["value"] for c in f.curves.values())
            and set(f.listed(names)) == {x for x in f.others(a) if f.better(a, x) == 0})


def are_biased(f, text):
    found = {f.label(name): value for name, value in re.findall(NAME + rf" \(relMSE {NUMBER}\)", text)}
    return set(found) == set(f.biased()) and all(same(v, f.curves[x]["bias"]["value"]) for x, v in found.items())


def errors_are(f, names, words, first):
    test = {"less": lambda a, b: above(b, a), "more": above,
            "no": lambda a, b: not above(a, b) and not above(b, a)}[words]
    first = f.label(first)
    return set(f.listed(names)) == {x for x in f.others(first) if test(f.error(x), f.error(first))}


def are_slow(f, names, *_):
    return set(f.listed(names)) == {x for x in f.labels if f.slope(x)["ci_low"] > -1}


def times_are(f, text):
    found = dict(re.findall(rf"{NUMBER} \[[^]]*\] with `([^`]+)`", text))
    said = {f"split-lobes={name}": n for n, name in found.items()}
    return set(said) == set(f.processor) and all(same(n, f.processor[x]["value"]) for x, n in said.items())


def prices_are(f, names, words, first):
    """Checks error times processor time relative to the first curve, in units of the standard deviations of
    both logarithms."""
    first, sign = f.label(first), {"less": -1, "more": 1, "no": 0}[words]

    def spread(interval):
        return math.log(interval["ci_high"] / interval["ci_low"]) ** 2

    def told(label):
        error, other, time = f.error(label), f.error(first), f.processor[label]
        price = math.log(error["value"] / other["value"] * time["value"])
        return 0 if 4 * price ** 2 <= spread(error) + spread(other) + spread(time) else math.copysign(1, price)

    return set(f.listed(names)) == {x for x in f.others(first) if told(x) == sign}


# Each claim has a pattern and a function that tests it; the pattern's groups are the arguments.
CLAIMS = [
    (rf"{NAME} is the most efficient, {NUMBER} \[.*\] times as efficient as {NAME}, the next\.", is_winner),
    (rf"{NAME} has the highest efficiency\. No significant difference from it was found for {LIST}\.", is_leader),
    (r"Light sampling combined with BSDF sampling is the most efficient: .* times as efficient as light sampling alone, "
     r"and .* times as efficient as BSDF sampling alone\.",
     lambda f: all(f.better("nee=on mis=power", x) > 0 for x in f.others("nee=on mis=power"))),
    (r"Directions chosen otherwise rarely reach the lamps by the narrow specular lobe\.",
     lambda f: all(f.better("directions=bsdf", x) > 0 for x in f.others("directions=bsdf"))),
    (rf"The error of {LIST} falls more slowly than 1 / samples, because few samples contribute most of it\.", are_slow),
    (r"No bias was found in (any of them|either)\.", lambda f, *_: not f.biased()),
    (r"More samples do not reduce the bias of (.*)\.", are_biased),
    (rf"{NAME} is the least efficient(, because the most powerful lamp is the farthest)?\.",
     lambda f, a, why: all(f.better(f.label(a), x) < 0 for x in f.others(f.label(a))) and
     (not why or f.label(a) == "light-choice=power")),
    (rf"Sampling all lights takes {NUMBER} times as long as sampling one\.",
     lambda f, n: same(n, f.seconds("light-choice=all")["value"] / f.seconds("light-choice=uniform")["value"])),
    (rf"At the same number of samples, {LIST} have less than half of the error of {NAME}\.",
     lambda f, names, first: set(f.listed(names)) ==
     {x for x in f.labels if above(f.error(f.label(first)), f.error(x), 2)}),
    (rf"The error of {LIST} falls faster with the number of samples than that of {NAME}\.",
     lambda f, names, first: f.label(first) == f.labels[0] and set(f.listed(names)) ==
     {x for x in f.labels if f.slope(x)["ci_high"] < f.slope(f.labels[0])["ci_low"]}),
    (rf"No difference of efficiency from {NAME} was found for {LIST}\.",
     lambda f, first, names: set(f.listed(names)) ==
     {x for x in f.others(f.label(first)) if f.better(x, f.label(first)) == 0}),
    (rf"{LIST} takes? more time than {NAME}\.",
     lambda f, names, first: set(f.listed(names)) ==
     {x for x in f.labels if above(f.seconds(x), f.seconds(f.label(first)))}),
    (rf"No sampler takes significantly more time than {NAME}\.",
     lambda f, first: not any(above(f.seconds(x), f.seconds(f.label(first))) for x in f.labels)),
    (rf"(No difference was found|Strata with jitter are more efficient|Strata without jitter are more efficient): "
     rf"the grid is {NUMBER} \[.*\] times as efficient as jittered strata\.",
     lambda f, words, n: f.better("sampler=grid", "sampler=stratified") ==
     (0 if words.startswith("No") else 1 if "without" in words else -1) and
     same(n, f.ratios["sampler=grid", "sampler=stratified"][0])),
    (rf"The bias of the grid is below a relMSE of {NUMBER}\.",
     lambda f, n: not f.curves["sampler=grid"]["biased"] and
     same(n, f.curves["sampler=grid"]["bias"]["ci_high"])),
    (rf"At the same number of samples, {LIST} (?:has|have) (less|more) error than {NAME}\.", errors_are),
    (rf"At the same number of samples, no difference of error from {NAME} was found for {LIST}\.",
     lambda f, first, names: errors_are(f, names, "no", first)),
    (rf"The processor time of a sample, relative to {NAME}, is (.*)\.",
     lambda f, first, text: f.label(first) == f.labels[0] and times_are(f, text)),
    (rf"At the same processor time, {LIST} (?:has|have) (less|more) error than {NAME}\.", prices_are),
    (rf"At the same processor time, no difference of error from {NAME} was found for {LIST}\.",
     lambda f, first, names: prices_are(f, names, "no", first)),
    (rf"{NAME} has the lowest error, {NUMBER} \[.*\]; the error of {NAME} is {NUMBER} \[.*\]\.",
     lambda f, a, n, b, m: f.error(f.label(a))["value"] == min(f.error(x)["value"] for x in f.labels) and
     same(n, f.error(f.label(a))["value"]) and same(m, f.error(f.label(b))["value"])),
    (r"Whitted's model leaves out diffuse light from other surfaces and caustics: a bias of .* relMSE, which more samples do "
     r"not reduce\.",
     lambda f: "integrator=whitted" in f.biased()),
    (r"No bias was found in Whitted's model\.", lambda f: "integrator=whitted" not in f.biased()),
    (r"(It takes more time than path tracing|It takes less time than path tracing|No difference of time was found): .* s "
     r"instead of .* s\.",
     lambda f, words: {"It takes more time than path tracing": 1, "It takes less time than path tracing": -1}.get(words, 0) ==
     above(f.seconds("integrator=whitted"), f.seconds("integrator=path")) -
     above(f.seconds("integrator=path"), f.seconds("integrator=whitted"))),
    (r"It has the lower error (?:only at (.*) samples per pixel|at no number of samples)\.",
     lambda f, counts: re.split(", | and ", counts or "") == [
         str(point["spp"]) for k, point in enumerate(f.curves["integrator=path"]["points"])
         if above(f.error("integrator=path", k), f.error("integrator=whitted", k))] or not counts),
]
# Reports with several sweeps have tests of their own: test_depths_follow_from_their_figures.
OF_THEIR_OWN = {"depths"}


def planted(results):
    """Yields the results, and altered ones: reversed or rotated order, all equal, all biased, and none
    biased."""
    def changed(change):
        other = copy.deepcopy(results)
        change(other["curves"], other["pairs"])
        return other

    def relabel(curves, _, order):
        for kind in dict.fromkeys(c["label"].partition("=")[0] for c in results["curves"]):
            own = [c for c in curves if c["label"].partition("=")[0] == kind]
            for curve, label in zip(own, order([c["label"] for c in own])):
                curve["label"] = label

    def alike(curves, pairs):
        for curve in curves:
            curve.update(points=curves[0]["points"], slope=curves[0]["slope"])
        for pair in pairs:
            pair["efficiency_ratio"] = {"value": 1.01, "ci_low": 0.8, "ci_high": 1.3}

    def biased(curves, _, value):
        for curve in curves:
            curve.update(biased=value, bias={"value": 0.5, "ci_low": 0.4 if value else -0.4, "ci_high": 0.6})

    yield "as measured", results
    if "processor_ratio" in results["curves"][0]:
        for factor in (0.2, 0.85, 5):
            yield f"processor time by {factor}", changed(lambda c, p: [
                curve["processor_ratio"].update({key: factor * value for key, value in curve["processor_ratio"].items()})
                for curve in c[1:]])
    yield "reversed", changed(lambda c, p: relabel(c, p, lambda x: x[::-1]))
    yield "rotated", changed(lambda c, p: relabel(c, p, lambda x: x[1:] + x[:1]))
    yield "alike", changed(alike)
    yield "all biased", changed(lambda c, p: biased(c, p, True))
    yield "none biased", changed(lambda c, p: biased(c, p, False))


class Reports(unittest.TestCase):
    def reproduce(self, *arguments):
        return subprocess.run([sys.executable, REPRODUCE, *arguments], text=True,
                              capture_output=True, env={**os.environ, "LAMPYRIS": PROGRAM})

    def test_commands_run(self):
        done = self.reproduce("--quick")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_table_is_that_of_the_results(self):
        done = self.reproduce("--check")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_words_follow_from_the_figures(self):
        # Compares the statements of each section with the cells of its table.
        text = (ROOT / "docs/reports/README.md").read_text(encoding="utf-8")
        sections = re.split(r"^## ", text.partition("`reproduce --table` -->")[2], flags=re.MULTILINE)[1:]
        self.assertEqual(len(sections), len(reproduce.REPORTS))
        for section in sections:
            words = re.sub(r"\s+", " ", section.partition("\n    lampyris")[0].partition("\n")[2])
            rows = [[cell.strip() for cell in line.strip("|").split("|")]
                    for line in section.splitlines() if line.startswith("|")][2:]
            biased = [row for row in rows if row[-1].endswith(": biased")]
            if re.search("No bias was found in (either|any)", words):
                self.assertEqual(biased, [], section)
            if re.search("biased|a bias of|the bias of `", words):
                self.assertNotEqual(biased, [], section)
            for row in biased:
                self.assertRegex(words, "[Bb]ias", section)
                self.assertNotRegex(words, "No bias was found in (either|any)", section)
            best = re.match(r"`(\S+)` is the most efficient", words)
            if best:
                verdicts = {row[0].partition("=")[2]: row[4] for row in rows}
                self.assertIn(verdicts.pop(best[1]), ("", "faster"), section)
                self.assertNotEqual(set(verdicts.values()), {"faster"}, section)
            if words.startswith("No difference was found"):
                self.assertEqual({row[4] for row in rows[1:]}, {"no difference was found"}, section)
            # An interval contains its value.
            for value, low, high in re.findall(r"([\d.e-]+) \[([\d.e-]+), ([\d.e-]+)\]", words):
                self.assertLessEqual(float(low), float(value), section)
                self.assertLessEqual(float(value), float(high), section)

    def test_every_sentence_rests_on_its_figures(self):
        said = 0
        for name, _, _ in reproduce.REPORTS:
            measured = reproduce.load(name)
            if "variants" in measured or name in OF_THEIR_OWN:
                continue
            for what, results in planted(measured):
                figures = Figures(results)
                for sentence in getattr(answers, name.replace("-", "_"))(results):
                    sentence = sentence[0].upper() + sentence[1:]
                    found = [(re.fullmatch(pattern, sentence), holds) for pattern, holds in CLAIMS]
                    found = [(match, holds) for match, holds in found if match]
                    with self.subTest(report=name, figures=what, sentence=sentence):
                        self.assertEqual(len(found), 1)
                        self.assertTrue(found[0][1](figures, *found[0][0].groups()))
                    said += 1
        self.assertGreater(said, 100)

    def test_depths_follow_from_their_figures(self):
        for what, results in planted(reproduce.load("depths")):
            figures = Figures(results)
            said = " ".join(answers.depths(results))
            with self.subTest(figures=what, said=said):
                bounded = [x for x in figures.biased() if x.startswith("max-bounces")]
                self.assertEqual("A maximum depth makes the image biased" in said, bool(bounded))
                self.assertEqual("No bias was found at any maximum depth" in said, not bounded)
                best = re.match(r"The efficiency is highest if roulette begins at bounce (\d+)\.", said)[1]
                best = figures.curves[f"roulette-min-bounces={best}"]
                self.assertEqual(best["efficiency"]["value"], max(
                    c["efficiency"]["value"] for x, c in figures.curves.items() if x.startswith("roulette")))
                for depth in bounded[:1] + bounded[-1:]:
                    self.assertRegex(said, rf"at {depth.partition('=')[2]}\b")

    def test_speeds_follow_from_their_figures(self):
        # Each variant that is compared is called faster or slower if the interval of the ratio
        # says so.
        results = reproduce.load("bvh")
        for turn in range(3):
            said = " ".join(answers.bvh(results))
            for variant in results["variants"][1:]:
                ratio = variant["frame"]["speed_ratio"]
                word = "faster" if ratio["ci_low"] > 1 else "slower" if ratio["ci_high"] < 1 else None
                name = variant["label"].partition("=")[2]
                verdict = (f"`{name}` is {word} than `middle`" if word else
                           f"No difference of speed was found between `{name}` and `middle`")
                self.assertIn(f"{verdict}: {answers.span(ratio)} times the speed.", said)
            results = exchanged(results) if turn == 0 else results
            for variant in results["variants"][1:] if turn == 1 else []:
                variant["frame"].update(speed_ratio={"value": 1, "ci_low": 0.9, "ci_high": 1.1},
                                        verdict="not told apart")

    def test_a_bias_that_no_figure_has_is_noticed(self):
        # This sentence was once in the report on strata, beside a table that did not contain its figure.
        sentence = ("No bias was found in either, though the grid is a quadrature and has one: here it is below "
                    "2.2e-05.")
        self.assertFalse([pattern for pattern, _ in CLAIMS if re.fullmatch(pattern, sentence)])

    def test_other_figures_make_other_words(self):
        # The figures of the first and the last curve or variant are exchanged.
        for name, _, _ in reproduce.REPORTS:
            results = reproduce.load(name)
            said = reproduce.answer(name, results)
            self.assertNotEqual(reproduce.answer(name, exchanged(results)), said, name)

    def test_a_grid_that_is_told_worse_and_biased(self):
        results = reproduce.load("strata")
        self.assertIn("No difference was found", reproduce.answer("strata", results))
        grid = results["curves"][1]
        grid["biased"], grid["bias"] = True, {"value": 0.5, "ci_low": 0.4, "ci_high": 0.6}
        results["pairs"][0]["efficiency_ratio"] = {"value": 0.3, "ci_low": 0.2, "ci_high": 0.4}
        said = reproduce.answer("strata", results)
        self.assertEqual(said, "Strata with jitter are more efficient: the grid is 0.3 [0.2, 0.4] times as efficient "
                               "as jittered strata. More samples do not reduce the bias of `grid` (relMSE 0.5).")
        results["pairs"][0]["efficiency_ratio"] = {"value": 3, "ci_low": 2, "ci_high": 4}
        self.assertIn("Strata without jitter are more efficient", reproduce.answer("strata", results))

    def test_reports_say_where_they_are_and_need_no_network(self):
        with tempfile.TemporaryDirectory() as folder:
            for command, more in (("converge", ["--spp-from", "1", "--spp", "2", "--replicates", "3", "--reference",
                                                "none"]), ("bench", ["--repeats", "2"])):
                report = os.path.join(folder, command)
                done = subprocess.run(
                    [PROGRAM, command, ROOT / "scenes/cornell.json", "--size", "8x8", *more,
                     "--report", report], text=True, capture_output=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                told = re.search(r"^wrote   (\S+), with (\S+) and (\S+)$", done.stdout, re.MULTILINE)
                self.assertTrue(told, done.stdout)
                self.assertEqual(told[1], os.path.join(report, "report.html"))
                for name in (told[1], told[2], told[3]):
                    self.assertTrue(os.path.exists(os.path.join(report, name)), name)
                page = pathlib.Path(told[1]).read_text(encoding="utf-8").replace("http://www.w3.org/", "")  # names of SVG
                self.assertEqual(re.findall(r"https?://|(?:src|href)=['\"](?!#|data:)", page), [], command)

    def test_others_are_refused(self):
        done = self.reproduce("sampler")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no such report; expected some of directions,", done.stderr)


if __name__ == "__main__":
    unittest.main()
