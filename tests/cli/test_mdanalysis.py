"""Mean square displacements and g(r) of the same files by MDAnalysis.

    HARDBODY=build/release/apps/hardbody/hardbody /usr/bin/python3 tests/cli/test_mdanalysis.py [TestClass[.test]]

Needs Debian's python3-mdanalysis and python3-gsd.
"""

import unittest
import warnings

import numpy

warnings.simplefilter("ignore")
import MDAnalysis
from MDAnalysis.analysis.msd import EinsteinMSD
from MDAnalysis.analysis.rdf import InterRDF

from test_cases import Analyses
from walks import EDGE, dump, gsd_file, walk

# Random steps, dense enough that each bin of g(r) has many pairs; each component less than a quarter of the box.
WALK = walk(1.4, frames=200, seed=11)


class AgainstMDAnalysis(Analyses):
    def both(self, name, universe, relative=1e-5):
        result = self.analyze(name, "--longest-lag", "60")
        self.assertEqual(result.returncode, 0, result.stderr)
        msd = EinsteinMSD(universe, select="all", msd_type="xyz", fft=False).run().results.timeseries
        rows = self.column("msd", "msd")
        self.assertGreater(len(rows), 20)
        self.assertEqual(max(rows), 60)
        for t, value in rows.items():
            self.assertAlmostEqual(value, msd[round(t)], delta=relative * msd[round(t)])
        self.assertGreater(msd[60], 10 * EDGE)  # across the box several times

        g = self.column("g_r", "g")
        r = numpy.array(list(g))
        width = r[1] - r[0]
        top = width * len(r)
        self.assertGreater(top, 0.45 * EDGE)
        rdf = InterRDF(universe.atoms, universe.atoms, nbins=len(r), range=(0, top), exclusion_block=(1, 1)).run()
        numpy.testing.assert_allclose(r, rdf.results.bins, rtol=1e-6)
        # MDAnalysis divides by the volume of the box and N (N - 1) pairs, as we do; bodies that are with themselves are
        # left out by the exclusion block.
        ours, theirs = numpy.array(list(g.values())), rdf.results.rdf
        pair = EDGE**3 / (len(WALK.position) * 28 * 4 * numpy.pi * r**2 * width)
        same = numpy.abs(ours - theirs) < 1e-3 * numpy.maximum(1, theirs)
        # A pair on the edge of a bin may be counted in the next one: at most one pair in 200 frames of 28.
        self.assertLessEqual((~same).sum(), 4, numpy.abs(ours - theirs)[~same] / pair[~same])
        self.assertTrue(numpy.all(numpy.abs(ours - theirs)[~same] < 1.5 * pair[~same]))
        self.assertGreater(same.mean(), 0.95)

    def test_gsd(self):
        gsd_file(self.path("walk.gsd"), WALK, image="never", position="unwrapped", shapes=None)
        self.both("walk.gsd", MDAnalysis.Universe(self.path("walk.gsd")))

    def test_dump(self):
        columns = ["id", "type", "xu yu zu", "quatw quati quatj quatk", "vx vy vz"]
        dump(self.path("walk.lammpstrj"), WALK, columns, low=0.0)
        self.both("walk.lammpstrj", MDAnalysis.Universe(
            self.path("walk.lammpstrj"), format="LAMMPSDUMP", topology_format="LAMMPSDUMP",
            lammps_coordinate_convention="unwrapped"))

    def test_images(self):
        """MDAnalysis unwraps nothing: the file with images against the one without a box in its positions."""
        gsd_file(self.path("images.gsd"), WALK, shapes=None)
        gsd_file(self.path("walk.gsd"), WALK, image="never", position="unwrapped", shapes=None)
        self.both("images.gsd", MDAnalysis.Universe(self.path("walk.gsd")))


if __name__ == "__main__":
    unittest.main()
