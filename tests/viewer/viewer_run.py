"""Runs lampyris-view with a script in a folder of its own. The tests of the viewer share this file.

    test_X.py LAMPYRIS VIEWER SOURCE_ROOT [CASE…]
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

from program import FolderCase, need_device

LAMPYRIS = os.path.abspath(sys.argv.pop(1))
VIEWER = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.abspath(sys.argv.pop(1))
SCENES = os.path.join(ROOT, 'scenes')
CORNELL = os.path.join(SCENES, 'cornell.json')
SPHERES = os.path.join(SCENES, 'spheres.json')
DATA = os.path.join(os.path.dirname(ROOT), 'shared', 'data')
SIZE = '160x90'
# Viewers with a window keep a list of recent scenes; that of the user stays as it is.
STATE = tempfile.TemporaryDirectory()
os.environ['XDG_STATE_HOME'] = STATE.name


class Result:
    def __init__(self, process, folder):
        self.code = process.returncode
        self.out = process.stdout
        self.err = process.stderr
        self.folder = folder

    def path(self, name):
        return os.path.join(self.folder, name)

    def state(self, name='state.json'):
        with open(self.path(name), encoding='utf-8') as file:
            return json.load(file)

    def hashes(self, name='hash.jsonl'):
        with open(self.path(name), encoding='utf-8') as file:
            return [json.loads(line) for line in file]

    def report(self):
        return json.loads(self.out)


class Case(FolderCase):
    """The viewer runs in the test's folder."""

    def write(self, name, text):
        with open(self.path(name), 'w', encoding='utf-8') as file:
            file.write(text)
        return self.path(name)

    def scene(self, name='cornell.json'):
        """Copies a scene so that it can be changed."""
        return shutil.copy(os.path.join(SCENES, name), self.path(name))

    def command(self, script, *arguments, scene=CORNELL, size=SIZE, window=False, validation=True):
        self.write('script.txt', script)
        command = [VIEWER, *([scene] if scene else []), '--size', size, '--script', 'script.txt']
        command += [] if window else ['--headless']
        command += ['--validation'] if validation else []
        return [*command, *arguments]

    def view(self, script, *arguments, code=0, env=None, timeout=200, **options):
        """Runs the viewer, and checks its exit code. Messages of the validation layers end the viewer with
        code 3."""
        process = subprocess.run(self.command(script, *arguments, **options), cwd=self.folder,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                 timeout=timeout, env=env)
        self.assertEqual(process.returncode, code, process.stderr[-3000:])
        return Result(process, self.folder)

    def render(self, scene, *arguments, size=SIZE):
        """Returns the output of `lampyris render` for the same picture."""
        result = subprocess.run([LAMPYRIS, 'render', scene, '--size', size, '--json', '-q', '-o',
                                 self.path('render.exr'), *arguments],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def compare(self, image, reference):
        result = subprocess.run([LAMPYRIS, 'compare', image, reference, '--json'],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)


def main():
    need_device(LAMPYRIS)
    unittest.main()
