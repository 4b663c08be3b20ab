"""docs/reports: do the commands run, and is the table that of the results?

test_reports.py PROGRAM
"""

import os
import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
REPRODUCE = ROOT / "docs/reports/reproduce"
PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())


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
