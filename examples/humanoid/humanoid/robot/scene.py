"""The scene: floor, light, sky, and a face on a board for the head camera to find."""

from __future__ import annotations

from math import pi
from xml.etree import ElementTree

from .ground import Ground, Obstacle
from .xmltext import add

# The face: a white disc on a dark board, with eyes and mouth. Lengths in metres; the detector uses them too.
FACE_RADIUS = 0.20
EYE_RADIUS, EYE_PLACE = 0.04, (0.075, 0.06)  # to the side and up from the disc's centre
MOUTH_SIZE, MOUTH_PLACE = (0.09, 0.022), -0.09  # half lengths, and how far below the centre
FACE_POSITION = (3.0, -0.9, 1.38)  # in the world, looking against x
BOARD = 0.30  # half the edge of the board
BOARD_BODIES = ("face", "post")
_WHITE, _BLACK = (0.95, 0.95, 0.92, 1.0), (0.04, 0.04, 0.05, 1.0)

GROUND = Ground(obstacles=(Obstacle("the board with the face", FACE_POSITION[0], FACE_POSITION[1], 0.3),))


def add_scene(root: ElementTree.Element) -> ElementTree.Element:
    """Add assets, light and floor to an MJCF document; returns its worldbody."""
    visual = add(root, "visual")
    add(visual, "global", offwidth=960, offheight=720)
    add(visual, "quality", shadowsize=2048)
    add(visual, "map", shadowclip=2)  # without this the floor shows stripes of shadow
    add(visual, "headlight", ambient=(0.35, 0.35, 0.35), diffuse=(0.35, 0.35, 0.35))
    asset = add(root, "asset")
    sky = {"rgb1": (0.6, 0.75, 0.9), "rgb2": (0.95, 0.97, 1.0)}
    add(asset, "texture", type="skybox", builtin="gradient", width=256, height=256, **sky)
    grid = {"rgb1": (0.25, 0.28, 0.32), "rgb2": (0.32, 0.36, 0.42)}
    add(asset, "texture", name="grid", type="2d", builtin="checker", width=300, height=300, **grid)
    add(asset, "material", name="grid", texture="grid", texrepeat=(1, 1), texuniform="true", reflectance=0)
    world = add(root, "worldbody")
    add(world, "light", name="sun", mode="track", pos=(0, 0, 4), dir=(0.2, 0.2, -1), directional="true",
        diffuse=(0.7, 0.7, 0.7))  # fmt: skip
    add(
        world,
        "geom",
        name="floor",
        type="plane",
        size=(0, 0, 0.05),
        material="grid",
        contype=1,
        conaffinity=0,
    )
    _face(world)
    return world


def _face(world: ElementTree.Element) -> None:
    """The board on its post. Nothing collides with it; planners keep their distance by GROUND."""
    x, y, z = FACE_POSITION
    ghost = {"contype": 0, "conaffinity": 0}
    post = add(world, "body", name="post", pos=(x + 0.05, y, z / 2))
    add(post, "geom", type="cylinder", size=(0.02, z / 2), rgba=_BLACK, **ghost)
    # The board faces along its own z. Its x is to the right of whoever looks at it, so its y is up.
    board = add(world, "body", name="face", pos=FACE_POSITION, euler=(pi / 2, 0.0, -pi / 2))
    add(board, "geom", type="box", size=(BOARD, BOARD, 0.01), pos=(0, 0, -0.012), rgba=_BLACK, **ghost)
    add(board, "geom", type="cylinder", size=(FACE_RADIUS, 0.001), rgba=_WHITE, **ghost)
    for side in (-1, 1):
        place = (side * EYE_PLACE[0], EYE_PLACE[1], 0.002)
        add(board, "geom", type="cylinder", size=(EYE_RADIUS, 0.001), pos=place, rgba=_BLACK, **ghost)
    mouth = (*MOUTH_SIZE, 0.001)
    add(board, "geom", type="box", size=mouth, pos=(0, MOUTH_PLACE, 0.002), rgba=_BLACK, **ghost)


def board() -> dict[str, object]:
    """The board with the face, to be drawn elsewhere: lengths in metres, in the world."""
    return {
        "at": FACE_POSITION,
        "half": BOARD,
        "face": FACE_RADIUS,
        "eye": (EYE_RADIUS, *EYE_PLACE),
        "mouth": (*MOUTH_SIZE, MOUTH_PLACE),
    }
