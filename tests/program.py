"""Functions that tests share: running a program, skipping a test without a device, and tests that measure
time."""
import functools
import os
import signal
import subprocess
import sys
import tempfile
import unittest

# Child processes inherit an ignored signal, and shells ignore SIGINT for programs that they start in the
# background.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def run(program, *arguments, **more):
    return subprocess.run([program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, check=False, **more)


def checked(program, *arguments, **more):
    """Runs a program, which must succeed, and returns its standard output."""
    result = run(program, *arguments, **more)
    if result.returncode != 0:
        raise AssertionError(result.stderr)
    return result.stdout


def limits(words):
    """Returns LAMPYRIS_LIMITS with these words in addition to those of the test's own environment. If both
    set the same number, that of the environment is used."""
    return ','.join(part for part in (words, os.environ.get('LAMPYRIS_LIMITS')) if part)


class FolderCase(unittest.TestCase):
    """Tests that have a temporary folder each, whose path is self.folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)


def need_device(lampyris):
    if run(lampyris, 'devices').returncode == 69:
        sys.exit(77)


def by_the_clock(test):
    """A decorator for a test that measures time. Another program may delay it, so it fails only after five
    failures in a row. The test must be repeatable without setUp."""
    @functools.wraps(test)
    def repeated(self):
        for _ in range(4):
            try:
                return test(self)
            except AssertionError as error:
                print(f'{test.__name__}, again: {error}', file=sys.stderr)
        return test(self)
    return repeated
