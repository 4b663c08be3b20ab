#!/usr/bin/python3
"""Tests the installed library: its symbols, its header, and a program outside the tree.

test_interface.py SOURCE_ROOT BUILD_ROOT [--write] [unittest's arguments]. --write keeps the interface
as it is now in interface.txt: callers that were compiled before then may have to be compiled again, so
the changelog says what changed.
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest

import program

HERE = os.path.dirname(os.path.abspath(__file__))
KEPT = os.path.join(HERE, 'interface.txt')


def run(*command, **more):
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False,
                            **more)
    if result.returncode != 0:
        raise AssertionError(f'{" ".join(command)}\n{result.stdout}{result.stderr}')
    return result.stdout


def header():
    return os.path.join(SOURCES, 'include', 'lampyris', 'lampyris.h')


def interface():
    """Returns the declarations of the header, one per line, without comments and preprocessor directives."""
    with open(header(), encoding='utf-8') as file:
        text = re.sub(r'//[^\n]*', '', file.read())
    text = re.sub(r'#ifdef __cplusplus.*?#endif', '', text, flags=re.DOTALL)
    text = re.sub(r'^#(.*\\\n)*.*\n', '', text, flags=re.MULTILINE).replace('LAMPYRIS_API ', '')
    declarations = re.findall(r'(?:[^;{]|\{[^}]*\})+;', text)
    return [re.sub(r'\s+', ' ', each).strip() for each in declarations]


class Interface(unittest.TestCase):
    def test_the_interface_is_as_it_was(self):
        with open(KEPT, encoding='utf-8') as file:
            kept = file.read().splitlines()
        self.assertGreater(len(kept), 40)
        self.maxDiff = None
        self.assertEqual(interface(), kept, 'python3 tests/library/test_interface.py SOURCE_ROOT '
                         'BUILD_ROOT --write keeps the new one')

    def test_public_names_alone_are_visible(self):
        listed = run('nm', '-D', '--defined-only', '-P', LIBRARY)
        names = {re.sub('@.*', '', line.split()[0]) for line in listed.splitlines()}
        declared = {name for line in interface() for name in re.findall(r'(lampyris_\w+)\(', line)}
        self.assertGreater(len(declared), 25)
        self.assertEqual(names - {'LAMPYRIS_0'}, declared)

    def test_the_soname_has_the_version(self):
        dynamic = run('objdump', '-p', LIBRARY)
        self.assertRegex(dynamic, r'SONAME +liblampyris\.so\.\d')
        self.assertNotRegex(dynamic, r'NEEDED +lib(glfw|imgui|volk|X11)')

    def test_the_header_stands_alone(self):
        for compiler, language, standard in (('cc', 'c', 'c11'), ('c++', 'c++', 'c++17')):
            run(compiler, '-x', language, f'-std={standard}', '-pedantic', '-Wall', '-Wextra', '-Werror',
                '-fsyntax-only', header())

    def test_no_global_state_of_the_process_is_touched(self):
        used = set(re.findall(r'U (\w+)', run('nm', '-D', LIBRARY)))
        self.assertIn('malloc', used)
        for name in ('exit', '_exit', 'abort', 'setlocale', 'chdir', 'setenv', 'putenv', 'umask', 'fork',
                     'system', 'json_set_alloc_funcs'):
            self.assertNotIn(name, used)


class Installed(unittest.TestCase):
    """Builds a program outside the tree with an installed library."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.root = os.path.join(cls.folder.name, 'root')
        run('meson', 'install', '-C', BUILD, '--no-rebuild', '--quiet', '--destdir', cls.root)
        found = [folder for folder, _, names in os.walk(cls.root) if 'lampyris.pc' in names]
        assert len(found) == 1, found
        cls.environment = {**os.environ, 'PKG_CONFIG_PATH': found[0], 'PKG_CONFIG_SYSROOT_DIR': cls.root,
                           'LD_LIBRARY_PATH': os.path.dirname(found[0])}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def build(self, *flags):
        source, program_path = (os.path.join(self.folder.name, name) for name in ('client.c', 'client'))
        with open(os.path.join(HERE, 'client.c'), encoding='utf-8') as file:
            text = file.read()
        with open(source, 'w', encoding='utf-8') as file:
            file.write(text)
        options = run('pkg-config', '--cflags', '--libs', 'lampyris', env=self.environment).split()
        run('cc', '-std=c11', '-g', *flags, source, '-o', program_path, *options, env=self.environment)
        return program_path

    def use(self, client):
        scene = os.path.join(SOURCES, 'scenes', 'cornell.json')
        picture, other = (os.path.join(self.folder.name, name) for name in ('client.exr', 'program.exr'))
        said = run(client, scene, picture, env=self.environment)
        self.assertRegex(said, r'^local relMSE 0\.\d+ \(0\.\d+ to 0\.\d+\), .* hash [0-9a-f]{16}\n$')
        expected = program.checked(LAMPYRIS, 'render', scene, '--spp', '16', '--size', '64x64', '-o', other,
                                   '--json')
        self.assertIn(f'"image_hash": "{said.split()[-1]}"', expected)
        compared = program.run(LAMPYRIS, 'compare', picture, other, '--max', 'mse=0')
        self.assertEqual(compared.returncode, 0, compared.stdout + compared.stderr)

    def test_a_program_is_built_and_renders(self):
        program.need_device(LAMPYRIS)
        client = self.build('-Wall', '-Wextra', '-Werror')
        self.use(client)
        missing = subprocess.run([client, 'none.json', 'x.exr'], stderr=subprocess.PIPE, text=True,
                                 env=self.environment, check=False)
        self.assertEqual(missing.returncode, 2)
        self.assertIn('none.json: ', missing.stderr)

    def test_with_the_address_sanitizer(self):
        program.need_device(LAMPYRIS)
        self.use(self.build('-fsanitize=address,undefined', '-fno-sanitize-recover=all',
                            os.path.join(SOURCES, 'tests', 'gpu', 'driver_leaks.c')))


if __name__ == '__main__':
    SOURCES, BUILD = (os.path.abspath(path) for path in sys.argv[1:3])
    LIBRARY = os.path.join(BUILD, 'src', 'library', 'liblampyris.so')
    LAMPYRIS = os.path.join(BUILD, 'src', 'cli', 'lampyris')
    if sys.argv[3:] == ['--write']:
        with open(KEPT, 'w', encoding='utf-8') as kept_file:
            kept_file.write('\n'.join(interface()) + '\n')
        sys.exit(0)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
