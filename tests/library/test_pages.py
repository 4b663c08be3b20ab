#!/usr/bin/python3
"""Runs the examples of docs/library.md and docs/python.md as they are written there: `test_pages.py LAMPYRIS
SOURCE_ROOT BUILD_ROOT`."""
import os
import re
import subprocess
import sys
import tempfile
import unittest

import program

LAMPYRIS, SOURCES, BUILD = (os.path.abspath(sys.argv.pop(1)) for _ in range(3))
LIBRARY = os.path.join(BUILD, 'src', 'library')


def examples(page, language):
    with open(os.path.join(SOURCES, 'docs', page), encoding='utf-8') as file:
        return re.findall(rf'^## ([^\n]*)\n(?:(?!^## ).)*?^```{language}\n(.*?)^```', file.read(),
                          re.MULTILINE | re.DOTALL)


class Pages(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        os.symlink(os.path.join(SOURCES, 'scenes'), os.path.join(self.folder, 'scenes'))

    def run_here(self, title, *command, **more):
        result = subprocess.run(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                check=False, **more)
        self.assertEqual(result.returncode, 0, f'{title}\n{result.stdout}')
        return result.stdout

    def build_and_run(self, title, text):
        source = os.path.join(self.folder, 'example.c')
        with open(source, 'w', encoding='utf-8') as file:
            file.write(text)
        self.run_here(title, 'cc', '-std=c11', '-Wall', '-Wextra', '-Werror', source, '-I',
                      os.path.join(SOURCES, 'include'), '-L', LIBRARY, '-llampyris', '-lm',
                      f'-Wl,-rpath,{LIBRARY}', '-o', os.path.join(self.folder, 'example'))
        return self.run_here(title, './example')

    def test_library(self):
        found = examples('library.md', 'c')
        self.assertEqual(len(found), 5)
        for title, text in found:
            with self.subTest(title):
                self.build_and_run(title, text)
        self.assertTrue({'box.exr', 'waves.png'} <= set(os.listdir(self.folder)))

    def run_python(self, prologue):
        found = examples('python.md', 'python')
        self.assertEqual(len(found), 5)
        environment = {**os.environ, 'PYTHONPATH': os.path.join(BUILD, 'python'), 'PYTHONDONTWRITEBYTECODE': '1'}
        for title, text in found:
            with self.subTest(title):
                self.run_here(title, sys.executable, '-X', 'dev', '-c', prologue + text, env=environment)
        self.assertTrue({'box.exr', 'box.png', 'waves.png'} <= set(os.listdir(self.folder)))

    def test_python(self):
        self.run_python('')

    def test_python_without_numpy(self):
        self.run_python('import sys; sys.modules["numpy"] = None\n')

    def test_the_first_examples_and_the_program_agree(self):
        (title, text), *_ = examples('python.md', 'python')
        environment = {**os.environ, 'PYTHONPATH': os.path.join(BUILD, 'python')}
        said = self.run_here(title, sys.executable, '-B', '-c', text, env=environment)
        said += self.build_and_run(*examples('library.md', 'c')[0])
        told = program.checked(LAMPYRIS, 'render', 'scenes/cornell.json', '--spp', '32', '--size', '96x96', '-o',
                               'program.exr', '--json', cwd=self.folder)
        expected = re.search('"image_hash": "([0-9a-f]{16})"', told).group(1)
        self.assertEqual(re.findall(r'(?<![.\w])[0-9a-f]{16}\b', said), [expected, expected], said)

    def test_readme(self):
        with open(os.path.join(SOURCES, 'README.md'), encoding='utf-8') as file:
            text, = re.findall(r'^```python\n(.*?)^```', file.read(), re.MULTILINE | re.DOTALL)
        environment = {**os.environ, 'PYTHONPATH': os.path.join(BUILD, 'python')}
        said = self.run_here('README.md', sys.executable, '-B', '-c', text, env=environment)
        self.assertRegex(said, r'^local relMSE .* lampyris render scenes/cornell.json -D ')


if __name__ == '__main__':
    program.need_device(LAMPYRIS)
    unittest.main()
