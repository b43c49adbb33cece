"""Pictures by Blender's Cycles.

    blender -b -P blender_view.py -- VIEWS.json

VIEWS.json is a list of {"model": GLB, "camera": as `applique render --camera` writes it, "output": PNG}; the
background is transparent.
"""

import json
import math
import sys

import bpy
import numpy
from mathutils import Matrix, Vector

# The glTF add-on of Blender 3.4 uses a name that NumPy 1.24 has dropped; Debian 12 has the two together.
if "bool" not in vars(numpy):
    numpy.bool = bool


def to_blender(v):
    """From glTF's axes (y up) to Blender's (z up)."""
    return Vector((v[0], -v[2], v[1]))


def camera_axes(camera):
    """Right, up and backward of the camera, as columns."""
    backward = (to_blender(camera["eye"]) - to_blender(camera["target"])).normalized()
    right = to_blender(camera["up"]).cross(backward).normalized()
    return Matrix((right, backward.cross(right), backward)).transposed()


def add_camera(scene, camera):
    distance = (Vector(camera["eye"]) - Vector(camera["target"])).length
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(camera["vertical_fov_degrees"])
    data.clip_start, data.clip_end = distance / 100, distance * 100
    thing = bpy.data.objects.new("camera", data)
    thing.matrix_world = Matrix.Translation(to_blender(camera["eye"])) @ camera_axes(camera).to_4x4()
    scene.collection.objects.link(thing)
    scene.camera = thing
    scene.render.resolution_x, scene.render.resolution_y = camera["size"]


def add_light(scene, camera):
    """A key light over the camera's left shoulder, and the sky."""
    sun = bpy.data.objects.new("key", bpy.data.lights.new("key", "SUN"))
    sun.data.energy = 2
    towards = camera_axes(camera) @ Vector((-0.5, 0.7, 1))
    sun.rotation_euler = towards.to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.45, 0.45, 0.45, 1)


def draw(model, camera, output):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=model)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 24
    scene.cycles.use_denoising = False
    scene.cycles.diffuse_bounces = 0
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = output
    add_camera(scene, camera)
    add_light(scene, camera)
    bpy.ops.render.render(write_still=True)


with open(sys.argv[sys.argv.index("--") + 1]) as views:
    for view in json.load(views):
        draw(view["model"], view["camera"], view["output"])
