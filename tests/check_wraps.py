#!/usr/bin/python3
"""Checks the libraries that are built if Debian's packages are missing: subprojects/, and what meson.build
requires of them.

check_wraps.py SOURCE_ROOT [unittest's arguments]
"""
import configparser
import glob
import os
import re
import sys
import unittest

ROOT = sys.argv.pop(1)
SUBPROJECTS = os.path.join(ROOT, 'subprojects')


def read(path):
    with open(path) as file:
        return file.read()


def read_wrap(path):
    parser = configparser.ConfigParser(interpolation=None)
    parser.read(path)
    return parser


WRAPS = {os.path.basename(path)[:-len('.wrap')]: read_wrap(path)
         for path in glob.glob(os.path.join(SUBPROJECTS, '*.wrap'))}
# The CMake projects of this tree, which build the sources that a wrap downloads.
BUILDERS = {os.path.basename(path): read(os.path.join(path, 'meson.build'))
            for path in glob.glob(os.path.join(SUBPROJECTS, '*-cmake'))}


def meson_files():
    """Returns the texts of meson.build of this project and of subprojects/packagefiles."""
    paths = [os.path.join(ROOT, 'meson.build')]
    for room in ('src', 'shaders', 'tests'):
        paths += glob.glob(os.path.join(ROOT, room, '**', 'meson.build'), recursive=True)
    return [read(path) for path in paths] + list(BUILDERS.values())


FALLBACKS = {pair for text in meson_files()
             for pair in re.findall(r"fallback:\s*\['([^']+)',\s*'([^']+)'\]", text)}
BUILT_BY_CMAKE = {(builder, name) for builder, text in BUILDERS.items()
                  for name in re.findall(r"\.subproject\('([^']+)'", text)}


def packagefile(name):
    wrap = WRAPS[name]['wrap-git']
    folder = wrap.get('patch_directory')
    return folder and read(os.path.join(SUBPROJECTS, 'packagefiles', folder, 'meson.build'))


def project_version(text):
    return re.search(r"project\([^)]*version: '([^']+)'", text).group(1)


class Wraps(unittest.TestCase):
    def test_fallbacks_have_what_they_name(self):
        self.assertTrue(FALLBACKS)
        for name, variable in FALLBACKS:
            with self.subTest(name):
                self.assertTrue(name in WRAPS or name in BUILDERS)
                text = BUILDERS[name] if name in BUILDERS else packagefile(name)
                if text:  # otherwise the file is upstream's own
                    self.assertRegex(text, rf'(?m)^{variable} = ')

    def test_builders_build_wraps(self):
        for builder, name in BUILT_BY_CMAKE:
            with self.subTest(builder):
                self.assertIn(name, WRAPS)

    def test_everything_is_used(self):
        used = {name for name, _ in FALLBACKS}
        self.assertEqual(set(BUILDERS) - used, set())
        self.assertEqual(set(WRAPS) - used - {name for _, name in BUILT_BY_CMAKE}, set())
        folders = {wrap['wrap-git'].get('patch_directory') for wrap in WRAPS.values()} - {None}
        self.assertEqual(set(os.listdir(os.path.join(SUBPROJECTS, 'packagefiles'))), folders)

    def test_wraps_name_releases(self):
        for name, wrap in WRAPS.items():
            with self.subTest(name):
                self.assertEqual(wrap.sections(), ['wrap-git'])
                self.assertRegex(wrap['wrap-git']['url'], r'^https://github\.com/[^/]+/[^/]+\.git$')
                self.assertRegex(wrap['wrap-git']['revision'], r'^v?\d+(\.\d+)+$')

    def test_versions_are_those_of_the_wraps(self):
        texts = {name: packagefile(name) for name in WRAPS}
        for builder, name in BUILT_BY_CMAKE:
            if builder == name + '-cmake':  # a builder may also need another wrap
                texts[name] = BUILDERS[builder]
        for name, text in texts.items():
            with self.subTest(name):
                if text:
                    revision = WRAPS[name]['wrap-git']['revision']
                    self.assertEqual(project_version(text), revision.lstrip('v'))

    def test_scripts_take_packages_alone(self):
        for script in ('common', 'render', 'test'):
            for line in read(os.path.join(ROOT, '.ci', script)).splitlines():
                if 'meson setup' in line:
                    self.assertIn('--wrap-mode=nofallback', line, script)
        self.assertIn('--wrap-mode=nofallback', read(os.path.join(ROOT, '.ci', 'common')))

    def test_sources_that_wraps_lay_down_stay_out_of_the_tree(self):
        lines = read(os.path.join(ROOT, '.gitignore')).splitlines()
        for line in ('/subprojects/*/', '!/subprojects/*-cmake/', '!/subprojects/packagefiles/'):
            self.assertIn(line, lines)


if __name__ == '__main__':
    unittest.main()
