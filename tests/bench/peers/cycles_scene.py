"""Runs inside Blender. Makes a scene from a description, and renders it with Cycles as often as requested.

    blender -b --factory-startup --python-exit-code 1 --python cycles_scene.py -- FOLDER SCENE

Each line of standard input is a JSON object with spp, seed, size and file (an EXR file to write). The answer to each is a
line "peers: " and a JSON object: wall and processor seconds of the whole render, both of this process. The first line
says who answers.
"""
import json
import os
import resource
import sys
import time

import bpy
import numpy
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import geometry  # noqa: E402

# In the descriptions y is up, in Blender z.
UPRIGHT = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))


def answer(**values):
    print('\npeers: ' + json.dumps(values), flush=True)


def place(point):
    return UPRIGHT @ Vector(point)


# --- Materials -----------------------------------------------------------------------------------


def _new_node(tree, kind, **inputs):
    node = tree.nodes.new(kind)
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    return node


def _color(values):
    return (*values, 1)


def _glossy(tree, color, roughness):
    node = _new_node(tree, 'ShaderNodeBsdfGlossy', Color=_color(color), Roughness=roughness)
    node.distribution = 'GGX' if roughness else 'SHARP'
    return node


def _surface(tree, description):
    kind = description['kind']
    if kind == 'diffuse':
        return _new_node(tree, 'ShaderNodeBsdfDiffuse', Color=_color(description['color']), Roughness=0)
    if kind == 'glass':
        node = _new_node(tree, 'ShaderNodeBsdfGlass', Color=_color((1, 1, 1)), Roughness=0, IOR=description['ior'])
        node.distribution = 'SHARP'
        return node
    if kind == 'metal':
        return _glossy(tree, description['color'], description['roughness'])
    if kind == 'plastic':
        node = tree.nodes.new('ShaderNodeMixShader')
        tree.links.new(_new_node(tree, 'ShaderNodeFresnel', IOR=description['ior']).outputs[0], node.inputs[0])
        base = _new_node(tree, 'ShaderNodeBsdfDiffuse', Color=_color(description['color']), Roughness=0)
        tree.links.new(base.outputs[0], node.inputs[1])
        tree.links.new(_glossy(tree, (1, 1, 1), 0).outputs[0], node.inputs[2])
        return node
    if kind == 'light':
        return _new_node(tree, 'ShaderNodeEmission', Color=_color(description['radiance']), Strength=1)
    raise ValueError('there is no kind of materials "%s"' % kind)


def make_material(name, description):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new('ShaderNodeOutputMaterial')
    tree.links.new(_surface(tree, description).outputs[0], output.inputs['Surface'])
    return material


# --- Objects, lights, the camera -----------------------------------------------------------------


def make_mesh(name, path, material):
    vertices, triangles, normals = geometry.read_ply(path)
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set('co', numpy.ascontiguousarray(vertices).ravel())
    mesh.loops.add(3 * len(triangles))
    mesh.loops.foreach_set('vertex_index', numpy.ascontiguousarray(triangles).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set('loop_start', numpy.arange(0, 3 * len(triangles), 3, dtype=numpy.int32))
    mesh.polygons.foreach_set('loop_total', numpy.full(len(triangles), 3, dtype=numpy.int32))
    mesh.polygons.foreach_set('use_smooth', numpy.full(len(triangles), normals is not None))
    mesh.update(calc_edges=True)
    mesh.materials.append(material)
    return mesh


def add_object(scene, name, data, matrix):
    thing = bpy.data.objects.new(name, data)
    thing.matrix_world = matrix
    scene.collection.objects.link(thing)
    return thing


def add_objects(scene, description, folder):
    materials = {name: make_material(name, one) for name, one in description['materials'].items()}
    meshes = {}
    for i, thing in enumerate(description['objects']):
        key = thing['mesh'], thing['material']
        if key not in meshes:
            path = os.path.join(folder, description['meshes'][thing['mesh']])
            meshes[key] = make_mesh('%s-%s' % key, path, materials[thing['material']])
        matrix = Matrix.Identity(4)
        if thing['matrix']:
            matrix = Matrix([*(thing['matrix'][4 * row:4 * row + 4] for row in range(3)), (0, 0, 0, 1)])
        add_object(scene, 'object-%d' % i, meshes[key], UPRIGHT @ matrix)


def add_quad_light(scene, number, description):
    """Cycles' area light shines along its own -z. Its radiance is its "power" over four times its area."""
    corner, u, v = (Vector(description[key]) for key in ('corner', 'u', 'v'))
    light = bpy.data.lights.new('light-%d' % number, 'AREA')
    light.shape, light.size, light.size_y = 'RECTANGLE', u.length, v.length
    light.use_shadow = True
    light.cycles.max_bounces = 1024
    light.cycles.use_multiple_importance_sampling = True
    strength = max(description['radiance'])
    light.color = [value / strength for value in description['radiance']]
    light.energy = strength * 4 * u.length * v.length
    x, y = u.normalized(), -v.normalized()
    axes = Matrix((x, y, x.cross(y))).transposed().to_4x4()
    middle = Matrix.Translation(corner + u / 2 + v / 2)
    lamp = add_object(scene, 'light-%d' % number, light, UPRIGHT @ middle @ axes)
    lamp.visible_camera = True
    return lamp


def set_world(scene, description, folder):
    scene.world = world = bpy.data.worlds.new('world')
    world.use_nodes = True
    background = world.node_tree.nodes['Background']
    if not description['environment']:
        background.inputs['Color'].default_value = (0, 0, 0, 1)
        return
    texture = world.node_tree.nodes.new('ShaderNodeTexEnvironment')
    texture.image = bpy.data.images.load(os.path.join(folder, description['environment']))
    texture.image.colorspace_settings.name = 'Linear'
    texture.interpolation = 'Linear'
    world.node_tree.links.new(texture.outputs['Color'], background.inputs['Color'])
    # The sampling map is constant in each cell, but the radiance is bilinear. With the image's own
    # resolution, which is the default, light from the sun's limb has almost no probability, and the error on
    # the mesh is ten times as large.
    world.cycles.sampling_method = 'MANUAL'
    world.cycles.sample_map_resolution = 4 * texture.image.size[0]
    world.cycles.max_bounces = 1024


def set_camera(scene, description):
    camera = bpy.data.cameras.new('camera')
    camera.sensor_fit, camera.lens_unit = 'VERTICAL', 'FOV'
    camera.angle = numpy.radians(description['fov_degrees'])
    camera.clip_start, camera.clip_end = 1e-3, 1e5
    position, target = place(description['position']), place(description['target'])
    turn = (target - position).to_track_quat('-Z', 'Y').to_matrix().to_4x4()
    scene.camera = add_object(scene, 'camera', camera, Matrix.Translation(position) @ turn)


# --- Cycles --------------------------------------------------------------------------------------


def set_cycles(scene, max_bounces):
    """Sets Cycles up like Lampyris: no contribution is clamped, and paths have max_bounces scattering
    events."""
    scene.render.engine = 'CYCLES'
    cycles = scene.cycles
    cycles.device = 'CPU'
    cycles.sampling_pattern = 'SOBOL'
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.use_fast_gi = False
    cycles.blur_glossy = 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.pixel_filter_type = 'BOX'  # the filter has the width of a pixel, whatever filter_width is
    # Cycles counts only the surfaces between the first and the last one.
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = max_bounces - 1
    cycles.transmission_bounces = cycles.transparent_max_bounces = max_bounces - 1


def set_output(scene):
    render = scene.render
    render.use_persistent_data = True  # the BVH is built once for all renders of a scene
    render.use_compositing = render.use_sequencer = False
    render.film_transparent = False
    render.dither_intensity = 0
    render.threads_mode = 'AUTO'
    render.resolution_percentage = 100
    scene.view_settings.view_transform = 'Standard'
    settings = render.image_settings
    settings.file_format, settings.color_mode = 'OPEN_EXR', 'RGB'
    settings.color_depth, settings.exr_codec = '32', 'NONE'


def make_scene(description, folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    add_objects(scene, description, folder)
    for i, light in enumerate(description['quad_lights']):
        add_quad_light(scene, i, light)
    set_world(scene, description, folder)
    set_camera(scene, description['camera'])
    set_cycles(scene, description['max_bounces'])
    set_output(scene)
    return scene


def processor_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def render(scene, spp, seed, size, file):
    scene.cycles.samples, scene.cycles.seed = spp, seed
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.filepath = file
    wall, processor = time.monotonic(), processor_seconds()
    bpy.ops.render.render(write_still=True)
    answer(seconds=time.monotonic() - wall, processor_seconds=processor_seconds() - processor)


def main():
    folder, name = sys.argv[sys.argv.index('--') + 1:]
    with open(os.path.join(folder, name + '.description.json')) as file:
        scene = make_scene(json.load(file), folder)
    answer(renderer='Cycles', version=bpy.app.version_string, objects=len(scene.objects))
    for line in sys.stdin:
        render(scene, **json.loads(line))


main()
