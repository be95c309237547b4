"""The type stubs have what the module has, with the same arguments, and everything has a docstring."""

import ast
import pathlib
import re

import motley
from motley import _motley


def stub_members():
    text = (pathlib.Path(motley.__file__).parent / "_motley.pyi").read_text()
    for of in ast.parse(text).body:
        if isinstance(of, ast.ClassDef):
            for member in of.body:
                if isinstance(member, ast.FunctionDef):
                    yield of.name, member


def public(names):
    return {name for name in names if not name.startswith("_")}


def test_every_call_is_in_the_stubs_and_has_a_docstring():
    stubs = {}
    for owner, member in stub_members():
        stubs.setdefault(owner, {})[member.name] = member
    for owner in public(vars(_motley)) - {"contact_dtype"}:
        members = vars(getattr(_motley, owner))
        assert public(members) - {"joint_types"} == public(stubs[owner])
        for name in public(members) - {"joint_types", "ground", "isa", "threads", "joint_count", "settings", "last_step"}:
            signature, *text = members[name].__doc__.split("\n", 1) if hasattr(members[name], "__doc__") else [""]
            assert text or isinstance(members[name], staticmethod), f"{owner}.{name} has no docstring"
            arguments = re.findall(r"(\w+):", signature)[1:]
            stub = stubs[owner][name].args
            known = [argument.arg for argument in stub.args[1:]]
            assert arguments[:len(known)] == known or isinstance(members[name], staticmethod), f"{owner}.{name}{signature}"
