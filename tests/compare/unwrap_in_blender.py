"""Gives a patch that applique_compare exported new texture coordinates by Blender's unwrap operator.

    blender -b -P unwrap_in_blender.py -- in.glb out.glb [CONFORMAL|ANGLE_BASED]

Nothing else changes: positions, triangles and the node's name stay, which tell applique_compare the case.
"""

import sys

import bpy
import numpy

# The glTF add-on of Blender 3.4 uses a name that NumPy 1.24 has dropped; Debian 12 has the two together.
if "bool" not in vars(numpy):
    numpy.bool = bool


def unwrap(method):
    """Unwraps the selected mesh as one chart: a patch is a disc and needs no seams."""
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.mark_seam(clear=True)
    bpy.ops.uv.unwrap(method=method, fill_holes=False, correct_aspect=False, margin=0)
    bpy.ops.object.mode_set(mode="OBJECT")


def main(source, target, method="CONFORMAL"):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=source)
    patch = next(thing for thing in bpy.context.scene.objects if thing.type == "MESH")
    bpy.context.view_layer.objects.active = patch
    patch.select_set(True)
    unwrap(method)
    bpy.ops.export_scene.gltf(filepath=target, export_format="GLB")


main(*sys.argv[sys.argv.index("--") + 1 :])
