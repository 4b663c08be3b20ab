#!/usr/bin/env python3
"""What is installed by meson into an empty folder. Both programs, their pages, completion and scenes are used there, and then removed
without a trace.

Usage: test_package.py SOURCE_ROOT BUILD_ROOT [unittest arguments]

"""
import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCES = os.path.abspath(sys.argv.pop(1))
BUILD = os.path.abspath(sys.argv.pop(1))
# Neither names of this machine's folders nor its environment are to matter.
CLEAN = {'PATH': '/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin', 'LC_ALL': 'C.UTF-8',
         'DEBIAN_FRONTEND': 'noninteractive',
         **{name: os.environ[name] for name in ('VK_DRIVER_FILES', 'VK_ICD_FILENAMES', 'http_proxy')
            if name in os.environ}}
WINDOW_LIBRARIES = re.compile(r'glfw|X11|xcb|wayland|imgui|libGL', re.IGNORECASE)


def files_below(root, left_out=()):
    """All files, links and folders, by their names within the root."""
    found = set()
    for folder, folders, names in os.walk(root):
        within = '/' + os.path.relpath(folder, root)
        folders[:] = [name for name in folders if os.path.join(within, name).replace('/./', '/')
                      not in left_out]
        found |= {os.path.join(within, name).replace('/./', '/') for name in folders + names}
    return found


class Installed(unittest.TestCase):
    """What the installed programs do. Subclasses run a command in their place."""

    def ok(self, *command, **more):
        result = self.run_there(*command, **more)
        self.assertEqual(result.returncode, 0, f'{command}\n{result.stdout}{result.stderr}')
        return result.stdout

    def use_programs(self, prefix, work):
        """work: an empty folder, as the commands see it."""
        scenes = f'{prefix}/share/lampyris/scenes'
        self.assertRegex(self.ok('lampyris', '--version'), r'^lampyris \d')
        self.ok('lampyris', 'render', f'{scenes}/cornell.json', '--size', '32x32', '--spp', '2',
                '-o', f'{work}/box.exr', '-o', f'{work}/box.png')
        self.ok('lampyris', 'render', f'{scenes}/models/vase.glb', '--env', f'{scenes}/models/gallery.hdr',
                '--size', '16x16', '--spp', '1', '-o', f'{work}/vase.exr')
        self.ok('lampyris', 'compare', f'{work}/box.exr', f'{work}/box.exr', '--max', 'mse=0')
        # By the pages: scenes lie beside docs.
        self.ok('lampyris', 'info', f'{prefix}/share/doc/lampyris/scenes/glass.json')
        # `lampyris view` finds the other program.
        script = self.outside(f'{work}/end.txt')
        with open(script, 'w', encoding='utf-8') as file:
            file.write('wait 1 samples\n')
        for program in (['lampyris', 'view'], ['lampyris-view']):
            self.ok(*program, f'{scenes}/cornell.json', '--size', '16x16', '--headless', '--script',
                    f'{work}/end.txt')
        shown = self.ok('bash', '-c', f'. {prefix}/share/bash-completion/completions/lampyris; '
                        'COMP_WORDS=(lampyris render --sampler sob); COMP_CWORD=3; _lampyris; echo $COMPREPLY')
        self.assertEqual(shown, 'sobol\n')

    def check_files(self, prefix):
        inside = self.outside(prefix)
        for name in ('bin/lampyris', 'bin/lampyris-view', 'share/doc/lampyris/README.md',
                     'share/doc/lampyris/docs/scene.schema.json', 'share/doc/lampyris/docs/scene-format.md',
                     'share/doc/lampyris/LICENSE', 'share/lampyris/scenes/cornell.json',
                     'share/fish/vendor_completions.d/lampyris.fish', 'share/mime/packages/lampyris.xml',
                     'share/icons/hicolor/scalable/apps/lampyris-view.svg'):
            self.assertTrue(os.path.exists(os.path.join(inside, name)), name)
        needed = subprocess.run(['objdump', '-p', os.path.join(inside, 'bin/lampyris')], check=True,
                                stdout=subprocess.PIPE, text=True).stdout
        for library in re.findall(r'NEEDED +(\S+)', needed):
            self.assertIsNone(WINDOW_LIBRARIES.search(library), library)
        for tool, name in (('desktop-file-validate', 'applications/lampyris-view.desktop'),
                           ('appstreamcli validate --no-net', 'metainfo/org.lampyris.View.metainfo.xml')):
            if shutil.which(tool.split()[0]):
                subprocess.run([*tool.split(), os.path.join(inside, 'share', name)], check=True)


class Prefix(Installed):

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.root = os.path.join(temporary.name, 'root')
        self.prefix = None

    def run_there(self, *command, **more):
        path = f'{self.prefix}/bin:' + CLEAN['PATH']
        return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300,
                              env={**CLEAN, 'PATH': path, 'HOME': self.root}, cwd='/', **more)

    def outside(self, path):
        return path

    def test_it_is_used_and_removed(self):
        environment = {**os.environ, 'DESTDIR': self.root}
        subprocess.run(['meson', 'install', '-C', BUILD, '--no-rebuild'], check=True, env=environment,
                       stdout=subprocess.DEVNULL)
        self.prefix = os.path.dirname(os.path.dirname(
            glob.glob(f'{self.root}/**/bin/lampyris', recursive=True)[0]))
        before = files_below(self.root)
        work = tempfile.mkdtemp(dir=os.path.dirname(self.root))
        self.check_files(self.prefix)
        self.use_programs(self.prefix, work)
        for page in ('lampyris', 'lampyris-view'):
            self.assertIn('SYNOPSIS', re.sub('.\b', '', self.ok('man', f'{self.prefix}/share/man/man1/{page}.1')))
        if shutil.which('update-mime-database'):
            self.ok('update-mime-database', f'{self.prefix}/share/mime')
            with open(f'{self.prefix}/share/mime/globs2', encoding='utf-8') as file:
                self.assertIn('60:application/x-lampyris-scene+json:*.lampyris.json', file.read())
            for name in files_below(self.root) - before:
                if os.path.isfile(self.root + name):
                    os.remove(self.root + name)
        subprocess.run(['ninja', '-C', BUILD, 'uninstall'], check=True, env=environment,
                       stdout=subprocess.DEVNULL)
        left = {name for name in files_below(self.root) if not os.path.isdir(self.root + name)}
        self.assertEqual({name for name in left if not name.startswith('/.cache/')}, set())


if __name__ == '__main__':
    unittest.main()
