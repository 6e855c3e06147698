"""The commands about templates: `ifgen templates list`, `export`, `diff`, `check` and `context`."""

from __future__ import annotations

import json
import shutil
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ifgen.command_kit import completion, terminal
from ifgen.command_kit.options import FOLDER, OUTPUT_FOLDER, format_option, include_option
from ifgen.config.customization import Customization
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, UsageError, shown_path
from ifgen.signals import sigterm_raises

if TYPE_CHECKING:
    from ifgen.generator_py.templates.catalogue import Contexts, Listed
    from ifgen.reading.packages import PackageFiles
    from ifgen.reading.search_path import SearchPath

# Late imports: each command loads what it needs, so that the others start fast.


@click.group()
def templates() -> None:
    """Look at ifgen's templates, and replace or add your own.

    Yours are in the folder that `templates` in [tool.ifgen] names.
    """


@templates.command("list", epilog="Example: ifgen templates list message_package")
@click.argument("names", metavar="[NAME]...", nargs=-1, shell_complete=completion.templates)
def print_list(names: tuple[str, ...]) -> int:
    """List the templates: what each makes, its variables and its parts.

    NAME is a template or a folder of templates. A template that makes no file is a part of others. You can
    replace single blocks in a template with {% extends "ifgen/NAME" %}.
    """
    from ifgen.generator_py.templates import exports
    from ifgen.generator_py.templates.catalogue import listed

    found = listed(settle().custom)
    chosen = exports.choose(names or ("all",), (template.name for template in found))
    print("\n\n".join(_entry(template) for template in found if template.name in chosen))
    return 0


@templates.command(epilog="Example: ifgen templates export message_package templates")
@click.argument("name", shell_complete=completion.templates)
@click.argument("folder", metavar="[DIR]", required=False, type=OUTPUT_FOLDER)
@click.option("--extend", is_flag=True, help="Write templates that extend ifgen's, block by block.")
def export(name: str, folder: Path | None, extend: bool) -> int:
    """Copy ifgen's templates, so that you can change them.

    NAME is a template, a folder of templates, or `all`; DIR is the folder for yours. The originals are kept
    in its folder .ifgen-exported. Commit that as well: `ifgen templates diff` needs it.
    """
    from ifgen.generator_py.templates import exports
    from ifgen.generator_py.templates.catalogue import listed

    ours = {template.name: template.blocks for template in listed(Customization())}
    chosen = exports.choose((name,), ours)
    folder = folder or _own_folder()
    with sigterm_raises():
        written = exports.export(chosen, folder, ours if extend else None)
    for path in written:
        print(f"exported {shown_path(path)}")
    if len(written) < len(chosen):
        print(f"{shown_path(folder)}: {len(chosen) - len(written)} exported already")
    if not _is_in_use(folder):
        name = Path(shown_path(folder)).as_posix()
        print(
            f"next: `templates = {json.dumps(name)}` in [tool.ifgen] of pyproject.toml, so that they are used"
        )
    return 0


@templates.command(epilog="Example: ifgen templates diff templates")
@click.argument("folder", metavar="[DIR]", required=False, type=FOLDER)
@click.option("--merge", is_flag=True, help="Merge the changes into yours, and mark conflicts.")
def diff(folder: Path | None, merge: bool) -> int:
    """Show what changed in ifgen's templates since you exported them.

    DIR is the folder with yours. If you changed a template too, the merged result is shown, with conflicts
    marked. Exits with 1 if yours lack some changes, or have unresolved conflicts.
    """
    from ifgen.generator_py.templates import exports

    folder = folder or _own_folder()
    compared = exports.compare(folder)
    if merge:
        with sigterm_raises():
            written = exports.accept(compared, folder)
        compared = exports.compare(folder)
        conflicts = {comparison.path for comparison in compared if comparison.unresolved}
        for path in written:
            print(f"{'CONFLICT in' if path in conflicts else 'merged'} {shown_path(path)}")
    for comparison in compared:
        print(f"{comparison.name}: {comparison.verdict}")
    changed = [comparison for comparison in compared if comparison.ours_changed]
    for comparison in changed:
        print()
        terminal.print_comparison(comparison)
    if not compared:
        print(f"{shown_path(folder)}: nothing in it replaces a template of ifgen's")
    return int(any(comparison.yours_lacks or comparison.unresolved for comparison in compared))


@templates.command(epilog="Example: ifgen templates check templates")
@click.argument("folder", metavar="[DIR]", required=False, type=FOLDER)
@format_option
def check(folder: Path | None, format_: str) -> int:
    """Look for mistakes in your templates, before anything is generated.

    DIR is the folder with them. Compares names, attributes, filters, includes and blocks with the variables
    of each template, and outputs with the packages. If all fits, it renders everything, and writes nothing.
    `ifgen generate` makes the same checks, and stops at errors.
    """
    from ifgen.pipeline.inspection import inspect_templates

    settings = settle(templates=folder).trusted()
    problems = inspect_templates(settings.custom, settings.paths, settings.include, settings.output)
    found = settings.policy.told(problems)
    folder = folder or _own_folder()
    return terminal.print_findings(found, format_, f"{shown_path(folder)}: no mistakes")


@templates.command(epilog="Example: ifgen templates context geometry_msgs/msg/Pose")
@click.argument("name", metavar="TYPE|NODE", required=False, shell_complete=completion.types)
@include_option
@click.option("--json", "as_json", is_flag=True, help="Print it as JSON.")
@click.option("--schema", is_flag=True, help="Print the JSON schema of all contexts instead.")
def context(name: str | None, include: tuple[Path, ...], as_json: bool, schema: bool) -> int:
    """Show the variables of templates for an interface or a node.

    TYPE is a name such as geometry_msgs/msg/Pose, NODE one such as my_package/my_node.
    """
    from ifgen.generator_py.templates import catalogue

    if schema:
        print(json.dumps(catalogue.schema(), indent=2))
        return 0
    if name is None:
        raise click.UsageError("Missing argument 'TYPE|NODE'", click.get_current_context())
    found = _contexts(name, include)
    if as_json:
        print(json.dumps(catalogue.as_json(found), indent=2))
    else:
        print("\n".join(catalogue.lines(found)).rstrip("\n"))
    return 0


def _contexts(name: str, include: tuple[Path, ...]) -> Contexts:
    from ifgen.generator_py.names import interface_name
    from ifgen.generator_py.templates import catalogue
    from ifgen.pipeline import lookup
    from ifgen.reading.packages import find_packages
    from ifgen.reading.search_path import SearchPath

    settings = settle(None, None, include)
    search = SearchPath(find_packages(settings.paths), settings.include)
    package_name, _, short = name.replace("/nodl/", "/").partition("/")
    package = search.package(package_name)
    if package is not None and short in {file.name for file in package.known_nodes()}:
        return _contexts_of_node(package, short, search)
    described, registry = lookup.find_type(name, search)
    owner = f"{described.package}/{described.folder}/{interface_name(described)}"
    return catalogue.of_interface(registry.interface(owner), registry)


def _contexts_of_node(package: PackageFiles, name: str, search: SearchPath) -> Contexts:
    from dataclasses import replace

    from ifgen.generator_py.templates import catalogue
    from ifgen.nodl.load import load

    files = tuple(file for file in package.known_nodes() if file.name == name)
    [loaded] = load([replace(package, nodes=files)], search).packages
    return catalogue.of_node(loaded, loaded.nodes[0])


def _is_in_use(folder: Path) -> bool:
    used = settle().custom.templates
    return used is not None and used.resolve() == folder.resolve()


def _own_folder() -> Path:
    """The folder of templates that [tool.ifgen] names. Raises UsageError if there is none."""
    folder = settle().custom.templates
    if folder is None:
        message = "there is no folder of templates: no DIR, and no `templates` in [tool.ifgen]"
        raise UsageError([Diagnostic("no-path", message, help="name a folder, or configure one")])
    return folder


def _entry(template: Listed) -> str:
    rows = [
        ("makes", template.makes),
        ("given", ", ".join(f"{name}: {type_}" for name, type_ in template.given.items())),
        ("part of", ", ".join(template.part_of)),
        ("blocks", ", ".join(template.blocks)),
        ("yours", shown_path(template.yours) if template.yours else ""),
    ]
    width = shutil.get_terminal_size().columns
    lines = [template.name]
    for title, text in rows:
        if text:
            first, later = f"  {title:8}", " " * 10
            wrap = textwrap.TextWrapper(max(width, 40), first, later, break_long_words=False)
            lines += wrap.wrap(text)
    return "\n".join(lines)
