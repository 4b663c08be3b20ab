"""What the tests in Python share: running a program, and leaving without a device."""
import subprocess
import sys


def run(program, *arguments, **more):
    return subprocess.run([program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, check=False, **more)


def checked(program, *arguments, **more):
    """What a program that must succeed writes to standard output."""
    result = run(program, *arguments, **more)
    if result.returncode != 0:
        raise AssertionError(result.stderr)
    return result.stdout


def need_device(lampyris):
    if run(lampyris, 'devices').returncode == 69:
        sys.exit(77)
