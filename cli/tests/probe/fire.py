# A fire as the Blender snippet of docs/probe.md expects it: a domain of its name, 360 frames per second, a cache in this folder.
import os

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.frame_start, scene.frame_end = 1, 40
scene.render.fps = 360

bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 1))
domain = bpy.context.object
domain.name = "Smoke Domain"
domain.scale = (1.6, 1.2, 2.0)
domain.modifiers.new("Fluid", "FLUID").fluid_type = "DOMAIN"
settings = domain.modifiers["Fluid"].domain_settings
settings.domain_type = "GAS"
settings.resolution_max = 32
settings.use_adaptive_domain = os.environ.get("ADAPTIVE") == "1"
settings.cache_type = "REPLAY"
settings.cache_data_format = "OPENVDB"
settings.cache_directory = os.path.join(os.getcwd(), "cache")
settings.cache_frame_start, settings.cache_frame_end = scene.frame_start, scene.frame_end

bpy.ops.mesh.primitive_ico_sphere_add(radius=0.25, location=(0, 0, 0.4))
source = bpy.context.object
source.modifiers.new("Fluid", "FLUID").fluid_type = "FLOW"
flow = source.modifiers["Fluid"].flow_settings
flow.flow_type = "FIRE"
flow.flow_behavior = "INFLOW"
flow.fuel_amount = 1.0
