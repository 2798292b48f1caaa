"""Opens GLB files in Blender's importer and judges what is there:
    blender -b --factory-startup --python-exit-code 1 --python blender.py -- IMAGE.png FOLDER FILE...
Every file has to give triangles, images and finite texture coordinates. Boxes that carry
samples/letters.png (their names begin with "letters") are drawn by Cycles from every side, as
FOLDER/NAME.blender.SIDE.png: each letter has to stand on its side, upright and not mirrored.
"""

import math
import os
import sys

import numpy

# The importer of Blender 3.4 asks numpy 1.24, which Debian has, for a name that it dropped.
numpy.bool = bool

import bpy  # noqa: E402  (numpy first)
from mathutils import Vector  # noqa: E402

IMAGE, FOLDER, *FILES = sys.argv[sys.argv.index("--") + 1:]
WIDTH = 96  # of the pictures, in pixels
KEPT = 0.98  # of the points; the rest are on edges

# In Blender z is up and the front of a glTF model looks along -y. Per side: its letter, the column
# and row of the image, the directions outwards, to the right and upwards, and the half sizes.
SIDES = [
    ("F", 0, 0, (0, -1, 0), (1, 0, 0), (0, 0, 1), 1.2, 0.8),
    ("B", 1, 0, (0, 1, 0), (-1, 0, 0), (0, 0, 1), 1.2, 0.8),
    ("L", 0, 1, (1, 0, 0), (0, 1, 0), (0, 0, 1), 1.0, 0.8),
    ("R", 1, 1, (-1, 0, 0), (0, -1, 0), (0, 0, 1), 1.0, 0.8),
    ("U", 0, 2, (0, 0, 1), (1, 0, 0), (0, 1, 0), 1.2, 1.0),
    ("D", 1, 2, (0, 0, -1), (1, 0, 0), (0, -1, 0), 1.2, 1.0),
]


def pixels(path):
    """Rows from the top, sRGB as stored, in [0, 1]."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"  # the values as they are
    width, height = image.size
    values = numpy.array(image.pixels[:]).reshape(height, width, image.channels)[::-1, :, :3]
    bpy.data.images.remove(image)
    return values


def kind(colors):
    """Colours whatever the light: black, or the channels against the brightest."""
    most = colors.max(axis=-1, keepdims=True)
    return numpy.where(most < 0.2, 0.0, colors / numpy.maximum(most, 1e-9))


def even_light():
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 4
    scene.cycles.use_denoising = False
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    world = bpy.data.worlds.new("even")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    scene.world = world
    scene.camera = bpy.data.objects.new("eye", bpy.data.cameras.new("eye"))
    scene.camera.data.type = "ORTHO"
    scene.collection.objects.link(scene.camera)


def draw(path, outwards, right, up, width, height):
    """A picture of one side, filled by it to the rim."""
    scene = bpy.context.scene
    scene.render.resolution_x = WIDTH
    scene.render.resolution_y = round(WIDTH * height / width)
    scene.camera.data.ortho_scale = 2 * width
    axes = (Vector(right), Vector(up), Vector(outwards))
    for row in range(3):
        for column in range(3):
            scene.camera.matrix_world[row][column] = axes[column][row]
        scene.camera.matrix_world[row][3] = 10 * axes[2][row]
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    return pixels(path)


def wrong_letters(name, image):
    problems = []
    cell_height, cell_width = image.shape[0] / 3, image.shape[1] / 2
    for letter, column, row, outwards, right, up, width, height in SIDES:
        seen = draw(os.path.join(FOLDER, f"{name}.blender.{letter}.png"), outwards, right, up, width, height)
        y, x = numpy.mgrid[0:seen.shape[0], 0:seen.shape[1]]
        at = lambda dx, dy: image[
            numpy.clip((row + (y + 0.5) / seen.shape[0]) * cell_height + dy, 0, image.shape[0] - 1).astype(int),
            numpy.clip((column + (x + 0.5) / seen.shape[1]) * cell_width + dx, 0, image.shape[1] - 1).astype(int)]
        wanted = at(0, 0)
        # Points near a change of colour are passed over.
        clear = numpy.all([(at(dx, dy) == wanted).all(axis=-1) for dx in (-6, 6) for dy in (-6, 6)], axis=0)
        share = lambda picture: (numpy.abs(kind(picture) - kind(wanted)).max(axis=-1) < 0.35)[clear].mean()
        if clear.sum() < 1000 or share(seen) < KEPT:
            problems.append(f"side {letter}: {share(seen):.3f} of {clear.sum()} points have their colour")
        # The judgement itself: the same picture mirrored or turned must not pass.
        if max(share(seen[:, ::-1]), share(seen[::-1]), share(seen[::-1, ::-1])) >= KEPT:
            problems.append(f"side {letter}: would pass mirrored or turned as well")
    return problems


def open_file(path):
    """Imports into an empty scene; returns what was found and what is wrong."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if "FINISHED" not in bpy.ops.import_scene.gltf(filepath=path):
        return "", ["the importer gave up"]
    meshes = [o.data for o in bpy.data.objects if o.type == "MESH"]
    triangles = sum(len(m.polygons) for m in meshes)
    images = [i for i in bpy.data.images if i.type == "IMAGE"]
    problems = [] if triangles else ["there is no triangle"]
    problems += [f"image {i.name} has no pixels" for i in images if min(i.size) == 0]
    for m in meshes:
        for layer in m.uv_layers:
            uvs = numpy.zeros(2 * len(m.loops))
            layer.data.foreach_get("uv", uvs)
            if not numpy.isfinite(uvs).all():
                problems.append(f"texture coordinates {layer.name} are not finite")
    if images and not any(m.uv_layers for m in meshes):
        problems.append("there are images but no texture coordinates")
    return f"{triangles} triangles, {len(images)} images", problems


failed = 0
for file in FILES:
    name = os.path.splitext(os.path.basename(file))[0]
    found, faults = open_file(file)
    if not faults and name.startswith("letters"):
        even_light()
        faults = wrong_letters(name, pixels(IMAGE))
    print(f"blender: {os.path.basename(file)} {'FAILED' if faults else 'ok'}: {found}")
    for fault in faults:
        print(f"  {fault}")
    failed += bool(faults)
print(f"blender: {len(FILES) - failed} passed, {failed} failed")
sys.exit(1 if failed else 0)
