"""Checks what the bit of a feature changes in the code of kernels.

For each feature: the kernels' SPIR-V with the specialization constants frozen, with the feature and
without it, as a driver's compiler would see it. Functions, buffers and push constants that only the
feature needs must be there in the first and gone in the second, which must be smaller. Prints
instructions and bytes of both, calls inlined and debug names included.

Lobes of materials, the bits of a second constant, likewise.

    frozen.py short|all BINDINGS_H NAME.spv ...

`short` looks at the features in one kernel of each kind and at the choices of samplers, of emitters and
of nodes, and counts instructions before calls are inlined; `all` looks at everything.

Exit status: 0 passed, 1 failed, 77 skipped (without spirv-tools).
"""

import functools
import os
import re
import shutil
import subprocess
import sys
import tempfile

# Passes that replace local variables by values, and then propagate constants through branches. They run
# twice, because a removed branch leaves new constants.
PASSES = """--freeze-spec-const --fold-spec-const-op-composite
    --ssa-rewrite --ccp --eliminate-dead-branches --merge-blocks
    --ssa-rewrite --ccp --eliminate-dead-branches --merge-blocks
    --eliminate-dead-functions --eliminate-dead-code-aggressive
    --eliminate-dead-variables --eliminate-dead-const""".split()
# For the size, each call counts as inlined, because drivers inline calls.
INLINE = """--merge-return --inline-entry-points-exhaustive --eliminate-dead-functions --ssa-rewrite --ccp
    --eliminate-dead-branches --merge-blocks --eliminate-dead-code-aggressive""".split()

SDF_ALL = (1 << 26) - 1  # all operations of distance fields

# name: (features without which the rest is looked at, {kernel: what must go}). What must go is
#   name()       a function
#   [name]       a storage buffer, or name_texels a texel buffer
#   frame.name   a read of the uniform block
#   Name         an instruction, extended ones included
#   name() xN    N calls of a function fewer, the function may stay
#   -            nothing by name, but the kernel must become smaller
EMISSIVE = ["EMITTER_TRIANGLES", "EMITTER_SPHERES", "EMITTER_DISCS", "EMITTER_QUADS",
            "EMITTER_BOXES", "EMITTER_CYLINDERS", "EMITTER_TUBES"]
SHAPES = ["GEOMETRY_" + kind for kind in (
    "SPHERES", "LARGE_SPHERES", "DISCS", "PLANES", "QUADS", "BOXES", "CYLINDERS", "TUBES", "SDFS",
    "INSTANCES", "SMALL_TRIANGLES")] + EMISSIVE[1:]
FEATURES = {
    "triangles": (["TRIANGLES", "NORMALS", "EMITTER_TRIANGLES", "GEOMETRY_DUPLICATES",
                   "GEOMETRY_SMALL_TRIANGLES"], {
        "intersect_closest": ["intersect_triangle()", "intersect_triangle_leaf()", "[triangles]"],
        "intersect_shadow": ["intersect_triangle()", "intersect_triangle_leaf()", "[triangles]"],
        "shade_surface": ["load_triangle_surface()", "sample_triangle_light()", "[triangles]"],
    }),
    "spheres": (["GEOMETRY_SPHERES", "GEOMETRY_LARGE_SPHERES", "EMITTER_SPHERES"], {
        "intersect_closest": ["intersect_large_sphere()"],
        "intersect_shadow": ["intersect_large_sphere()"],
        "shade_surface": ["sample_sphere_light()", "pdf_sphere_cone()", "sphere_height()"],
    }),
    "large spheres": (["GEOMETRY_LARGE_SPHERES"], {
        "intersect_closest": ["intersect_large_sphere()", "exact_product()"],
        "intersect_shadow": ["intersect_large_sphere()", "exact_product()"],
        "shade_surface": ["sphere_height()", "exact_product()"],
    }),
    "planes": (["GEOMETRY_PLANES"], {
        "intersect_closest": ["intersect_plane()"],
        "intersect_shadow": ["intersect_plane()"],
        "shade_surface": ["place_on_plane()"],
    }),
    "quads": (["GEOMETRY_QUADS", "EMITTER_QUADS"], {
        "intersect_closest": ["intersect_quad()"],
        "intersect_shadow": ["intersect_quad()"],
        "shade_surface": ["surface_of_quad()", "place_on_quad()"],
    }),
    "boxes": (["GEOMETRY_BOXES", "EMITTER_BOXES"], {
        "intersect_closest": ["intersect_box()"],
        "intersect_shadow": ["intersect_box()"],
        "shade_surface": ["surface_of_box()", "sample_box()", "place_on_box()"],
    }),
    "cylinders": (["GEOMETRY_CYLINDERS", "EMITTER_CYLINDERS"], {
        "intersect_closest": ["intersect_cylinder()"],
        "intersect_shadow": ["intersect_cylinder()"],
        "shade_surface": ["cylinder_sight()"],
    }),
    "tubes": (["GEOMETRY_TUBES", "EMITTER_TUBES"], {
        "intersect_closest": ["intersect_tube()"],
        "intersect_shadow": ["intersect_tube()"],
        "shade_surface": ["intersect_tube()"],
    }),
    "all cylinders": (["GEOMETRY_CYLINDERS", "EMITTER_CYLINDERS", "GEOMETRY_TUBES",
                       "EMITTER_TUBES"], {
        "intersect_closest": ["intersect_round()", "side_bound()"],
        "intersect_shadow": ["intersect_round()", "side_bound()"],
        "shade_surface": ["surface_of_cylinder()", "place_on_cylinder()", "side_point()"],
    }),
    "discs": (["GEOMETRY_DISCS", "EMITTER_DISCS"], {
        "intersect_closest": ["intersect_disc()"],
        "intersect_shadow": ["intersect_disc()"],
        "shade_surface": ["-"],
    }),
    "distance fields": (["GEOMETRY_SDFS"], {
        "intersect_closest": ["march_sdf()", "sdf_value()", "frame.sdf_code"],
        "intersect_shadow": ["march_sdf()", "sdf_value()", "frame.sdf_code"],
        "shade_surface": ["load_sdf_surface()", "sdf_value()", "frame.sdf_code"],
    }),
    "shapes": (SHAPES, {
        "intersect_closest": ["intersect_shape_leaf()", "[shapes]"],
        "intersect_shadow": ["intersect_shape_leaf()", "[shapes]"],
        "shade_surface": ["load_shape_surface()", "sample_shape_light()", "[shapes]"],
    }),
    "instances": (["GEOMETRY_INSTANCES"], {
        "generate_rays": ["-"],
        "intersect_closest": ["enter_space()", "load_instance_inverse()"],
        "intersect_shadow": ["enter_space()", "load_instance_inverse()"],
        "shade_surface": ["place_point()", "load_instance_inverse()"],
        "shade_ao": ["place_point()", "load_instance_inverse()"],
        "shade_whitted": ["place_point()", "load_instance_inverse()"],
    }),
    "small triangles": (["GEOMETRY_SMALL_TRIANGLES"], {
        "intersect_closest": ["intersect_small_triangle()"],
        "intersect_shadow": ["intersect_small_triangle()", "is_beside_target()", "small_lamp_of()"],
        "shade_surface": ["triangle_size()", "is_hidden_by_lamp()"],
    }),
    "triangles in several leaves": (["GEOMETRY_DUPLICATES"], {
        "intersect_closest": ["-"],
        "intersect_shadow": ["-"],
    }),
    "shading normals": (["NORMALS", "NORMAL_MAPS"], {
        "shade_surface": ["bend_normal()"],
        "shade_ao": ["decode_normal()"],
    }),
    "corner attributes": (["NORMALS", "TANGENTS", "UV0", "UV1", "COLORS"], {
        "intersect_closest": ["load_uv()"],
        "intersect_shadow": ["load_uv()"],
        "shade_surface": ["decode_normal()", "load_uv()", "[attributes]"],
        "shade_ao": ["decode_normal()", "load_uv()", "[attributes]"],
    }),
    "tangents": (["TANGENTS"], {"shade_surface": ["decode_tangent()"]}),
    "texture coordinates": (["UV0", "UV1"], {"shade_surface": ["load_uv()"]}),
    "vertex colours": (["COLORS"], {"shade_surface": ["load_color()", "apply_color()"]}),
    "textures": (["TEXTURES", "TEXELS_CODES", "TEXELS_FLOAT", "NORMAL_MAPS"], {
        "intersect_closest": ["filter_texture()", "[texels]"],
        "intersect_shadow": ["filter_texture()", "[texels]"],
        "shade_surface": ["filter_texture()", "load_texel()", "[texels]", "sphere_uv()",
                          "scale_material()"],
    }),
    "8-bit textures": (["TEXELS_CODES"], {"shade_surface": ["decode_codes()", "decode_srgb()"]}),
    "float textures": (["TEXELS_FLOAT"], {"shade_surface": ["-"]}),
    "normal maps": (["NORMAL_MAPS"], {"shade_surface": ["perturb_normal()"]}),
    "alpha": (["ALPHA"], {
        "intersect_closest": ["alpha_passes()", "filter_texture()", "[materials]"],
        "intersect_shadow": ["alpha_passes()", "filter_texture()", "[materials]"],
    }),
    "media": (["MEDIA"], {
        "generate_rays": ["[materials]"],
        "shade_miss": ["load_medium()", "media_current()"],
        "shade_surface": ["find_media()", "media_cross()", "load_medium()", "transmittance()"],
        "shade_whitted": ["find_media()", "load_medium()", "transmittance()"],
    }),
    "classes": (["CLASSES"], {"intersect_closest": ["hit_class()"]}),
    "delta lights, suns": (["EMITTER_LIGHTS", "EMITTER_SUNS"], {
        "shade_surface": ["sample_point_light()", "spot_falloff()", "range_window()"],
    }),
    "suns": (["EMITTER_SUNS"], {
        "shade_surface": ["sample_sun()", "sun_radiance()"],
        "shade_miss": ["found_suns()", "sees_sun()"],
    }),
    "environment to connect to": (["EMITTER_ENVIRONMENT"], {
        "shade_surface": ["sample_environment()", "search_table()"],
        "shade_miss": ["frame.environment_pick"],
    }),
    "photometric profiles": (["EMITTER_PROFILES"], {
        "shade_surface": ["profile_intensity()", "find_interval()"],
    }),
    "emission": (["EMISSION", "NEE"] + EMISSIVE, {
        "shade_surface": ["add_emission()", "add_radiance()"],
    }),
    "emissive triangles": (["EMITTER_TRIANGLES"], {"shade_surface": ["sample_triangle_light()"]}),
    "emissive spheres": (["EMITTER_SPHERES"], {
        "shade_surface": ["sample_sphere_light()", "pdf_sphere_cone()", "sample_sphere()"],
    }),
    "emissive discs": (["EMITTER_DISCS"], {"shade_surface": ["basis_around() x1"]}),
    "emissive quads": (["EMITTER_QUADS"], {"shade_surface": ["sample_quad()"]}),
    "emissive boxes": (["EMITTER_BOXES"], {"shade_surface": ["sample_box()", "box_sight()"]}),
    "emissive cylinders": (["EMITTER_CYLINDERS"], {
        "shade_surface": ["sample_cylinder()", "cylinder_sight()"],
    }),
    "emissive tubes": (["EMITTER_TUBES"], {
        "shade_surface": ["sample_tube()", "hides_itself()", "intersect_tube()"],
    }),
    "emissive shapes": (EMISSIVE[1:], {
        "shade_surface": ["sample_shape_light()"],
    }),
    "next-event estimation": (["NEE"], {
        "shade_surface": ["connect_light()", "sample_light()", "pdf_light()", "[emitters]",
                          "[shadow_rays]", "frame.emitter_count", "queue_push() x1"],
        "shade_whitted": ["whitted_lights()", "whitted_light()", "[emitters]", "queue_push() x1"],
    }),
    "emitters hit by the BSDF": (["BSDF_HITS_EMITTERS"], {
        "shade_surface": ["mis_weight()", "pdf_light()"],
    }),
    "environment": (["ENVIRONMENT", "ENVIRONMENT_IMAGE"], {
        "intersect_closest": ["queue_push() x1"],
        "shade_whitted": ["add_surroundings()", "environment_radiance()", "frame.ambient"],
    }),
    "environment image": (["ENVIRONMENT_IMAGE"], {
        "shade_miss": ["load_environment_at()", "[environment]", "frame.environment_size"],
    }),
    "Russian roulette": (["ROULETTE"], {"shade_surface": ["frame.roulette_min_bounces"]}),
    "clamp": (["CLAMP"], {
        "shade_surface": ["clamp_contribution()", "frame.clamp_limit"],
        "shade_miss": ["clamp_contribution()", "frame.clamp_limit"],
        "intersect_shadow": ["clamp_contribution()", "frame.clamp_limit"],
    }),
    "least density": (["MIN_DENSITY"], {"shade_surface": ["frame.min_density"]}),
    "split lobes": (["SPLIT_LOBES"], {
        "generate_rays": ["frame.split_lobes"],
        "accumulate": ["frame.split_lobes"],
        "shade_surface": ["branch_slot()", "go_on_specular()", "eval_split_connection()",
                          "queue_push() x1"],
    }),
    "shadow rays by depth": (["NEE_DEPTH"], {"shade_surface": ["frame.nee_depth"]}),
    "pixel jitter": (["JITTER", "LENS"], {"generate_rays": ["random_4d()", "pcg4d()", "frame.seed"]}),
    "sample counts by tile": (["TILES"], {
        "generate_rays": ["listed()"],
        "accumulate": ["listed()"],
    }),
    "lens": (["LENS"], {
        "generate_rays": ["ray_through_lens()", "sample_aperture()", "frame.lens_radius"],
    }),
    "far camera": (["FAR_CAMERA"], {
        "generate_rays": ["frame.camera_start"],
        "shade_surface": ["distance_from_camera()", "frame.camera_start"],
        "shade_whitted": ["distance_from_camera()", "frame.camera_start"],
        "shade_ao": ["distance_from_camera()", "frame.camera_start"],
    }),
    "suspended traversals": (["SUSPEND"], {
        "intersect_closest": ["suspend()", "resume()", "[suspended]", "queue_push() x1"],
        "intersect_shadow": ["suspend()", "resume()", "queue_push()", "[suspended]"],
    }),
    "counted steps": (["STEPS"], {
        "intersect_closest": ["count_steps()", "add_steps()", "OpGroupNonUniformIAdd"],
        "intersect_shadow": ["count_steps()", "add_steps()", "OpGroupNonUniformIAdd"],
    }),
    "texel reads of the scene": (["TEXEL_SCENE"], {
        "intersect_closest": ["nodes_texels", "triangles_texels", "shapes_texels"],
        "intersect_shadow": ["nodes_texels", "triangles_texels", "shapes_texels"],
        "shade_surface": ["triangles_texels", "materials_texels", "emitters_texels"],
        "shade_miss": ["environment_texels"],
    }),
    "texel reads of state": (["TEXEL_STATE"], {
        "intersect_closest": ["paths_texels"],
        "intersect_shadow": ["shadow_rays_texels", "radiance_texels"],
        "shade_surface": ["paths_texels"],
        "shade_miss": ["paths_texels"],
        "accumulate": ["radiance_texels"],
    }),
}
# For each lobe in shade_surface: the lobes compiled in addition, and the functions that must vanish.
PRINCIPLED = ["PRINCIPLED", "ROUGH"]
LOBES = {
    "LAMBERT": ([], ["eval_lambert()", "sample_lambert()"]),
    "MIRROR": ([], ["sample_mirror()"]),
    "PRINCIPLED": (["ROUGH"], ["eval_principled()", "sample_principled()"]),
    "BURLEY": (PRINCIPLED, ["albedo_burley()"]),
    "GLTF": (PRINCIPLED + ["BURLEY", "CHARLIE", "CLEARCOAT"], ["-"]),
    "METAL": (PRINCIPLED, ["-"]),
    "SUBSURFACE": (PRINCIPLED, ["-"]),
    "SHEEN": (PRINCIPLED, ["-"]),
    "CHARLIE": (PRINCIPLED, ["eval_fibres()", "albedo_charlie()"]),
    "CLEARCOAT": (PRINCIPLED, ["eval_coat()", "sample_gtr1()", "albedo_coat()"]),
    "TRANSMISSION": (PRINCIPLED, ["eval_base_refraction()", "eval_base_thin()"]),
    "DIELECTRIC": (["ROUGH"], ["eval_dielectric()", "sample_dielectric()"]),
    "CONDUCTOR": (["ROUGH"], ["eval_conductor()", "sample_conductor()", "fresnel_conductor()"]),
    "PHONG": ([], ["eval_phong()", "sample_phong()"]),
    "BLINN_PHONG": ([], ["eval_blinn_phong()", "sample_blinn_phong()"]),
    "MICROFACET": (["ROUGH"], ["eval_microfacet()", "sample_microfacet()"]),
    "MASKINGS": (["MICROFACET", "ROUGH"], ["-"]),
    "UNCOUPLED": (["MICROFACET", "ROUGH"], ["-"]),
    "MIXED_FRESNEL": (PRINCIPLED + ["METAL"], ["-"]),
    "EXACT_COAT": (PRINCIPLED + ["CLEARCOAT"], ["albedo_coat_exact()"]),
    "ROUGH": (["DIELECTRIC", "DELTA"], ["eval_rough_dielectric()", "sample_rough_dielectric()"]),
    "DELTA": (["DIELECTRIC", "ROUGH"], ["sample_smooth_dielectric()"]),
    "ANISOTROPIC": (PRINCIPLED, ["albedo_turned()", "turn_anisotropy()"]),
    "COMPENSATE": (["CONDUCTOR", "ROUGH"], ["-"]),
    "THIN": (["DIELECTRIC", "ROUGH"], ["-"]),
    "IRIDESCENCE": (PRINCIPLED, ["fresnel_film()"]),
    "DISPERSION": (["DIELECTRIC", "ROUGH"], ["disperse()"]),
    "DIFFUSE_TRANSMISSION": (PRINCIPLED + ["THIN"], ["-"]),
    "SEPARABLE": (["DIELECTRIC", "ROUGH"], ["-"]),
}
ALL_VERTICES = 0xffffffff # see shared/bindings.h
# The functions of lib/light.glsl and lib/light_tree.glsl that each strategy of light sampling needs, in the
# order of shared/methods.h.
DOWN = {"choose_below", "width_below", "light_importance", "take_first", "receiver_of", "triangle_area",
        "shape_area"}
LIGHT_CHOICES = {
    "uniform": {"choose_bin", "triangle_area", "shape_area"},
    "power": {"choose_bin", "triangle_area"},
    "all": {"connect_all_lamps", "sample_lamp", "choose_in_lamp", "probability_in_lamp"} | DOWN,
    "tree": {"choose_from_tree", "probability_in_tree"} | DOWN,
}

# The functions of lib/sampler.glsl that each sampler needs, in the order of shared/methods.h.
SOBOL = {"sobol_4d", "scramble", "digits_1", "digits_2", "digits_3", "pcg4d"}
STRATA = {"stratified", "stratum_point", "permute", "random_4d", "pcg4d"}
SAMPLERS = {
    "sobol": SOBOL | {"sobol"},
    "pcg": {"random_4d", "pcg4d"},
    "lcg": {"random_lcg"},
    "stratified": STRATA,
    "grid": STRATA,
    "blue-noise": SOBOL | {"blue_noise", "spread_bits"},
    "sine": {"random_sine"},
}
# All other lobes are left out, which saves time in spirv-opt.
FEW_LOBES = ["LAMBERT", "MIRROR", "PHONG", "DISPERSION"]

# Texel reads replace other code, so the code need not become smaller.
EXCHANGED = {
    "texel reads of the scene": {
        "intersect_closest": ["[nodes]", "[triangles]", "[shapes]"],
        "intersect_shadow": ["[nodes]", "[triangles]", "[shapes]"],
        "shade_surface": ["[triangles]", "[materials]", "[emitters]"],
        "shade_miss": ["[environment]"],
    },
    "texel reads of state": {
        "intersect_shadow": ["[shadow_rays]"],
        "intersect_closest": [], "shade_surface": [], "shade_miss": [], "accumulate": [],
    },
}

# Shadow rays use the traversal code of closest hits, and the other integrators use the shading code of
# shade_surface. So these kernels represent all others.
SHORT_KERNELS = {"generate_rays", "intersect_closest", "shade_surface", "shade_miss", "accumulate"}

failures = 0
short = False


def fail(message):
    global failures
    failures += 1
    print("FAIL " + message)


def read_bits(path, prefix):
    """Returns the bits of a header by name."""
    with open(path, encoding="utf-8") as file:
        found = re.findall(r"#define %s_(\w+) \(1u << (\d+)\)" % prefix, file.read())
    return {name: 1 << int(bit) for name, bit in found}


def disassemble(path):
    text = subprocess.run(["spirv-dis", path], check=True, stdout=subprocess.PIPE,
                          universal_newlines=True).stdout
    lines = [line.split(";")[0].strip() for line in text.splitlines()]
    return [line for line in lines if line]


def code_of(lines):
    """Returns the lines from the first function on, without declarations."""
    return lines[next(i for i, line in enumerate(lines) if " OpFunction " in line):]


@functools.lru_cache(maxsize=None)
def freeze(path, features, lobes, folder, aovs=0, choices=""):
    return Module(path, features, lobes, folder, aovs, choices)


class Module:
    """A frozen kernel: its size, and the names that remain in it."""

    def __init__(self, path, features, lobes, folder, aovs, choices):
        frozen = os.path.join(folder, "frozen.spv")
        inlined = os.path.join(folder, "inlined.spv")
        # Ids as in shared/bindings.h. All queues exist.
        constant = "--set-spec-const-default-value=0:%d 5:%d 6:1023 7:%d 8:%d 20:%d %s" % (
            features & 0xffffffff, lobes, features >> 32 & 0xffffffff, aovs, features >> 64,
            choices if "21:" in choices else "21:%d %s" % (SDF_ALL, choices))
        subprocess.run(["spirv-opt", constant] + PASSES + [path, "-o", frozen], check=True)
        lines = disassemble(frozen)
        self.names = self.find_names(lines)
        if short:
            self.bytes, self.instructions = os.path.getsize(frozen), len(code_of(lines))
            return
        subprocess.run(["spirv-val", "--target-env", "vulkan1.1", frozen], check=True)
        subprocess.run(["spirv-opt"] + INLINE + [frozen, "-o", inlined], check=True)
        self.bytes = os.path.getsize(inlined)
        self.instructions = len(code_of(disassemble(inlined)))

    @staticmethod
    def find_names(lines):
        """Returns how many times each name that FEATURES may contain occurs."""
        names = {}

        def add(name, count=1):
            names[name] = names.get(name, 0) + count

        functions = {}
        members = {}
        for line in lines:
            function = re.match(r'OpName (%\w+) "(\w+)\(', line)
            if function:
                functions[function[1]] = function[2]
            member = re.match(r'OpMemberName %gpu_frame (\d+) "(\w+)"', line)
            if member:
                members[member[1]] = member[2]
            buffer = re.search(r"OpVariable %_ptr_StorageBuffer_(\w+)_block ", line)
            if buffer:
                add("[%s]" % buffer[1])
            variable = re.match(r"%(\w+_texels|stack_\w+) = OpVariable", line)
            if variable:
                add(variable[1])
        for line in code_of(lines):
            called = re.search(r"OpFunctionCall %\w+ (%\w+)", line)
            if called:
                add(functions[called[1]] + "()")
            uniform = re.search(r"OpAccessChain %_ptr_Uniform_\w+ %\w+ %int_0 %int_(\d+)", line)
            if uniform:
                add("frame." + members[uniform[1]])
            instruction = re.search(r"OpExtInst %\w+ %\w+ (\w+)|\b(Op\w+)", line)
            add(instruction[1] or instruction[2])
        return names

    def count(self, name):
        return self.names.get(name, 0)


def check_gone(place, want, on, off):
    if want == "-":
        return
    name, _, fewer = want.partition(" x")
    if fewer:
        if on.count(name) - off.count(name) != int(fewer):
            fail("%s: %d uses of %s became %d, not %s fewer" %
                 (place, on.count(name), name, off.count(name), fewer))
        return
    if not on.count(name):
        fail("%s: %s is not there with the feature" % (place, name))
    if off.count(name):
        fail("%s: %s is still there without the feature" % (place, name))


def check_fewer(place, on, off):
    if off.instructions >= on.instructions:
        fail("%s: %d instructions did not become fewer" % (place, on.instructions))


def report(name, kernel, on, off):
    print("%-26s %-18s %5d -> %5d instructions, %6d -> %6d bytes" %
          (name, kernel, on.instructions, off.instructions, on.bytes, off.bytes))


def check_lobe(name, bits, lobes, kernels, folder):
    besides, wanted = LOBES[name]
    features = sum(bits.values()) & ~bits["TEXEL_SCENE"] & ~bits["TEXEL_STATE"]
    without = sum(lobes[lobe] for lobe in besides)
    on = freeze(kernels["shade_surface"], features, without | lobes[name], folder)
    off = freeze(kernels["shade_surface"], features, without, folder)
    for want in wanted:
        check_gone(name, want, on, off)
    check_fewer(name, on, off)
    report(name, "shade_surface", on, off)


def usual(bits):
    """Removes the geometry that makes kernels several times as long, for tests that do not concern it."""
    return {name: bit for name, bit in bits.items()
            if name not in SHAPES or name in ("GEOMETRY_SPHERES", "GEOMETRY_DISCS",
                                              "EMITTER_SPHERES", "EMITTER_DISCS")}


def check_feature(name, bits, lobes, kernels, folder):
    removed, expected = FEATURES[name]
    if set(removed) <= set(usual(bits)):
        bits = usual(bits)
    texel = bits["TEXEL_SCENE"] | bits["TEXEL_STATE"]
    everything = sum(bits.values()) & ~texel
    for feature in removed:
        everything |= bits[feature]
    without = everything & ~sum(bits[feature] for feature in removed)
    for kernel, wanted in expected.items():
        if short and kernel not in SHORT_KERNELS:
            continue
        place = "%s, %s" % (name, kernel)
        on = freeze(kernels[kernel], everything, lobes, folder)
        off = freeze(kernels[kernel], without, lobes, folder)
        for want in wanted:
            check_gone(place, want, on, off)
        exchanged = EXCHANGED.get(name)
        for want in exchanged[kernel] if exchanged else []:
            check_gone(place, want, off, on)
        if not exchanged:
            check_fewer(place, on, off)
        report(name, kernel, on, off)


def check_ballot(bits, lobes, kernels, folder):
    """Ballot is selected by another module, not by a constant."""
    for kernel in ("intersect_closest", "shade_surface"):
        on = freeze(kernels[kernel], sum(bits.values()), lobes, folder)
        off = freeze(kernels[kernel + "_plain"], sum(bits.values()), lobes, folder)
        check_gone("ballot, " + kernel, "OpGroupNonUniformBallot", on, off)
        check_gone("no ballot, " + kernel, "OpControlBarrier", off, on)


# The code that AOVs add to kernels, in the notation of FEATURES: the code that all of them need, and the code
# that must vanish if only one other kind is left.
AOVS = {
    "intersect_closest": {"STEPS": ["store_steps()", "[radiance]"]},
    "shade_surface": {"ALBEDO NORMAL NORMAL_GEOMETRIC DEPTH POSITION IDS ALPHA": [
        "store_first_hit()", "albedo_color()", "store_aov_scalar()"],
        "EMISSION DIRECT INDIRECT": ["add_part()", "add_aov_vector()"],
        "BY_PART BY_BOUNCE BY_EMITTER": ["add_to_classes()", "keep_brightest()"]},
    "shade_miss": {"EMISSION DIRECT INDIRECT": ["add_part()"], "BY_EMITTER": ["move_to_emitter()"],
                   "BY_PART BY_BOUNCE BY_EMITTER": ["add_to_classes()", "keep_brightest()"]},
    "intersect_shadow": {
        "EMISSION DIRECT INDIRECT": ["add_part()"],
        "BY_PART BY_BOUNCE BY_EMITTER": ["add_to_classes()", "keep_brightest()",
                                         "emitter_of_connection()"]},
    "accumulate": {"ALBEDO NORMAL NORMAL_GEOMETRIC DEPTH POSITION ALPHA EMISSION DIRECT INDIRECT "
                   "STEPS": ["add_aovs()"],
                   "BY_PART BY_BOUNCE BY_EMITTER": ["add_classes()", "keep_brightest_sample()"]},
    "resolve": {},
}


def check_aovs(aovs, bits, lobes, kernels, folder):
    aovs = {name: bit for name, bit in aovs.items() if name != "END"}
    features = sum(bits.values()) & ~bits["TEXEL_SCENE"] & ~bits["TEXEL_STATE"]
    for kernel, kinds in AOVS.items():
        on = freeze(kernels[kernel], features, lobes, folder, sum(aovs.values()))
        off = freeze(kernels[kernel], features, lobes, folder)
        check_fewer("AOVs, " + kernel, on, off)
        report("AOVs", kernel, on, off)
        for kind, wanted in kinds.items():
            others = sum(bit for name, bit in aovs.items() if name not in kind.split())
            without = freeze(kernels[kernel], features, lobes, folder, others)
            for want in wanted:
                check_gone("AOVs, " + kernel, want, on, without)
                check_gone("AOVs, " + kernel, want, on, off)


def check_samplers(bits, kernels, folder):
    """Of the code of all samplers, only the code that the chosen one needs is left."""
    owned = set().union(*SAMPLERS.values())
    features = bits["JITTER"]
    for number, (name, wanted) in enumerate(SAMPLERS.items()):
        module = freeze(kernels["generate_rays"], features, 0, folder, 0, "10:%d" % number)
        there = {function for function in owned if module.count(function + "()")}
        if there != wanted:
            fail("sampler %s: has %s, expected %s" % (name, sorted(there), sorted(wanted)))
        print("%-26s %-18s %5d instructions" % (name, "generate_rays", module.instructions))


# The functions that one kind of pixel sampling needs and the others do not.
PIXEL_SAMPLINGS = {
    "sampler": set(),
    "centre": set(),
    "grid": {"pixel_uniforms_2d", "pixel_stratum", "permute"},
    "random": {"pixel_uniforms_2d"},
    "stratified": {"pixel_uniforms_2d", "pixel_stratum", "permute"},
}


def check_pixel_samplings(bits, kernels, folder):
    """If the sampler does not choose the place in the pixel, that code of the sampler is left out, and
    otherwise the code of pixel sampling."""
    owned = set().union(*PIXEL_SAMPLINGS.values()) | {"sobol_4d"}
    for number, (name, wanted) in enumerate(PIXEL_SAMPLINGS.items()):
        jitter = 0 if name == "centre" else bits["JITTER"] # see specialize()
        choice = 0 if name == "centre" else number
        module = freeze(kernels["generate_rays"], jitter, 0, folder, 0, "10:0 25:%d" % choice)
        there = {function for function in owned if module.count(function + "()")}
        wanted = wanted | ({"sobol_4d"} if name == "sampler" else set())
        if there != wanted:
            fail("pixel sampling %s: has %s, expected %s" % (name, sorted(there), sorted(wanted)))
        print("%-26s %-18s %5d instructions" % (name, "generate_rays", module.instructions))


def check_accumulations(bits, kernels, folder):
    """The film's sums are binned, or divided to running means, or the code has neither."""
    for number, (name, wanted) in enumerate({"binned": (True, False), "sum": (False, False),
                                             "running": (False, True)}.items()):
        module = freeze(kernels["accumulate"], 0, 0, folder, 0, "29:%d" % number)
        there = (module.count("film_add()") > 0, module.count("OpFDiv") > 0)
        if there != wanted:
            fail("accumulation %s: bins, division: %s, expected %s" % (name, there, wanted))
        resolved = freeze(kernels["resolve"], 0, 0, folder, 0, "29:%d" % number)
        found = (resolved.count("film_mean()") > 0, resolved.count("film_sum_factors()") > 0)
        if found != wanted:
            fail("accumulation %s: resolve has bins, means: %s, expected %s" %
                 (name, found, wanted))
        print("%-26s %-18s %5d instructions" % (name, "accumulate", module.instructions))


def check_light_choices(bits, lobes, kernels, folder):
    """Of all strategies of light sampling, only the chosen one is left."""
    owned = set().union(*LIGHT_CHOICES.values())
    names = ["TRIANGLES", "GEOMETRY_SPHERES", "EMISSION", "NEE", "BSDF_HITS_EMITTERS", "EMITTER_TRIANGLES",
             "EMITTER_SPHERES"]
    features = sum(bits[name] for name in names)
    for number, (name, wanted) in enumerate(LIGHT_CHOICES.items(), 1):
        module = freeze(kernels["shade_surface"], features, lobes, folder, 0,
                        "14:%d 32:%d" % (number, ALL_VERTICES))
        there = {function for function in owned if module.count(function + "()")}
        if there != wanted:
            fail("light choice %s: has %s, expected %s" % (name, sorted(there), sorted(wanted)))
        print("%-26s %-18s %5d instructions" % (name, "shade_surface", module.instructions))


def check_environment_filters(bits, kernels, folder):
    """Of the two kinds of environment lookup, only the chosen one is left, and none without an image."""
    owned = ["environment_place_of", "load_environment_cell", "cell_density", "environment_texel"]
    image = bits["ENVIRONMENT"] | bits["ENVIRONMENT_IMAGE"] | bits["EMITTER_ENVIRONMENT"]
    for name, features, number, wanted in (("bilinear", image, 0, owned[:3]),
                                           ("nearest", image, 1, owned[3:]),
                                           ("no image", bits["ENVIRONMENT"], 1, [])):
        module = freeze(kernels["shade_miss"], features, 0, folder, 0, "24:%d" % number)
        there = [function for function in owned if module.count(function + "()")]
        if there != wanted:
            fail("environment, %s: has %s, expected %s" % (name, there, wanted))
        print("%-26s %-18s %5d instructions" % (name, "shade_miss", module.instructions))


def check_normals(bits, lobes, kernels, folder):
    """Of the two ways to sample microfacet normals, only the chosen one is left."""
    owned = ["sample_ggx_vndf", "sample_ggx_ndf"]
    for number, name in enumerate(owned):
        module = freeze(kernels["shade_surface"], bits["TRIANGLES"],
                        sum(lobes[lobe] for lobe in ("CONDUCTOR", "MICROFACET", "ROUGH")), folder, 0,
                        "27:%d" % number)
        there = [function for function in owned if module.count(function + "()")]
        if there != [name]:
            fail("normals, %s: has %s" % (name, there))
        print("%-26s %-18s %5d instructions" % (name, "shade_surface", module.instructions))


def check_stacks(bits, kernels, folder):
    """Of the private and the shared part of the traversal stack, only those that hold entries are left."""
    owned = ["stack_private", "stack_shared"]
    for kernel in ("intersect_closest", "intersect_shadow"):
        for name, entries, shared, wanted in (("private stack", 41, 0, owned[:1]),
                                              ("stack shared in part", 41, 12, owned),
                                              ("shared stack", 10, 12, owned[1:])):
            module = freeze(kernels[kernel], bits["TRIANGLES"], 0, folder, 0,
                            "2:%d 31:%d" % (entries, shared))
            there = [variable for variable in owned if module.count(variable)]
            if there != wanted:
                fail("%s, %s: has %s, expected %s" % (name, kernel, there, wanted))
            print("%-26s %-18s %5d instructions" % (name, kernel, module.instructions))


def check_nodes(bits, kernels, folder):
    """Only the box test of the chosen kind of nodes is left."""
    owned = ["test_quantised_children", "test_float_children"]
    for kernel in ("intersect_closest", "intersect_shadow"):
        for number, name in enumerate(owned):
            module = freeze(kernels[kernel], bits["TRIANGLES"], 0, folder, 0, "19:%d" % number)
            there = [function for function in owned if module.count(function + "()")]
            if there != [name]:
                fail("nodes, %s: has %s, expected %s" % (kernel, there, name))
            print("%-26s %-18s %5d instructions" % (name, kernel, module.instructions))


# Operations of distance fields whose function has another name, or that have none.
SDF_FUNCTIONS = {"METABALLS": "sdf_ball", "RESTORE": None}


def check_sdf_operations(sdfs, bits, kernels, folder):
    """Only those operations of distance fields that the scene uses are left."""
    kernel = kernels["intersect_closest"]
    features = bits["GEOMETRY_SDFS"]
    functions = {name: SDF_FUNCTIONS.get(name, "sdf_" + name.lower()) for name in sdfs}
    owned = {function for function in functions.values() if function}
    # Each turn selects half of the operations by a bit of their numbers, so that any two differ in some turn.
    for turn in range(10):
        wanted = {name for name, number in sdfs.items() if (number >> turn // 2 & 1) == turn % 2}
        chosen = sum(1 << sdfs[name] for name in wanted)
        module = freeze(kernel, features, 0, folder, 0, "21:%d" % chosen)
        there = {function for function in owned if module.count(function + "()")}
        expected = {functions[name] for name in wanted if functions[name]}
        # A difference is an intersection with the inverted operand.
        expected |= {"sdf_intersection"} if "DIFFERENCE" in wanted else set()
        if there != expected:
            fail("distance fields: has %s, expected %s" % (sorted(there), sorted(expected)))
        print("%-26s %-18s %5d instructions" % ("%d operations" % len(wanted), "intersect_closest",
                                                module.instructions))


def check_all_are_tested(bits, lobes):
    tested = set()
    for removed, _ in FEATURES.values():
        tested.update(removed)
    for name in sorted(set(bits) - tested - {"BALLOT"}):
        fail("no test removes " + name)
    for name in sorted(set(lobes) - set(LOBES) - {"END"}):
        fail("no test removes LOBE_" + name)


def main():
    global short
    short = sys.argv.pop(1) == "short"
    for tool in ("spirv-opt", "spirv-dis", "spirv-val"):
        if not shutil.which(tool):
            print("skipped: there is no %s" % tool)
            return 1 if os.environ.get("LAMPYRIS_NO_SKIP") else 77
    # Emitters and geometry are bits of other constants; here they are placed above the features.
    bits = read_bits(sys.argv[1], "FEATURE")
    for prefix, shift in (("EMITTER", 32), ("GEOMETRY", 64)):
        for name, bit in read_bits(sys.argv[1], prefix).items():
            if name != "END":
                bits["%s_%s" % (prefix, name)] = bit << shift
    lobes = read_bits(os.path.join(os.path.dirname(sys.argv[1]), "material.h"), "LOBE")
    few = sum(lobes[name] for name in FEW_LOBES)
    with open(os.path.join(os.path.dirname(sys.argv[1]), "sdf.h"), encoding="utf-8") as file:
        sdfs = {name: int(number)
                for name, number in re.findall(r"#define SDF_(\w+) (\d+)u", file.read())
                if name != "OPERATIONS"}
    kernels = {os.path.basename(path)[:-len(".spv")]: path for path in sys.argv[2:]}
    with tempfile.TemporaryDirectory() as folder:
        for name in FEATURES:
            check_feature(name, bits, few, kernels, folder)
        check_samplers(bits, kernels, folder)
        check_pixel_samplings(bits, kernels, folder)
        check_accumulations(bits, kernels, folder)
        check_light_choices(bits, few, kernels, folder)
        check_environment_filters(bits, kernels, folder)
        check_normals(bits, lobes, kernels, folder)
        check_nodes(bits, kernels, folder)
        check_stacks(bits, kernels, folder)
        if not short:
            for name in LOBES:
                check_lobe(name, usual(bits), lobes, kernels, folder)
            check_ballot(usual(bits), few, kernels, folder)
            check_aovs(read_bits(sys.argv[1], "AOV"), usual(bits), few, kernels, folder)
            check_sdf_operations(sdfs, bits, kernels, folder)
    check_all_are_tested(bits, lobes)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
