"""Run by Blender: bakes one shadowed point light to the vertices of a PLY, one sample each.

    blender --background --factory-startup --python blender_bake.py -- mesh.ply baked.ply

Prints a line `TIMES import bake export` in seconds.
"""

import sys
import time

import bpy

source, target = sys.argv[sys.argv.index("--") + 1:][:2]
times = []


def timed(work, **arguments):
    began = time.perf_counter()
    work(**arguments)
    times.append(time.perf_counter() - began)


bpy.ops.wm.read_factory_settings(use_empty=True)
timed(bpy.ops.import_mesh.ply, filepath=source)
mesh = bpy.context.object
if not mesh.data.color_attributes:
    mesh.data.color_attributes.new("baked", "BYTE_COLOR", "CORNER")
material = bpy.data.materials.new("white")
material.use_nodes = True
mesh.data.materials.clear()
mesh.data.materials.append(material)

light = bpy.data.objects.new("light", bpy.data.lights.new("light", "POINT"))
light.data.energy, light.data.shadow_soft_size = 40.0, 0.0
light.location = (0.3, -0.2, 0.35)
bpy.context.collection.objects.link(light)

scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 1
scene.render.bake.use_pass_indirect = False
scene.render.bake.use_pass_color = False
scene.render.bake.target = "VERTEX_COLORS"
bpy.context.view_layer.objects.active = mesh
mesh.select_set(True)
timed(bpy.ops.object.bake, type="DIFFUSE")
timed(bpy.ops.export_mesh.ply, filepath=target)
print("TIMES", *times)
