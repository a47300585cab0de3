# The package's public names: each is in the type stub with the same arguments, and has a docstring.
import ast
import inspect
import pathlib

import pytest

import furcula

STUB = ast.parse((pathlib.Path(furcula.__file__).parent / "__init__.pyi").read_text())
FUNCTIONS = {n.name: n for n in STUB.body if isinstance(n, ast.FunctionDef)}
CLASSES = {n.name: n for n in STUB.body if isinstance(n, ast.ClassDef)}
IMPORTED = {a.asname or a.name for n in STUB.body if isinstance(n, ast.ImportFrom) for a in n.names}


def test_every_public_name_is_in_the_stub_and_described():
    stubbed = FUNCTIONS.keys() | CLASSES.keys() | IMPORTED
    for name in furcula.__all__:
        assert name in stubbed, name
        assert getattr(furcula, name).__doc__, name
    assert not (FUNCTIONS.keys() | CLASSES.keys()) - set(furcula.__all__)


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_functions_have_the_arguments_of_the_stub(name):
    arguments = FUNCTIONS[name].args
    stubbed = [a.arg for a in arguments.args], [a.arg for a in arguments.kwonlyargs]
    actual = inspect.signature(getattr(furcula, name)).parameters.values()
    assert [p.name for p in actual if p.kind is p.POSITIONAL_OR_KEYWORD] == stubbed[0]
    assert [p.name for p in actual if p.kind is p.KEYWORD_ONLY] == stubbed[1]


@pytest.mark.parametrize("name", ["Log", "Model"])
def test_classes_have_the_members_of_the_stub(name):
    stubbed = {n.name for n in CLASSES[name].body if isinstance(n, ast.FunctionDef)}
    actual = {m for m in vars(getattr(furcula, name)) if not m.startswith("_")}
    assert actual == {m for m in stubbed if not m.startswith("_")}
    assert all(hasattr(getattr(furcula, name), m) for m in stubbed)
