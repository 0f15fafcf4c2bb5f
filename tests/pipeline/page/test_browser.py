"""The page in a browser: drawn without errors, moving as the records say, by mouse and by keys, and with bad input.

Chromium without a window draws with its processor. Positions are read back through the page; pixels are compared with
those that VTK draws from the same place.
"""

from __future__ import annotations

import http.client
import io
import json
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from made_pages import lift_case, lift_motion, lifted, made_content, made_results

import heavylift as hl
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.commands.live import LiveRun, serve
from heavylift.pipeline.drawn.build import case_scene
from heavylift.pipeline.page.page import page_content, page_html
from heavylift.pipeline.pictures.camera import Camera, View
from heavylift.pipeline.pictures.render import Drawing, Patch, Renderer, RenderingUnavailableError
from heavylift.pipeline.results.histories import load_results
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.stages import run_case

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
DRIVER = shutil.which("chromedriver")
CASES = Path(__file__).parents[3] / "cases"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not (CHROMIUM and DRIVER),
        reason="no Chromium with its driver; on Debian `apt-get install -y chromium chromium-driver`",
    ),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),  # sockets that selenium keeps open
]

SIZE = (1400, 900)
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    f"--window-size={SIZE[0]},{SIZE[1]}",
)


class Page:
    """A page in a browser of its own.

    Parameters
    ----------
    driver
        Of selenium.
    """

    def __init__(self, driver):
        self.driver = driver

    def open(self, address):
        """Load and wait until it is ready; whatever went wrong fails the test."""
        self.driver.get(address)
        self.wait("window.heavylift && (heavylift.state.ready || heavylift.state.error !== '')")
        assert self("heavylift.state.error") == ""
        return self

    def __call__(self, expression):
        return self.driver.execute_script(f"return {expression}")

    def do(self, statement):
        self.driver.execute_script(statement)

    def wait(self, condition, seconds=90.0):
        end = time.monotonic() + seconds
        while not self(condition):
            assert time.monotonic() < end, condition
            time.sleep(0.05)

    def settle(self):
        """Wait until a frame is drawn that began after now."""
        drawn = self("heavylift.drawn()")
        self.do("heavylift.seek(heavylift.clock.now)")
        self.wait(f"heavylift.drawn() > {drawn}")
        time.sleep(0.3)

    def keys(self, key, *, shift=False):
        shifted = "true" if shift else "false"
        self.do(
            "document.getElementById('hl-app').dispatchEvent(new KeyboardEvent('keydown', "
            f"{{key: {json.dumps(key)}, shiftKey: {shifted}, bubbles: true, cancelable: true}}))"
        )

    def errors(self):
        """What the console says that is no message or hint of speed."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]

    def pixels(self, element):
        """Pixels of an element as it is seen, shape (height, width, 3)."""
        from PIL import Image

        content = self.driver.find_element("id", element).screenshot_as_png
        return np.asarray(Image.open(io.BytesIO(content)).convert("RGB")).astype(int)


def new_driver(profile, *more):
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in (*FLAGS, f"--user-data-dir={profile}", *more):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(service=Service(DRIVER), options=options)
    driver.set_script_timeout(90)
    return driver


@pytest.fixture(scope="module")
def driver(tmp_path_factory):
    pytest.importorskip("selenium", reason="selenium is not installed")
    made = new_driver(tmp_path_factory.mktemp("profile"))
    yield made
    made.quit()


@pytest.fixture(scope="module")
def lift(tmp_path_factory):
    return lift_motion(tmp_path_factory.mktemp("lift") / "lift")


@pytest.fixture(scope="module")
def file(lift, tmp_path_factory):
    """A page with two phases and an event at their border."""
    case, results, motion = lift
    content = made_content(
        case, motion, results, phases=[("hoist", 0.0, 5.0), ("hold", 5.0, 8.0)], events=[(5.0, "hold begins")]
    )
    path = tmp_path_factory.mktemp("page") / "lift.html"
    path.write_text(page_html(content), encoding="utf-8")
    return path


@pytest.fixture
def page(driver, file):
    return Page(driver).open(file.as_uri())


def module_at(time):
    """Where the module is by the formula that made its records."""
    return [0.0, 0.0, 2.0 + 0.5 * time]


def test_it_loads_without_errors_and_asks_for_nothing(page):
    assert page.errors() == []
    loaded = page("performance.getEntriesByType('resource').map(entry => entry.name)")
    assert [name for name in loaded if not name.startswith(("data:", "blob:"))] == []


def test_pixels_are_those_of_vtk_from_the_same_place(page, lift):
    """What the page covers is what VTK covers with the same surfaces, camera and size; ropes are thinner than that."""
    page.do("heavylift.seek(2.0)")
    for group in ("ropes", "rods", "joints", "water"):
        page.do(
            f"document.querySelectorAll('#hl-objects [aria-label=\"show {group}\"]')"
            ".forEach(box => { if (box.checked) box.click(); })"
        )
    page.settle()
    seen = page("heavylift.camera()")
    height, width = page.pixels("hl-canvas").shape[:2]
    shown = page.pixels("hl-canvas")
    position, target, up = np.array(seen["array"]).reshape(3, 3)
    camera = Camera(
        View.looking(position - target, up), position, np.radians(0.5 * seen["fov"]), seen["aspect"]
    )
    from heavylift.pipeline.drawn.moments import Moment

    _, _, motion = lift
    patches = tuple(
        Patch(Moment(motion, 2.0).surface(one), one.triangles)
        for one in motion.surfaces
        if one.group == "bodies"
    )
    try:
        with Renderer() as renderer:
            nothing = np.empty((0, 3), dtype=np.int64)
            drawing = Drawing(patches[0].points, nothing, patches=patches)
            expected = renderer.render(drawing, camera, (width, height)).astype(int)
    except RenderingUnavailableError as error:
        pytest.skip(str(error))
    one, other = (np.any(pixels < 250, axis=2) for pixels in (shown, expected))
    # corners with the legend and the axes belong to the page alone
    for mask in (one, other):
        mask[: height // 3, -240:] = False
        mask[-120:, -120:] = False
    assert other.sum() > 0.02 * other.size
    assert np.sum(one & other) / np.sum(one | other) > 0.95


def test_what_is_not_seen_is_not_there(page):
    """The library would bring hundreds of labels of a hidden grid, which it places at every frame."""
    assert page("document.querySelectorAll('#hl-canvas *').length") < 20


def test_ropes_that_are_thinner_than_a_pixel_have_no_gaps(driver, tmp_path):
    """A hoist of 400 m: each row of pixels between its ends is covered."""
    arrays = lifted()
    arrays["hook.position"][:, 2] -= 400.0
    arrays["module.position"][:, 2] -= 400.0
    case, results, motion = lift_motion(tmp_path / "lift", arrays)
    file = tmp_path / "thin.html"
    file.write_text(page_html(made_content(case, motion, results)), encoding="utf-8")
    page = Page(driver).open(file.as_uri())
    page.do("heavylift.isolate('hoist'); heavylift.view('+x')")
    page.settle()
    rows = np.flatnonzero(np.any(page.pixels("hl-canvas")[:, 200:600] < 230, axis=(1, 2)))
    assert len(rows) > 200
    assert np.all(np.diff(rows) == 1)


def test_marks_are_at_their_places_whether_or_not_names_have_room(driver, tmp_path):
    """Of a scene before its run: each label has a dot where its point is projected, also among many at one place."""
    case, stages = lift_case(tmp_path / "lift")
    motion = case_scene(case, stages, assemble_scene(case, stages), None, marked=True)
    file = tmp_path / "draw.html"
    file.write_text(page_html(page_content(case, motion, None, labelled=True)), encoding="utf-8")
    page = Page(driver).open(file.as_uri())
    page.settle()
    seen = page("heavylift.camera()")
    position, target, up = np.array(seen["array"]).reshape(3, 3)
    ahead = (target - position) / np.linalg.norm(target - position)
    right = np.cross(ahead, up) / np.linalg.norm(np.cross(ahead, up))
    tangent = np.tan(np.radians(0.5 * seen["fov"]))
    pixels = np.array(
        page(
            "(c => Array.from(c.getContext('2d').getImageData(0, 0, c.width, c.height).data))"
            "(document.getElementById('hl-overlay'))"
        )
    )
    width, height = page("(c => [c.width, c.height])(document.getElementById('hl-overlay'))")
    pixels = pixels.reshape(height, width, 4)
    found = 0
    for label in page("heavylift.header().labels"):
        point = np.array(label["point"])
        if label["body"] >= 0:
            name = page(f"heavylift.header().bodies[{label['body']}].name")
            point = np.array(page(f"heavylift.position({json.dumps(name)}, {label['point']})"))
        d = point - position
        depth = d @ ahead
        x = (1 + d @ right / (depth * tangent * seen["aspect"])) / 2 * width
        y = (1 - d @ np.cross(right, ahead) / (depth * tangent)) / 2 * height
        if 2 < x < width - 2 and 2 < y < height - 2:
            found += 1
            red, _, _, covered = pixels[round(y), round(x)]
            assert red < 60, label["text"]  # that of a dot,
            assert covered > 200, label["text"]  # not of air
    assert found > 5


def test_a_view_is_of_what_is_isolated(page):
    page.do("heavylift.seek(4.0); heavylift.isolate('module'); heavylift.view('+x')")
    np.testing.assert_allclose(page("heavylift.camera().array")[3:6], module_at(4.0), atol=0.05)
    page.do("heavylift.isolate(null); heavylift.view('+x')")
    assert page("heavylift.camera().array")[5] > 4.0 + module_at(4.0)[2]


def test_play_moves_bodies_to_where_the_records_say(page):
    page.do("heavylift.speed(2)")
    page.keys(" ")
    page.wait("heavylift.clock.now > 1.0")
    page.keys(" ")
    assert page("heavylift.clock.playing") is False
    now = page("heavylift.clock.now")
    assert now > 1.0
    np.testing.assert_allclose(page("heavylift.position('module')"), module_at(now), atol=1e-5)
    angle = 0.1 * now
    np.testing.assert_allclose(
        page("heavylift.position('module', [1, 0, 0])"),
        np.add(module_at(now), [np.cos(angle), np.sin(angle), 0.0]),
        atol=1e-5,
    )


def test_a_tone_is_heard_where_the_sound_is_on(driver, lift, tmp_path):
    """As playback passes its time, once; never without the button, which a page without tones does not show."""
    case, results, motion = lift
    file = tmp_path / "heard.html"
    for tones, hidden in (((), True), (((0.0, 440.0), (0.5, 600.0), (7.9, 300.0)), False)):
        file.write_text(page_html(made_content(case, motion, results, tones=tones)), encoding="utf-8")
        page = Page(driver).open(file.as_uri())
        assert page("document.getElementById('hl-sound').hidden") is hidden
    page.do(
        "window.heard = []; const make = AudioContext.prototype.createOscillator;"
        "AudioContext.prototype.createOscillator = function () {"
        " const made = make.call(this); const start = made.start.bind(made);"
        " made.start = (when) => { window.heard.push(made.frequency.value); start(when); }; return made; }"
    )
    for sound, heard in ((False, []), (True, [440.0, 600.0])):
        page.do("heavylift.seek(0)")
        if sound:
            page.do("document.getElementById('hl-sound').click()")
        page.do("heavylift.speed(2)")
        page.keys(" ")
        page.wait("heavylift.clock.now > 1.0")
        page.keys(" ")
        assert page("window.heard") == heard
    page.do("heavylift.seek(0)")  # not played
    page.do("heavylift.seek(2)")
    page.do("document.getElementById('hl-sound').click()")
    assert page("window.heard") == [440.0, 600.0]
    assert page.errors() == []


def test_ropes_end_at_their_lugs_between_records(page):
    page.do("heavylift.seek(4.04)")
    (points,) = page("heavylift.points('sling_1')")
    angle, height = 0.404, 2.0 + 0.5 * 4.04
    lug = [5 * np.cos(angle) - 3 * np.sin(angle), 5 * np.sin(angle) + 3 * np.cos(angle), height + 2.0]
    np.testing.assert_allclose(points, [0.0, 0.0, height + 12.0, *lug], atol=1e-4)


def test_a_check_leads_to_its_instant_and_place(page):
    before = page("heavylift.camera().array")
    page.driver.find_element("css selector", "[data-check=height]").click()
    assert page("heavylift.clock.now") == pytest.approx(3.0)
    after = np.array(page("heavylift.camera().array"))
    assert not np.allclose(before, after)
    np.testing.assert_allclose(after[3:6], module_at(3.0), atol=0.5)
    assert page("heavylift.plots.some(plot => plot.series.some(one => one.label === 'module.position.z'))")


def test_keys(page):
    """Time, events, views, section, labels, deformation of nothing: each key does what its list says."""
    page.keys("End")
    assert page("heavylift.clock.now") == pytest.approx(8.0)
    page.keys("Home")
    assert page("heavylift.clock.now") == 0.0
    page.keys("ArrowRight")
    assert page("heavylift.clock.now") == pytest.approx(0.1)
    page.keys("ArrowRight", shift=True)
    assert page("heavylift.clock.now") == pytest.approx(1.1)
    page.keys("]")
    assert page("heavylift.clock.now") == pytest.approx(5.0)
    assert page("document.getElementById('hl-phase').textContent") in {"hoist", "hold", ""}
    page.keys("[")
    assert page("heavylift.clock.now") == pytest.approx(5.0)  # there is none before
    page.keys("+")
    assert page("heavylift.clock.speed") == 2
    page.keys("3")
    camera = np.array(page("heavylift.camera().array")).reshape(3, 3)
    assert (camera[0] - camera[1])[0] > 10.0 * abs((camera[0] - camera[1])[1])
    page.keys("x")
    assert page("heavylift.options.section") == "x"
    page.keys("x")
    assert page("heavylift.options.section") == ""
    page.keys("l")
    assert page("heavylift.options.labels") is True
    page.keys("?")
    assert page("document.getElementById('hl-help').hidden") is False


def test_a_section_takes_half_of_the_picture_away(page):
    def covered():
        page.settle()
        return int(np.any(page.pixels("hl-canvas") < 250, axis=2).sum())

    whole = covered()
    page.do("heavylift.section('z', 0.0)")
    assert covered() < 0.7 * whole
    page.do("heavylift.section('')")
    assert covered() == pytest.approx(whole, rel=0.02)


def test_hide_and_isolate(page):
    page.do("heavylift.isolate('module')")
    assert page("heavylift.visible('module')") is True
    assert page("heavylift.visible('hoist')") is False
    page.keys("Escape")
    assert page("heavylift.visible('hoist')") is True


def test_followed_body_stays_where_it_is_seen(page):
    page.do("heavylift.follow(0)")
    page.settle()
    first = np.array(page("heavylift.camera().array"))
    page.do("heavylift.seek(6.0)")
    page.settle()
    moved = np.array(page("heavylift.camera().array"))
    np.testing.assert_allclose(moved[:3] - first[:3], [0.0, 0.0, 3.0], atol=1e-3)


def test_a_measured_distance_is_followed_in_time(page):
    """Two points that are clicked on the top of the module are as far apart later, and turned."""
    page.do("heavylift.view('+z'); heavylift.isolate('module'); heavylift.measure(true)")
    page.settle()
    from selenium.webdriver import ActionChains

    canvas = page.driver.find_element("css selector", "#hl-canvas canvas")
    for offset in (-30, 30):
        ActionChains(page.driver).move_to_element_with_offset(canvas, offset, 5).click().perform()
    page.settle()
    a, b = np.array(page("heavylift.picks()"))
    assert np.linalg.norm(b - a) > 0.3
    page.do("heavylift.seek(8.0)")
    page.settle()
    c, d = np.array(page("heavylift.picks()"))
    angle, (x, y, _) = 0.8, b - a
    turned = [x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle), 0.0]
    np.testing.assert_allclose(d - c, turned, atol=1e-3)
    words = page("document.getElementById('hl-measured').textContent")
    assert float(re.search(r"Distance ([\d.]+) m", words)[1]) == pytest.approx(
        np.linalg.norm(b - a), rel=1e-3
    )


def test_plots_have_curves_and_their_numbers(page, lift):
    """Pixels of the first colour, and rows of the csv that are the records in the range."""
    _, results, _ = lift
    page.do("heavylift.plots.slice().forEach(plot => plot.remove()); heavylift.plot('hoist.tension')")
    page.do("heavylift.zoom(2.0, 4.0)")
    page.settle()
    curve = np.array([0x1F, 0x5F, 0xA8])
    shown = np.array(
        page(
            "(c => Array.from(c.getContext('2d').getImageData(0, 0, c.width, c.height).data))"
            "(heavylift.plots[0].canvas)"
        )
    ).reshape(-1, 4)[:, :3]
    colours = int(np.all(np.abs(shown - curve) < 9, axis=1).sum())
    assert colours > 100
    rows = [line.split(",") for line in page("heavylift.table(0)").split("\r\n")[1:] if line]
    assert [row[0] for row in rows][:3] == ["2", "2.1", "2.2"]  # as the records have them
    assert max(len(row[1]) for row in rows) <= 10  # nine digits are all that single precision has
    found = np.array(rows, dtype=float)
    chosen = (results.time > 1.99) & (results.time < 4.01)
    np.testing.assert_allclose(found[:, 0], results.time[chosen], rtol=1e-6)
    np.testing.assert_allclose(found[:, 1], results["hoist.tension"][chosen], rtol=1e-6)
    page.do("heavylift.plots[0].csv(); heavylift.plots[0].png()")
    page.wait("heavylift.saved.length === 2")
    assert page("heavylift.saved.every(one => one.size > 100)")


def test_channels_are_found_by_parts_of_their_names(page):
    page.do(
        "(box => { box.value = 'Posi mod'; box.dispatchEvent(new Event('input')); })"
        "(document.getElementById('hl-filter'))"
    )
    shown = page(
        "[...document.querySelectorAll('#hl-channels [data-series]')].map(button => button.dataset.series)"
    )
    assert shown == [f"module.position.{axis}" for axis in "xyz"]


def test_to_the_largest_value(page, lift):
    _, results, _ = lift
    page.do(
        "heavylift.plots.slice().forEach(plot => plot.remove()); heavylift.plot('hoist.tension').extreme('max')"
    )
    assert page("heavylift.clock.now") == pytest.approx(results.time[results["hoist.tension"].argmax()])
    # of several curves the largest of all, or of the one that is chosen
    page.do("heavylift.plot('module.position', 0); heavylift.plot('module.position', 2)")
    position = "heavylift.plots.find(plot => plot.series[0].label === 'module.position.x')"
    page.do(f"{position}.extreme('max')")
    assert page("heavylift.clock.now") == pytest.approx(8.0)
    page.settle()
    page.do(
        f"{position}.legend.querySelector('[data-label=\"module.position.x\"]')"
        ".dispatchEvent(new Event('pointerdown', {bubbles: true}))"
    )
    page.do(f"{position}.extreme('max')")
    assert page("heavylift.clock.now") == 0.0


def test_bad_input_is_told_and_the_rest_works(driver, tmp_path):
    """A body that leaves, a channel without data, one that has infinite numbers, names with scripts."""
    arrays = lifted()
    arrays["hook.position"][40:] = 1e30
    arrays["empty.force"] = np.full(81, np.nan)
    arrays["huge.force"] = np.full(81, 1e300)
    case, _, motion = lift_motion(tmp_path / "lift", arrays)
    evil = '<script>window.hurt = 1</script><img src=x onerror="window.hurt = 1">'
    arrays[f"{evil}.force"] = np.ones(81)
    case = case.model_copy(update={"title": evil})
    content = made_content(case, motion, made_results(arrays), notes=[evil], events=[(1.0, evil)])
    file = tmp_path / "bad.html"
    file.write_text(page_html(content), encoding="utf-8")
    page = Page(driver).open(file.as_uri())
    page.do("heavylift.plot('empty.force'); heavylift.plot('huge.force'); heavylift.seek(5.0)")
    page.do("document.querySelectorAll('#hl-channels details').forEach(box => { box.open = true; })")
    page.settle()
    assert page.errors() == []
    assert page("window.hurt === undefined")
    assert page("document.querySelectorAll('#hl img').length") == 0
    assert page("document.getElementById('hl-title').textContent") == evil
    assert page("heavylift.there('hook')") is False
    assert page("heavylift.there('module')") is True
    np.testing.assert_allclose(page("heavylift.position('module')"), module_at(5.0), atol=1e-5)
    assert "hook has left" in page("document.getElementById('hl-notes').textContent")
    assert (
        page("heavylift.plots.find(plot => plot.series[0].label === 'empty.force').series[0].extreme('max')")
        is None
    )


def test_a_run_that_was_cut_short_is_shown_as_far_as_it_got(driver, tmp_path):
    """One record: a scene and numbers, and no slider."""
    times = np.array([0.0])
    arrays = {name: values[:1] for name, values in lifted().items()}
    case, results, motion = lift_motion(tmp_path / "lift", arrays, times)
    file = tmp_path / "short.html"
    file.write_text(page_html(made_content(case, motion, results)), encoding="utf-8")
    page = Page(driver).open(file.as_uri())
    page.keys(" ")
    assert page("heavylift.clock.playing") is False
    assert page("document.getElementById('hl-player').hidden") is True
    np.testing.assert_allclose(page("heavylift.position('module')"), module_at(0.0), atol=1e-6)
    assert page.errors() == []


def test_a_page_without_webgl_has_plots(file, tmp_path):
    made = new_driver(tmp_path / "profile", "--disable-3d-apis")
    try:
        page = Page(made).open(file.as_uri())
        assert "No scene in three dimensions" in page("document.getElementById('hl-notes').textContent")
        assert page("heavylift.plots.length") > 0
        page.keys("End")
        assert page("heavylift.clock.now") == pytest.approx(8.0)
    finally:
        made.quit()


@pytest.mark.parametrize(
    "name",
    [
        "hoist",
        "pulleys",
        "three_links_open",
        "flexible_pendulum",
        "spmt_bump",
        "ball_on_beam",
        "hanging_plate",
        "barge_decay",
        "staged_lift",
        "tumbling_beam",
        "thin_plate_lift",
    ],
)
def test_cases_are_shown_as_they_ran(driver, name, tmp_path):
    """Every body is where its records say, at four of them; something is drawn; nothing is wrong."""
    case = load_case(CASES / name)
    run_case(case, out=tmp_path)
    results = load_results(case, tmp_path)
    page = Page(driver).open((tmp_path / "report" / "report.html").as_uri())
    scale = max(1.0, *(float(np.abs(results[n]).max()) for n in results if n.endswith(".position")))
    for record in np.linspace(0, len(results.time) - 1, 4).round().astype(int):
        page.do(f"heavylift.seek({float(results.time[record])!r})")
        for body in page("heavylift.header().bodies.map(body => body.name)"):
            np.testing.assert_allclose(
                page(f"heavylift.position({json.dumps(body)})"),
                results[f"{body}.position"][record],
                atol=2e-6 * scale,
            )
    page.settle()
    pixels = page.pixels("hl-canvas")[:, :-240]
    assert np.any(pixels < 235, axis=2).sum() > 300
    assert page("heavylift.plots.length") > 0
    assert page("heavylift.header().checks.length") == len(case.check) + len(
        page("heavylift.header().checks.filter(row => row.name.includes(': '))")
    )
    assert page.errors() == []


def test_a_run_is_watched_and_stopped(driver, tmp_path):
    """A run of a day: records come while it goes on, the button stops it, and only this page may do that."""
    command = [
        sys.executable, "-c", "from heavylift.pipeline.commands.start import main; main()",
        "view", str(CASES / "barge_decay"), "--out", str(tmp_path), "--set", 'simulate.duration="90000 s"',
    ]  # fmt: skip
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as run:
        try:
            lines = []
            address = None
            while address is None:
                lines.append(run.stdout.readline())
                assert lines[-1], "".join(lines)
                address = re.search(r"http://127\.0\.0\.1:\d+/", lines[-1])
            page = Page(driver).open(address[0])
            page.wait("heavylift.clock.end > 0", 240)
            first = page("heavylift.clock.end")
            page.do("document.querySelector('#hl-objects [aria-label=\"show heaving\"]').click()")
            page.do("document.querySelector('#hl-channels [data-of=rolling]').open = true")
            page.wait(f"heavylift.clock.end > {first}", 120)
            assert page("heavylift.visible('heaving')") is False  # what was chosen stays as it is
            assert page("heavylift.visible('rolling')") is True
            assert page("document.querySelector('#hl-channels [data-of=rolling]').open") is True
            assert page("heavylift.header().channels.length") > 20
            page.driver.find_element("id", "hl-stop").click()
            page.wait("document.getElementById('hl-progress').textContent.startsWith('ended')", 120)
            page.wait("document.getElementById('hl-verdict').textContent.startsWith('Stopped')", 60)
            assert page("heavylift.clock.end") < 90000
            assert page.errors() == []
        finally:
            run.send_signal(signal.SIGINT)
            run.wait(120)
    assert run.returncode == 5


def test_the_server_answers_its_own_page_alone(tmp_path):
    """Not by another name of this machine, and no stop without the word that the page has."""
    case = load_case(CASES / "hoist")
    live = LiveRun(case, OutputFolder(tmp_path), None)
    server = serve(live)
    host, port = server.server_address[:2]
    assert host == "127.0.0.1"

    def asked(method, path, **headers):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
        connection.request(method, path, headers=headers)
        answer = connection.getresponse()
        answer.read()
        connection.close()
        return answer.status

    try:
        assert asked("GET", "/progress") == 200
        assert asked("GET", "/progress", Host=f"evil.example:{port}") == 403
        assert asked("GET", "/elsewhere") == 404
        assert asked("POST", "/stop") == 403
        assert asked("POST", "/stop", **{"X-Heavylift": "guess"}) == 403
        assert asked("POST", "/stop", **{"X-Heavylift": live.token}) == 200
    finally:
        server.shutdown()
        server.server_close()


def test_a_run_in_a_cell_of_a_notebook_is_drawn_by_itself(page, tmp_path):
    """In a frame without a way to the notebook around it."""
    run = hl.load(CASES / "hoist").run()
    cell = tmp_path / "cell.html"
    cell.write_text(
        f"<!DOCTYPE html><title>notebook</title><body>{run._repr_html_()}</body>", encoding="utf-8"
    )
    page.driver.get("about:blank")
    page.errors()  # of what the page before asks a server that is gone
    page.driver.get(cell.as_uri())
    page.driver.switch_to.frame(0)
    page.wait("window.heavylift && (heavylift.state.ready || heavylift.state.error !== '')")
    assert page("heavylift.state.error") == ""
    assert page("document.title") == run.case.title
    assert page("window.origin") == "null"  # nothing of the notebook is within its reach
    page.do("heavylift.seek(20.0)")
    page.settle()
    assert page("heavylift.clock.now") == 20.0
    assert page.errors() == []
