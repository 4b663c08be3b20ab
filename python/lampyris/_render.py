"""Renders, and the pictures that they produce."""
import base64
import ctypes
import html
import math
import os
import signal
import tempfile
import threading
from collections import namedtuple
from types import SimpleNamespace

from . import _arrays, _context, _native
from ._errors import InputError, Stopped
from ._native import lib
from ._scene import Scene, dump, load

Moment = namedtuple('Moment', 'phase fraction samples seconds rays')
Part = namedtuple('Part', 'kind name reason bytes is_left_out')


class Estimate:
    """The local relMSE of a picture, estimated from two halves of its samples. The 95 % confidence interval is
    from `low` to `high`; `at_most` is the upper end of the one-sided interval. If there is no interval,
    the object is false, `value`, `low` and `high` are NaN, and `why` is the reason; `at_most` is NaN if
    there is no bound either."""

    def __init__(self, value, low, high, at_most, why):
        self.value, self.low, self.high, self.at_most, self.why = value, low, high, at_most, why

    def __bool__(self):
        return not math.isnan(self.value)

    def __float__(self):
        return self.value

    def __str__(self):
        if self:
            return f'local relMSE {self.value:.3g}, 95 % interval {self.low:.3g} to {self.high:.3g}'
        if not math.isnan(self.at_most):
            return f'local relMSE at most {self.at_most:.3g} (95 %): {self.why}'
        return f'local relMSE not known: {self.why}'

    def __repr__(self):
        return f'<Estimate: {self}>'


class _Watch:
    """Handles the progress reports of a call: calls the caller's function, and ends the call after Ctrl-C as
    if that function had requested it. Python's default handler would raise an exception anywhere in a
    callback."""

    def __init__(self, function):
        self.function, self.failure, self.interrupted = function, None, False
        self.report = _native.REPORT(self._report)
        self.struct = _native.Progress(report=self.report)

    def _report(self, _user, moment):
        try:
            if self.function:
                m = moment.contents
                told = self.function(Moment(_native.decode(m.phase), m.fraction, m.samples, m.seconds, m.rays))
                return told is not False and not self.interrupted
        except BaseException as failure:  # raised again after the library has returned
            self.failure = failure
            return False
        return not self.interrupted

    def _interrupt(self, _signal, _frame):
        self.interrupted = True

    def __enter__(self):
        is_main = threading.current_thread() is threading.main_thread()
        self.is_handler = is_main and signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if self.is_handler:
            signal.signal(signal.SIGINT, self._interrupt)
        return self

    def __exit__(self, *_):
        if self.is_handler:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        self.report = self.struct = None  # they refer to this object
        failure, self.failure = self.failure, None
        try:
            if failure:
                raise failure
        finally:
            del failure


class Render(_context.Owned):
    """A render in progress. step() continues it, and picture() returns its present picture. Keyword arguments
    are the keys of a scene file's "film" and "settings" (spp, seed, max_bounces, mis ...), and

        size: (width, height)
        error: the render ends when the local relMSE is below this, or at spp if that is given
        seconds: the render ends after this rendering time
        adaptive: if true, each tile gets a number of samples according to its error
        camera: name or index of one of the scene's cameras
        aovs: layers in addition to the radiance: ['albedo', 'depth', 'halves' ...]
        resume: path of a checkpoint from which the render continues
        progress: a function that is called often, with a Moment; if it returns False, the call ends"""

    _release = staticmethod(lib.render_release)

    def __init__(self, scene, *, size=None, aovs=None, progress=None, **settings):
        super().__init__(scene._context)
        if size is not None:
            settings['width'], settings['height'] = size
        if aovs is not None:
            settings['aov'] = list(aovs)
        self._progress, self._steps, self._interrupted = progress, 0, False
        with _Watch(progress) as watch:
            try:
                self._context._run(lib.render_begin, scene._handle, dump(settings),
                                   ctypes.byref(watch.struct), ctypes.byref(self._handle))
            except Stopped:
                if watch.interrupted:
                    raise KeyboardInterrupt from None
                raise

    def step(self, samples=0, *, seconds=0, error=0):
        """Renders until every pixel has `samples` samples, the rendering time is `seconds`, or the local
        relMSE is below `error`, all counted from the beginning of the render. Without arguments the goal
        is that of the settings. Returns False if a callback or Ctrl-C stopped it; the next step then
        continues."""
        goal = _native.Goal(samples=samples, seconds=seconds, error=error)
        given = ctypes.byref(goal) if samples or seconds or error else None
        self._steps += 1
        with _Watch(self._progress) as watch:
            try:
                self._call(lib.render_step, given, ctypes.byref(watch.struct))
            except Stopped:
                return False
            finally:
                self._interrupted = watch.interrupted
        return not self._interrupted

    def checkpoint(self, path):
        """Writes a checkpoint. A render continues from it with the argument `resume`, or by the command line
        `lampyris render --checkpoint FILE --resume`."""
        self._call(lib.render_checkpoint, _native.encode(path))

    def picture(self):
        """Returns the picture with all samples rendered so far."""
        return Picture(self)

    def _items(self, function, make):
        """Returns all items that a function of the library lists by index."""
        found = []
        while True:
            try:
                item = make()
                self._call(function, len(found), ctypes.byref(item))
            except InputError:
                return found
            found.append(item)

    @property
    def parts(self):
        """The parts of the renderer, and for each part that is left out the reason why the scene does not need
        it."""
        return [Part(_native.decode(part.kind), _native.decode(part.name), _native.decode(part.reason) or None,
                     part.bytes, part.is_left_out) for part in self._items(lib.render_part, _native.Part)]


class Picture:
    """A picture of a render. `array` is its radiance, and picture['depth'] another layer; both are `Pixels`.
    numpy.asarray(picture) is the radiance, too.

        error: an Estimate              hash: 16 hexadecimal digits, as `lampyris render` prints
        samples: per pixel              seconds: .render, .load, .bvh, .upload, .compile, .judge, .write
        rays: .closest, .shadow         repeat: the command line that renders the same bits, or None
        ended_by: "spp", "error" ...    stopped: a callback or Ctrl-C ended the step

    The picture keeps its render alive, so that it can be saved, until close() is called or the picture is
    collected."""

    def __init__(self, render):
        self.render, self._at_step = render, render._steps
        state = _native.State()
        render._call(lib.render_state, ctypes.byref(state))
        self.size = (state.width, state.height)
        self.samples = state.samples
        self.ended_by = _native.decode(state.ended_by)
        self.stopped = self.ended_by == 'signal' or render._interrupted
        self.pixels_without_samples = state.pixels_without_samples
        self.samples_dropped = state.samples_dropped
        self.seconds = SimpleNamespace(**{name[8:]: getattr(state, name) for name, _ in state._fields_
                                          if name.startswith('seconds_')})
        self.rays = SimpleNamespace(closest=state.rays_closest, shadow=state.rays_shadow)
        self.error = Estimate(state.error, state.error_low, state.error_high, state.error_at_most,
                              _native.decode(state.error_why) or None)
        self.hash = f'{state.hash:016x}'
        command = ctypes.c_char_p()
        render._call(lib.render_repeat, ctypes.byref(command))
        self.repeat = _native.decode(command.value) or None
        self.channels, self.layers = {}, {}
        for layer in render._items(lib.render_layer, _native.Layer):
            self._read(layer)

    def _read(self, layer):
        name = _native.decode(layer.name)
        pixels = _arrays.Pixels(*self.size, layer.channel_count, 'u' if layer.is_integer else 'f')
        self.render._call(lib.render_read, layer.name, pixels.address, 0, 0)
        self.channels[name] = _native.decode(layer.channels).split(',')
        self.layers[name] = pixels

    @property
    def array(self):
        return self.layers['radiance']

    @property
    def __array_interface__(self):
        return self.array.__array_interface__

    def __getitem__(self, layer):
        try:
            return self.layers[layer]
        except KeyError:
            raise KeyError(f'{layer}: the picture has {", ".join(self.layers)}') from None

    def save(self, path, *, half=False):
        """Writes the picture as .exr, .png, .jpg, .hdr or .pfm. EXR files contain all layers; all formats
        but PFM contain metadata about the render. `half` selects 16 bits per value in EXR files."""
        if self._at_step != self.render._steps:
            raise InputError('the render has made another step since this picture was taken; save a picture '
                             'before the next step')
        params = _native.SaveParams(half_float=half)
        self.render._call(lib.render_save, _native.encode(path), ctypes.byref(params))

    def close(self):
        self.render.close()

    def __repr__(self):
        return (f'<Picture {self.size[0]}x{self.size[1]}, {self.samples} samples, {self.error}, '
                f'{self.seconds.render:.3f} s>')

    # Notebooks show the picture with its error below it.
    def _repr_png_(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'picture.png')
            self.save(path)
            with open(path, 'rb') as file:
                return file.read()

    def _repr_html_(self):
        said = html.escape(f'{self.samples} samples in {self.seconds.render:.2f} s, {self.error}')
        data = base64.b64encode(self._repr_png_()).decode('ascii')
        return f'<figure><img src="data:image/png;base64,{data}"><figcaption>{said}</figcaption></figure>'


def _scene_of(scene, context):
    if isinstance(scene, Scene):
        return scene
    return Scene(scene, context=context) if isinstance(scene, dict) else load(scene, context=context)


def render(scene, *, context=None, **settings):
    """Renders a scene and returns the Picture. `scene` is a Scene, the path of a file, or a dict. Render
    describes the settings. After Ctrl-C it returns the picture rendered so far."""
    begun = Render(_scene_of(scene, context), **settings)
    begun.step()
    return begun.picture()


def progressive(scene, *, context=None, spp=None, error=0, seconds=0, **settings):
    """Yields pictures with 1, 2, 4, ... samples per pixel. The last one has `spp` samples, an error below
    `error`, or a rendering time of `seconds`; if none of these is given, there is no last one. All are
    pictures of one render, so each must be saved before the next is requested. After Ctrl-C the picture
    rendered so far is the last one."""
    if spp is not None:
        settings['spp'] = spp
    begun = Render(_scene_of(scene, context), **settings)
    samples = 1
    while True:
        goes_on = begun.step(min(samples, spp) if spp else samples, seconds=seconds)
        picture = begun.picture()
        is_enough = error > 0 and picture.error.at_most < error
        yield picture
        if not goes_on or is_enough or picture.ended_by == 'time' or (spp and samples >= spp):
            return
        samples *= 2
