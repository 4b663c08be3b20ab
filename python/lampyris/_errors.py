"""The exceptions of the package."""
from . import _native


class Error(Exception):
    """An error. `path` is the file that has the error, `pointer` its place in the file as a JSON pointer, and
    `expected` the part of the message that says what was expected; each is None if it is not known.
    `status` is the exit code that the command line has for this error."""

    status = _native.DEVICE

    def __init__(self, message, path=None, pointer=None, expected=None):
        super().__init__(message)
        self.path, self.pointer, self.expected = path, pointer, expected

    def __reduce__(self):
        return type(self), (str(self), self.path, self.pointer, self.expected)


class InputError(Error, ValueError):
    """An argument, a file or a document is wrong, or needs more memory than the budget allows."""
    status = _native.INPUT


class DeviceError(Error, RuntimeError):
    """The device, its driver or the system failed."""


class NoVulkanError(DeviceError):
    """There is no Vulkan loader, or no Vulkan driver."""
    status = _native.NO_VULKAN


class OutputError(Error):
    """A file could not be written."""
    status = _native.OUTPUT


class Stopped(Error):
    """A callback requested a stop before there was a picture."""
    status = _native.STOPPED


CLASSES = {each.status: each for each in (InputError, NoVulkanError, OutputError, Stopped)}


def make(error):
    """Makes the exception that describes an error of the library."""
    texts = [_native.decode(text) or None for text in (error.file, error.place, error.expected)]
    return CLASSES.get(error.status, DeviceError)(_native.decode(error.message), *texts)
