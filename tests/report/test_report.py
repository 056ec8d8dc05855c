"""hardbody report in a headless Chromium that reaches no network.

    HARDBODY=build/release/apps/hardbody/hardbody HARDBODY_STATIC=build/release/tests/hardbody_static_report
    /usr/bin/python3 tests/report/test_report.py [TestClass[.test]]
"""

import csv
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import synthetic  # noqa: E402  (beside this file)
from browser import Browser  # noqa: E402

HARDBODY = os.path.abspath(os.environ.get("HARDBODY", "build/release/apps/hardbody/hardbody"))
STATIC = os.path.abspath(os.environ.get("HARDBODY_STATIC", "build/release/tests/hardbody_static_report"))
INTERACTIVE = os.environ.get("HARDBODY_INTERACTIVE", "1") == "1"

# A run of some seconds, long enough for every number.
RUN = """seed = 3
[system]
number = 128
packing_fraction = 0.4
[shape]
aspect_ratio = 3
[equilibration]
time = 10
[production]
time = 150
[output]
trajectory = ["gsd"]
frames = 6
"""

SUPERBALLS = """[system]
number = 64
packing_fraction = 0.3
[shape]
kind = "superellipsoid"
semi_axes = [1, 1, 1.5]
exponents = [0.5, 0.5]
[equilibration]
time = 1
[production]
time = 4
"""

MIXTURE = """[system]
number = 80
packing_fraction = 0.2
[[species]]
semi_axes = [0.5, 0.5, 1.5]
fraction = 0.5
[[species]]
kind = "superellipsoid"
semi_axes = [0.7, 0.7, 0.7]
exponents = [0.5, 0.5]
fraction = 0.5
sizes = "gaussian"
width = 0.1
[equilibration]
time = 1
[production]
time = 4
"""

# 4 x 14^3 bodies: as they are placed.
MANY = """[system]
number = 10976
packing_fraction = 0.4
start = "fcc"
[shape]
aspect_ratio = 2
[equilibration]
time = 0
[production]
time = 0
"""

SWEEP = """[system]
number = 64
[equilibration]
time = 1
[production]
time = 2
[grid]
shape.aspect_ratio = [2.0, 3.0]
system.packing_fraction = [0.1, 0.2]
"""

# Of each plot over lags, distances or wave numbers: the file and what is shown of it, in this order.
FILES = {
    "msd": ("msd.csv", ["msd"]),
    "msd_directions": ("msd_directions.csv", ["msd_x", "msd_y", "msd_z"]),
    "rotational_msd": ("rotational_msd.csv", ["rot_msd", "rot_msd_body"]),
    "c2": ("c2.csv", ["c2"]),
    "c1": ("c1.csv", ["c1"]),
    "f_self": ("f_self.csv", ["f_self_q1", "f_self_q2", "f_self_q3", "f_self_q4"]),
    "overlap": ("overlap.csv", ["overlap"]),
    "chi4": ("overlap.csv", ["chi4"]),
    "velocity": ("velocity.csv", ["vacf", "wacf"]),  # over their values at t = 0
    "alpha2": ("alpha2.csv", ["alpha2"]),
    "g_r": ("g_r.csv", ["g", "g2"]),
    "s_q": ("s_q.csv", ["S"]),
    "van_hove": ("van_hove.csv", [f"G_s_t{k}" for k in range(2, 13, 2)]),
}
PLOTS = [*FILES, "pressure", "order", "energy"]

HOSTILE = '<img src=x onerror="window.hacked=1"><b>&amp;'
HOSTILE_LINE = "# </script><script>window.hacked=1</script><!-- <script>\n"

# In a page: how many different colours a canvas shows, on a grid of 40 x 40 places.
COLOURS = """function colours(canvas) {
  const copy = document.createElement('canvas');
  copy.width = copy.height = 40;
  const context = copy.getContext('2d');
  context.imageSmoothingEnabled = false;
  context.drawImage(canvas, 0, 0, 40, 40);
  const data = context.getImageData(0, 0, 40, 40).data;
  const seen = new Set();
  for (let k = 0; k < data.length; k += 4) seen.add(data.slice(k, k + 3).join());
  return seen.size;
}
"""

# Widths of a desktop and of a telephone.
SIZES = [(1280, 900), (390, 844)]


def summary_of(directory):
    return json.loads((directory / "summary.json").read_text(encoding="utf-8"))


def rows_of(path):
    return path.read_text(encoding="utf-8").splitlines()


class Case(unittest.TestCase):
    """Runs are made once and shared: none of the tests changes them."""

    made = None  # directory of the runs and their configs
    runs = {}
    one_browser = None
    opened = None  # by page()

    @classmethod
    def setUpClass(cls):
        if Case.made is None:
            Case.made = pathlib.Path(tempfile.mkdtemp())
            unittest.addModuleCleanup(shutil.rmtree, Case.made)
        cls.root = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.root.cleanup)
        cls.here = pathlib.Path(cls.root.name)

    @classmethod
    def browser(cls):
        """One for all tests: it takes longest to start."""
        if Case.one_browser is None:
            Case.one_browser = Browser()
            unittest.addModuleCleanup(Case.one_browser.close)
        return Case.one_browser

    @classmethod
    def config_of(cls, name):
        return Case.made / name.replace("/", "_") / "config.toml"

    @classmethod
    def run_of(cls, name, config):
        if name not in Case.runs:
            file = cls.config_of(name)
            file.parent.mkdir()
            file.write_text(config)
            directory = Case.made / "runs" / name
            subprocess.run([HARDBODY, "run", file, "--out", directory], check=True, capture_output=True)
            Case.runs[name] = directory
        return Case.runs[name]

    def report(self, *arguments, program=HARDBODY, status=0):
        result = subprocess.run([program, "report", *map(str, arguments)], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, status, result.stderr)
        return result

    def open(self, path, width=1280, height=900, **options):
        browser = self.browser()
        browser.open(path, width, height, **options)
        Case.opened = None
        return browser

    def open_low(self, path, width=1280, **options):
        """In a window so low that the bodies are not in sight, and so not drawn: without a graphics card that takes longer
        than all the rest."""
        browser = self.open(path, width, 200, **options)
        self.assertEqual(sum(browser.run("return window.hardbodyReport.views.map((v) => v.drawn)")), 0)
        return browser

    def page(self, path):
        """As open_low(), but a page that is open already stays as it is: for tests that do not mind what others did there."""
        if Case.opened != path:
            self.open_low(path)
            Case.opened = path
        return self.browser()

    def wait_for(self, browser, script, seconds=240):
        """Until the script returns something true, which is returned."""
        end = time.monotonic() + seconds
        while True:
            value = browser.run(script)
            if value or time.monotonic() > end:
                self.assertTrue(value, script)
                return value
            time.sleep(0.1)

    def assert_silent(self, browser):
        """No request but the file and what is in it, nothing to complain about."""
        self.assertEqual(browser.requests(), [])
        self.assertEqual([c for c in browser.complaints() if "GPU stall" not in c and "swiftshader" not in c.lower()], [])

    def assert_fits(self, browser, width):
        """Nothing stands out to the side."""
        self.assertLessEqual(browser.run("return document.documentElement.scrollWidth"), width)

    def colours(self, browser, selector):
        """How many different colours a canvas shows, on a grid of 40 x 40 places."""
        return browser.run(
            COLOURS
            + """const canvas = document.querySelector(arguments[0]);
            const view = window.hardbodyReport.page.views[0];
            if (view && canvas === view.canvas) view.renderer.render(view.scene, view.camera);
            return colours(canvas);""",
            selector,
        )

    def assert_draws_in_sight(self, browser):
        """Brings the bodies of a page of open_low() into sight, and looks at what it draws by itself."""
        browser.run(
            COLOURS
            + """const view = window.hardbodyReport.page.views[0]; const {drawBall} = view;
            // Called after each drawing, before the browser clears it.
            view.drawBall = () => { drawBall.call(view); window.seenColours ??= colours(view.canvas); };
            document.querySelector('.stage').scrollIntoView({behavior: 'instant'});"""
        )
        self.assertGreater(self.wait_for(browser, "return window.hardbodyReport.views[0].drawn && window.seenColours"), 40)


@unittest.skipUnless(INTERACTIVE, "this program was built without the interactive front end")
class OneRun(Case):
    def setUp(self):
        self.run_directory = self.run_of("run", RUN)
        self.file = self.run_directory / "report.html"
        self.report(self.run_directory)

    def expected_points(self, name, columns):
        """Points of the first `columns` quantities of a CSV file that are there, at positive lags."""
        table = [line.split(",") for line in rows_of(self.run_directory / "observables" / name)[1:]]
        return sum(1 for row in table for k in range(columns) if row[1 + 2 * k] and float(row[0]) > 0)

    def test_desktop_and_telephone(self):
        for width, height in SIZES:
            with self.subTest(width=width):
                browser = self.open(self.file, width, height)
                browser.run("document.querySelector('.stage').scrollIntoView({behavior: 'instant'})")
                self.wait_for(browser, "return window.hardbodyReport.views[0].drawn > 0")
                view = browser.run("return window.hardbodyReport.views[0]")
                self.assertEqual((view["bodies"], view["frames"]), (128, 6))
                # Every body's mesh reaches the graphics card.
                self.assertGreater(view["triangles"], 128 * 100)
                self.assertEqual(view["triangles"] % 128, 0)  # equal shapes: as many of each
                self.assertGreater(self.colours(browser, ".stage canvas"), 40)
                charts = {chart["id"]: chart for chart in browser.run("return window.hardbodyReport.charts")}
                self.assertEqual(list(charts), PLOTS)
                for name, chart in charts.items():
                    self.assertGreater(chart["points"], 10, name)
                self.assertEqual(charts["alpha2"]["points"], self.expected_points("alpha2.csv", 1))
                self.assertEqual(charts["velocity"]["points"], self.expected_points("velocity.csv", 2))
                self.assertEqual(charts["s_q"]["points"], self.expected_points("s_q.csv", 1))
                self.assert_fits(browser, width)
                self.assert_silent(browser)

    def test_numbers_are_those_of_the_summary(self):
        browser = self.page(self.file)
        observables = json.loads((self.run_directory / "summary.json").read_text())["observables"]
        for key in ("Z", "D_trans", "D_rot", "S", "t_C2_1overe"):
            value, error = observables[key]["value"], observables[key]["error"]
            text = browser.run("return document.querySelector(arguments[0]).textContent", f'.sheet [data-key="{key}"] dd')
            shown = re.match(r"([−0-9.]+) ± ([0-9.]+)", text)
            self.assertIsNotNone(shown, text)
            self.assertLess(abs(float(shown[1].replace("−", "-")) - value), 0.06 * error)
            self.assertLess(abs(float(shown[2]) - error), 0.06 * error)

    def test_fits_are_drawn(self):
        browser = self.page(self.file)
        series = {chart["id"]: chart["series"] for chart in browser.run("return window.hardbodyReport.charts")}
        self.assertIn("6 D_trans t", series["msd"])
        self.assertIn("4 D_rot t", series["rotational_msd"])
        self.assertIn("A exp[−(t/τ)ᵝ]", series["c2"])

    def test_error_bars_are_within_the_frame(self):
        browser = self.page(self.file)
        charts = {chart["id"]: chart for chart in browser.run("return window.hardbodyReport.charts")}
        for name in ("alpha2", "g_r", "s_q"):  # linear axes
            low, high = charts[name]["range"]
            ends = []
            for line in rows_of(self.run_directory / "observables" / FILES[name][0])[1:]:
                row = [float(field) if field else math.nan for field in line.split(",")]
                if row[0] > 0 or name != "alpha2":
                    ends += [row[1] + sign * (row[2] if row[2] > 0 else 0) for sign in (-1, 1)]
            ends = [end for end in ends if not math.isnan(end)]
            self.assertLess(low, min(ends), name)
            self.assertGreater(high, max(ends), name)

    def test_buttons_save(self):
        browser = self.open_low(self.file)
        browser.run(
            """window.saved = [];
            HTMLAnchorElement.prototype.click = function click() { window.saved.push(this.download); };
            document.querySelectorAll('.tool').forEach((b) => { if (/^Save/.test(b.title)) b.click(); });"""
        )
        number = 2 * len(PLOTS) + 2  # a table and a picture of each; bodies, results
        self.wait_for(browser, f"return window.saved.length >= {number}")
        names = browser.run("return window.saved")
        for name in PLOTS:
            self.assertIn(f"run-{name}.csv", names)
            self.assertIn(f"run-{name}.png", names)
        self.assertIn("run-bodies.png", names)
        self.assertIn("run-results.csv", names)

    def saved(self, browser, plot):
        """What the CSV button of a plot saves: a list of a heading and numbers a column, None where there is none."""
        text = browser.run(
            """return new Promise((done) => {
              const make = URL.createObjectURL;
              URL.createObjectURL = (blob) => { blob.text().then(done); return make(blob); };
              document.querySelector(`#plot-${arguments[0]} [title$="as CSV"]`).click();
            });""",
            plot,
        )
        head, *rows = csv.reader(text.splitlines())
        return list(zip(head, [[float(x) if x else None for x in column] for column in zip(*rows)]))

    def columns(self, name):
        """Of a file that the run wrote: as saved()."""
        head, *rows = csv.reader(rows_of(self.run_directory / "observables" / name))
        return dict(zip(head, [[float(x) if x else None for x in column] for column in zip(*rows)]))

    def assert_same(self, own, other, what):
        self.assertEqual(len(own), len(other), what)
        for x, y in zip(own, other):
            self.assertEqual(x is None, y is None, what)
            if x is not None:
                self.assertLessEqual(abs(x - y), 1e-3 * abs(x), what)

    def test_saved_csv_is_the_data(self):
        browser = self.page(self.file)
        for plot, (file, shown) in FILES.items():
            with self.subTest(plot=plot):
                saved, table = self.saved(browser, plot), self.columns(file)
                data = [column for column in saved if not re.match(r"6 D|4 D|A exp", column[0])]
                if plot in ("g_r", "s_q"):
                    self.assert_same(data[0][1], next(iter(table.values())), "abscissa")
                else:  # logarithmic: from the first positive lag on
                    lags = next(iter(table.values()))
                    first = next(k for k, t in enumerate(lags) if t > 0)
                    table = {name: values[first:] for name, values in table.items()}
                    self.assert_same(data[0][1], lags[first:], "abscissa")
                self.assertEqual(len(data), 1 + 2 * len(shown))
                for k, name in enumerate(shown):
                    column = next(c for c in table if c.startswith(name + " "))
                    error = next(c for c in table if c.startswith(name + "_error "))
                    unit = self.columns(file)[column][0] if plot == "velocity" else 1
                    for key, (_, values) in ((column, data[1 + 2 * k]), (error, data[2 + 2 * k])):
                        self.assert_same(table[key], [v if v is None else v * unit for v in values], key)

    def test_saved_blocks_are_the_data(self):
        browser = self.page(self.file)
        blocks = self.columns("blocks.csv")
        middle = [(a + b) / 2 for a, b in zip(*list(blocks.values())[:2])]
        observables = json.loads((self.run_directory / "summary.json").read_text())["observables"]
        for plot, column, key in (("pressure", "Z [1]", "Z"), ("order", "S [1]", "S")):
            saved = dict(self.saved(browser, plot)[1:])
            self.assert_same(self.saved(browser, plot)[0][1], middle, "middle of a block")
            self.assert_same(blocks[column], saved[key], key)
            self.assert_same([observables[key]["value"]] * len(middle), saved["mean"], "mean of " + key)
        drift = [column for column in self.saved(browser, "energy") if not column[0].endswith("error")][1][1]
        energy = [1.5 * (128 - 1) * a + 128 * b for a, b in zip(blocks["kT_trans [kT]"], blocks["kT_rot [kT]"])]
        self.assertEqual(len(drift), len(energy))
        for shown, own in zip(drift, energy):
            self.assertAlmostEqual(shown, own / energy[0] - 1, delta=1e-12)

    def test_fits_are_those_of_the_summary(self):
        browser = self.page(self.file)
        observables = json.loads((self.run_directory / "summary.json").read_text())["observables"]
        for plot, line, factor, key in (("msd", "6 D_trans t", 6, "D_trans"), ("rotational_msd", "4 D_rot t", 4, "D_rot")):
            (_, t), *series = self.saved(browser, plot)
            drawn = [(x, y) for x, y in zip(t, dict(series)[line]) if y is not None]
            self.assertGreater(len(drawn), 5)
            for (x1, y1), (x2, y2) in zip(drawn, drawn[1:]):
                self.assertAlmostEqual((y2 - y1) / (x2 - x1) / (factor * observables[key]["value"]), 1, delta=1e-6)
        for plot, name in (("c2", "C2"), ("f_self", "F")):
            (_, t), *series = self.saved(browser, plot)
            tau, beta = (observables[f"{key}_{name}"]["value"] for key in ("tau", "beta"))
            drawn = [(x, y) for x, y in zip(t, dict(series)["A exp[−(t/τ)ᵝ]"]) if y is not None]
            self.assertGreater(len(drawn), 5)
            amplitude = [y * math.exp((x / tau) ** beta) for x, y in drawn]
            self.assertAlmostEqual(min(amplitude) / max(amplitude), 1, delta=1e-6)
            # It lies on the points that it is a fit to.
            near = [(y, c) for x, y, c in zip(t, dict(series)["A exp[−(t/τ)ᵝ]"], series[0][1]) if y is not None and c > 0.1]
            for y, c in near:
                self.assertAlmostEqual(y, c, delta=0.05)

    def test_keys(self):
        browser = self.page(self.file)
        place = "const view = window.hardbodyReport.page.views[0]; return view.camera.position.toArray()"
        before = browser.run(place)
        press = """const canvas = document.querySelector('.stage canvas'); canvas.focus({preventScroll: true});
            canvas.dispatchEvent(new KeyboardEvent('keydown', {key: arguments[0], bubbles: true}));"""
        browser.run(press, "ArrowLeft")
        self.assertNotEqual(browser.run(place), before)
        browser.run(press, "r")
        for now, then in zip(browser.run(place), before):
            self.assertAlmostEqual(now, then)
        # The chart's cursor reads values.
        text = browser.run(
            """const chart = document.querySelector('#plot-msd .uplot'); chart.focus();
            chart.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight'}));
            return new Promise((done) => setTimeout(() => done(document.querySelector('#plot-msd .readout').textContent), 300));"""
        )
        self.assertRegex(text, r"^t = ")

    def test_everything_has_a_name(self):
        browser = self.page(self.file)
        nameless = browser.run(
            """return [...document.querySelectorAll('button, select, input, canvas[tabindex], [role=img]')].filter((e) =>
              !e.getAttribute('aria-label') && !e.textContent.trim() && !(e.labels && e.labels.length)).map((e) => e.outerHTML);"""
        )
        self.assertEqual(nameless, [])
        self.assertEqual(browser.run("return document.querySelectorAll('h1').length"), 1)
        self.assertEqual(browser.run("return document.documentElement.lang"), "en")

    def test_light_and_dark(self):
        shade = "return getComputedStyle(document.body).backgroundColor.match(/[0-9]+/g).map(Number)"
        for dark in (False, True):
            with self.subTest(dark=dark):
                browser = self.open_low(self.file, dark=dark)
                self.assertEqual(max(browser.run(shade)) < 60, dark)
                browser.run("document.querySelector('.theme').click()")
                self.assertEqual(max(browser.run(shade)) < 60, not dark)

    def test_frames_play(self):
        browser = self.open(self.file)
        matrices = "return Array.from(window.hardbodyReport.page.views[0].meshes[0].mesh.instanceMatrix.array.slice(0, 64))"
        last = browser.run(matrices)
        browser.run("const s = document.querySelector('.player input'); s.value = 0; s.dispatchEvent(new Event('input'))")
        self.assertIn("t = 0 · frame 1 of 6", browser.run("return document.querySelector('.view .caption').textContent"))
        self.assertNotEqual(browser.run(matrices), last)
        self.wait_for(browser, "return window.hardbodyReport.views[0].drawn > 0")
        balls = browser.run("return window.hardbodyReport.page.views[0].balls")
        self.assertEqual(balls, 1)
        browser.run("document.querySelector('.play').click()")
        self.wait_for(browser, "return window.hardbodyReport.views[0].frame >= 2")
        # Playing does not draw the ball of colours again, turning does.
        self.assertEqual(browser.run("return window.hardbodyReport.page.views[0].balls"), balls)
        browser.run("document.querySelector('.play').click()")
        self.assertEqual(browser.run("return window.hardbodyReport.page.views[0].timer"), None)

    def test_cut_hides_bodies(self):
        browser = self.open_low(self.file)
        picture = """const view = window.hardbodyReport.page.views[0];
            view.clip.share = arguments[0]; view.cut(); view.renderer.render(view.scene, view.camera);
            const gl = view.renderer.getContext();
            const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
            gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
            const ground = pixels.slice(0, 3).join(); let covered = 0;
            for (let k = 0; k < pixels.length; k += 4) covered += pixels.slice(k, k + 3).join() !== ground;
            return covered;"""
        whole, half = browser.run(picture, 1), browser.run(picture, 0.4)
        self.assertLess(half, 0.9 * whole)
        self.assertGreater(half, 0.1 * whole)

    def test_size(self):
        self.assertLess(self.file.stat().st_size, 2_000_000)


@unittest.skipUnless(INTERACTIVE, "this program was built without the interactive front end")
class OtherRuns(Case):
    def test_ten_thousand_bodies(self):
        """One mesh of instances: so many triangles, drawn in one call. What the page itself takes for a frame, and all of it
        where the processor draws too, as here, is printed."""
        directory = self.run_of("many", MANY)
        self.report(directory)
        self.assertLess((directory / "report.html").stat().st_size, 3e6)
        browser = self.open_low(directory / "report.html")
        begin = time.monotonic()
        self.assert_draws_in_sight(browser)
        draw = 1000 * (time.monotonic() - begin)
        view = browser.run(
            """const v = window.hardbodyReport.page.views[0];
            return [v.bodies, v.meshes.map((m) => m.mesh.count), v.renderer.info.render.triangles, v.renderer.info.render.calls];"""
        )
        self.assertEqual(view[:2], [10976, [10976]])
        self.assertGreater(view[2], 10976 * 50)
        self.assertLess(view[3], 20)
        prepare, balls = browser.run(
            """const v = window.hardbodyReport.page.views[0]; const before = v.balls; v.draw = () => {};
            const begin = performance.now();
            for (let k = 0; k < 10; k += 1) { v.show(0); v.drawBall(); }
            return [(performance.now() - begin) / 10, v.balls - before];"""
        )
        self.assertEqual(balls, 0)
        print(f"10,976 bodies: {prepare:.1f} ms to prepare a frame, {draw:.1f} ms to draw it without a graphics card")
        self.assert_silent(browser)

    def test_superellipsoids(self):
        directory = self.run_of("superballs", SUPERBALLS)
        self.report(directory)
        browser = self.open_low(directory / "report.html")
        self.assert_draws_in_sight(browser)
        self.assertEqual(browser.run("return window.hardbodyReport.views[0].bodies"), 64)
        # Points of the mesh lie on the surface, and normals are those of it.
        worst = browser.run(
            """const {geometry} = window.hardbodyReport.page.views[0].meshes[0].mesh; const {position, normal} = geometry.attributes;
            let worst = 0;
            for (let k = 0; k < position.count; k += 1) {
              const [x, y, z] = [position.getX(k), position.getY(k), position.getZ(k)];
              worst = Math.max(worst, Math.abs(x ** 4 + y ** 4 + z ** 4 - 1));
              const g = [x ** 3, y ** 3, z ** 3]; const l = Math.hypot(...g);
              worst = Math.max(worst, 1 - (g[0] * normal.getX(k) + g[1] * normal.getY(k) + g[2] * normal.getZ(k)) / l);
            }
            return worst;"""
        )
        self.assertLess(worst, 1e-5)
        self.assert_silent(browser)

    def test_mixture(self):
        directory = self.run_of("mixture", MIXTURE)
        self.report(directory)
        browser = self.open_low(directory / "report.html")
        self.assert_draws_in_sight(browser)
        view = browser.run("const v = window.hardbodyReport.page.views[0]; return [v.bodies, v.meshes.length, v.modes().map((m) => m.key)]")
        self.assertEqual(view, [80, 2, ["direction", "angle", "species", "plain"]])
        charts = browser.run("return window.hardbodyReport.charts")
        self.assertEqual(len([name for name in charts[0]["series"] if "MSD" in name]), 3)
        # One colour a species in all plots, that of its card; all bodies have the text's.
        titles = browser.run("return window.hardbodyReport.page.views[0].run.species.map((s) => s.title)")
        for chart in charts:
            for label, colour in zip(chart["series"], chart["colours"]):
                of = [k for k, title in enumerate(titles) if label.endswith(f", {title}") or f", {title}," in label]
                of_pair = label.endswith("species 1 and 2")
                self.assertEqual(colour, of[0] if of else len(titles) if of_pair else -1, label)
        self.assert_silent(browser)

    def test_nothing_rotational_of_spheres(self):
        spheres = "[[species]]\nsemi_axes = [1, 1, 1]\n"
        text = "[system]\nnumber = 60\npacking_fraction = 0.2\n{}[equilibration]\ntime = 1\n[production]\ntime = 4\n"
        directory = self.run_of("spheres", text.format("[shape]\naspect_ratio = 1\n"))
        self.report(directory)
        browser = self.open_low(directory / "report.html")
        charts = {chart["id"]: chart for chart in browser.run("return window.hardbodyReport.charts")}
        self.assertEqual(list(charts), [name for name in PLOTS if name not in ("rotational_msd", "c2", "c1", "order")])
        self.assertEqual(charts["g_r"]["series"], ["g"])
        self.assertEqual((charts["g_r"]["yLabel"], charts["g_r"]["about"]), ("g(r)", "g of the centres."))
        self.assertEqual(charts["velocity"]["series"], ["velocity"])
        keys = browser.run("return [...document.querySelectorAll('.sheet [data-key]')].map((e) => e.dataset.key)")
        self.assertIn("D_trans", keys)
        self.assertEqual([key for key in keys if re.match("D_rot|S$|.*C2|kT_rot", key)], [])
        self.report(directory, "-o", self.here / "static.html", program=STATIC)
        static = (self.here / "static.html").read_text(encoding="utf-8")
        self.assertIn("Mean square displacement", static)
        self.assertNotIn("Orientation", static)
        # Of a mixture the species of spheres has no curves of rotation.
        discs = "fraction = 0.5\n[[species]]\nsemi_axes = [1, 1, 0.5]\nfraction = 0.5\n"
        directory = self.run_of("spheres_and_discs", text.format(spheres + discs))
        self.report(directory)
        browser = self.open_low(directory / "report.html")
        charts = {chart["id"]: chart for chart in browser.run("return window.hardbodyReport.charts")}
        self.assertEqual(list(charts), PLOTS)
        for name, species in [("msd", {0, 1}), ("c2", {1}), ("rotational_msd", {1})]:
            self.assertEqual({colour for colour in charts[name]["colours"] if colour >= 0}, species, name)
        self.assert_silent(browser)

    def test_why_values_are_missing_is_said(self):
        directory = self.run_of("superballs", SUPERBALLS)
        observables = summary_of(directory)["observables"]
        self.report(directory)
        browser = self.open_low(directory / "report.html")
        for key in ("D_trans", "tau_C2"):
            self.assertIsNone(observables[key]["value"])
            shown = browser.run(f"""return document.querySelector('[data-key="{key}"] dd .none').textContent""")
            self.assertEqual(shown, observables[key]["missing"])
        self.assertNotIn("NaN", browser.run("return document.body.textContent.split('window.')[0]"))

    def test_unfinished(self):
        directory = self.here / "unfinished"
        shutil.copytree(self.run_of("superballs", SUPERBALLS), directory)
        for name in ["summary.json", "observables"]:
            target = directory / name
            shutil.rmtree(target) if target.is_dir() else target.unlink()
        self.report(directory)
        browser = self.open_low(directory / "report.html")
        self.assertIn("unfinished", browser.run("return document.querySelector('.remarks').textContent"))
        self.assertEqual(browser.run("return window.hardbodyReport.views.length"), 1)
        self.assert_draws_in_sight(browser)
        self.assert_silent(browser)

    def test_stopped(self):
        directory = self.here / "stopped"
        shutil.copytree(self.run_of("superballs", SUPERBALLS), directory)
        summary = json.loads((directory / "summary.json").read_text())
        summary["interrupted"] = True
        (directory / "summary.json").write_text(json.dumps(summary))
        self.report(directory)
        browser = self.open_low(directory / "report.html")
        self.assertIn("stopped early", browser.run("return document.querySelector('.remarks').textContent"))

    def test_hostile_names(self):
        directory = self.here / HOSTILE
        shutil.copytree(self.run_of("superballs", SUPERBALLS), directory)
        for name in ("config.toml", "log.txt"):
            with open(directory / name, "a", encoding="utf-8") as file:
                file.write(HOSTILE_LINE)
        other = self.run_of("superballs", SUPERBALLS)
        for arguments in ([directory], [directory, other, "-o", self.here / "both.html"]):
            with self.subTest(number=len(arguments)):
                self.report(*arguments)
                file = directory / "report.html" if len(arguments) == 1 else self.here / "both.html"
                browser = self.open_low(file)
                self.assertIsNone(browser.run("return window.hacked ?? null"))
                self.assertIn(HOSTILE, browser.run("return document.querySelector('.hero').textContent"))
                self.assertIn(HOSTILE_LINE.strip(), browser.run("return [...document.querySelectorAll('pre')].map((e) => e.textContent).join()"))
                self.assertEqual(browser.run("return document.querySelectorAll('#report img').length"), 0)
                self.assert_silent(browser)
        self.assertIn(HOSTILE, browser.run("return document.title"))

    def test_several(self):
        runs = [self.run_of("run", RUN), self.run_of("superballs", SUPERBALLS)]
        file = self.here / "several.html"
        self.report(*runs, "-o", file)
        for width, _ in SIZES:
            with self.subTest(width=width):
                browser = self.open_low(file, width)
                charts = {chart["id"]: chart for chart in browser.run("return window.hardbodyReport.charts")}
                self.assertEqual(list(charts), PLOTS)
                # The other is too short for D_trans.
                self.assertEqual(charts["msd"]["series"], ["run", "run, 6 D_trans t", "superballs"])
                wave_numbers = [summary_of(run)["wave_numbers"][0] for run in runs]
                for name, chart in charts.items():
                    for run, wave_number in zip(("run", "superballs"), wave_numbers):
                        if name == "van_hove":  # the same number of lags from the longest on, whose times differ
                            self.assertTrue([label for label in chart["series"] if label.startswith(f"{run}, t = ")])
                            continue
                        label = f"{run}, q l = {wave_number:.3g}" if name == "f_self" else run
                        self.assertIn(label, chart["series"], name)
                self.assertEqual(browser.run("""return document.querySelectorAll('.comparison [data-key="Z"] td .number').length"""), 2)
                self.assertIn("semi_axes", browser.run("return document.querySelector('#settings ~ .card').textContent"))
                browser.run("""const select = document.querySelector('label.chooser select');
                  select.selectedIndex = 1; select.dispatchEvent(new Event('change'));""")
                self.assertIn("1 : 1 : 1.5", browser.run("return window.hardbodyReport.page.views[0].run.title"))
                self.assert_fits(browser, width)
                self.assert_draws_in_sight(browser)
                self.assert_silent(browser)

    def test_several_mixtures_of_one_name(self):
        """Settings of each of the species, and directories that only their parents tell apart."""
        one = self.run_of("x/run", MIXTURE)
        other = self.run_of("y/run", MIXTURE.replace("semi_axes = [0.5, 0.5, 1.5]", "semi_axes = [0.5, 0.5, 1.2]"))
        file = self.here / "mixtures.html"
        self.report(one, other, "-o", file)
        browser = self.open_low(file)
        names = browser.run("return [...document.querySelectorAll('.runs b:first-of-type')].map((e) => e.textContent)")
        self.assertEqual(names[0], "x/run")
        self.assertIn("y/run", names)
        different = browser.run("return document.querySelector('#settings ~ .card').textContent")
        self.assertIn("species 1.semi_axes", different)
        self.assertNotIn("species 2", different)
        self.assert_draws_in_sight(browser)

    def test_frames_cut_off_are_said(self):
        directory = self.here / "cut_off"
        shutil.copytree(self.run_of("run", RUN), directory)
        with open(directory / "trajectory.gsd", "r+b") as file:
            file.truncate(file.seek(0, os.SEEK_END) * 3 // 4)
        self.report(directory)
        browser = self.open_low(directory / "report.html")
        self.assertIn("frames cut off", browser.run("return document.querySelector('.hero').textContent"))
        self.assert_draws_in_sight(browser)

    def test_the_demo(self):
        """A short form of what tools/demo shows."""
        config = (pathlib.Path(__file__).parents[2] / "apps" / "demo.toml").read_text(encoding="utf-8")
        directory = self.run_of("demo", config.replace("time = 400", "time = 20"))
        self.report(directory)
        for width, _ in SIZES:
            with self.subTest(width=width):
                browser = self.open_low(directory / "report.html", width)
                self.assert_draws_in_sight(browser)
                view = browser.run("return window.hardbodyReport.views[0]")
                self.assertEqual((view["bodies"], view["frames"]), (512, 60))
                for chart in browser.run("return window.hardbodyReport.charts"):
                    self.assertGreater(chart["points"], 10, chart["id"])
                self.assert_fits(browser, width)
                self.assert_silent(browser)


@unittest.skipUnless(INTERACTIVE, "this program was built without the interactive front end")
class Sweep(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep = cls.here / "sweep"
        # As few bodies as all the points' boxes allow: those of some twenty points are drawn.
        synthetic.write_sweep(cls.run_of("points", RUN.replace("number = 128", "number = 64")), cls.sweep)
        subprocess.run([HARDBODY, "report", cls.sweep], check=True, capture_output=True)
        cls.file = cls.sweep / "report.html"

    def test_500_points_open_within_3_seconds(self):
        browser = self.open(self.file)
        # By the page's own time, not the clock's: the machine has other things to do.
        self.assertGreater(browser.computed, 0.05)
        self.assertLess(browser.computed, 3)

    def test_map_and_points(self):
        for width, height in SIZES:
            with self.subTest(width=width):
                browser = self.open(self.file, width, height)
                seen = browser.run("return window.hardbodyReport.map")
                self.assertEqual((seen["points"], seen["known"]), (500, 499))
                self.assertGreater(seen["segments"], 50)
                self.assertGreater(self.colours(browser, ".map canvas"), 50)
                self.assertEqual(len(browser.run("return [...document.querySelectorAll('.points tbody tr')].map((e) => 0)")), 500)
                # A click opens the point there.
                browser.run(
                    """const {map} = window.hardbodyReport.page.sweep; const [x, y, w, h] = map.rectangle(map.g, [20, 15]);
                    const canvas = map.canvas; canvas.scrollIntoView({behavior: 'instant', block: 'center'});
                    const at = canvas.getBoundingClientRect();
                    const options = {clientX: at.left + x + w / 2, clientY: at.top + y + h / 2, bubbles: true};
                    canvas.dispatchEvent(new MouseEvent('click', options));"""
                )
                self.assertEqual(browser.run("return window.hardbodyReport.map.shown"), 20 * 20 + 15)
                charts = [c["id"] for c in browser.run("return window.hardbodyReport.charts")]
                self.assertEqual(sorted(charts), sorted([*PLOTS, "cuts"]))
                self.assertEqual(browser.run("return window.hardbodyReport.views[0].bodies"), 64)
                self.assert_fits(browser, width)
                self.assert_silent(browser)

    def test_many_points_one_after_the_other(self):
        """A page may have some sixteen WebGL contexts: a view gives its own back."""
        browser = self.open(self.file, 600, 400, scale=0.5)
        for k in range(18):
            browser.run(
                """const {map} = window.hardbodyReport.page.sweep; const [x, y, w, h] = map.rectangle(map.g, [arguments[0], 10]);
                const at = map.canvas.getBoundingClientRect();
                map.canvas.dispatchEvent(new MouseEvent('click', {clientX: at.left + x + w / 2, clientY: at.top + y + h / 2, bubbles: true}));
                document.querySelector('.stage').scrollIntoView({behavior: 'instant'});""",
                k,
            )
            self.wait_for(browser, "return window.hardbodyReport.views[0].drawn > 0")
        self.assertGreater(self.colours(browser, ".stage canvas"), 40)
        self.assert_silent(browser)

    def test_keys_move_and_open(self):
        browser = self.open(self.file)
        shown = browser.run(
            """const {map} = window.hardbodyReport.page.sweep; const [i, j] = map.cursor; map.canvas.focus();
            for (const key of ['ArrowRight', 'ArrowUp', 'Enter']) map.canvas.dispatchEvent(new KeyboardEvent('keydown', {key}));
            return [20 * (i + 1) + j + 1, window.hardbodyReport.map.shown];"""
        )
        self.assertEqual(shown[0], shown[1])

    def test_values_are_those_of_the_table(self):
        browser = self.page(self.file)
        index = 7 * 20 + 11
        browser.run("window.hardbodyReport.page.sweep.showPoint(arguments[0])", index)
        row = rows_of(self.sweep / "sweep.csv")[1 + index].split(",")
        text = browser.run("""return document.querySelector('#point [data-key="Z"] dd').textContent""")
        self.assertAlmostEqual(float(text.split(" ±")[0]), float(row[7]), delta=0.06 * float(row[8]))

    def test_failed_point_says_why(self):
        browser = self.page(self.file)
        browser.run("window.hardbodyReport.page.sweep.showPoint(arguments[0])", 3 * 20 + 4)
        self.assertIn("<b>no</b>", browser.run("return document.querySelector('#point').textContent"))
        self.assertEqual(browser.run("return document.querySelectorAll('#point .notice b').length"), 0)

    def test_isolines_of_a_plane(self):
        browser = self.page(self.file)
        worst = browser.run(
            """const {map} = window.hardbodyReport.page.sweep;
            const lines = map.constructor.isolines([0, 1, 2.5, 4], [0, 2, 3], (i, j) => [0, 1, 2.5, 4][i] + 2 * [0, 2, 3][j], 4.2);
            return [lines.length, Math.max(...lines.flat().map(([x, y]) => Math.abs(x + 2 * y - 4.2)))];"""
        )
        self.assertEqual(worst[0], 1)
        self.assertLess(worst[1], 1e-12)

    def test_real_sweep(self):
        (self.here / "real.toml").write_text(SWEEP)
        subprocess.run([HARDBODY, "sweep", self.here / "real.toml", "--out", self.here / "real"], check=True, capture_output=True)
        self.report(self.here / "real")
        browser = self.open(self.here / "real" / "report.html")
        # The runs have no D_trans: something else is shown, and the reason beside the point.
        self.assertEqual(browser.run("return [window.hardbodyReport.map.points, window.hardbodyReport.map.known]"), [4, 4])
        embedded = "return window.hardbodyReport.page.sweep.sweep.points.map((p) => p.embedded)"
        self.assertEqual(browser.run(embedded), [True] * 4)
        browser.run("window.hardbodyReport.page.sweep.showPoint(1)")
        self.assertIn("packing fraction 0.2", browser.run("return document.querySelector('#plots h2').textContent"))
        reason = browser.run("return document.querySelector('.results [data-key=\"D_trans\"] dd .none').textContent")
        self.assertRegex(reason, "(at|within|up to) the longest lag|where the fit begins")
        self.assert_silent(browser)

    def table(self, name, keys, rows):
        """Report of a sweep of which there is only the table; a row: keys, D_trans, Z, equilibrated."""
        sweep = self.here / name
        sweep.mkdir(exist_ok=True)
        header = [*keys, "equilibration_time", "production_time", "D_trans", "D_trans_error", "Z", "Z_error", "equilibrated", "status", "message"]
        with open(sweep / "sweep.csv", "w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(header)
            for *values, d_trans, z, equilibrated in rows:
                table.writerow([*values, 10, 60, d_trans, "0.01" if d_trans else "", z, "0.01", equilibrated, "done", ""])
        self.report(sweep)
        self.report(sweep, "-o", sweep / "static.html", program=STATIC)
        return sweep

    def test_one_key_and_seeds(self):
        """The mean of the seeds against the key; no map. The quantity with most values is opened."""
        rows = [(phi, seed, "0.1" if phi == 0.1 else "", 2 + 10 * phi + seed, "false" if phi == 0.3 else "true") for phi in (0.1, 0.2, 0.3) for seed in (1, 2)]
        sweep = self.table("seeds", ["system.packing_fraction", "seed"], rows)
        browser = self.open(sweep / "report.html")
        cut = browser.run("return window.hardbodyReport.page.sweep.cut.plot")
        self.assertEqual(cut["y"]["label"], "Compressibility factor")
        self.assertEqual(cut["x"]["label"], "packing fraction φ")
        for got, wanted in zip(cut["series"][0]["y"], [4.5, 5.5, 6.5]):
            self.assertAlmostEqual(got, wanted)
        self.assertEqual(cut["series"][0]["open"], [False, False, True])
        # Pooled as replicas are; the values stand behind their mean.
        self.assertEqual(cut["series"][0]["spread"][0], [4, 5])
        self.assertAlmostEqual(cut["series"][0]["error"][0], 1.8373 * 0.5, places=4)
        self.assertEqual(browser.run("return window.hardbodyReport.page.sweep.cut.spreads[0].length"), 6)
        self.assertEqual(browser.run("return document.querySelectorAll('.map canvas').length"), 0)
        self.assertIn("Along the sweep", browser.run("return document.querySelector('.map-card').textContent"))
        self.assert_silent(browser)
        static = (sweep / "static.html").read_text(encoding="utf-8")
        self.assertLess(static.index("<figcaption>Z; open"), static.index("<figcaption>D_trans"))
        self.assertEqual(static.count('<circle class="open"'), 1)
        self.assertEqual(static.count("<circle"), 4)
        self.assertEqual(static.count('<path class="spread"'), 2)

    def test_replicas(self):
        """Values of the replicas behind the pooled ones; the message says where they disagree."""
        rows = [(phi, 7, "0.1", 2 + 10 * phi, "true") for phi in (0.1, 0.2)]
        name = "replicas"
        sweep = self.here / name
        sweep.mkdir()
        with open(sweep / "replicas.csv", "w", encoding="utf-8") as file:
            file.write("system.packing_fraction,seed,replica,equilibration_time,Z,Z_error,status\n")
            file.writelines(f"{phi},{7 + k},{k},10,{2 + 10 * phi + k - 1},0.01,done\n" for phi in (0.1, 0.2) for k in range(3))
        sweep = self.table(name, ["system.packing_fraction", "seed"], rows)
        browser = self.open(sweep / "report.html")
        shown = browser.run("const {cut, sweep} = window.hardbodyReport.page.sweep; return [cut.plot.series[0].spread, sweep.points[0].values]")
        z = 1 if shown[1][1][0] == 3 else 0
        self.assertEqual(shown[1][z], [3, 0.01, "", [2, 3, 4]])
        static = (sweep / "static.html").read_text(encoding="utf-8")
        self.assertEqual(static.count('<path class="spread"'), 1)
        self.assert_silent(browser)

    def test_keys_that_go_together(self):
        """There is no plane between zipped keys: no empty map."""
        sweep = self.table("zipped", ["shape.aspect_ratio", "system.packing_fraction"], [(x, x / 10, "0.1", x, "true") for x in (1, 2, 3, 4)])
        browser = self.open(sweep / "report.html")
        self.assertEqual(browser.run("return document.querySelectorAll('.map canvas').length"), 0)
        self.assertEqual(browser.run("return window.hardbodyReport.page.sweep.cut.plot.series[0].y"), [0.1] * 4)
        self.assertEqual((sweep / "static.html").read_text(encoding="utf-8").count("<circle"), 8)
        # Each aspect ratio may have packing fractions of its own: that is a plane.
        rows = [(x, (x + k) / 10, "0.1", x + k, "true") for x in (1, 2, 3) for k in (0, 0.5)]
        browser = self.open(self.table("ragged", ["shape.aspect_ratio", "system.packing_fraction"], rows) / "report.html")
        self.assertEqual(browser.run("return window.hardbodyReport.map.known"), 6)

    def test_open_points_of_a_map(self):
        rows = [(x, phi, x * phi, 1 + x, "false" if x == 3 else "true") for x in (1, 2, 3) for phi in (0.1, 0.2)]
        sweep = self.table("open", ["shape.aspect_ratio", "system.packing_fraction"], rows)
        browser = self.open(sweep / "report.html")
        seen = browser.run("""const page = window.hardbodyReport.page.sweep;
          return [[1, 2, 3].map((x) => page.cell(x, 0.1).open), page.map.xLabel, page.map.yLabel];""")
        self.assertEqual(seen, [[False, False, True], "aspect ratio X₀", "packing fraction φ"])
        self.assertIn("not shown to be equilibrated", browser.run("return document.querySelector('.map-card').textContent"))
        static = (sweep / "static.html").read_text(encoding="utf-8")
        for text in ("aspect ratio X₀", "packing fraction φ", "not shown to be equilibrated"):
            self.assertIn(text, static)

    def test_one_key(self):
        sweep = self.here / "line"
        synthetic.write_sweep(self.run_of("run", RUN), sweep, ratios=1, densities=6, failed=())
        self.report(sweep)
        browser = self.open(sweep / "report.html")
        charts = {c["id"]: c for c in browser.run("return window.hardbodyReport.charts")}
        self.assertEqual(charts["cuts"]["points"], 6)
        self.assert_silent(browser)


class Static(Case):
    """Of a program that was built without the bundle."""

    def test_plots_without_script(self):
        directory = self.run_of("run", RUN)
        result = self.report(directory, "-o", self.here / "static.html", program=STATIC)
        self.assertIn("static", result.stdout)
        text = (self.here / "static.html").read_text(encoding="utf-8")
        self.assertNotIn("<script", text)
        for q in summary_of(directory)["wave_numbers"]:
            self.assertIn(f">q l = {q:.3g}<", text)
        for width, height in SIZES:
            with self.subTest(width=width):
                browser = self.open(self.here / "static.html", width, height)
                self.assertEqual(browser.run("return document.querySelectorAll('svg').length"), 15)
                points = browser.run("return document.querySelectorAll('figure')[0].querySelectorAll('circle').length")
                self.assertEqual(points, len(rows_of(directory / "observables" / "msd.csv")) - 1)
                self.assertIn("npm", browser.run("return document.querySelector('.notice').textContent"))
                self.assert_fits(browser, width)
                self.assert_silent(browser)

    def test_sweep(self):
        """Maps over two keys, plots against one, and the table."""
        run = self.run_of("run", RUN)
        for name, ratios, figures in [("plane", 6, ".map svg circle"), ("line", 1, ".card svg circle")]:
            with self.subTest(name):
                sweep = self.here / f"static_{name}"
                synthetic.write_sweep(run, sweep, ratios=ratios, densities=5, failed=())
                self.report(sweep, program=STATIC)
                for width, height in SIZES:
                    browser = self.open(sweep / "report.html", width, height)
                    titles = browser.run("return [...document.querySelectorAll('figcaption')].map((e) => e.textContent)")
                    self.assertEqual([t.split(" [")[0] for t in titles], ["D_trans", "D_rot", "t_C2", "Z", "S", "Γ"])
                    points = browser.run(f"return document.querySelectorAll('{figures}').length")
                    self.assertEqual(points, 6 * ratios * 5)
                    lines = browser.run("return document.querySelectorAll('.map svg path[fill=none]').length")
                    self.assertEqual(lines > 0, name == "plane")
                    rows = browser.run("return document.querySelectorAll('tbody tr').length")
                    self.assertEqual(rows, ratios * 5)
                    self.assert_fits(browser, width)
                    self.assert_silent(browser)

    def test_hostile_names(self):
        directory = self.here / HOSTILE
        shutil.copytree(self.run_of("superballs", SUPERBALLS), directory)
        with open(directory / "log.txt", "a", encoding="utf-8") as file:
            file.write(HOSTILE_LINE)
        self.report(directory, program=STATIC)
        browser = self.open(directory / "report.html")
        self.assertIsNone(browser.run("return window.hacked ?? null"))
        self.assertIn(HOSTILE, browser.run("return document.querySelector('.path').textContent"))
        self.assertEqual(browser.run("return document.querySelectorAll('img').length"), 0)


class CommandLine(Case):
    def line(self, *arguments):
        result = self.report(*arguments, status=2)
        self.assertEqual(result.stderr.count("\n"), 1)
        return result.stderr

    def test_message_has_path_and_size(self):
        directory = self.run_of("superballs", SUPERBALLS)
        self.assertRegex(self.report(directory).stdout, re.escape(f"{directory}/report.html: ") + r"[0-9.]+ [kM]B")
        self.assertEqual([p for p in directory.iterdir() if p.suffix == ".part"], [])

    def test_what_is_no_run(self):
        (self.here / "empty").mkdir(exist_ok=True)
        self.assertIn("is not there; accepted", self.line(self.here / "nothing"))
        self.assertIn("config.toml is missing", self.line(self.here / "empty"))

    def test_damaged_files(self):
        source = self.run_of("superballs", SUPERBALLS)
        for name, text, message in [
            ("summary.json", "{", "summary.json: is not valid JSON"),
            ("summary.json", "[]", "summary.json: is not an object"),
            ("observables/msd.csv", "t [l],msd [l^2]\n1,x\n", 'msd.csv:2: "x" is not a number'),
            ("observables/msd.csv", "", "msd.csv: has no header line of columns"),
            ("observables/msd.csv", "\0" * 512, "msd.csv: has no header line of columns"),
            ("observables/msd.csv", "t [l],msd [l^2]\n1\n", "msd.csv:2: has 1 fields; accepted: 2"),
            ("config.toml", "[system\n", "config.toml:1"),
        ]:
            with self.subTest(name=name, text=text):
                directory = self.here / "damaged"
                shutil.copytree(source, directory)
                (directory / name).write_text(text)
                (directory / "report.html").unlink(missing_ok=True)
                self.assertIn(message, self.line(directory))
                self.assertFalse((directory / "report.html").exists())
                shutil.rmtree(directory)

    def test_what_cannot_be_shown_is_said(self):
        """A damaged trajectory or checkpoint costs the view, not the report."""
        source = self.run_of("superballs", SUPERBALLS)
        for name, others in [("trajectory.gsd", []), ("checkpoint.bin", ["trajectory.gsd"])]:
            with self.subTest(name):
                directory = self.here / "damaged"
                shutil.copytree(source, directory)
                for other in others:
                    (directory / other).unlink(missing_ok=True)
                (directory / name).write_text("HARDBODY")
                self.report(directory)
                page = (directory / "report.html").read_text()
                self.assertRegex(page, "not shown.*" + re.escape(name) + ": is ")
                shutil.rmtree(directory)

    def test_where_it_cannot_be_written(self):
        directory = self.run_of("superballs", SUPERBALLS)
        self.assertIn("accepted: -o FILE.html", self.line(directory, directory))
        self.assertIn("is a directory; accepted: a new file", self.line(directory, "-o", self.here))
        self.assertIn("is not a directory", self.line(directory, "-o", self.here / "no" / "file.html"))

    def test_replaces_nothing_but_reports(self):
        directory = self.run_of("superballs", SUPERBALLS)
        letter = self.here / "letter.html"
        letter.write_text("<!doctype html>\n<p>Dear reader,")
        pipe = self.here / "pipe"
        os.mkfifo(pipe)
        self.assertIn("letter.html: exists and is something else; accepted: a new file", self.line(directory, "-o", letter))
        self.assertEqual(letter.read_text(), "<!doctype html>\n<p>Dear reader,")
        for place in [pipe, directory / "config.toml"]:
            before = os.stat(place)
            self.line(directory, "-o", place)
            self.assertEqual(os.stat(place), before)
        # A report is replaced, behind a link too.
        old = self.here / "old.html"
        self.report(directory, "-o", old)
        old.write_text(old.read_text() + "<!-- old -->")
        link = self.here / "link.html"
        link.symlink_to("old.html")
        self.report(directory, "-o", link)
        self.assertTrue(link.is_symlink())
        self.assertNotIn("<!-- old -->", old.read_text())

    def test_force_removes_an_old_report(self):
        directory = self.run_of("superballs", SUPERBALLS)
        self.report(directory)
        copy = self.here / "again"
        shutil.copytree(directory, copy)
        subprocess.run([HARDBODY, "run", self.config_of("superballs"), "--out", copy, "--force", "--set", "production.time=0"],
                       check=True, capture_output=True)
        self.assertFalse((copy / "report.html").exists())


if __name__ == "__main__":
    unittest.main()
