#!/usr/bin/env python3
"""Tests installation by meson into an empty folder, and of Debian's packages into a new system that
debootstrap makes. Both programs, their manual pages, completion and scenes are used there, and then removed
without a trace.

Usage: test_package.py SOURCE_ROOT BUILD_ROOT [unittest arguments]

The packages are built from a copy of the sources. Debian needs root, a mirror (LAMPYRIS_MIRROR,
http://deb.debian.org/debian unless given), and the packages that .ci/test --long installs; without
these it is skipped. LAMPYRIS_PACKAGES is a folder of packages to take instead of building them.
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
MIRROR = os.environ.get('LAMPYRIS_MIRROR', 'http://deb.debian.org/debian')
# The environment contains neither names of this machine's folders nor other variables.
CLEAN = {'PATH': '/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin', 'LC_ALL': 'C.UTF-8',
         'DEBIAN_FRONTEND': 'noninteractive',
         **{name: os.environ[name] for name in ('VK_DRIVER_FILES', 'VK_ICD_FILENAMES', 'http_proxy')
            if name in os.environ}}
WINDOW_LIBRARIES = re.compile(r'glfw|X11|xcb|wayland|imgui|libGL', re.IGNORECASE)


def skip(why):
    if os.environ.get('LAMPYRIS_NO_SKIP'):
        raise AssertionError(why)
    raise unittest.SkipTest(why)


def files_below(root, left_out=()):
    """Returns all files, links and folders, named relative to the root."""
    found = set()
    for folder, folders, names in os.walk(root):
        within = '/' + os.path.relpath(folder, root)
        folders[:] = [name for name in folders if os.path.join(within, name).replace('/./', '/')
                      not in left_out]
        found |= {os.path.join(within, name).replace('/./', '/') for name in folders + names}
    return found


class Installed(unittest.TestCase):
    """Tests of the installed programs. Subclasses define how a command is run there."""

    def ok(self, *command, **more):
        result = self.run_there(*command, **more)
        self.assertEqual(result.returncode, 0, f'{command}\n{result.stdout}{result.stderr}')
        return result.stdout

    def use_programs(self, prefix, work):
        """Uses the programs. `work` is an empty folder, as the commands see it."""
        scenes = f'{prefix}/share/lampyris/scenes'
        self.assertRegex(self.ok('lampyris', '--version'), r'^lampyris \d')
        self.ok('lampyris', 'render', f'{scenes}/cornell.json', '--size', '32x32', '--spp', '2',
                '-o', f'{work}/box.exr', '-o', f'{work}/box.png')
        self.ok('lampyris', 'render', f'{scenes}/models/vase.glb', '--env', f'{scenes}/models/gallery.hdr',
                '--size', '16x16', '--spp', '1', '-o', f'{work}/vase.exr')
        self.ok('lampyris', 'compare', f'{work}/box.exr', f'{work}/box.exr', '--max', 'mse=0')
        # As the pages say: the scenes are beside the docs.
        self.ok('lampyris', 'info', f'{prefix}/share/doc/lampyris/scenes/glass.json')
        # `lampyris view` must find the other program.
        script = self.outside(f'{work}/end.txt')
        with open(script, 'w', encoding='utf-8') as file:
            file.write('wait 1 samples\n')
        for program in (['lampyris', 'view'], ['lampyris-view']):
            self.ok(*program, f'{scenes}/cornell.json', '--size', '16x16', '--headless', '--script',
                    f'{work}/end.txt')
        shown = self.ok('bash', '-c', f'. {prefix}/share/bash-completion/completions/lampyris; '
                        'COMP_WORDS=(lampyris render --sampler sob); COMP_CWORD=3; _lampyris; echo $COMPREPLY')
        self.assertEqual(shown, 'sobol\n')

    def use_library(self, prefix, work):
        """Uses the Python package, and through it the library."""
        code = ('import sys, lampyris\n'
                'picture = lampyris.render(sys.argv[1], size=(16, 16), spp=2)\n'
                'picture.save(sys.argv[2])\n'
                'print(lampyris.__version__, picture.error)\n')
        said = self.ok('python3', '-c', code, f'{prefix}/share/lampyris/scenes/cornell.json', f'{work}/python.exr')
        self.assertRegex(said, r'^\d+\.\d+\.\d+ local relMSE ')
        self.ok('lampyris', 'render', f'{prefix}/share/lampyris/scenes/cornell.json', '--size', '16x16', '--spp', '2',
                '-o', f'{work}/program.exr')
        self.ok('lampyris', 'compare', f'{work}/python.exr', f'{work}/program.exr', '--max', 'mse=0')

    def check_files(self, prefix):
        inside = self.outside(prefix)
        for name in ('bin/lampyris', 'bin/lampyris-view', 'share/doc/lampyris/README.md',
                     'share/doc/lampyris/docs/scene.schema.json', 'share/doc/lampyris/docs/scene-format.md',
                     'share/doc/lampyris/LICENSE', 'share/lampyris/scenes/cornell.json',
                     'share/fish/vendor_completions.d/lampyris.fish', 'share/mime/packages/lampyris.xml',
                     'share/icons/hicolor/scalable/apps/lampyris-view.svg'):
            self.assertTrue(os.path.exists(os.path.join(inside, name)), name)
        self.check_links(os.path.join(inside, 'share/doc/lampyris'))
        needed = subprocess.run(['objdump', '-p', os.path.join(inside, 'bin/lampyris')], check=True,
                                stdout=subprocess.PIPE, text=True).stdout
        for library in re.findall(r'NEEDED +(\S+)', needed):
            self.assertIsNone(WINDOW_LIBRARIES.search(library), library)
        for tool, name in (('desktop-file-validate', 'applications/lampyris-view.desktop'),
                           ('appstreamcli validate --no-net', 'metainfo/org.lampyris.View.metainfo.xml')):
            if shutil.which(tool.split()[0]):
                subprocess.run([*tool.split(), os.path.join(inside, 'share', name)], check=True)

    def check_links(self, pages):
        """Checks that no installed page has a link to a file that is not installed."""
        found = 0
        for folder, _, names in os.walk(pages, followlinks=True):
            for name in filter(re.compile(r'\.md$').search, names):
                with open(os.path.join(folder, name), encoding='utf-8') as file:
                    links = re.findall(r'\]\(([^)\s]+)\)', file.read())
                for target in links:
                    if re.match(r'\w+:|#', target):
                        continue
                    found += 1
                    # Resolves the name as browsers do, because `scenes` is a link to another folder.
                    path = os.path.normpath(os.path.join(folder, target.partition('#')[0]))
                    self.assertTrue(os.path.exists(path), f'{folder}/{name}: {target}')
        self.assertGreater(found, 100)


class Prefix(Installed):

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.root = os.path.join(temporary.name, 'root')
        self.prefix = None

    def run_there(self, *command, **more):
        path = f'{self.prefix}/bin:' + CLEAN['PATH']
        return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300,
                              env={**CLEAN, 'PATH': path, 'HOME': self.root, 'PYTHONDONTWRITEBYTECODE': '1',
                                   'PYTHONPATH': self.folder_of('lampyris/__init__.py'),
                                   'LD_LIBRARY_PATH': self.folder_of('liblampyris.so')}, cwd='/', **more)

    def folder_of(self, name):
        found, = glob.glob(f'{self.root}/**/{name}', recursive=True)
        return found[:-len(name) - 1]

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
        self.use_library(self.prefix, work)
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


class Debian(Installed):

    @classmethod
    def setUpClass(cls):
        for tool in ('dpkg-buildpackage', 'dh', 'lintian', 'debootstrap'):
            if not shutil.which(tool, path=CLEAN['PATH']):
                skip(f'{tool} is not installed')
        if os.getuid() != 0:
            skip('debootstrap needs root')
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = cls.temporary.name
        cls.root = os.path.join(cls.folder, 'root')
        cls.packages = os.environ.get('LAMPYRIS_PACKAGES') or cls.build()
        made = subprocess.run(['debootstrap', '--variant=minbase', 'bookworm', cls.root, MIRROR], env=CLEAN,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if made.returncode != 0:
            skip(f'debootstrap failed:\n{made.stdout}')

    @classmethod
    def build(cls):
        tree = os.path.join(cls.folder, 'build', 'lampyris')
        names = subprocess.run(['git', '-C', SOURCES, 'ls-files', '-z', '--cached', '--others',
                                '--exclude-standard'], check=True, stdout=subprocess.PIPE, text=True).stdout
        for name in filter(None, names.split('\0')):
            if os.path.exists(os.path.join(SOURCES, name)):
                os.makedirs(os.path.dirname(os.path.join(tree, name)), exist_ok=True)
                shutil.copy2(os.path.join(SOURCES, name), os.path.join(tree, name), follow_symlinks=False)
        subprocess.run(['dpkg-buildpackage', '-us', '-uc', '-b'], cwd=tree, env=CLEAN, check=True,
                       stdout=subprocess.DEVNULL)
        return os.path.dirname(tree)

    def run_there(self, *command, **more):
        return subprocess.run(['chroot', self.root, *command], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=1800,
                              env={name: word for name, word in CLEAN.items() if not name.startswith('VK_')},
                              **more)

    def outside(self, path):
        return self.root + path

    def test_lintian_has_nothing_to_say(self):
        changes, = glob.glob(os.path.join(self.packages, 'lampyris_*.changes'))
        result = subprocess.run(['lintian', '--allow-root', '--fail-on', 'error,warning,info', '--display-info', changes],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=CLEAN)
        self.assertEqual((result.returncode, result.stdout), (0, ''))

    def depends(self, package):
        words = subprocess.run(['dpkg-deb', '-f', package, 'Depends'], check=True, stdout=subprocess.PIPE,
                               text=True).stdout
        return [re.sub(r' .*', '', word.strip()) for word in words.split(',')]

    def test_they_are_used_and_removed(self):
        packages = [path for path in glob.glob(os.path.join(self.packages, '*.deb')) if 'dbgsym' not in path]
        own = {os.path.basename(path).split('_')[0] for path in packages}
        self.assertEqual(own, {'lampyris', 'lampyris-view', 'liblampyris0.1', 'liblampyris-dev', 'python3-lampyris'})
        needed = sorted({name for path in packages for name in self.depends(path)} - own)
        self.ok('apt-get', 'install', '-qq', '-y', '--no-install-recommends', 'mesa-vulkan-drivers', 'man-db',
                'shared-mime-info', 'desktop-file-utils', 'hicolor-icon-theme', *needed)
        # Files that dpkg's triggers have created do not belong to the packages.
        kept = ('/var/lib/dpkg', '/var/log', '/var/cache', '/proc', '/sys', '/dev', '/tmp', '/root')
        before = files_below(self.root, kept)
        mime = self.mime_types()
        for path in packages:
            shutil.copy(path, self.root + '/tmp')
        self.ok('sh', '-c', 'dpkg --install /tmp/*.deb')
        self.assertIn('application/x-lampyris-scene+json', self.mime_types())
        self.check_files('/usr')
        os.mkdir(self.root + '/tmp/work')
        self.use_programs('/usr', '/tmp/work')
        self.use_library('/usr', '/tmp/work')
        for page in ('lampyris', 'lampyris-view'):
            self.assertIn('SYNOPSIS', re.sub('.\b', '', self.ok('man', page)))
        self.ok('dpkg', '--purge', *sorted(own))
        self.assertEqual(files_below(self.root, kept) ^ before, set())
        self.assertEqual(self.mime_types(), mime)
        self.assertEqual(self.ok('dpkg-query', '--show', '--showformat', '${Package} ${Status}\n').count('lampyris'), 0)

    def mime_types(self):
        with open(self.root + '/usr/share/mime/types', encoding='utf-8') as file:
            return set(file.read().split())


if __name__ == '__main__':
    unittest.main()
