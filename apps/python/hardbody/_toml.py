"""Dictionaries as TOML."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

_ACCEPTED = "a bool, int, float, str, path, dict, or a list, tuple or NumPy array of these"
_DEEPEST = 16
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_SPECIAL = re.compile(r'["\\\x00-\x1f\x7f]')


def toml_text(config: Mapping[str, Any], name: str = "config") -> str:
    """Returns a dictionary as a TOML document of the same values, floats to the last bit.

    Dictionaries in it are tables, lists of dictionaries arrays of tables. Raises TypeError or ValueError with the path
    of the key whose value has no form in TOML; messages begin with `name`.
    """
    lines: list[str] = []
    sections: list[str] = []
    for key, value in _items(config, name, ""):
        if "." in key:
            raise ValueError(f"{name}: a key is {key!r}; accepted: a section with keys of its own, or overrides")
        if isinstance(value, Mapping):
            sections += [f"\n[{_key(key)}]", *_assignments(value, name, key)]
        elif _is_list_of_tables(value):
            for number, table in enumerate(value, 1):
                sections += [f"\n[[{_key(key)}]]", *_assignments(table, name, f"{key}[{number}]")]
        else:
            lines.append(f"{_key(key)} = {value_text(value, name, key)}")
    return "\n".join([*lines, *sections, ""])


def value_text(value: Any, name: str, path: str, depth: int = 0) -> str:
    """Returns a value as TOML on one line."""
    if depth > _DEEPEST:
        raise ValueError(f"{name}: {path} is nested more than {_DEEPEST} times; accepted: less")
    if isinstance(value, np.ndarray):
        value = _plain(value, name, path)
    if isinstance(value, Mapping):
        members = [f"{_key(k)} = {value_text(v, name, f'{path}.{k}', depth + 1)}" for k, v in _items(value, name, path)]
        return "{" + ", ".join(members) + "}"
    if isinstance(value, (list, tuple, range)):
        items = (value_text(v, name, f"{path}[{k}]", depth + 1) for k, v in enumerate(value))
        return "[" + ", ".join(items) + "]"
    return _scalar_text(value, name, path)


def _scalar_text(value: Any, name: str, path: str) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        if not -(2**63) <= int(value) < 2**63:
            raise ValueError(f"{name}: {path} is {int(value)}; accepted: integers of 64 bits")
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        number = float(value)
        if number != value and value == value:  # more digits than a double has
            raise TypeError(f"{name}: {path} is {value!r}; accepted: {_ACCEPTED}")
        return repr(number)
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, str):
        return _string(value, name, path)
    raise TypeError(f"{name}: {path} is {_shown(value)}; accepted: {_ACCEPTED}")


def _assignments(table: Mapping[str, Any], name: str, path: str) -> list[str]:
    return [f"{_key(k)} = {value_text(v, name, f'{path}.{k}')}" for k, v in _items(table, name, path)]


def _items(table: Mapping[str, Any], name: str, path: str) -> Iterable[tuple[str, Any]]:
    for key, value in table.items():
        if not isinstance(key, str):
            where = f" of {path}" if path else ""
            raise TypeError(f"{name}: a key{where} is {_shown(key)}; accepted: a str")
        _string(key, name, f"the key {key!r}")
        yield key, value


def _is_list_of_tables(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and len(value) > 0 and all(isinstance(v, Mapping) for v in value)


def _plain(array: np.ndarray[Any, Any], name: str, path: str) -> Any:
    if array.dtype.kind not in "biufUO":
        raise TypeError(f"{name}: {path} is an array of {array.dtype}; accepted: arrays of bools, numbers or strings")
    return array.tolist()


def _key(key: str) -> str:
    return key if _BARE_KEY.fullmatch(key) else _string(key, "", "")


def _string(text: str, name: str, path: str) -> str:
    try:
        text.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{name}: {path} is {text!r}, which is not Unicode; accepted: text") from None
    return '"' + _SPECIAL.sub(lambda found: _escaped(found[0]), text) + '"'


def _escaped(character: str) -> str:
    return f"\\{character}" if character in '"\\' else f"\\u{ord(character):04X}"


def shown(value: Any, longest: int = 200) -> str:
    """Returns what messages say of a value: its repr, shortened; its type if it has none."""
    try:
        text = repr(value)
    except Exception:  # of any kind: the message is about an argument
        return f"of type {type(value).__name__}"
    return text if len(text) <= longest else text[: longest - 3] + "..."


def _shown(value: Any) -> str:
    return f"{shown(value, 60)} ({type(value).__name__})"
