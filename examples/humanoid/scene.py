"""Where the robot stands: floor, light and sky."""

from __future__ import annotations

from xml.etree import ElementTree

from .xmltext import add


def add_scene(root: ElementTree.Element) -> ElementTree.Element:
    """Add assets, light and floor to an MJCF document; gives its worldbody."""
    visual = add(root, "visual")
    add(visual, "global", offwidth=960, offheight=720)
    add(visual, "quality", shadowsize=2048)
    add(visual, "map", shadowclip=2)  # without it the floor shows stripes of shadow
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
    return world
