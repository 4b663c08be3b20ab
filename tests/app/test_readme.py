#!/usr/bin/env python3
"""What README.md and docs/ tell people to type works as it stands there, and what they point to is there.

    test_readme.py LAMPYRIS SOURCE_ROOT [CASE…]

Command lines run by copy and paste, by a shell, one after the other in a folder that has scenes/,
with options behind them that make pictures and times small; later options hold. The shell finds the
programs as .ci/render says.
"""
import glob
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))
BUILD = os.path.dirname(os.path.dirname(os.path.dirname(LAMPYRIS)))
VIEWER = os.path.join(BUILD, 'src/app/viewer/lampyris-view')


def need_device():
    result = subprocess.run([LAMPYRIS, 'devices'], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if result.returncode == 69:
        sys.exit(77)


def read(path):
    with open(os.path.join(ROOT, path), encoding='utf-8') as file:
        return file.read()


def pages():
    return ['README.md', *sorted(os.path.relpath(path, ROOT)
                                 for path in glob.glob(os.path.join(ROOT, 'docs', '*.md')))]


def command_lines(text):
    """Lines of code blocks that call the program, without their comments."""
    text = text.replace('\\\n', ' ')
    lines = re.findall(r'^(?:    )?(lampyris .*)$', text, re.MULTILINE)
    return [re.sub(r'\s+#\s.*$', '', line) for line in lines]


# Scenes whose size is a number of theirs.
FEWER = {'forest.json': '-D trees=200', 'teapot_stadium.json': '-D resolution=4',
         'spheres.json': '-D count=200'}


def small(line):
    """Options that make a command quick without changing what it is."""
    command = shlex.split(line)[1]
    given = lambda *names: any(re.search(r'\s--%s\b' % name, line) for name in names)
    more = []
    if command in ('render', 'converge', 'bench', 'info', 'view') and not given('pixel'):
        more.append('--size 16x12')
    if command == 'render':
        more.append('' if given('frames', 'pixel') else '--spp 2')
        more.append('--time 0.05' if given('time') else '')
    elif command == 'converge':
        more.append('--replicates 3')
        more.append('--times 0.02' if given('times') else '--spp-from 1 --spp 2')
    elif command == 'bench':
        more.append('--time 0.2' if given('tune') else '--repeats 2')
    elif command == 'view':
        more.append('--headless --script end.txt')
    more += [words for name, words in FEWER.items() if name in line and command != 'compare']
    return ' '.join(more)


class Commands(unittest.TestCase):
    """As after .ci/render: its last lines say what to type first."""

    @classmethod
    def setUpClass(cls):
        need_device()
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        for name in ('scenes', 'docs'):
            os.symlink(os.path.join(ROOT, name), os.path.join(cls.folder, name))
        with open(os.path.join(cls.folder, 'end.txt'), 'w', encoding='utf-8') as file:
            file.write('wait 1 samples\n')
        cls.said = cls.run_render_script()

    @classmethod
    def run_render_script(cls):
        """.ci/render on a machine that has everything, in a project that is built."""
        os.mkdir(os.path.join(cls.folder, '.ci'))
        os.mkdir(os.path.join(cls.folder, 'tools'))
        for name in ('render', 'common'):
            os.symlink(os.path.join(ROOT, '.ci', name), os.path.join(cls.folder, '.ci', name))
        for name, words in (('dpkg-query', 'echo install ok installed'), ('meson', 'exit 1'),
                            ('ninja', 'echo "$@" >>ninja.txt')):
            path = os.path.join(cls.folder, 'tools', name)
            with open(path, 'w', encoding='utf-8') as file:
                file.write(f'#!/bin/sh\n{words}\n')
            os.chmod(path, 0o755)
        os.symlink(BUILD, os.path.join(cls.folder, 'build'))
        tools = os.path.join(cls.folder, 'tools')
        return subprocess.run(
            ['.ci/render', 'scenes/cornell.json', '--size', '16x16', '--spp', '1'], cwd=cls.folder,
            env={**os.environ, 'PATH': tools + ':' + os.environ['PATH']},
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120)

    def shell(self, line):
        path = [words for words in self.said.stdout.splitlines() if 'export PATH=' in words]
        return subprocess.run(
            ['sh', '-c', f'{path[0].strip()}\n{line}'], cwd=self.folder, text=True, timeout=120,
            env={**os.environ, 'HOME': self.folder, 'PATH': '/usr/bin:/bin'},
            stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def run_lines(self, page):
        lines = command_lines(read(page))
        for line in lines:
            if line.startswith('lampyris view') and not os.path.exists(VIEWER):
                continue
            # Redirections end a line.
            words, arrow, file = line.partition(' > ')
            result = self.shell(f'{words} {small(words)}{arrow}{file}')
            # A limit that tiny pictures miss, or a time that a busy machine does, is no failure.
            fine = (0, 1) if re.search(r' --(max|min|baseline)\b', line) else (0,)
            self.assertIn(result.returncode, fine, f'{page}: {line}\n{result.stderr}')
        return len(lines)

    def test_the_render_script_ends_with_what_to_do(self):
        self.assertEqual(self.said.returncode, 0, self.said.stderr)
        with open(os.path.join(self.folder, 'ninja.txt'), encoding='utf-8') as file:
            self.assertEqual(file.read().split(), ['-C', 'build', 'programs'])
        self.assertTrue(os.path.exists(os.path.join(self.folder, 'cornell.exr')))
        self.assertEqual(self.said.stdout.count('export PATH='), 1)
        self.assertIn('meson install', self.said.stdout)
        # The same line as in the README.
        self.assertIn('export PATH="$PWD/build/src/app:$PATH"', read('README.md'))
        line = next(l for l in self.said.stdout.splitlines() if 'export PATH=' in l).strip()
        self.assertEqual(line.replace(os.path.realpath(self.folder), '$PWD'),
                         'export PATH="$PWD/build/src/app:$PATH"')

    def test_by_name(self):
        self.assertRegex(self.shell('lampyris --version').stdout, r'^lampyris \d')

    @unittest.skipUnless(os.path.exists(VIEWER), 'the viewer is not built')
    def test_the_viewer_is_found(self):
        result = self.shell('lampyris view scenes/cornell.json --size 16x12 --headless '
                            '--script end.txt')
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_readme(self):
        self.assertGreater(self.run_lines('README.md'), 20)

    def test_docs(self):
        self.assertGreater(sum(self.run_lines(page) for page in pages() if page != 'README.md'), 20)


class Pages(unittest.TestCase):
    def test_links_lead_somewhere(self):
        for page in [*pages(), 'scenes/README.md', 'docs/reports/README.md']:
            for target in re.findall(r'\]\(([^)\s]+)\)', read(page)):
                if re.match(r'\w+:', target):
                    continue
                path = os.path.join(ROOT, os.path.dirname(page), target.partition('#')[0])
                self.assertTrue(target.startswith('#') or os.path.exists(path), f'{page}: {target}')

    def test_files_that_are_named_are_there(self):
        # README names files in code, too.
        for path in re.findall(r'`((?:src|docs|scenes|shaders|tests|\.ci)/[^`\s]*)`',
                               read('README.md')):
            self.assertTrue(os.path.exists(os.path.join(ROOT, path)), path)


class Models(unittest.TestCase):
    def test_they_are_what_the_script_computes(self):
        # Other libraries of mathematics may round the last digit in another way.
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([os.path.join(ROOT, 'scenes/models/generate'), folder], check=True)
            for name in sorted(os.listdir(folder)):
                with open(os.path.join(folder, name), 'rb') as file:
                    made = file.read()
                with open(os.path.join(ROOT, 'scenes/models', name), 'rb') as file:
                    kept = file.read()
                self.assertEqual(len(made), len(kept), name)
                other = sum(a != b for a, b in zip(made, kept))
                self.assertLess(other, len(kept) // 1000, name)


class Programs(unittest.TestCase):
    def test_they_are_built_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            setup = subprocess.run(['meson', 'setup', folder, ROOT, '-Dtests=disabled'],
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.assertEqual(setup.returncode, 0, setup.stdout)
            for targets in ([], ['programs']):
                told = subprocess.run(['ninja', '-C', folder, '-n', *targets], check=True,
                                      stdout=subprocess.PIPE, text=True).stdout
                steps = int(re.findall(r'^\[\d+/(\d+)\]', told, re.MULTILINE)[-1])
                self.assertLess(steps, 400)
                self.assertNotIn('tests/', told)


class Claims(unittest.TestCase):
    """docs/claims.md: which tests hold what the README claims."""

    def test_the_named_tests_exist(self):
        listed = subprocess.run(['meson', 'introspect', '--tests', BUILD], check=True,
                                stdout=subprocess.PIPE, text=True).stdout
        known = {test['name'] for test in json.loads(listed)}
        rows = [row for row in re.findall(r'^\| (.+?) \| (.+?) \|$', read('docs/claims.md'),
                                          re.MULTILINE) if row[0] != 'claim']
        self.assertGreater(len(rows), 20)
        for claim, tests in rows:
            names = re.findall(r'`([^`]+)`', tests)
            self.assertTrue(names, claim)
            for name in names:
                if name.startswith('viewer') and not os.path.exists(VIEWER):
                    continue
                self.assertTrue(name in known, f'{claim}: there is no test {name!r}')

    def test_every_claim_of_the_readme_is_there(self):
        # The table of the README's first screen: its left column, word for word.
        table = re.findall(r'^\| \*\*(.+?)\*\*', read('README.md'), re.MULTILINE)
        self.assertGreater(len(table), 5)
        claims = read('docs/claims.md')
        for claim in table:
            self.assertIn(f'| {claim} |', claims)


if __name__ == '__main__':
    unittest.main()
