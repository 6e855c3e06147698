"""Parameters of a walk for another body: what fits our legs, by the size of its own."""

from __future__ import annotations

from dataclasses import replace

from ..robot import table
from ..robot.body import OURS, STRAIGHT_HEIGHT
from ..robot.model import HumanoidModel
from .pace import Pace
from .reference import GaitParameters

_EDGE = 0.15  # most of a half sole that its edge takes: a narrow sole would have nothing left


def fitted(parameters: GaitParameters, model: HumanoidModel) -> GaitParameters:
    """The same walk on another body.

    The centre of mass is as far below where straight legs hold it as on ours, as a share of the legs' length,
    or as far as the ankles allow.
    """
    if model.body is OURS:
        return parameters
    scale, sole = model.body.scale, model.sole
    # With legs as long as ours.
    lower = min(STRAIGHT_HEIGHT - parameters.com_height, model.body.crouch / scale)
    pace = Pace.no_lower_than(STRAIGHT_HEIGHT - lower)
    return replace(
        parameters,
        com_height=model.straight_height - scale * lower,
        double_support=max(parameters.double_support, pace.double_support),
        reach=parameters.reach * scale,
        stance_width=model.body.stance_width * parameters.stance_width / OURS.stance_width,
        lift=parameters.lift * scale,
        zmp_ahead=parameters.zmp_ahead - table.FOOT_CENTRE + sole.centre,
        zmp_inwards=parameters.zmp_inwards * min(1.0, 2 * sole.half_width / table.FOOT_WIDTH),
        edge_along=min(parameters.edge_along, _EDGE * sole.half_length),
        edge_across=min(parameters.edge_across, _EDGE * sole.half_width),
    )
