"""docs/reports: do the commands run, is the table that of the results, and do the words follow from it?

test_reports.py PROGRAM
"""

import importlib.machinery
import importlib.util
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
loader = importlib.machinery.SourceFileLoader("reproduce", str(REPRODUCE))
reproduce = importlib.util.module_from_spec(importlib.util.spec_from_loader("reproduce", loader))
loader.exec_module(reproduce)


def exchanged(results):
    """The same results, with the labels of the first and the last curve or variant exchanged; those of
    a single one with ten times the speed."""
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
        # What every section says, against the cells of its table.
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
            if re.search("biase[ds]|a bias of", words):
                self.assertNotEqual(biased, [], section)
            for row in biased:
                self.assertRegex(words, "bias", section)
                self.assertNotRegex(words, "No bias was found in (either|any)", section)
            best = re.match(r"`(\S+)` is the most efficient", words)
            if best:
                verdicts = {row[0].partition("=")[2]: row[4] for row in rows}
                self.assertIn(verdicts.pop(best[1]), ("", "faster"), section)
                self.assertNotEqual(set(verdicts.values()), {"faster"}, section)
            if words.startswith("Not told apart"):
                self.assertEqual({row[4] for row in rows[1:]}, {"not told apart"}, section)
            # An interval holds its value.
            for value, low, high in re.findall(r"([\d.e-]+) \[([\d.e-]+), ([\d.e-]+)\]", words):
                self.assertLessEqual(float(low), float(value), section)
                self.assertLessEqual(float(value), float(high), section)

    def test_other_figures_make_other_words(self):
        # The figures of the first curve or variant and of the last one exchanged.
        for name, _, _ in reproduce.REPORTS:
            results = reproduce.load(name)
            said = reproduce.answer(name, results)
            self.assertNotEqual(reproduce.answer(name, exchanged(results)), said, name)

    def test_a_grid_that_is_told_worse_and_biased(self):
        results = reproduce.load("strata")
        self.assertIn("Not told apart", reproduce.answer("strata", results))
        grid = results["curves"][1]
        grid["biased"], grid["bias"] = True, {"value": 0.5, "ci_low": 0.4, "ci_high": 0.6}
        results["pairs"][0]["efficiency_ratio"] = {"value": 0.3, "ci_low": 0.2, "ci_high": 0.4}
        said = reproduce.answer("strata", results)
        self.assertEqual(said, "With jitter: the grid has 0.3 [0.2, 0.4] of the efficiency. Biased, "
                               "which no number of samples mends: `grid` by 0.5.")
        results["pairs"][0]["efficiency_ratio"] = {"value": 3, "ci_low": 2, "ci_high": 4}
        self.assertIn("Without jitter", reproduce.answer("strata", results))

    def test_reports_say_where_they_are(self):
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

    def test_others_are_refused(self):
        done = self.reproduce("sampler")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no such report; expected some of directions,", done.stderr)

    def test_reports_need_no_network(self):
        for page in (ROOT / "docs/reports").glob("*/report.html"):
            text = page.read_text(encoding="utf-8").replace("http://www.w3.org/", "")  # SVG's names
            outside = re.findall(r"https?://|(?:src|href)=['\"](?!#|data:)", text)
            self.assertEqual(outside, [], page)


if __name__ == "__main__":
    unittest.main()
