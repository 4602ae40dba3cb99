"""Client of the Relight service: upload meshes, light them, save the results."""

from relight.client import Answer, Client, Mesh, RelightError
from relight.lights import (
    directional_light,
    disk_light,
    environment_light,
    ies_light,
    mesh_light,
    point_light,
    rect_light,
    sky_light,
    sphere_light,
    spot_light,
)

__all__ = [
    "Answer",
    "Client",
    "Mesh",
    "RelightError",
    "directional_light",
    "disk_light",
    "environment_light",
    "ies_light",
    "mesh_light",
    "point_light",
    "rect_light",
    "sky_light",
    "sphere_light",
    "spot_light",
]
