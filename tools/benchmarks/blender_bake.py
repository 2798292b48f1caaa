"""Blender's own transfer of a texture between two meshes, timed beside benchmark_bake.

    blender -b --factory-startup -P blender_bake.py -- SOURCE.obj TARGET.obj TEXTURE SIZE OUTPUT.png

Prints CSV: CPU seconds of the process for the UV data transfer (nearest face, interpolated), the unwrap
of the target (smart projection), the bake (Cycles, selected to active, emission, one sample) and the
writing of the image, then the peak memory. Blender finds counterparts by nearness in space; the pair is
taken as it lies, and what it makes of it is not judged here.
"""
import resource
import sys
import time

import bpy

source_path, target_path, texture_path, size, output = sys.argv[sys.argv.index("--") + 1:]
size = int(size)


def load(path):
    bpy.ops.wm.obj_import(filepath=path)
    return bpy.context.selected_objects[0]


def choose(active, *others):
    bpy.ops.object.select_all(action="DESELECT")
    for chosen in (active, *others):
        chosen.select_set(True)
    bpy.context.view_layer.objects.active = active


def timed(action):
    begun = time.process_time()
    action()
    return time.process_time() - begun


def emitting(name, image, baked):
    """A material that shows the image, or one that is baked to it."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    out = nodes.new("ShaderNodeOutputMaterial")
    emission = nodes.new("ShaderNodeEmission")
    links.new(emission.outputs[0], out.inputs[0])
    if not baked:
        links.new(texture.outputs[0], emission.inputs[0])
    nodes.active = texture
    return material


bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
source, target = load(source_path), load(target_path)
source.data.materials.clear()
source.data.materials.append(emitting("source", bpy.data.images.load(texture_path), False))
image = bpy.data.images.new("baked", size, size)


def transfer_uv():
    choose(source, target)
    bpy.ops.object.data_transfer(data_type="UV", loop_mapping="POLYINTERP_NEAREST")


def unwrap():
    for layer in list(target.data.uv_layers):
        target.data.uv_layers.remove(layer)
    choose(target)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project()
    bpy.ops.object.mode_set(mode="OBJECT")


def bake():
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.cycles.samples = 1
    scene.cycles.use_denoising = False
    target.data.materials.clear()
    target.data.materials.append(emitting("target", image, True))
    choose(target, source)
    extent = max(source.dimensions)
    bpy.ops.object.bake(type="EMIT", use_selected_to_active=True, max_ray_distance=extent,
                        cage_extrusion=extent / 20, margin=16)


def save():
    image.filepath_raw, image.file_format = output, "PNG"
    image.save()


seconds = [timed(step) for step in (transfer_uv, unwrap, bake, save)]
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print("source,target,size,blender,uv_transfer,unwrap,bake,save,peak_mib")
print(",".join([source_path, target_path, str(size), bpy.app.version_string] +
               [f"{s:.3f}" for s in seconds] + [f"{peak:.0f}"]))
