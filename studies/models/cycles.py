"""Runs inside Blender: draws a glTF file with Cycles, as much as it can of what raypool means by the file.

    blender --background --factory-startup --python studies/models/cycles.py -- \
      MODEL PICTURE.png WIDTHxHEIGHT SAMPLES DEPTH burley|lambert

Camera and lights are the file's, the background is black, the picture is sRGB without a film's curve.
"""
import sys

import bpy
import numpy


def cut_out(material):
    """Blender's importer leaves alphaMode MASK to the viewport; Cycles would blend. A comparison cuts."""
    tree = material.node_tree
    alpha = next((node.inputs["Alpha"] for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
    if alpha is None or not alpha.is_linked:
        return
    source = alpha.links[0].from_socket
    compare = tree.nodes.new("ShaderNodeMath")
    compare.operation = "LESS_THAN"  # cut off below the threshold, not at it
    compare.inputs[1].default_value = material.alpha_threshold
    keep = tree.nodes.new("ShaderNodeMath")
    keep.operation = "SUBTRACT"
    keep.inputs[0].default_value = 1
    tree.links.new(source, compare.inputs[0])
    tree.links.new(compare.outputs[0], keep.inputs[1])
    tree.links.new(keep.outputs[0], alpha)


def lambert(material):
    """Blender's importer makes Principled BSDFs, whose matt part is Burley's: it is brighter where eye and light are on
    the same side. This puts Lambert's in its place, of the 95% that highlights leave. Not for glass."""
    tree = material.node_tree
    principled = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
    if principled is None or principled.inputs["Transmission"].default_value > 0:
        return

    def connect(source, target):
        """A socket of the Principled BSDF is as good as what leads to it."""
        if source.is_output:
            tree.links.new(source, target)
        elif source.is_linked:
            tree.links.new(source.links[0].from_socket, target)
        else:
            target.default_value = source.default_value

    def mix(share, first, second):
        node = tree.nodes.new("ShaderNodeMixRGB")
        connect(share, node.inputs["Fac"])
        for color, target in ((first, node.inputs["Color1"]), (second, node.inputs["Color2"])):
            if isinstance(color, tuple):
                target.default_value = color
            else:
                connect(color, target)
        return node

    black = (0, 0, 0, 1)
    base, metallic = principled.inputs["Base Color"], principled.inputs["Metallic"]
    left = mix(metallic, base, black)
    dimmed = tree.nodes.new("ShaderNodeMixRGB")
    dimmed.blend_type = "MULTIPLY"
    dimmed.inputs["Fac"].default_value, dimmed.inputs["Color2"].default_value = 1, (0.95, 0.95, 0.95, 1)
    tree.links.new(left.outputs[0], dimmed.inputs["Color1"])
    matt = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(dimmed.outputs[0], matt.inputs["Color"])
    covering = tree.nodes.new("ShaderNodeMixShader")  # with nothing
    connect(principled.inputs["Alpha"], covering.inputs["Fac"])
    tree.links.new(matt.outputs[0], covering.inputs[2])
    tree.links.new(mix(metallic, black, base).outputs[0], base)
    both = tree.nodes.new("ShaderNodeAddShader")
    targets = [link.to_socket for link in principled.outputs[0].links]
    tree.links.new(principled.outputs[0], both.inputs[0])
    tree.links.new(covering.outputs[0], both.inputs[1])
    for target in targets:
        tree.links.new(both.outputs[0], target)


def main(model, picture, size, samples, depth, matt):
    # Blender 3.4's importer uses a name that Debian's numpy has no more.
    if "bool" not in vars(numpy):
        numpy.bool = bool
    bpy.ops.wm.read_factory_settings(use_empty=True)
    # COMPAT takes candela as watts a steradian, and lux as watts a square metre.
    bpy.ops.import_scene.gltf(filepath=model, convert_lighting_mode="COMPAT")
    scene = bpy.context.scene
    scene.camera = next(thing for thing in scene.objects if thing.type == "CAMERA")
    for light in bpy.data.lights:
        light.cycles.max_bounces = 1024
        if light.type == "SUN":
            light.angle = 0
        else:
            light.shadow_soft_size = 0
    for material in bpy.data.materials:
        if material.blend_method == "CLIP":
            cut_out(material)
        if matt == "lambert" and material.node_tree:
            lambert(material)
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0, 0, 0)
    scene.render.engine = "CYCLES"
    settings = scene.cycles
    settings.device = "CPU"
    settings.samples = samples
    settings.use_adaptive_sampling = settings.use_denoising = False
    # Light that is scattered `depth` times counts; nothing is clamped or blurred.
    settings.max_bounces = settings.diffuse_bounces = settings.glossy_bounces = depth - 1
    settings.transmission_bounces = settings.transparent_max_bounces = depth - 1
    settings.caustics_reflective = settings.caustics_refractive = True
    settings.sample_clamp_direct = settings.sample_clamp_indirect = settings.blur_glossy = 0
    settings.light_sampling_threshold = 0
    settings.pixel_filter_type = "BOX"
    settings.filter_width = 1  # of the box: a pixel
    render = scene.render
    render.resolution_x, render.resolution_y = (int(x) for x in size.split("x"))
    render.resolution_percentage = 100
    render.dither_intensity = 0
    render.film_transparent = False
    render.image_settings.file_format, render.image_settings.color_mode = "PNG", "RGB"
    scene.display_settings.display_device = "sRGB"
    scene.view_settings.view_transform, scene.view_settings.look = "Standard", "None"
    scene.view_settings.exposure, scene.view_settings.gamma = 0, 1
    render.filepath = picture
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    words = sys.argv[sys.argv.index("--") + 1:]
    main(words[0], words[1], words[2], int(words[3]), int(words[4]), words[5])
