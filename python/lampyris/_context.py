"""Contexts, each with a device and a log, and the calls into the library."""
import ctypes
import logging
import threading
from collections import namedtuple

from . import _errors, _native
from ._native import lib

logger = logging.getLogger('lampyris')
LEVELS = [logging.ERROR, logging.WARNING, logging.INFO, logging.DEBUG]

Device = namedtuple('Device', 'index name driver kind memory_bytes is_cpu unusable')


@_native.LOG
def _log(_user, level, message):
    logger.log(LEVELS[level], '%s', _native.decode(message))


class _Handle:
    """Owns a handle of the library. It is closed at the end of a `with` statement, or when it is collected."""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        if getattr(self, '_handle', None):
            self.close()


class Context(_Handle):
    """A device, which the first render opens, and the state of the library. Functions of the module use a
    common context unless one is passed. Any thread may use a context; its calls are executed one at a
    time. Messages go to the logger "lampyris"."""

    def __init__(self, device=None, memory_bytes=0, validation=False):
        self._lock, self._owner, self._dead = threading.Lock(), None, []
        self._handle = ctypes.c_void_p()
        name = None if device is None else str(device)
        params = _native.ContextParams(device=_native.encode(name), log=_log, log_level=len(LEVELS) - 1,
                                       memory_bytes=memory_bytes, validation=validation)
        if lib.context_create(ctypes.byref(params), ctypes.byref(self._handle)) != _native.OK:
            raise _errors.DeviceError('the context could not be created: out of memory')

    def _run(self, function, *arguments):
        """Calls a function of the library, and raises an exception if it fails."""
        if not self._handle:
            raise _errors.InputError('the context is closed')
        if self._owner == threading.get_ident():
            raise _errors.InputError('a callback used the context that called it; use another context, or '
                                     'make the call after the callback has returned')
        with self._lock:
            self._owner = threading.get_ident()
            try:
                error = self._error() if function(*arguments) != _native.OK else None
            finally:
                self._owner = None
                self._bury()
        try:
            if error:
                raise error
        finally:
            del error  # otherwise its traceback and this frame keep each other, and the arguments, alive

    def _error(self):
        error = _native.Error()
        lib.context_error(self._handle, ctypes.byref(error))
        return _errors.make(error)

    def _discard(self, release, handle):
        """Releases an object as soon as no call is in progress, because Python may collect garbage at any
        time and in any thread."""
        self._dead.append((release, handle))
        if self._lock.acquire(blocking=False):
            try:
                self._bury()
            finally:
                self._lock.release()

    def _bury(self):
        while self._dead:
            release, handle = self._dead.pop()
            release(handle)

    def devices(self):
        """Returns the devices of the machine, as a list of Device."""
        count = ctypes.c_uint32()
        self._run(lib.device_count, self._handle, ctypes.byref(count))
        found = []
        for index in range(count.value):
            device = _native.Device()
            self._run(lib.device_at, self._handle, index, ctypes.byref(device))
            texts = [_native.decode(text) for text in (device.name, device.driver, device.kind)]
            found.append(Device(index, *texts, device.memory_bytes, device.is_cpu,
                                _native.decode(device.unusable) or None))
        return found

    def close(self):
        """Releases the context. Its device is closed when its scenes and renders are released, too."""
        handle, self._handle = self._handle, None
        if handle:
            self._discard(lib.context_release, handle)


class Owned(_Handle):
    """An object of the library that belongs to a context."""

    _release = None

    def __init__(self, context):
        self._context = context
        self._handle = ctypes.c_void_p()

    def _call(self, function, *arguments):
        if not self._handle:
            raise _errors.InputError(f'the {type(self).__name__.lower()} is closed')
        self._context._run(function, self._handle, *arguments)

    def close(self):
        """Releases the memory now instead of when the object is collected."""
        handle, self._handle = self._handle, None
        if handle:
            self._context._discard(self._release, handle)


_common = None
_common_lock = threading.Lock()


def common():
    """Returns the context that is used if the caller passes none."""
    global _common
    with _common_lock:
        if _common is None:
            _common = Context()
        return _common
