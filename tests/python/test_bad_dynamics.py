"""Bad input to dynamics: an exception that names the argument and what is accepted, never a crash."""

import pathlib

import numpy as np
import pytest
from generated import CALLS, E, S, bad_calls, check_refusal, junk
from hypothesis import given, settings
from test_custom_shapes import Spheroid

import hardbody as hb

SYSTEM = hb.random_start(E, number=8, packing_fraction=0.01)
SPECIES = hb.Species(S)
STORED = pathlib.Path(__file__).resolve().parents[1] / "reference/cases/m2_velocity_of_frame_0.gsd"
BALL = hb.Ellipsoid([0.5, 0.5, 0.5])
QUATERNIONS = [[1, 0, 0, 0], [0, 1, 0, 0]]
VECTORS = [[0, 1.0, 0], [1.0, 0, 0]]


def simulation(**options):
    return hb.Simulation(SYSTEM, **options)


def stop(_):
    return False


def saved():
    return simulation().save()


# Functions and arguments that they accept. Junk may make runs of any length: they are ended when they call back.
FUNCTIONS = {
    "Species": (hb.Species, dict(shape=E, mass=2.0, inertia=[1, 1, 0.5], spins=True)),
    "species.scaled": (SPECIES.scaled, dict(factor=2.0)),
    "Polydisperse": (hb.Polydisperse, dict(species=E, number=5, width=0.1, sizes="uniform", seed=1)),
    "System": (
        hb.System,
        dict(
            box=20.0,
            species=[SPECIES, E],
            positions=[[0, 0, 0], [5, 0, 0]],
            orientations=QUATERNIONS,
            velocities=VECTORS,
            angular_velocities=VECTORS,
            species_of=[1, 0],
            groups=[1, 1],
        ),
    ),
    "thermalized": (SYSTEM.thermalized, dict(seed=1)),
    "random_start": (
        hb.random_start,
        dict(
            components=E,
            number=8,
            packing_fraction=0.02,
            seed=1,
            nematic_order=None,
            most_compressed=100,
            progress=stop,
        ),
    ),
    "mixture": (hb.random_start, dict(components=[(E, 4), (SPECIES, 4)], packing_fraction=0.001, seed=1)),
    "compressed": (hb.compressed, dict(system=SYSTEM, packing_fraction=0.02, progress=stop)),
    "lattice_start": (
        hb.lattice_start,
        dict(components=E, number=32, packing_fraction=0.1, lattice="fcc", seed=1, axis=2, nematic_order=0.5),
    ),
    "from_gsd": (hb.from_gsd, dict(path=STORED, frame=1, components=[(BALL, 2)], seed=1, mend=False, reverse=False)),
    "Simulation": (
        hb.Simulation,
        dict(
            system=SYSTEM,
            envelope=0.2,
            neighbours="dilated",
            finder="bracketing",
            distance="newton5",
            root="one_dimensional",
            eps_d=1e-5,
            instruction_set="portable",
            prepare_from=64,
            least_progress=1e-6,
        ),
    ),
    "run": (
        lambda **arguments: simulation().run(**arguments),
        dict(time=0.1, every=0.05, callback=stop, progress=None),
    ),
    "run_collisions": (
        lambda **arguments: simulation().run(**arguments),
        dict(collisions=1, every=0.05, callback=stop, progress=False),
    ),
    "run_until": (lambda **arguments: simulation().run(**arguments), dict(until=0.1, every=0.05, callback=stop)),
    "shrink_box": (
        lambda **arguments: simulation(neighbours="dilated").shrink_box(**arguments),
        dict(target_box=10.0, least_gain=0.0),
    ),
    "record_collisions": (lambda **arguments: simulation().record_collisions(**arguments), dict(number=5)),
    "measure": (
        lambda **arguments: simulation().measure(**arguments),
        dict(
            duration=1.0,
            longest_lag=0.5,
            wave_numbers=[1.0, 2.0],
            collective=True,
            order=["hexatic"],
            order_neighbours=8,
        ),
    ),
    "restore": (lambda **arguments: hb.Simulation.restore(**arguments), dict(state=saved(), shapes=[])),
    "CustomShape": (
        hb.CustomShape,
        dict(object=Spheroid(), name="mine", volume=4.1, symmetry_axis=2, centrally_symmetric=True),
    ),
}

# What messages say in place of an argument's name.
OTHER_WORDS = {
    "packing_fraction": r"^number: a box of edge .* at this packing fraction is too small",
    "box": r"^positions\[\d\] is .* boxes of the origin",
    "factor": r"semi-axis [xyz] is",
    "mass": r"^inertia is .* (all mass at the bounding radius|mass within the body)",
    # Radii and symmetries are the object's, which its name stands for.
    "object": r"accepted: an object with a method support|^mine\.\w+ is missing|^a property of \(.*\) cannot be read"
    r"|^shape mine: (volume is .* bounding sphere$|symmetry_axis is .* changes the support height)",
    "components": r"number of bodies is|and body \d+ is ellipsoid of semi-axes|number is \d+|"
    r"bodies of its types, the config|accepted: .* components",
    "species": r"^species_of\[\d+\] is",
    "time": r"^every is .* for doubles near time",
    "until": r"^every is .* for doubles near time",
    "callback": r"^position has (dtype object|shape \(\);)",  # of Pose, which is called
    "progress": r"^position has (dtype object|shape \(\);)",
    "duration": r"^longest_lag is .* at most the duration",
    "path": r"No such file or directory: ",
    "state": r"No such file or directory: ",
}

MANY_BODIES = range(1000, 10**6 + 1)


def bad_values(name):
    """Numbers of bodies are not so large that a call takes long."""
    if name != "number":
        return junk
    return junk.map(lambda value: 7 if isinstance(value, int) and value in MANY_BODIES else value)


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_right_arguments_are_accepted(name):
    function, arguments = FUNCTIONS[name]
    function(**arguments)


@pytest.mark.filterwarnings("ignore:overflow encountered", "ignore:invalid value encountered")
@pytest.mark.filterwarnings("ignore:nanobind.*uninitialized:RuntimeWarning")
@settings(max_examples=CALLS)
# With another argument beside `every` a run of any length might be asked for, which calls back as late.
@given(bad_calls(FUNCTIONS, bad_values, alone=("every",)))
def test_bad_arguments_are_named(call):
    try:
        check_refusal(call, OTHER_WORDS, (ValueError, TypeError, MemoryError, OSError))
    except RuntimeError as error:
        assert "progress returned False" in str(error) or "compression" in str(error), f"{call.name}: {error}"


def test_uninitialised_objects_are_refused():
    for kind in (hb.System, hb.Simulation, hb.Species, hb.CustomShape, hb.Observables, hb.Counters):
        blank = kind.__new__(kind)
        with pytest.raises(TypeError), pytest.warns(RuntimeWarning, match="uninitialized"):
            repr(kind)
            blank.__len__() if hasattr(kind, "__len__") else blank.__repr__()


def test_uninitialised_simulations_are_refused():
    blank = hb.Simulation.__new__(hb.Simulation)
    calls = (lambda: blank.run(time=1), lambda: blank.measure(1.0), lambda: blank.observables, lambda: blank.time)
    for call in calls:
        with pytest.raises(TypeError), pytest.warns(RuntimeWarning, match="uninitialized"):
            call()


@pytest.mark.parametrize("number", [2**63, 2**64 - 1, 2**100, -(2**63) - 1])
def test_integers_beyond_64_bits_are_refused(number):
    with pytest.raises(
        ValueError, match=r"seed is an integer outside -2\^63 to 2\^63 - 1; accepted: an integer from 0 to"
    ):
        hb.random_start(E, number=8, packing_fraction=0.01, seed=number)


def test_arrays_may_be_of_any_layout():
    positions = np.asfortranarray(np.arange(24.0).reshape(8, 3) * 4)
    one = hb.System(200.0, E, positions)
    np.testing.assert_array_equal(one.positions, positions)
    np.testing.assert_array_equal(hb.System(200.0, E, positions[::-1]).positions, positions[::-1])
    np.testing.assert_array_equal(hb.System(200.0, E, positions.astype("f4")).positions, positions)
    assert len(hb.System(1.0, E, [])) == 0
