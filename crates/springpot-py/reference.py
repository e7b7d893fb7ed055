"""Writes docs/reference/api.md, every member of the package with its docstring, from the package that is installed: python reference.py."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import springpot as sp

PAGE = Path(__file__).resolve().parents[2] / "docs/reference/api.md"
HEAD = """# The Python package, member by member

Signatures and docstrings, as `help` shows them; [the overview](python.md) has a line each. This page is made by `python crates/springpot-py/reference.py`.
"""
MODULES = ("fractional", "units")


def page() -> str:
    """The whole page."""
    names = [name for name in sp.__all__ if name != "__version__" and name not in MODULES]
    is_class = {name: inspect.isclass(getattr(sp, name)) for name in names}
    parts = [HEAD, "## Functions\n"]
    parts += [block(f"sp.{name}", getattr(sp, name)) for name in sorted(names) if not is_class[name]]
    for module in MODULES:
        of = getattr(sp, module)
        parts.append(f"## sp.{module}\n")
        parts += [block(f"sp.{module}.{name}", getattr(of, name)) for name in public(of)]
    for name in sorted(names):
        if is_class[name]:
            parts.append(f"## sp.{name}\n")
            parts.append(block(f"sp.{name}", getattr(sp, name)))
            parts += [block(f"sp.{name}.{member}", value) for member, value in members(getattr(sp, name))]
    return "\n".join(parts)


def public(module: Any) -> list[str]:
    """Names that a module means for others."""
    return sorted(getattr(module, "__all__", None) or [name for name in vars(module) if own(module, name)])


def own(module: Any, name: str) -> bool:
    """Whether a name is a function of this module itself."""
    value = getattr(module, name)
    return not name.startswith("_") and callable(value) and getattr(value, "__module__", "").startswith("springpot")


def members(kind: type) -> Iterator[tuple[str, Any]]:
    """What a class has of its own and says something of, in the order of the alphabet."""
    for name in sorted(vars(kind)):
        value = inspect.getattr_static(kind, name)
        if not name.startswith("_") and inspect.getdoc(getattr(kind, name)):
            yield name, value


def block(name: str, value: Any) -> str:
    """A name with its arguments, and its docstring below."""
    unwrapped = value.__func__ if isinstance(value, (staticmethod, classmethod)) else value
    lines = [f"{name}{arguments(unwrapped)}"]
    doc = inspect.getdoc(unwrapped) or ""
    if doc:
        lines += ["", textwrap.indent(doc, "    ", lambda line: bool(line.strip()))]
    # No docstring ends the block.
    text = "\n".join(lines).replace("```", "'''")
    return f"```text\n{text.rstrip()}\n```\n"


def arguments(value: Any) -> str:
    """As they are written at a call, without types."""
    if inspect.isclass(value) or not callable(value):
        return ""
    try:
        signature = inspect.signature(value)
    except ValueError:
        return "(…)"
    empty = inspect.Parameter.empty
    kept = [one.replace(annotation=empty) for one in signature.parameters.values() if one.name not in ("self", "cls")]
    return str(signature.replace(parameters=kept, return_annotation=empty))


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
