"""Small program whose types mypy --strict checks."""

import numpy as np
from numpy.typing import NDArray

import hardbody as hb


def nearest_pair(result: hb.Distances) -> int:
    distance: NDArray[np.float64] = result.distance
    return int(np.argmin(distance))


def main() -> None:
    a = hb.Ellipsoid([1, 1, 3])
    b = hb.Superellipsoid([1, 2, 3], 0.5, 0.5)
    X: hb.Pose = hb.Pose([4, 0, 2.4], [1, 0, 0, 0]) @ hb.Pose()
    r: hb.DistanceResult = hb.distance(a, hb.Pose(), b, X, penetration="local")
    normal: NDArray[np.float64] = r.normal
    print(f"{r.status} by {r.distance:.4g} along {normal}")

    positions = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 2.4], [9.0, 0.0, 0.0]])
    many = hb.distance_many([a, b], positions, None, [[0, 1], [0, 2]], shape_of=[0, 1, 0], threads=2)
    print(nearest_pair(many), bool(hb.overlap(a, hb.Pose(), b, X)), many.status[0])

    hit: hb.ContactResult = hb.time_of_contact(a, hb.Motion(), b, hb.Motion(X, velocity=[-1, 0, 0]), t_max=10)
    mass: float = hb.mass_properties(b).mass
    larger: hb.Ellipsoid = a.scaled(2)
    shapes: list[hb.Shape] = [a, b]
    contacts: hb.Contacts = hb.time_of_contact_many(
        shapes, positions[:2], None, [[0, 0, 0], [-1, 0, 0]], None, [[0, 1]], t_max=10
    )
    masses: hb.Masses = hb.mass_properties_many(shapes, density=[1, 2])
    print(contacts.time[0] == hit.time, contacts.status[0], masses.inertia.shape)
    print(hit.status, hit.time, mass, larger, hb.Ellipsoid.spheroid(3.0).volume)


class Ball:
    """Shape written in Python."""

    bounding_radius = inscribed_radius = min_curvature_radius = 1.0
    volume = 4 / 3 * np.pi

    def support(self, n: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        length = float(np.sqrt(n @ n))
        return length, n / length


def dynamics() -> None:
    rods = hb.Species(hb.Ellipsoid.spheroid(3.0), mass=1.0, inertia="uniform")
    start: hb.System = hb.random_start([(rods, 30), hb.Polydisperse(rods, 30, 0.1)], packing_fraction=0.05)
    simulation = hb.Simulation(start, neighbours="dilated")
    observables: hb.Observables = simulation.measure(duration=1, wave_numbers=[2.0])
    times: list[float] = []
    try:
        simulation.run(time=1, every=0.5, callback=lambda s: times.append(s.time), progress=lambda done: None)
    except hb.NumericalError as error:
        print([pair.reason for pair in error.failures])
    results: hb.Results = observables.results()
    Z: hb.Estimate = results["Z"]
    positions: NDArray[np.float64] = simulation.positions
    print(times, float(Z), positions.shape, simulation.counters.overlaps)
    print(hb.Simulation.restore(simulation.save()).recorded["time"])
    ball: hb.SupportShape = Ball()
    print(hb.distance(ball, hb.Pose(), hb.CustomShape(Ball()), hb.Pose([3, 0, 0])).distance)


if __name__ == "__main__":
    dynamics()
    main()
