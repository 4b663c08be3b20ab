"""Lampyris, a path tracer that reports its error, as a Python package that uses liblampyris.

    import lampyris
    picture = lampyris.render('cornell.json', spp=64, size=(512, 512))
    print(picture.error, picture.seconds.render)
    picture.save('cornell.exr')

docs/python.md describes the package in full."""
from ._arrays import Pixels
from ._compare import Interval, Metrics, compare, read
from ._context import Context, Device, common
from ._errors import DeviceError, Error, InputError, NoVulkanError, OutputError, Stopped
from ._native import decode, lib
from ._render import Estimate, Moment, Part, Picture, Render, progressive, render
from ._scene import Scene, load

__version__ = decode(lib.version())
__all__ = ['Context', 'Device', 'DeviceError', 'Error', 'Estimate', 'InputError', 'Interval', 'Metrics',
           'Moment', 'NoVulkanError', 'OutputError', 'Part', 'Picture', 'Pixels', 'Render', 'Scene', 'Stopped',
           'compare', 'devices', 'load', 'progressive', 'read', 'render']


def devices(context=None):
    """Returns the devices of the machine, as a list of Device."""
    return (context or common()).devices()
