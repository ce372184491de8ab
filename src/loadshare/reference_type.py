"""How Numba compiles `by_reference`, and the functions of `extremes`.

The former becomes a pointer, through which fields are read in place; each of the latter becomes one
instruction.
"""

# Numba has no type annotations.
# mypy: disable-error-code="misc,no-untyped-def,no-untyped-call,untyped-decorator,call-arg,override"

from __future__ import annotations

from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import cgutils, types
from numba.core.imputils import impl_ret_borrowed, lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import (
    intrinsic,
    lower_builtin,
    models,
    overload,
    register_model,
    type_callable,
)

from loadshare.by_reference import by_reference, set_apart
from loadshare.extremes import larger, smaller


class Reference(types.Type):
    """Numba's type of a pointer to a named tuple.

    Parameters
    ----------
    to : numba.types.NamedTuple
    """

    def __init__(self, to: Any) -> None:
        self.to = to
        super().__init__(name=f"Reference({to})")


@register_model(Reference)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, reference: Reference) -> None:
        super().__init__(manager, reference, manager[reference.to].get_value_type().as_pointer())


@infer_getattr
class _Fields(AttributeTemplate):
    key = Reference

    def generic_resolve(self, reference: Reference, field: str) -> Any:
        return reference.to.types[reference.to.fields.index(field)]


@lower_getattr_generic(Reference)
def _read(context: Any, builder: Any, reference: Reference, pointer: Any, field: str) -> Any:
    k = reference.to.fields.index(field)
    value = _loaded(builder, cgutils.gep_inbounds(builder, pointer, 0, k))
    return impl_ret_borrowed(context, builder, reference.to.types[k], value)


def _loaded(builder: Any, pointer: Any) -> Any:
    """Load number by number: LLVM forgets that loads of a whole array are invariant.

    No store to an array changes a field, so it need not be read again in every pass of a loop.
    """
    kind = pointer.type.pointee
    if not isinstance(kind, ir.Aggregate):
        value = builder.load(pointer)
        value.set_metadata("invariant.load", builder.module.add_metadata([]))
        return value
    value = ir.Constant(kind, ir.Undefined)
    for k in range(len(kind.elements)):
        part = _loaded(builder, cgutils.gep_inbounds(builder, pointer, 0, k))
        value = builder.insert_value(value, part, k)
    return value


@intrinsic
def _by_reference(_context, fields):
    def code(_target, builder, _signature, values):
        place = cgutils.alloca_once(builder, values[0].type)
        builder.store(values[0], place)
        return place

    return Reference(fields)(fields), code


@intrinsic
def _set_apart(_context):
    def code(context, builder, _signature, _values):
        builder.function.attributes.add("noinline")
        return context.get_dummy_value()

    return types.none(), code


@overload(by_reference, inline="always")
def _by_reference_here(fields):
    return lambda fields: _by_reference(fields)


@overload(set_apart, inline="always")
def _set_apart_here():
    return lambda: _set_apart()


def _extreme(function: Any, name: str) -> None:
    """Compile a function of two numbers as one instruction."""

    @type_callable(function)
    def _typed(_context):
        return lambda number, other: types.float64

    @lower_builtin(function, types.float64, types.float64)
    def _code(_context, builder, _signature, values):
        kind = values[0].type
        called = ir.FunctionType(kind, [kind, kind])
        return builder.call(builder.module.declare_intrinsic(name, [kind], called), values)


_extreme(larger, "llvm.maxnum")
_extreme(smaller, "llvm.minnum")
