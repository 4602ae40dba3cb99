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
    name: Optional[str] = None,
    color: Optional[Triple] = None,
    cast_shadows: Optional[bool] = None,
) -> Light:
    """A sun: parallel light travelling along `direction`."""
    return _light(
        "directional",
        direction=direction,
        irradiance_w_m2=irradiance_w_m2,
        illuminance_lx=illuminance_lx,
        name=name,
        color=color,
        cast_shadows=cast_shadows,
    )
