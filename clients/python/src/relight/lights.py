"""Lights as the API takes them. A plain dict does as well: these spell the fields.

The unit is in the field's name, and each light takes exactly one power. All of a request is
radiometric (W) or all photometric (lm, cd, lx). The server checks; nothing is checked twice here.
"""

from __future__ import annotations

from typing import Any, Dict, Optional, Sequence

Light = Dict[str, Any]
Triple = Sequence[float]


def _light(kind: str, **fields: Any) -> Light:
    light: Light = {"type": kind}
    for name, value in fields.items():
        if value is not None:
            light[name] = list(value) if isinstance(value, (tuple, list)) else value
    return light


def point_light(
    position: Triple,
    *,
    flux_w: Optional[float] = None,
    flux_lm: Optional[float] = None,
    intensity_w_sr: Optional[float] = None,
    intensity_cd: Optional[float] = None,
    name: Optional[str] = None,
    color: Optional[Triple] = None,
    cast_shadows: Optional[bool] = None,
) -> Light:
    """Shines alike in all directions from a point of the mesh's own frame."""
    return _light(
        "point",
        position=position,
        flux_w=flux_w,
        flux_lm=flux_lm,
        intensity_w_sr=intensity_w_sr,
        intensity_cd=intensity_cd,
        name=name,
        color=color,
        cast_shadows=cast_shadows,
    )


def spot_light(
    position: Triple,
    direction: Triple,
    *,
    outer_cone_deg: float,
    inner_cone_deg: Optional[float] = None,
    flux_w: Optional[float] = None,
    flux_lm: Optional[float] = None,
    intensity_w_sr: Optional[float] = None,
    intensity_cd: Optional[float] = None,
    name: Optional[str] = None,
    color: Optional[Triple] = None,
    cast_shadows: Optional[bool] = None,
) -> Light:
    """A point that shines into a cone around `direction`, the way its light travels."""
    return _light(
        "spot",
        position=position,
        direction=direction,
        outer_cone_deg=outer_cone_deg,
        inner_cone_deg=inner_cone_deg,
        flux_w=flux_w,
        flux_lm=flux_lm,
        intensity_w_sr=intensity_w_sr,
        intensity_cd=intensity_cd,
        name=name,
        color=color,
        cast_shadows=cast_shadows,
    )


def directional_light(
    direction: Triple,
    *,
    irradiance_w_m2: Optional[float] = None,
    illuminance_lx: Optional[float] = None,
    angle_deg: Optional[float] = None,
    name: Optional[str] = None,
    color: Optional[Triple] = None,
    cast_shadows: Optional[bool] = None,
) -> Light:
    """A sun: parallel light travelling along `direction`; a disc of `angle_deg` across, if given."""
    return _light(
        "directional",
        direction=direction,
        irradiance_w_m2=irradiance_w_m2,
        illuminance_lx=illuminance_lx,
        angle_deg=angle_deg,
        name=name,
        color=color,
        cast_shadows=cast_shadows,
    )


# The common fields of these (name, color or temperature_k, enabled, cast_shadows) and their power
# (radiance_w_m2_sr, luminance_cd_m2, flux_w or flux_lm) are passed by their names in the API.


def rect_light(center: Triple, edge_u: Triple, edge_v: Triple, **fields: Any) -> Light:
    """A flat rectangle, edges given whole, that shines toward u x v (both ways: two_sided=True)."""
    return _light("rect", center=center, edge_u=edge_u, edge_v=edge_v, **fields)


def disk_light(center: Triple, normal: Triple, radius: float, **fields: Any) -> Light:
    """A flat disk that shines on the side of its normal."""
    return _light("disk", center=center, normal=normal, radius=radius, **fields)


def sphere_light(center: Triple, radius: float, **fields: Any) -> Light:
    """A ball that shines outward."""
    return _light("sphere", center=center, radius=radius, **fields)


def environment_light(image_id: Optional[str] = None, **fields: Any) -> Light:
    """A sky: an image that `Client.store_environment` keeps (rotation_deg, scale), or, without one,
    the same from everywhere (radiance_w_m2_sr or luminance_cd_m2)."""
    return _light("environment", image=None if image_id is None else {"id": image_id}, **fields)


def sky_light(**fields: Any) -> Light:
    """A clear sky with its sun: sun_direction (toward it, +Y up), or latitude_deg, longitude_deg and
    time (RFC 3339); turbidity. Photometric."""
    return _light("sky", **fields)


def ies_light(position: Triple, direction: Triple, profile_id: str, **fields: Any) -> Light:
    """A lamp with a photometric profile that `Client.store_profile` keeps (up, scale)."""
    return _light("ies", position=position, direction=direction, profile={"id": profile_id}, **fields)


def mesh_light(**fields: Any) -> Light:
    """The mesh's own faces whose material is emissive."""
    return _light("from_mesh", **fields)
