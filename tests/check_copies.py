#!/usr/bin/python3
"""Functions for vectors exist only once: products, lengths and conversions of three components are not
written by hand outside src/base/maths.h or, in single precision, outside cglm. Only cglm's functions for
three components are used, because the others round differently on machines with other instructions.

check_copies.py SOURCE_ROOT [unittest's arguments]
"""
import glob
import os
import re
import sys
import unittest

ROOT = sys.argv.pop(1)
HOME = os.path.join('src', 'base', 'maths.h')
PATTERNS = {
    'a cross product': r'\[\(\w+ \+ 1\) % 3\] \*\s.*\[\(\w+ \+ 2\) % 3\]|\[1\] \* \w+\[2\] - ',
    'a scalar product': r'(\S+)\[0\] \* (\S+)\[0\]\s\+\s\1\[1\] \* \2\[1\]\s\+\s\1\[2\] \* \2\[2\]',
    'a length': r'sqrt\((\w) \* \1 \+ (\w) \* \2 \+ (\w) \* \3\)|hypot\(hypot\(',
}


def copies(text):
    return [(text[:match.start()].count('\n') + 1, what)
            for what, pattern in PATTERNS.items() for match in re.finditer(pattern, text)]


class Copies(unittest.TestCase):
    def test_there_are_none(self):
        for path in glob.glob(os.path.join(ROOT, 'src', '**', '*.[ch]'), recursive=True):
            name = os.path.relpath(path, ROOT)
            with open(path) as file, self.subTest(name):
                self.assertEqual(copies(file.read()) if name != HOME else [], [])

    def test_cglm_is_used_where_it_is_scalar(self):
        used = set()
        for room in ('src', 'tests'):
            for path in glob.glob(os.path.join(ROOT, room, '**', '*.[ch]'), recursive=True):
                with open(path) as file:
                    used.update(re.findall(r'#include <(cglm/[^>]+)>', file.read()))
        self.assertEqual(used, {'cglm/vec3.h', 'cglm/struct/vec3.h'})

    def test_the_home_has_them_all(self):
        with open(os.path.join(ROOT, HOME)) as file:
            self.assertEqual({what for _, what in copies(file.read())}, set(PATTERNS))


if __name__ == '__main__':
    unittest.main()
