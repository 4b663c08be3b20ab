"""Writes scene files of Lampyris (docs/scene-format.md) from the descriptions in scenes.py."""
import json
import os


def _material(description):
    kind = description['kind']
    if kind == 'diffuse':
        return {'type': 'diffuse', 'base_color': description['color']}
    if kind == 'glass':
        return {'type': 'dielectric', 'ior': description['ior']}
    if kind == 'metal':
        # With a specular colour of white, Schlick's curve is white at every angle; "mixed" multiplies it by
        # the specular colour.
        return {'type': 'principled', 'metallic': 1, 'base_color': [1, 1, 1], 'specular_fresnel': 'mixed',
                'specular_color': description['color'], 'roughness': description['roughness'],
                'masking': 'separable', 'compensate': False}
    if kind == 'plastic':
        # With glTF's layers the base is a Lambertian surface, which a smooth layer weights by 1 - F
        # (docs/materials.md).
        return {'type': 'principled', 'layers': 'gltf', 'base_color': description['color'], 'roughness': 0,
                'ior': description['ior']}
    if kind == 'light':
        return {'type': 'diffuse', 'base_color': [0, 0, 0], 'emission': description['radiance']}
    raise ValueError('there is no kind of materials "%s"' % kind)


def _shapes(description):
    """Returns a shape for each mesh that occurs once; other meshes become instances of a hidden one."""
    uses = {}
    for thing in description['objects']:
        uses[thing['mesh']] = uses.get(thing['mesh'], 0) + 1
    shared = set()
    for thing in description['objects']:
        name, transform = thing['mesh'], {}
        if thing['matrix']:
            transform = {'transform': {'matrix': [*thing['matrix'], 0, 0, 0, 1]}}
        mesh = {'type': 'mesh', 'file': description['meshes'][name], 'material': thing['material']}
        if uses[name] == 1:
            yield dict(mesh, **transform)
            continue
        if name not in shared:
            shared.add(name)
            yield dict(mesh, name=name, hidden=True)
        yield dict({'type': 'instance', 'of': name, 'material': thing['material']}, **transform)


def document(description):
    materials = {name: _material(material) for name, material in description['materials'].items()}
    shapes = list(_shapes(description))
    for i, light in enumerate(description['quad_lights']):
        materials['quad-light-%d' % i] = _material({'kind': 'light', 'radiance': light['radiance']})
        shapes.append({'type': 'quad', 'material': 'quad-light-%d' % i,
                       'corner': light['corner'], 'u': light['u'], 'v': light['v']})
    result = {
        'lampyris': 1, 'comment': 'Made by tests/bench/peers.',
        'camera': dict(description['camera'], type='perspective'),
        'settings': {'max_bounces': description['max_bounces']},
        'environment': {'radiance': [0, 0, 0]}, 'materials': materials, 'shapes': shapes,
    }
    if description['environment']:
        result['environment'] = {'type': 'image', 'file': description['environment']}
    return result


def write(description, folder):
    """Writes the scene file, beside its meshes and its sky, and returns its path."""
    path = os.path.join(folder, description['name'] + '.json')
    with open(path, 'w') as file:
        json.dump(document(description), file)
    return path
