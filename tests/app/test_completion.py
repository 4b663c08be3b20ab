#!/usr/bin/env python3
"""Tests the completion scripts: their shells can read them, they contain every option, and they complete
words. zsh and fish are tested if they are installed.

Usage: test_completion.py LAMPYRIS [unittest arguments]
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from program import checked, run

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
COMMANDS = ('render', 'merge', 'submit', 'converge', 'bench', 'compare', 'check', 'info', 'view', 'devices',
            'help')


def script(shell, program='lampyris'):
    return checked(LAMPYRIS, 'help', *(['view'] if program == 'lampyris-view' else []),
                   '--completion', shell)


def options(command):
    """Returns the options in the help, with the placeholders of their values."""
    return set(re.findall(r'^  (?:-\w, )?--([\w-]+)', checked(LAMPYRIS, command, '--help-all'),
                          re.MULTILINE))


class Folder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = cls.temporary.name
        for shell in ('bash', 'zsh', 'fish'):
            for program in ('lampyris', 'lampyris-view'):
                with open(os.path.join(cls.folder, f'{program}.{shell}'), 'w', encoding='utf-8') as file:
                    file.write(script(shell, program))
        for name in ('box.json', 'a scene.glb', 'notes.txt'):
            with open(os.path.join(cls.folder, name), 'w', encoding='utf-8'):
                pass
        os.mkdir(os.path.join(cls.folder, 'box'))

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def shell(self, *command):
        result = run(*command, cwd=self.folder, timeout=60, env={**os.environ, 'HOME': self.folder})
        self.assertEqual((result.returncode, result.stderr), (0, ''), command)
        return result.stdout.splitlines()

    def check_syntax(self, shell):
        for program in ('lampyris', 'lampyris-view'):
            self.shell(shell, '-n', f'{program}.{shell}')


class Bash(Folder):
    def complete(self, *words):
        """Returns the completions of the last word."""
        quoted = ' '.join("'" + word + "'" for word in words)
        function = '_' + words[0].replace('-', '_')
        return set(self.shell('bash', '--norc', '-c', f'. ./{words[0]}.bash; COMP_WORDS=({quoted}); '
                              f'COMP_CWORD={len(words) - 1}; {function}; printf "%s\\n" "${{COMPREPLY[@]}}"'))

    def test_it_is_a_script(self):
        self.check_syntax('bash')

    def test_every_option_is_completed(self):
        for command in COMMANDS:
            self.assertEqual({word for word in self.complete('lampyris', command, '--')},
                             {'--' + name for name in options(command)}, command)
        self.assertEqual(self.complete('lampyris-view', '--'), {'--' + name for name in options('view')})

    def test_commands(self):
        self.assertEqual(self.complete('lampyris', ''), set(COMMANDS))
        self.assertEqual(self.complete('lampyris', '--quiet', 'co'), {'converge', 'compare'})
        self.assertEqual(self.complete('lampyris', 'help', 'de'), {'devices'})
        self.assertIn('--log-level', self.complete('lampyris', '--l'))

    def test_values(self):
        self.assertEqual(self.complete('lampyris', 'render', '--sampler', 's'),
                         {'sobol', 'stratified', 'sine'})
        self.assertEqual(self.complete('lampyris', 'render', '--sampler', '=', 'so'), {'sobol'})
        self.assertEqual(self.complete('lampyris', 'render', '--nee', '='), {'on', 'off'})
        self.assertEqual(self.complete('lampyris', 'bench', '--rays', 'primary,d'), {'primary,diffuse'})
        self.assertEqual(self.complete('lampyris', 'render', '--spp', ''), {''})
        self.assertEqual(self.complete('lampyris', 'converge', '--reference', 'n'), {'none', 'notes.txt'})

    def test_files(self):
        self.assertEqual(self.complete('lampyris', 'render', 'b'), {'box', 'box.json'})
        self.assertEqual(self.complete('lampyris', 'render', 'a'), {'a scene.glb'})
        self.assertEqual(self.complete('lampyris', 'render', '--checkpoint', 'n'), {'notes.txt'})
        self.assertEqual(self.complete('lampyris', 'render', '--bvh-cache', ''), {'box'})
        self.assertEqual(self.complete('lampyris-view', 'n'), {'notes.txt'})


@unittest.skipUnless(shutil.which('fish'), 'fish is not installed')
class Fish(Folder):
    def complete(self, line):
        program = line.split()[0]
        return {word.split('\t')[0] for word in self.shell(
            'fish', '--no-config', '-c', f'source {program}.fish; complete -C "{line}"')}

    def test_it_is_a_script(self):
        self.check_syntax('fish')

    def test_every_option_is_completed(self):
        for command in COMMANDS:
            self.assertEqual({word for word in self.complete(f'lampyris {command} --')},
                             {'--' + name for name in options(command)}, command)

    def test_values_and_files(self):
        self.assertEqual(self.complete('lampyris '), set(COMMANDS))
        self.assertEqual(self.complete('lampyris render --sampler so'), {'sobol'})
        self.assertIn('box.json', self.complete('lampyris render b'))
        self.assertEqual(self.complete('lampyris-view --tone a'), {'aces', 'agx'})


@unittest.skipUnless(shutil.which('zsh'), 'zsh is not installed')
class Zsh(Folder):
    def test_it_is_a_script(self):
        self.check_syntax('zsh')

    def test_every_option_is_there(self):
        text = script('zsh')
        for command in COMMANDS:
            branch = re.search(rf'^{command}\)\n(.*?)^  ;;$', text, re.MULTILINE | re.DOTALL).group(1)
            self.assertEqual(set(re.findall(r"[ {,'*]--([\w-]+)=?(?:'?\[|})", branch)), options(command), command)


class Failures(unittest.TestCase):
    def test_usage(self):
        for words in (('--completion', 'tcsh'), ('render', '--completion', 'bash')):
            result = run(LAMPYRIS, 'help', *words)
            self.assertEqual((result.returncode, result.stdout), (2, ''), words)


if __name__ == '__main__':
    unittest.main()
