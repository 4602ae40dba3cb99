"""Client of the Relight service: upload meshes, light them, save the results."""

from relight.client import Answer, Client, Mesh, RelightError
from relight.lights import directional_light, point_light, spot_light

__all__ = [
    "Answer",
    "Client",
    "Mesh",
    "RelightError",
    "directional_light",
    "point_light",
    "spot_light",
]
