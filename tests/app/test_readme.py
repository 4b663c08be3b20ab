#!/usr/bin/env python3
"""The commands in README.md and docs/ work as they are written there, and the files that these pages name
exist.

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

from program import need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))
BUILD = os.path.dirname(os.path.dirname(os.path.dirname(LAMPYRIS)))
VIEWER = os.path.join(BUILD, 'src/viewer/lampyris-view')
RANKS = os.path.join(BUILD, 'src/cli/lampyris-mpi')


def read(path):
    with open(os.path.join(ROOT, path), encoding='utf-8') as file:
        return file.read()


def pages():
    return ['README.md', *sorted(os.path.relpath(path, ROOT)
                                 for folder in ('docs', 'docs/measurements')
                                 for path in glob.glob(os.path.join(ROOT, folder, '*.md')))]


def command_lines(text):
    """Returns the lines of code blocks that call the program, without their comments, and the cells of tables
    whose header is "command"."""
    text = text.replace('\\\n', ' ')
    lines = re.findall(r'^(?:    )?(lampyris .*)$', text, re.MULTILINE)
    for table in re.findall(r'^\|.*\| command \|.*\n(?:\|.*\n)+', text, re.MULTILINE):
        lines += [line.replace('\\|', '|') for line in re.findall(r'`(lampyris [^`]*)`', table)]
    return [re.sub(r'\s+#\s.*$', '', line) for line in lines]


# Scenes whose cost depends on a number in the file.
FEWER = {'forest.json': '-D trees=200', 'teapot_stadium.json': '-D resolution=4',
         'spheres.json': '-D count=200', 'figures.json': '-D dragon_triangles=2000'}


def small(line):
    """Returns options that make a command fast without changing its meaning."""
    command = shlex.split(line)[1]
    given = lambda *names: any(re.search(r'\s--%s\b' % name, line) for name in names)
    more = []
    if command in ('render', 'converge', 'bench', 'info', 'view') and not given('pixel'):
        more.append('--size 16x12')
    if command == 'render':
        more.append('' if given('frames', 'pixel') else '--spp 8' if given('shard') else '--spp 2')
        more.append('--time 0.05' if given('time') else '')
    elif command == 'converge':
        more.append('--replicates 3')
        more.append('--times 0.02' if given('times') else '--spp-from 1 --spp 2')
    elif command == 'bench':
        more.append('--repeats 2')
    elif command == 'view':
        more.append('--headless --script end.txt')
    more += [words for name, words in FEWER.items() if name in line and command != 'compare']
    return ' '.join(more)


class Commands(unittest.TestCase):
    """The commands run after .ci/render, whose last lines say what to type first."""

    @classmethod
    def setUpClass(cls):
        need_device(LAMPYRIS)
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
        """Runs .ci/render as on a machine with all packages, in a project that is built."""
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
            # A redirection ends the command line.
            words, arrow, file = line.partition(' > ')
            result = self.shell(f'{words} {small(words)}{arrow}{file}')
            # Tiny pictures may exceed a limit, and a busy machine may be slower than a baseline; neither is a
            # failure.
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
        # The README contains the same line.
        self.assertIn('export PATH="$PWD/build/src/cli:$PATH"', read('README.md'))
        line = next(l for l in self.said.stdout.splitlines() if 'export PATH=' in l).strip()
        self.assertEqual(line.replace(os.path.realpath(self.folder), '$PWD'),
                         'export PATH="$PWD/build/src/cli:$PATH"')

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


class Experiments(unittest.TestCase):
    """The commands of docs/experiments.md at full size; class Commands runs smaller ones."""

    def test_all_run(self):
        need_device(LAMPYRIS)
        lines = command_lines(read('docs/experiments.md'))
        self.assertGreater(len(lines), 15)
        with tempfile.TemporaryDirectory() as folder:
            for name in ('scenes', 'docs'):
                os.symlink(os.path.join(ROOT, name), os.path.join(folder, name))
            path = os.path.dirname(LAMPYRIS) + ':/usr/bin:/bin'
            for line in lines:
                result = subprocess.run(['sh', '-c', line], cwd=folder, timeout=1200, text=True,
                                        env={**os.environ, 'HOME': folder, 'PATH': path},
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                self.assertEqual(result.returncode, 0, f'{line}\n{result.stderr}')


class Pages(unittest.TestCase):
    def test_links_lead_somewhere(self):
        for page in [*pages(), 'scenes/README.md', 'tests/README.md', 'docs/reports/README.md']:
            for target in re.findall(r'\]\(([^)\s]+)\)', read(page)):
                if re.match(r'\w+:', target):
                    continue
                path = os.path.join(ROOT, os.path.dirname(page), target.partition('#')[0])
                self.assertTrue(target.startswith('#') or os.path.exists(path), f'{page}: {target}')

    def test_files_that_are_named_are_there(self):
        # The README also mentions files in code.
        for path in re.findall(r'`((?:src|docs|scenes|shaders|tests|\.ci)/[^`\s]*)`',
                               read('README.md')):
            self.assertTrue(os.path.exists(os.path.join(ROOT, path)), path)


class Models(unittest.TestCase):
    def test_they_are_what_the_script_computes(self):
        # Other mathematical libraries may round the last digit differently.
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
                self.assertLess(steps, 660)  # with tests there are 1293
                self.assertNotIn('tests/', told)


def introspect(what):
    return json.loads(subprocess.run(['meson', 'introspect', what, BUILD], check=True,
                                     stdout=subprocess.PIPE, text=True).stdout)


def is_optional(name):
    """Returns whether a test exists only with the viewer, with MPI, with Embree or in builds by clang."""
    return name == 'bvh_embree' or name.startswith('fuzz ') or \
        name.startswith('app ranks') and not os.path.exists(RANKS) or \
        name.startswith('viewer') and not os.path.exists(VIEWER)


class Claims(unittest.TestCase):
    """The tests that docs/claims.md names for the README's claims exist."""

    def test_the_named_tests_exist(self):
        known = {test['name'] for test in introspect('--tests')}
        rows = [row for row in re.findall(r'^\| (.+?) \| (.+?) \|$', read('docs/claims.md'),
                                          re.MULTILINE) if row[0] != 'claim']
        self.assertGreater(len(rows), 20)
        for claim, tests in rows:
            names = re.findall(r'`([^`]+)`', tests)
            self.assertTrue(names, claim)
            for name in names:
                self.assertTrue(name in known or is_optional(name),
                                f'{claim}: there is no test {name!r}')

    def test_every_claim_of_the_readme_is_there(self):
        # The left column of the README's first table must have the same words.
        table = re.findall(r'^\| \*\*(.+?)\*\*', read('README.md'), re.MULTILINE)
        self.assertGreater(len(table), 5)
        claims = read('docs/claims.md')
        for claim in table:
            self.assertIn(f'| {claim} |', claims)


class Program:
    """Tests that meson runs with one program: their sources, and the arguments of each run."""

    def __init__(self, sources):
        self.sources = sources
        self.runs = []


class Verification(unittest.TestCase):
    """The numbers, tests and cases that docs/verification.md names exist, and so does everything it cites."""

    @classmethod
    def setUpClass(cls):
        sources = {}
        for target in introspect('--targets'):
            for path in target['filename']:
                sources[path] = [source for group in target['target_sources']
                                 for source in group['sources']]
        cls.programs, cls.by_test, cls.suites = {}, {}, set()
        for test in introspect('--tests'):
            command = [os.path.join(BUILD, word) if os.path.join(BUILD, word) in sources else word
                       for word in test['cmd']]
            cls.by_test[test['name']] = []
            cls.suites |= {suite.rpartition(':')[2] for suite in test['suite']}
            for i, word in enumerate(command):
                if word in sources or word.endswith('.py'):
                    program = cls.programs.setdefault(word, Program(sources.get(word, [word])))
                    program.runs.append(command[i + 1:])
                    cls.by_test[test['name']].append(program)
        cls.rows = re.findall(r'^\| ([A-Z]\d+) \|.*\| ([^|]*) \|$', read('docs/verification.md'),
                              re.MULTILINE)
        cls.numbers = [number for number, _ in cls.rows]

    @staticmethod
    def own_files(*folders):
        for folder in folders:
            for path, _, names in os.walk(os.path.join(ROOT, folder)):
                for name in names:
                    if name.endswith(('.c', '.h', '.cpp', '.glsl', '.comp', '.py', 'meson.build')):
                        yield os.path.relpath(os.path.join(path, name), ROOT)

    @staticmethod
    def cases_of(program, pattern):
        found = set()
        for path in program.sources:
            if path.endswith(('.c', '.py')) and os.path.exists(path):
                found |= set(re.findall(pattern, read(path), re.MULTILINE))
        return found

    def test_each_number_stands_once(self):
        self.assertGreater(len(self.rows), 120)
        for number in self.numbers:
            self.assertEqual(self.numbers.count(number), 1, number)
        for group in sorted({number[0] for number in self.numbers}):
            of_group = [int(number[1:]) for number in self.numbers if number[0] == group]
            self.assertEqual(of_group, list(range(1, len(of_group) + 1)), group)

    def test_the_named_tests_and_cases_exist(self):
        for number, tests in self.rows:
            names = re.findall(r'`([^`]+)`', tests)
            self.assertTrue(names or tests == 'not yet', f'{number} names no test')
            cases = set()
            for name in names:
                self.assertTrue(name in self.by_test or is_optional(name),
                                f'{number}: there is no test {name!r}')
                for program in self.by_test.get(name, []):
                    cases |= self.cases_of(program, r'^TEST\((\w+)\)|^    def (test_\w+)')
            known = {word for case in cases for word in case}
            for case in re.findall(r'\*(\w+)\*', tests):
                self.assertTrue(case in known or any(map(is_optional, names)),
                                f'{number}: {names} have no case {case!r}')

    def test_what_is_cited_is_there(self):
        cited = 0
        for path in self.own_files('src', 'shaders', 'tests'):
            text = re.sub(r'\n *(//|#|\*) *', ' ', read(path))
            for numbers in re.findall(r'docs/verification\.md, ((?:[A-Z]\d+(?:,? and |, )?)+)', text):
                for number in re.findall(r'[A-Z]\d+', numbers):
                    cited += 1
                    self.assertIn(number, self.numbers, path)
            if path != 'tests/app/test_readme.py':
                self.assertNotRegex(text, r'(?<!docs/)verification\.md|[Ss]tiff case', path)
        self.assertGreater(cited, 25)

    def test_what_the_design_refers_to_is_there(self):
        groups = {number[0] for number in self.numbers}
        cited = re.findall(r'\[([A-Z]\d*(?:(?:, | to )[A-Z]\d*)*)\]', read('docs/design.md'))
        self.assertGreater(len(cited), 10)
        for name in ' '.join(cited).replace(',', '').split():
            if name != 'to':
                self.assertIn(name, groups if len(name) == 1 else self.numbers)

    def test_forms_are_named_by_their_numbers(self):
        forms = 0
        for path in glob.glob(os.path.join(ROOT, 'src/check/*.c')):
            for number in re.findall(r'^ .*(?:FORM\(|FORM, |LAMP\(|\{)"([A-Z]\d+)a? ', read(path), re.MULTILINE):
                forms += 1
                self.assertIn(number, self.numbers, path)
        for number in re.findall(r'^    \{"(\d+) ', read('tests/render/test_surroundings.c'), re.MULTILINE):
            forms += 1
            self.assertIn('B' + number, self.numbers, 'test_surroundings.c')
        self.assertGreater(forms, 100)

    def test_pages_that_are_cited_are_there(self):
        for path in self.own_files('src', 'shaders', 'tests', 'include'):
            for page in re.findall(r'\bdocs/[\w-]+\.md\b', read(path)):
                self.assertTrue(os.path.exists(os.path.join(ROOT, page)), f'{path}: {page}')

    def test_the_page_of_tests_names_what_is_there(self):
        page = read('tests/README.md')
        for name in re.findall(r'`([\w/]+\.(?:h|c|py|comp|md))`', page):
            found = [path for folder in ('', 'tests', 'tests/*', 'docs')
                     for path in glob.glob(os.path.join(ROOT, folder, name))]
            self.assertTrue(found or 'MODULE' in name, name)
        for suite in re.findall(r'^\| `(\w+)` \|', page.partition('## Where')[0], re.MULTILINE):
            if not suite.startswith('LAMPYRIS'):
                self.assertTrue(suite in self.suites or suite in ('viewer', 'fuzz'), suite)

    def test_every_case_is_run(self):
        # Without arguments, a program runs all cases except those whose names end in _long.
        for program in self.programs.values():
            for case in self.cases_of(program, r'TEST_CASE\((\w+)\)'):
                self.assertTrue(any(case in run or not run and not case.endswith('_long')
                                    for run in program.runs),
                                f'{program.sources[0]}: no test of meson runs {case}')


if __name__ == '__main__':
    unittest.main()
