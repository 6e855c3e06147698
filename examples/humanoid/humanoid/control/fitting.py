"""Parameters of a walk for another body: what fits our legs, by the size of its own."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from ..robot import table
from ..robot.body import OURS
from ..robot.model import HumanoidModel, load
from .reference import GaitParameters

_EDGE = 0.15  # most of a half sole that its edge takes: a narrow sole would have nothing left


def fitted(parameters: GaitParameters, model: HumanoidModel) -> GaitParameters:
    """The same walk on another body.

    The centre of mass is as far below where straight legs hold it as on ours, as a share of the legs' length.
    """
    if model.body is OURS:
        return parameters
    scale, sole = model.body.scale, model.sole
    return replace(
        parameters,
        com_height=model.straight_height - scale * (_ours() - parameters.com_height),
        reach=parameters.reach * scale,
        stance_width=model.body.stance_width * parameters.stance_width / OURS.stance_width,
        lift=parameters.lift * scale,
        zmp_ahead=parameters.zmp_ahead - table.FOOT_CENTRE + sole.centre,
        edge_along=min(parameters.edge_along, _EDGE * sole.half_length),
        edge_across=min(parameters.edge_across, _EDGE * sole.half_width),
    )


@cache
def _ours() -> float:
    """The height of our own centre of mass on straight legs [m]."""
    return load().straight_height
