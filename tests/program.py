"""What the tests in Python share: running a program, leaving without a device, tests of clocks."""
import functools
import os
import signal
import subprocess
import sys

# Children inherit a signal that is ignored, as a shell has it with SIGINT for what it starts in its
# background.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def run(program, *arguments, **more):
    return subprocess.run([program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, check=False, **more)


def checked(program, *arguments, **more):
    """What a program that must succeed writes to standard output."""
    result = run(program, *arguments, **more)
    if result.returncode != 0:
        raise AssertionError(result.stderr)
    return result.stdout


def limits(words):
    """LAMPYRIS_LIMITS with these words, besides those that the test itself is run under. Of a number
    that both have, the test's own counts."""
    return ','.join(part for part in (words, os.environ.get('LAMPYRIS_LIMITS')) if part)


def need_device(lampyris):
    if run(lampyris, 'devices').returncode == 69:
        sys.exit(77)


def by_the_clock(test):
    """A test of what clocks say, which another program may have held up: it fails where it fails
    five times in a row. It can be run again without setUp."""
    @functools.wraps(test)
    def repeated(self):
        for _ in range(4):
            try:
                return test(self)
            except AssertionError as error:
                print(f'{test.__name__}, again: {error}', file=sys.stderr)
        return test(self)
    return repeated
