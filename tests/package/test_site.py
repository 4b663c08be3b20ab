#!/usr/bin/env python3
"""Tests the web site of all pages: .ci/site makes it from the files in git, and finds broken links.

Usage: test_site.py SOURCE_ROOT [unittest arguments]; skipped (77) without mkdocs.
"""
import importlib.machinery
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCES = os.path.abspath(sys.argv.pop(1))
SCRIPT = os.path.join(SOURCES, '.ci/site')

if not shutil.which('mkdocs'):
    print('mkdocs is not installed')
    sys.exit(1 if os.environ.get('LAMPYRIS_NO_SKIP') else 77)


def script():
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader('site_of_pages', SCRIPT)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader('site_of_pages', loader))
    loader.exec_module(module)
    return module


class Site(unittest.TestCase):
    def test_all_pages_are_there(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([SCRIPT, folder], text=True, capture_output=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertEqual(done.stdout, f'{folder}/index.html\n')
            names = subprocess.run(['git', '-C', SOURCES, 'ls-files', 'docs/*.md'], check=True, text=True,
                                   stdout=subprocess.PIPE).stdout.split()
            self.assertGreater(len(names), 25)
            for name in names:
                page = name.replace('README.md', 'index.md')[:-2] + 'html'
                self.assertTrue(os.path.exists(os.path.join(folder, page)), name)

    def test_dead_links_are_found(self):
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, 'b'))
            with open(os.path.join(folder, 'a.html'), 'w', encoding='utf-8') as file:
                file.write('<h1 id="here">A</h1><a href="#here">1</a><a href="#there">2</a><a href="b/c.html">3</a>'
                           '<img src="none.png"><a href="https://example.org/none">4</a>')
            with open(os.path.join(folder, 'b', 'c.html'), 'w', encoding='utf-8') as file:
                file.write('<a href="../a.html#here">1</a><a href="../a.html#away">2</a><a href="..">3</a>')
            self.assertEqual(sorted(script().dead_links(folder)),
                             [('a.html', '#there'), ('a.html', 'none.png'), ('b/c.html', '..'),
                              ('b/c.html', '../a.html#away')])

    def test_other_folders_are_kept(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, 'mine.txt'), 'w', encoding='utf-8') as file:
                file.write('kept')
            done = subprocess.run([SCRIPT, folder], text=True, capture_output=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn('holds no site', done.stderr)
            self.assertEqual(os.listdir(folder), ['mine.txt'])


if __name__ == '__main__':
    unittest.main()
