"""Runs both renderers through one interface: open() a scene, render() it with samples and a seed, close().

render() returns wall and processor seconds, and Lampyris also its number of rays. Seconds include some time that does not
depend on the number of samples. Lampyris' processor seconds are those of its process, from loading to writing; its wall
seconds are those of rendering alone. Both of Cycles are those of the operator that renders and writes.
"""
import hashlib
import json
import os
import resource
import shutil
import subprocess

import lampyris_scene

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'cycles_scene.py')


def _hash(path):
    with open(path, 'rb') as file:
        return hashlib.sha256(file.read()).hexdigest()[:12]


class Failure(Exception):
    """A renderer ended with an error. The message is its output."""


def _processor_seconds_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Lampyris:
    """Runs a new process for each render."""

    family = 'Lampyris'

    def __init__(self, name, program, options=()):
        self.name, self.program, self.options = name, os.path.abspath(program), list(options)
        # Rows of results belong to one version of the program and of the code that writes scenes.
        self.version = ' '.join([_hash(self.program), _hash(lampyris_scene.__file__), *self.options])
        self.scene = None

    def open(self, description, folder, size):
        self.scene, self.size = lampyris_scene.write(description, folder), size

    def render(self, spp, seed, file):
        command = [self.program, 'render', self.scene, '-q', '--json', '--spp', str(spp), '--seed', str(seed),
                   '--size', '%dx%d' % (self.size, self.size), '-o', file, *self.options]
        processor = _processor_seconds_of_children()
        result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        if result.returncode:
            raise Failure('%s: exit code %d: %s' % (' '.join(command), result.returncode, result.stderr.strip()))
        summary = json.loads(result.stdout)
        return {'seconds': summary['seconds']['render'], 'device': summary['device'],
                'rays': sum(summary['rays'].values()),
                'processor_seconds': _processor_seconds_of_children() - processor}

    def close(self):
        pass


class Cycles:
    """Runs a process for each scene, which keeps its BVH between renders."""

    name = family = 'Cycles'

    def __init__(self, blender):
        self.blender = shutil.which(blender)
        # Blender looks for its modules beside the first Python in PATH, which may not be the system's.
        self.environment = dict(os.environ, PATH='/usr/bin:/bin')
        self.environment.pop('PYTHONPATH', None)
        words = subprocess.run([blender, '--version'], stdout=subprocess.PIPE, text=True, check=True).stdout.split()
        self.version = ' '.join([*words[:2], _hash(SCRIPT)])
        self.process = None

    def open(self, description, folder, size):
        self.size, self.log = size, []
        self.process = subprocess.Popen(
            [self.blender, '-b', '--factory-startup', '--python-exit-code', '1', '--python', SCRIPT, '--', folder,
             description['name']], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            env=self.environment)
        self.about = self._answer()

    def _answer(self):
        for line in self.process.stdout:
            if line.startswith('peers: '):
                return json.loads(line[len('peers: '):])
            self.log = self.log[-40:] + [line]
        raise Failure('Blender ended with exit code %d: %s' % (self.process.wait(), ''.join(self.log)))

    def render(self, spp, seed, file):
        request = {'spp': spp, 'seed': seed, 'size': self.size, 'file': os.path.abspath(file)}
        self.process.stdin.write(json.dumps(request) + '\n')
        self.process.stdin.flush()
        return self._answer()

    def close(self):
        if self.process:
            self.process.communicate()
            self.process = None
