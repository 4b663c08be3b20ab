"""Describes the five scenes, each once for both renderers.

A description is a dict of plain values, from which lampyris_scene.py makes a scene file and cycles_scene.py the objects of
Blender. Lengths are metres, y is up, colours and radiances are linear Rec. 709, and the picture is a square.

    camera        position, target, fov_degrees
    materials     by name: kind and its parameters (below)
    meshes        by name: the PLY file
    objects       mesh, material and the matrix (3 x 4, row by row) that moves it into the world, or None
    quad_lights   corner, u, v, radiance: a lamp that shines to the side of u x v, with nothing behind it
    environment   an EXR file in latitude and longitude, or None

Kinds of materials, chosen so that both programs have the very same formula:

    diffuse   color: Lambert's surface
    glass     ior: a perfectly smooth dielectric
    metal     color, roughness: GGX of alpha = roughness^2 and Smith's separable masking, by single scattering, whose
              reflectance is the colour at every angle
    plastic   color, ior: Lambert's surface under a perfectly smooth dielectric; with Fresnel's reflectance F of the
              direction towards the eye, F of a mirror and 1 - F of Lambert's surface
    light     radiance: emits to both sides and reflects nothing
"""
import array
import hashlib
import json
import math
import os
import random

import exr
import geometry

MAX_BOUNCES = 9  # scattering events on a path
SKY_SIZE = (1024, 512)
SUN = {'elevation_degrees': 35.0, 'azimuth_degrees': 130.0, 'radius_degrees': 1.5, 'radiance': (1100.0, 950.0, 700.0)}

WHITE = {'kind': 'diffuse', 'color': (.73, .73, .7)}
RED = {'kind': 'diffuse', 'color': (.62, .08, .06)}
GREEN = {'kind': 'diffuse', 'color': (.14, .44, .1)}


def _sky_radiance(direction, sun):
    x, y, z = direction
    if y < 0:
        return (.2, .18, .15)
    up = math.sqrt(y)
    sky = [a + (b - a) * up for a, b in zip((.9, .95, 1.0), (.25, .45, .9))]
    angle = math.degrees(math.acos(min(1, x * sun[0] + y * sun[1] + z * sun[2])))
    # The sun's limb is one or two texels wide, so that the interpolation matters.
    part = min(1, max(0, (SUN['radius_degrees'] + .25 - angle) / .5))
    return [a + part * b for a, b in zip(sky, SUN['radiance'])]


def write_sky(path):
    """Writes a gradient with a sun of 3 degrees, in the convention of docs/lighting.md."""
    width, height = SKY_SIZE
    elevation, azimuth = (math.radians(SUN[key]) for key in ('elevation_degrees', 'azimuth_degrees'))
    sun = (math.cos(elevation) * math.cos(azimuth), math.sin(elevation), math.cos(elevation) * math.sin(azimuth))
    planes = [array.array('f') for _ in range(3)]
    for row in range(height):
        theta = math.pi * (row + .5) / height
        for column in range(width):
            phi = 2 * math.pi * ((column + .5) / width - .5)
            direction = (math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi))
            for plane, value in zip(planes, _sky_radiance(direction, sun)):
                plane.append(value)
    exr.write(path, width, height, planes)


def write_even(path):
    """Writes radiance 1 in all directions, under which a surface shows its albedo."""
    exr.write(path, 16, 8, [array.array('f', [1] * (16 * 8)) for _ in range(3)])


# Functions that make environments and meshes, by the name of the file; a file is made when a scene needs it.
ENVIRONMENTS = {'sky.exr': write_sky, 'even.exr': write_even}
MESHES = {
    'floor.ply': lambda: geometry.quad((-60, 0, 60), (120, 0, 0), (0, 0, -120)),
    'white.ply': lambda: geometry.joined(
        geometry.quad((-1, 0, 1), (2, 0, 0), (0, 0, -2)), geometry.quad((-1, 0, -1), (2, 0, 0), (0, 2, 0)),
        # The ceiling has a hole for the lamp, so that the lamp's back is not visible.
        geometry.quad((-1, 2, -1), (2, 0, 0), (0, 0, .7)), geometry.quad((-1, 2, .3), (2, 0, 0), (0, 0, .7)),
        geometry.quad((-1, 2, -.3), (.6, 0, 0), (0, 0, .6)), geometry.quad((.4, 2, -.3), (.6, 0, 0), (0, 0, .6))),
    'left.ply': lambda: geometry.quad((-1, 0, 1), (0, 0, -2), (0, 2, 0)),
    'right.ply': lambda: geometry.quad((1, 0, -1), (0, 0, 2), (0, 2, 0)),
    'tall.ply': lambda: geometry.box((-.65, 0, -.6), (-.05, 1.2, 0), 17),
    'short.ply': lambda: geometry.box((.05, 0, .05), (.65, .6, .65), -18),
    'ball.ply': lambda: geometry.icosphere(5),
    'pebble.ply': lambda: geometry.icosphere(3),
    'lamp.ply': lambda: geometry.globe(32, 17),
    'torus.ply': lambda: geometry.displaced_torus(1040, 640),
    'hall.ply': lambda: geometry.joined(
        geometry.quad((-8, -.4, 12), (16, 0, 0), (0, 0, -16)), geometry.quad((-8, -.4, -4), (16, 0, 0), (0, 12, 0))),
}
for _i, _plate in enumerate((((-3.2, .2748, 5.469), (0, .1503, -.938)), ((-3.2, .4738, 4.0579), (0, .2524, -.9159)),
                             ((-3.2, .865, 2.6375), (0, .37, -.875)), ((-3.2, 1.4947, 1.3005), (0, .5107, -.8011)))):
    MESHES['plate-%d.ply' % _i] = lambda plate=_plate: geometry.quad(plate[0], (6.4, 0, 0), plate[1])


def _place(x, y, z, scale):
    return (scale, 0, 0, x, 0, scale, 0, y, 0, 0, scale, z)


def _object(mesh, material, matrix=None):
    return {'mesh': mesh, 'material': material, 'matrix': matrix}


def _room(objects, materials):
    return {
        'camera': {'position': (0, 1, 4.9), 'target': (0, 1, 0), 'fov_degrees': 30},
        'materials': dict({'white': WHITE, 'red': RED, 'green': GREEN}, **materials),
        'objects': [_object('white', 'white'), _object('left', 'red'), _object('right', 'green'), *objects],
        'quad_lights': [{'corner': (-.4, 2, -.3), 'u': (.8, 0, 0), 'v': (0, 0, .6), 'radiance': (17, 14, 9)}],
        'environment': None,
    }


def box():
    return _room([_object('tall', 'white'), _object('short', 'white')], {})


def glass():
    return _room([_object('ball', 'glass', _place(.45, .4, .35, .4)), _object('ball', 'metal', _place(-.4, .5, -.3, .5))],
                 {'glass': {'kind': 'glass', 'ior': 1.5},
                  'metal': {'kind': 'metal', 'color': (.9, .7, .4), 'roughness': .3}})


def mesh():
    return {
        'camera': {'position': (0, 2.6, 4.6), 'target': (0, .35, 0), 'fov_degrees': 32},
        'materials': {'clay': {'kind': 'diffuse', 'color': (.6, .45, .35)},
                      'ground': {'kind': 'diffuse', 'color': (.5, .5, .5)}},
        'objects': [_object('torus', 'clay', _place(0, .75, 0, 1)), _object('floor', 'ground')],
        'quad_lights': [],
        'environment': 'sky.exr',
    }


def plates():
    materials = {'room': {'kind': 'diffuse', 'color': (.4, .4, .4)}}
    objects = [_object('hall', 'room')]
    for i, roughness in enumerate((.45, .28, .15, .08)):
        materials['plate-%d' % i] = {'kind': 'metal', 'color': (.9, .75, .5), 'roughness': roughness}
        objects.append(_object('plate-%d' % i, 'plate-%d' % i))
    lamps = ((-2.7, 4.6, 0, .0333, 900), (-1.1, 4.6, 0, .1, 100), (.6, 4.6, 0, .3, 11.1), (2.7, 4.6, 0, .9, 1.235),
             (0, 9, 9, .4, 80))
    for i, (x, y, z, radius, radiance) in enumerate(lamps):
        materials['lamp-%d' % i] = {'kind': 'light', 'radiance': (radiance,) * 3}
        objects.append(_object('lamp', 'lamp-%d' % i, _place(x, y, z, radius)))
    return {
        'camera': {'position': (0, 3.2, 12), 'target': (0, 1.75, 3), 'fov_degrees': 44},
        'materials': materials, 'objects': objects, 'quad_lights': [], 'environment': None,
    }


def spheres():
    materials = {
        'ground': {'kind': 'diffuse', 'color': (.5, .48, .45)},
        'chalk': {'kind': 'diffuse', 'color': (.75, .72, .68)}, 'moss': {'kind': 'diffuse', 'color': (.18, .34, .08)},
        'red': {'kind': 'plastic', 'color': (.55, .1, .08), 'ior': 1.5},
        'blue': {'kind': 'plastic', 'color': (.05, .16, .5), 'ior': 1.5},
        'silver': {'kind': 'metal', 'color': (.93, .91, .88), 'roughness': .15},
        'gold': {'kind': 'metal', 'color': (.95, .7, .3), 'roughness': .3},
        'copper': {'kind': 'metal', 'color': (.9, .55, .4), 'roughness': .5},
    }
    kinds = sorted(set(materials) - {'ground'})
    numbers = random.Random(1)
    objects = [_object('floor', 'ground')]
    for i in range(10000):  # one in each square metre
        x, z, size = (numbers.random() for _ in range(3))
        radius = .15 + .3 * size * size
        objects.append(_object('pebble', kinds[numbers.randrange(len(kinds))], _place(
            i % 100 - 50 + radius + x * (1 - 2 * radius), radius, i // 100 - 50 + radius + z * (1 - 2 * radius), radius)))
    return {
        'camera': {'position': (0, 6, 38), 'target': (0, 0, 26), 'fov_degrees': 34},
        'materials': materials, 'objects': objects, 'quad_lights': [], 'environment': 'sky.exr',
    }


SCENES = {
    'box': ('a box with a quad light', box),
    'glass': ('glass and rough metal in it', glass),
    'mesh': ('a displaced mesh of 1.3 M triangles under a sky with a sun', mesh),
    'plates': ("Veach's plates with mesh lights", plates),
    'spheres': ('10,000 instanced spheres under the sky', spheres),
}


def describe(name):
    description = SCENES[name][1]()
    description.update(name=name, max_bounces=MAX_BOUNCES,
                       meshes={o['mesh']: o['mesh'] + '.ply' for o in description['objects']})
    return description


def write_files(description, folder):
    """Writes missing meshes and the environment, then the description. Returns a value that identifies the
    scene."""
    files = list(description['meshes'].values())
    if description['environment']:
        files.append(description['environment'])
    for file in files:
        path = os.path.join(folder, file)
        if not os.path.exists(path):
            if file in ENVIRONMENTS:
                ENVIRONMENTS[file](path + '.part')
            else:
                geometry.write_ply(path + '.part', MESHES[file]())
            os.replace(path + '.part', path)
    text = json.dumps(description, sort_keys=True)
    with open(os.path.join(folder, description['name'] + '.description.json'), 'w') as file:
        file.write(text)
    identity = hashlib.sha256(text.encode('ascii'))
    for file in sorted(files):
        with open(os.path.join(folder, file), 'rb') as data:
            identity.update(data.read())
    return identity.hexdigest()[:16]
