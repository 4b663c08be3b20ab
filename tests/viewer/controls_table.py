"""Defines what the tour does with every control of the panel.

An entry is (id, value[, effect[, back]]): the value that is set, what has to change because of it
(result: the picture or what is known of it; picture; state: what the viewer says it is doing), and
how it is taken back: by undoing, where nothing is said; None: it stays; else another value.
A string is a command of its own (docs/viewer.md), which counts for the ids that it names.

The ids of rows have their number as '#' where the table is compared with the panel.
"""
UNDO = 'undo'


def each(name, first, words, effect='result'):
    """Sets each word, and finally the first one again."""
    return [(name, word, effect, None) for word in words[:-1]] + [(name, words[-1], effect, first)]


# The tabs and the search box of the panel.
PANEL = [
    *[('panel.' + name, 'on', 'state', None) for name in ('scene', 'object', 'camera', 'measure', 'render')],
    'set panel.search "tone curve"', 'wait 2 frames', 'expect item.panel.search == "tone curve"',
    'set panel.search ""',
    # A click on an object opens the tab in which it is selected.
    'set panel.search exposure', 'wait 2 frames', 'mouse 168 100', 'button left', 'wait 4 frames',
    'expect picked.distance > 0', 'expect item.panel.object == on', 'expect item.panel.search == ""',
    'press panel.render',
]

VIEW = [
    ('view.exposure', '1.5', 'picture'),
    ('view.exposure_auto', 'on', 'picture', None),
    ('view.exposure_auto', 'off', 'none', None),  # the exposure stays as computed
    ('view.exposure', '0', 'picture', None),
    *each('view.tone', 'none', ['reinhard', 'aces', 'agx'], 'picture'),
    *each('view.aov', 'radiance', ['albedo', 'normal', 'objects', 'materials', 'samples', 'variance', 'steps',
                       'emission', 'direct', 'indirect'], 'picture'),
    ('view.aov', 'depth', 'picture', None),
    ('view.automatic', 'off', 'none', None),  # the range stays until it is changed
    ('view.range_low', '1', 'picture', None),
    ('view.range_high', '7', 'picture', None),
    ('view.automatic', 'on', 'picture', None),
    ('view.aov', 'radiance', 'picture', None),
    # The squares are only visible if the picture has fewer pixels than the window, as while the camera moves.
    ('view.nearest', 'on', 'none'),
    ('view.denoise', 'on', 'picture', None),
    ('view.denoise_iterations', '1', 'picture'),
    # This setting has an effect only while the camera moves.
    ('view.denoise_temporal', 'off', 'none'),
    ('view.denoise', 'off', 'picture', None),
    ('view.split', 'on', 'result', None),
    ('view.split_at', '0.25', 'picture'),
    ('renderer.side', 'B', 'none', None),  # both sides have the same settings so far
    ('renderer.max_bounces', '0', 'picture', None),
    ('renderer.side', 'A', 'state', None),
    ('view.swap', '', 'picture'),
    ('view.split', 'off', 'result', None),
    ('statistics.error_by', 'part', 'result', None),
    ('statistics.error_by', 'off', 'none', None),
    ('view.frame_ms', '50', 'state', '33'),
    ('view.pause', 'on', 'state', 'off'),
    ('view.undocked', 'on', 'state', None),
    'wait 2 frames', 'expect window.picture.2 == 240', 'expect window.panel_place.0 > 10',
    # The bar moves the window; the camera does not move.
    'mouse 60 32', 'button left down', 'wait 2 frames', 'mouse 90 52', 'wait 2 frames',
    'button left up', 'wait 2 frames', 'expect window.panel_place.0 > 40',
    'expect window.panel_place.1 > 30', 'expect camera.position.2 < 1e9',
    'set view.undocked off', 'wait 2 frames', 'expect window.panel_place.0 == 0',
    'expect window.picture.2 < 240',
]

RENDERER = [
    ('renderer.spp', '3'),
    ('renderer.seed', '5'),
    *each('renderer.integrator', 'path', ['direct', 'whitted']),
    ('renderer.integrator', 'ao', 'result', None),
    ('renderer.ao_distance', '0.4'),
    ('renderer.integrator', 'path', 'result', None),
    ('renderer.max_bounces', '2'),
    *each('renderer.directions', 'bsdf', ['sphere', 'hemisphere', 'cosine']),
    ('renderer.directions', 'power-cosine', 'result', None),
    ('renderer.direction_exponent', '4'),
    ('renderer.directions', 'bsdf', 'result', None),
    ('renderer.normals', 'ndf'),
    # This changes only views from inside closed bodies, and there are none here.
    ('renderer.radiance_scaling', 'off', 'none'),
    ('renderer.clamp', '0.3'),
    ('renderer.roulette', 'off'),
    ('renderer.roulette', 'constant', 'result', None),
    ('renderer.roulette_survival', '0.4'),
    ('renderer.roulette', 'frame', 'result', None),
    ('renderer.roulette_max_bounces', '2'),
    ('renderer.roulette', 'throughput', 'result', None),
    ('renderer.roulette_min_bounces', '0'),
    ('renderer.nee', 'off'),
    ('renderer.nee_depth', '1'),
    *each('renderer.mis', 'power', ['balance', 'none']),
    ('renderer.mis_exponent', '1'),
    ('renderer.min_density', '0.05'),
    ('renderer.split_lobes', '1'),
    ('renderer.pixel_jitter', 'off'),
    *each('renderer.pixel_sampling', 'sampler', ['centre', 'random', 'stratified']),
    ('renderer.pixel_sampling', 'grid', 'result', None),
    ('renderer.pixel_strata', '2'),
    ('renderer.pixel_sampling', 'sampler', 'result', None),
    *each('renderer.filter', 'box', ['tent', 'gaussian', 'blackman-harris']),
    ('renderer.filter_radius', '2'),
    *each('renderer.sampler', 'sobol', ['pcg', 'lcg', 'stratified', 'grid', 'blue-noise', 'sine']),
    ('renderer.halves', 'contiguous'),
    # With one sample per half, sum and running mean are equal; tests of the film distinguish them.
    ('renderer.film_accumulation', 'running', 'none', None),
    ('renderer.film_accumulation', 'binned', 'none', None),
    ('renderer.wave', '1024'),
    ('renderer.workgroup', '32'),
    ('renderer.features', 'all'),
    # Each frame is a new picture, so none has two samples.
    'set renderer.samples_a_frame 1', 'set renderer.accumulation "fresh frames"', 'wait 10 frames',
    'expect sides.0.samples <= 1', 'set renderer.accumulation accumulate', 'wait 2 samples',
    'set renderer.samples_a_frame 0',
]

CAMERA = [
    ('camera.fov', '30', 'picture'),
    ('camera.position', '0.5,1,3', 'picture'),
    ('camera.direction', '0.1,-0.2,-1', 'picture'),
    ('camera.lens_radius', '60', 'picture', None),
    ('camera.focus', '2', 'picture'),
    ('camera.blades', '5', 'picture', None),
    ('camera.blade_rotation', '30', 'picture'),
    ('camera.reset', '', 'picture'),
    ('camera.frame', '', 'picture'),
    ('camera.kind', 'panoramic', 'picture'),
    ('camera.kind', 'orthographic', 'picture', None),
    ('camera.height', '5', 'picture'),
    ('camera.kind', 'perspective', 'picture', None),
    'press camera.reset',
    ('camera.save', '', 'state', None),
    ('camera.slot', '3', 'state', None),
    ('camera.slot', '1', 'state', None),
    'set camera.fov 55',
    ('camera.restore', '', 'picture'),
    ('camera.clear', '', 'state', None),
    'press camera.reset',
    ('camera.mode', 'orbit', 'state', None),
    ('camera.speed', '2', 'state', None),
    ('camera.revolve_speed', '90', 'state', None),
    'set camera.revolves on', 'wait 5 frames', 'expect rig.revolves == true',
    'press camera.stop', 'wait 2 frames', 'expect rig.revolves == false',
    'set camera.revolves on', 'set camera.revolves off', 'expect rig.revolves == false',
    'set camera.revolve_speed 0', 'set camera.revolves on', 'key d down', 'wait 3 frames', 'key d up',
    'expect rig.revolve_speed > 3', 'set camera.revolves off', 'expect times.header ~ camera',
    'press camera.reset',
    ('camera.mode', 'fly', 'state', None),
    'press camera.reset',
    'press camera.copy', 'expect message.text ~ JSON',
]

SCENE = [
    'set scene.path other.json', 'wait 3 frames', 'wait 1 samples', 'expect scene ~ other.json',
    'set scene.recent.1 on', 'wait 3 frames', 'wait 1 samples', 'expect scene ~ tour.json',
    'set scene.file.0 on', 'wait 3 frames', 'wait 1 samples', 'expect scene ~ cameras.gltf',
    'set scene.path tour.json', 'wait 3 frames', 'wait 1 samples', 'expect scene ~ tour.json',
    'copy other.json tour.json', 'press scene.reload', 'wait 3 frames', 'wait 1 samples',
    'expect counts.lights == 0', 'copy tour-whole.json tour.json', 'press scene.reload',
    'wait 3 frames', 'wait 1 samples', 'expect counts.lights == 2',
    ('scene.watch', 'on', 'state', 'off'),
    ('surroundings.strength', '3'),
    ('surroundings.kind', 'none'),
    ('surroundings.kind', 'constant', 'result', None),
    ('surroundings.color', '1,0.2,0.1'),
    ('surroundings.kind', 'sky', 'result', None),
    ('surroundings.rotation', '90'),
    ('renderer.environment_filter', 'nearest'),
    ('renderer.environment_sampling', 'luminance'),
    ('surroundings.turbidity', '8'),
    ('surroundings.elevation', '10'),
    ('surroundings.azimuth', '120'),
    ('surroundings.sun', 'off'),
    ('surroundings.image', 'bumps.png'),
    ('surroundings.kind', 'original', 'result', None),
]

LIGHTS = [
    ('lights.filter', 'sun', 'state', ''),
    *each('renderer.light_choice', 'auto', ['uniform', 'all', 'tree']),
    ('renderer.anisotropy', 'off'),
    ('renderer.classes', 'merged'),
    ('lights.1', 'on', 'state', None),
    ('light.diameter', '20'),
    ('light.direction', '0.5,-1,0'),
    ('light.intensity', '5'),
    ('light.color', '1,0.1,0.1'),
    ('light.kind', 'point'),
    ('lights.0', 'on', 'state', None),
    ('light.profile_off', ''),
    ('light.position', '-0.5,2,1'),
    ('light.inner_angle', '35'),
    ('light.outer_angle', '20'),
    ('light.range', '1.5'),
    ('light.intensity', '40'),
    ('light.kind', 'directional'),
    ('light.visible', 'off'),
    ('lights.1', 'on', 'state', None),
    ('light.exchange', ''),
    ('lights.add', ''),
    ('lights.add_area', ''),
]

# For each material of the scene: its number, and the controls that are changed.
MATERIALS = [
    ('materials.filter', 'gro', 'state', ''),
    ('materials.1', 'on', 'state', None),
    *each('material.model', 'diffuse', ['mirror', 'principled', 'dielectric', 'conductor', 'phong',
                             'blinn_phong', 'microfacet']),
    ('materials.0', 'on', 'state', None),
    ('material.base_color', '0.1,0.6,0.2'),
    ('material.emission', '1,2,3', 'result', None),
    ('material.unlit', 'on'),
    ('material.emission', '0,0,0', 'result', None),
    ('material.anisotropic', '0.1'),
    ('material.roughness', '0.8'),
    ('material.metallic', '0.9'),
    ('material.anisotropic_rotation', '0.6'),
    ('material.specular_color', '0.4,0.2,0.9'),
    ('material.specular_weight', '0.2'),
    ('material.transmission', '0.9'),
    ('material.ior', '1.9'),
    ('material.specular', '0.1'),
    ('material.specular_tint', '1'),
    ('material.specular_fresnel', 'mixed'),
    ('material.clearcoat', '0.1'),
    ('material.coat_fresnel', 'exact'),
    ('material.coat', 'burley', 'result', None),
    ('material.clearcoat_gloss', '0.3'),
    ('material.coat', 'ggx', 'result', None),
    ('material.clearcoat_roughness', '0.7'),
    ('material.normal_scale', '0.2'),
    ('material.sheen_color', '0.9,0.1,0.1'),
    ('material.sheen_roughness', '0.9'),
    ('material.subsurface', '0.9'),
    ('material.sheen', '1'),
    ('material.sheen_tint', '0'),
    ('material.layers', 'gltf'),
    ('material.iridescence', '1'),
    ('material.film_thickness', '300'),
    ('material.film_ior', '2'),
    ('material.dispersion', '4'),
    ('material.thin', 'on', 'result', None),
    ('material.diffuse_transmission', '0.8'),
    ('material.thin', 'off', 'result', None),
    ('material.tint_each', 'on'),
    ('material.compensate', 'off'),
    ('material.separable', 'on'),
    ('material.extinction', '3,1,9'),
    ('material.alpha', 'blend', 'none', None),  # the material is opaque so far
    ('material.opacity', '0.5', 'result', None),
    ('material.alpha', 'mask', 'result', None),
    ('material.alpha_cutoff', '0.8'),
    ('material.alpha', 'opaque', 'result', None),
    ('materials.2', 'on', 'state', None),
    ('material.medium_priority', '3', 'none'),  # no other medium overlaps it
    ('material.extinction', '9,9,9'),
    ('materials.3', 'on', 'state', None),
    *each('material.distribution', 'ggx', ['beckmann', 'phong']),
    ('material.distribution', 'phong', 'result', None),
    ('material.phong_exponent', '200'),
    ('material.distribution', 'ggx', 'result', None),
    *each('material.masking', 'smith', ['schlick_ggx', 'lh', 'rational', 'schlick', 'schlick_remapped',
                                        'rational_unbounded']),
    *each('material.diffuse', 'coupled', ['uncoupled']),
    ('material.fresnel', 'exact'),
    ('material.model', 'conductor', 'result', None),
    ('material.conductor_eta', '1,1,1'),
    ('material.conductor_k', '2,3,1'),
    ('material.model', 'phong', 'result', None),
    ('material.exponent', '200'),
]

OBJECTS = [
    ('object.filter', 'pot', 'state', ''),
    ('object.0.visible', 'off'),
    ('object.2.visible', 'off'),
    ('object.1', 'on', 'state', None),
    'mouse 216 99', 'button left', 'wait 3 frames', 'expect picked.distance > 0',
    ('objects.outline', 'off', 'none', 'on'),  # it is neither in the film nor in the picture
    ('picked.edit_material', '', 'state', None),
    ('picked.hide', ''),
    ('object.position', '0.3,0.4,0.1'),
    ('object.turn', '10,20,30', 'result', None),
    ('object.scale', '1.5,0.5,1', 'result', None),
    ('object.put_back', ''),
    'press lights.add_area', 'wait 2 samples', 'check material.emission 1,2,3 picture',
    ('object.exchange', ''),
]

FILES = [
    'press files.screenshot', 'wait idle', 'expect message.text ~ tour-0001.png',
    'set files.with_panel on', 'press files.screenshot', 'wait idle',
    'expect message.text ~ tour-0002.png', 'set files.with_panel off',
    'press files.exr', 'wait idle', 'expect message.text ~ tour-0001.exr',
    'set view.denoise on', 'wait 2 samples', 'set files.denoised on', 'press files.exr',
    'wait idle', 'expect message.text ~ tour-0002.exr', 'set files.denoised off',
    'set view.denoise off',
    'set files.scene_path written.json', 'press files.save_scene', 'wait idle',
    'expect message.text ~ written.json',
    'press shaders.reload', 'wait 2 frames', 'wait idle', 'expect message.text ~ shaders',
    'set renderer.seed 77', 'expect counts.undo > 0', 'press history.undo',
    'expect item.renderer.seed == 0', 'press history.redo', 'expect item.renderer.seed == 77',
    'press history.undo',
]

# These controls need a file with several cameras.
CAMERAS = [
    ('camera.of_scene', '1', 'picture'),
    ('animation.time', '0.5', 'picture'),
    ('animation.speed', '2', 'none', None),
    'set animation.plays on', 'wait 5 frames', 'set animation.plays off', 'wait 2 samples',
    'expect item.animation.time > 0.1',
]

STEPS = {'panel': PANEL, 'view': VIEW, 'renderer': RENDERER, 'camera': CAMERA, 'scene': SCENE, 'lights': LIGHTS,
         'materials': MATERIALS, 'objects': OBJECTS, 'files': FILES, 'cameras': CAMERAS}
