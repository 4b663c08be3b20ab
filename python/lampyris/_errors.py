"""Exceptions."""
from . import _native


class Error(Exception):
    """What went wrong. `path` is the file that is wrong, `pointer` the place in it as a JSON pointer,
    `expected` what the message says was expected: each None where there is nothing to say. `status` is
    the exit code of the command line."""

    status = _native.DEVICE

    def __init__(self, message, path=None, pointer=None, expected=None):
        super().__init__(message)
        self.path, self.pointer, self.expected = path, pointer, expected

    def __reduce__(self):
        return type(self), (str(self), self.path, self.pointer, self.expected)


class InputError(Error, ValueError):
    """An argument, a file or a document is wrong, or needs more memory than there is."""
    status = _native.INPUT


class DeviceError(Error, RuntimeError):
    """The device, its driver or the system failed."""


class NoVulkanError(DeviceError):
    """There is no Vulkan loader or no driver."""
    status = _native.NO_VULKAN


class OutputError(Error):
    """A file could not be written."""
    status = _native.OUTPUT


class Stopped(Error):
    """A callback asked to stop, before there was a picture."""
    status = _native.STOPPED


CLASSES = {each.status: each for each in (InputError, NoVulkanError, OutputError, Stopped)}


def make(error):
    """The exception for a struct of the library."""
    texts = [_native.decode(text) or None for text in (error.file, error.place, error.expected)]
    return CLASSES.get(error.status, DeviceError)(_native.decode(error.message), *texts)
