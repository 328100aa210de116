"""Materials. Made by bindings/python/make_stubs.py; edits are lost."""

from typing import Any, Literal, Mapping, Sequence, TypedDict, Union

from numpy.typing import ArrayLike

_Names = Union[str, Sequence[str]]
_Amount = Union[float, Sequence[tuple[float, float]], ArrayLike]

class Material:
    keys: dict[str, Any]
    def __init__(self, keys: dict[str, Any]) -> None: ...
    @property
    def law(self) -> str: ...
    @property
    def region(self) -> str: ...
    def with_keys(self, **changes: Any) -> Material: ...

_OgdenTerm = TypedDict("_OgdenTerm", {"mu": float, "alpha": float}, total=False)
_PronyTerm = TypedDict("_PronyTerm", {"ratio": float, "time": float}, total=False)
_Mullins = TypedDict("_Mullins", {"r": float, "m": float, "beta": float}, total=False)
_FiberSpread = TypedDict("_FiberSpread", {"concentration": float, "rings": int, "around": int}, total=False)
_Fibers = TypedDict("_Fibers", {"direction": ArrayLike, "directions": ArrayLike, "field": str, "spread": "_FiberSpread", "law": Literal["exponential", "toe"], "k1": float, "k2": float, "dispersion": float, "exponent": float, "isochoric": bool, "straight_modulus": float, "straight_stretch": float}, total=False)
_CompressionPenalty = TypedDict("_CompressionPenalty", {"modulus": float, "beta": float}, total=False)
_CellField = TypedDict("_CellField", {"values": ArrayLike, "file": str}, total=False)

def laws() -> tuple[str, ...]: ...
def arguments(law: str) -> list[Any]: ...

def neo_hookean(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law neo_hookean: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def neo_hookean_ogden(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law neo_hookean_ogden: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def stable_neo_hookean(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law stable_neo_hookean: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def stable_neo_hookean_barrier(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law stable_neo_hookean_barrier: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def isochoric_neo_hookean(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law isochoric_neo_hookean: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def isochoric_extended(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    threshold: float = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law isochoric_extended: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    threshold:
        of isochoric_extended (default: 0.1)
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def corotated(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law corotated: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def fixed_corotated(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law fixed_corotated: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def stvk(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law stvk: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def stvk_resistant(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    resistance: float = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law stvk_resistant: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    resistance:
        [Pa] of stvk_resistant; >= 0 (default: 0)
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def linear(
    *,
    young: Union[float, None] = ...,
    poisson: float = ...,
    mu: Union[float, None] = ...,
    lambda_: Union[float, None] = ...,
    bulk: Union[float, None] = ...,
    bulk_choice: Literal["consistent", "bulk_modulus"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law linear: see docs/materials.

    Parameters
    ----------
    young:
        [Pa] Young's modulus; > 0 (default: by others)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    lambda_:
        [Pa] first Lamé parameter, may be "inf" (default: by others)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    bulk_choice:
        what Poisson's ratio means for a neo_hookean law: "consistent", "bulk_modulus" (default: "consistent")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def mooney_rivlin(
    *,
    c1: float = ...,
    c2: float = ...,
    c20: float = ...,
    c11: float = ...,
    c02: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law mooney_rivlin: see docs/materials.

    Parameters
    ----------
    c1:
        [Pa] of mooney_rivlin and veronda_westmann, with and without isochoric_ (default: 0)
    c2:
        of the same: in Pa, and a pure number (default: 0)
    c20:
        [Pa] of mooney_rivlin (default: 0)
    c11:
        [Pa] of mooney_rivlin (default: 0)
    c02:
        [Pa] of mooney_rivlin (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def fung(
    *,
    mu0: float = ...,
    mu1: float = ...,
    gamma: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law fung: see docs/materials.

    Parameters
    ----------
    mu0:
        [Pa] of fung; >= 0 (default: 0)
    mu1:
        of fung; >= 0 (default: 0)
    gamma:
        [Pa] of fung; >= 0 (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def arruda_boyce(
    *,
    mu: Union[float, None] = ...,
    beta1: float = ...,
    beta2: float = ...,
    beta3: float = ...,
    beta4: float = ...,
    locking_stretch: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law arruda_boyce: see docs/materials.

    Parameters
    ----------
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    beta1:
        of arruda_boyce; >= 0 (default: 0)
    beta2:
        of arruda_boyce; >= 0 (default: 0)
    beta3:
        of arruda_boyce; >= 0 (default: 0)
    beta4:
        of arruda_boyce; >= 0 (default: 0)
    locking_stretch:
        of arruda_boyce, in place of the betas; >= 0 (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def ogden(
    *,
    terms: Union[Sequence["_OgdenTerm"], None] = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law ogden: see docs/materials.

    Parameters
    ----------
    terms:
        of ogden
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def yeoh(
    *,
    c: Union[ArrayLike, None] = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law yeoh: see docs/materials.

    Parameters
    ----------
    c:
        [Pa] of yeoh: its coefficients in order
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def gent(
    *,
    mu: Union[float, None] = ...,
    jm: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law gent: see docs/materials.

    Parameters
    ----------
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    jm:
        of gent: I - 3 where chains are straight; >= 0 (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def veronda_westmann(
    *,
    c1: float = ...,
    c2: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law veronda_westmann: see docs/materials.

    Parameters
    ----------
    c1:
        [Pa] of mooney_rivlin and veronda_westmann, with and without isochoric_ (default: 0)
    c2:
        of the same: in Pa, and a pure number (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def holmes_mow(
    *,
    mu: Union[float, None] = ...,
    beta: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law holmes_mow: see docs/materials.

    Parameters
    ----------
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    beta:
        of holmes_mow; >= 0 (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def isochoric_mooney_rivlin(
    *,
    c1: float = ...,
    c2: float = ...,
    c20: float = ...,
    c11: float = ...,
    c02: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law isochoric_mooney_rivlin: see docs/materials.

    Parameters
    ----------
    c1:
        [Pa] of mooney_rivlin and veronda_westmann, with and without isochoric_ (default: 0)
    c2:
        of the same: in Pa, and a pure number (default: 0)
    c20:
        [Pa] of mooney_rivlin (default: 0)
    c11:
        [Pa] of mooney_rivlin (default: 0)
    c02:
        [Pa] of mooney_rivlin (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def isochoric_fung(
    *,
    mu0: float = ...,
    mu1: float = ...,
    gamma: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law isochoric_fung: see docs/materials.

    Parameters
    ----------
    mu0:
        [Pa] of fung; >= 0 (default: 0)
    mu1:
        of fung; >= 0 (default: 0)
    gamma:
        [Pa] of fung; >= 0 (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def isochoric_arruda_boyce(
    *,
    mu: Union[float, None] = ...,
    beta1: float = ...,
    beta2: float = ...,
    beta3: float = ...,
    beta4: float = ...,
    locking_stretch: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law isochoric_arruda_boyce: see docs/materials.

    Parameters
    ----------
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    beta1:
        of arruda_boyce; >= 0 (default: 0)
    beta2:
        of arruda_boyce; >= 0 (default: 0)
    beta3:
        of arruda_boyce; >= 0 (default: 0)
    beta4:
        of arruda_boyce; >= 0 (default: 0)
    locking_stretch:
        of arruda_boyce, in place of the betas; >= 0 (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def isochoric_ogden(
    *,
    terms: Union[Sequence["_OgdenTerm"], None] = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law isochoric_ogden: see docs/materials.

    Parameters
    ----------
    terms:
        of ogden
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def isochoric_yeoh(
    *,
    c: Union[ArrayLike, None] = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law isochoric_yeoh: see docs/materials.

    Parameters
    ----------
    c:
        [Pa] of yeoh: its coefficients in order
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def isochoric_gent(
    *,
    mu: Union[float, None] = ...,
    jm: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law isochoric_gent: see docs/materials.

    Parameters
    ----------
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    jm:
        of gent: I - 3 where chains are straight; >= 0 (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def isochoric_veronda_westmann(
    *,
    c1: float = ...,
    c2: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law isochoric_veronda_westmann: see docs/materials.

    Parameters
    ----------
    c1:
        [Pa] of mooney_rivlin and veronda_westmann, with and without isochoric_ (default: 0)
    c2:
        of the same: in Pa, and a pure number (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def isochoric_holmes_mow(
    *,
    mu: Union[float, None] = ...,
    beta: float = ...,
    poisson: float = ...,
    bulk: Union[float, None] = ...,
    volume_energy: Literal["by_law", "quadratic", "logarithmic", "mixed"] = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law isochoric_holmes_mow: see docs/materials.

    Parameters
    ----------
    mu:
        [Pa] shear modulus; > 0 (default: by others)
    beta:
        of holmes_mow; >= 0 (default: 0)
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    bulk:
        [Pa] bulk modulus, may be "inf" (default: by others)
    volume_energy:
        U(J) of a law with constants of its own: "by_law", "quadratic", "logarithmic", "mixed" (default: "by_law")
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """

def named(
    *,
    name: Union[str, None] = ...,
    poisson: float = ...,
    density: float = ...,
    region: Union[str, None] = ...,
    prony: Union[Sequence["_PronyTerm"], None] = ...,
    static_time: Literal["long_term", "seconds"] = ...,
    mullins: Union["_Mullins", None] = ...,
    fibers: Union[Sequence["_Fibers"], None] = ...,
    compression_penalty: Union["_CompressionPenalty", None] = ...,
    stiffness_field: Union[Union["_CellField", ArrayLike], None] = ...,
    poisson_field: Union[Union["_CellField", ArrayLike], None] = ...,
) -> Material:
    """The law named: see docs/materials.

    Parameters
    ----------
    name:
        of the law named: one of the library
    poisson:
        Poisson's ratio; 0.5: incompressible; <= 0.5 (default: 0)
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)
    region:
        of the mesh (default: every region not named elsewhere)
    prony:
        terms of a Prony series: an isochoric law then relaxes
    static_time:
        what the time of a statics is to prony: everything has relaxed, or seconds: "long_term", "seconds" (default: "long_term")
    mullins:
        softening of an isochoric law by what it has borne
    fibers:
        families of fibers
    compression_penalty:
        against single crushed elements
    stiffness_field:
        factors on the stiffness
    poisson_field:
        Poisson's ratios, in place of poisson

    Values are looked at when the body is added. Raises isochor.Error for keys that there are not.
    """
