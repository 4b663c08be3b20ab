"""Scenes: documents, whose values JSON pointers read and set, and meshes in arrays."""
import ctypes
import json
import os

from . import _arrays, _context, _native
from ._native import lib


def _plain(value):
    """Converts arrays and numbers of numpy, and paths, to types that JSON can represent."""
    if hasattr(value, 'tolist'):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f'{value!r} cannot be written as JSON')


def dump(value):
    return json.dumps(value, default=_plain, allow_nan=False).encode('utf-8')


class Scene(_context.Owned):
    """A scene, made from a document, which is given as a dict. The key "lampyris" may be omitted:

        scene = lampyris.Scene({'materials': {'red': {'base_color': [.8, .1, .1]}},
                                'shapes': [{'type': 'sphere', 'radius': 1, 'material': 'red'}]})
        scene['/materials/red/roughness'] = .3

    load() makes a scene from a file. Paths in the document are relative to `folder`. Errors in the scene
    are reported by check() or by the next render."""

    _release = staticmethod(lib.scene_release)

    def __init__(self, document=None, *, folder=None, defines=None, allow_outside_paths=False,
                 strict=False, context=None, _path=None):
        super().__init__(context or _context.common())
        self._kept = {}
        overrides = [f'{key}={dump(value).decode()}'.encode('utf-8') for key, value in
                     (defines or {}).items()] + [None]
        params = _native.SceneParams(overrides=(ctypes.c_char_p * len(overrides))(*overrides),
                                     allow_outside_paths=allow_outside_paths, is_strict=strict)
        out = (ctypes.byref(params), ctypes.byref(self._handle))
        context = self._context
        if _path is not None:
            context._run(lib.scene_load, context._handle, _native.encode(_path), *out)
        else:
            text = dump({'lampyris': 1, **(document or {})})
            context._run(lib.scene_parse, context._handle, text, _native.encode(folder), *out)

    def __getitem__(self, pointer):
        text = ctypes.c_void_p()
        self._call(lib.scene_get, pointer.encode('utf-8'), ctypes.byref(text))
        try:
            return json.loads(ctypes.string_at(text))
        finally:
            lib.text_release(text)

    def __setitem__(self, pointer, value):
        self._call(lib.scene_set, pointer.encode('utf-8'), dump(value))

    def __delitem__(self, pointer):
        self._call(lib.scene_remove, pointer.encode('utf-8'))

    def __contains__(self, pointer):
        try:
            self[pointer]
        except ValueError:
            return False
        return True

    @property
    def document(self):
        """The whole document."""
        return self['']

    def mesh(self, name, positions, indices=None, *, normals=None, uvs=None, colors=None, material=None):
        """Adds a triangle mesh, as the shape `name` at the end of /shapes, or replaces the mesh of that name.

        The arguments are arrays of these shapes: positions (n, 3), in metres; indices (m, 3), or None if every
        three consecutive vertices form a triangle; normals (n, 3); uvs (n, 2), where (0, 0) is an image's
        upper left corner; colors (n, 4), linear RGBA. Arrays of float32, or of uint32 for indices, are not
        copied, whatever their strides. The library reads them when it reads the scene, so they must not
        change until the next render has begun."""
        mesh = _native.Mesh(is_borrowed=True, material=material and material.encode('utf-8'))
        kept = []
        for values, what, member, stride, width in (
                (positions, 'positions', 'positions', 'position_stride', 3),
                (normals, 'normals', 'normals', 'normal_stride', 3),
                (uvs, 'uvs', 'uvs', 'uv_stride', 2), (colors, 'colors', 'colors', 'color_stride', 4)):
            if values is None:
                continue
            given = _arrays.take(values, f'{name}: {what}', width)
            if what == 'positions':
                mesh.vertex_count = given.count
            elif given.count != mesh.vertex_count:
                raise _context._errors.InputError(
                    f'{name}: {what}: there are {given.count} elements; expected {mesh.vertex_count}, one per '
                    'position', expected=str(mesh.vertex_count))
            setattr(mesh, member, given.address)
            setattr(mesh, stride, given.stride)
            kept.append(given)
        mesh.triangle_count = mesh.vertex_count // 3
        if indices is not None:
            given = _arrays.take(indices, f'{name}: indices', 3, 'u')
            mesh.triangle_count, mesh.indices, mesh.index_stride = given.count, given.address, given.stride
            kept.append(given)
        self._call(lib.scene_add_mesh, name.encode('utf-8'), ctypes.byref(mesh))
        self._kept[name] = kept

    def check(self):
        """Reads the scene now, so that errors in it are found."""
        self._call(lib.scene_check, None)


def load(path, *, defines=None, allow_outside_paths=False, strict=False, context=None, **more_defines):
    """Loads a .json, .gltf, .glb, .obj, .ply or .stl file. Other arguments set values of names that the scene
    file defines, as `lampyris render -D` does: load('room.json', roughness=.2)."""
    return Scene(defines={**(defines or {}), **more_defines}, allow_outside_paths=allow_outside_paths,
                 strict=strict, context=context, _path=os.fspath(path))
