#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""The report of a run: pages made of synthetic flights, opened in headless Chromium, asked what they
show. Skipped where there is no plotly.js or no Chromium (scripts/test.sh installs both)."""

import base64
import json
import math
import os
import re
import struct
import subprocess
import zlib

from app_test_util import AppTest, main, strict_json
from browser_util import CHROMIUM, Browser

# 32 x 20, grey.
JPEG = ("/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABQODxIPDRQSEBIXFRQYHjIhHhwcHj0sLiQySUBMS0dARkVQWnNiUFVtVkVGZIhlbXd7gYKBTmCNl4"
        "x9lnN+gXz/wAALCAAUACABAREA/8QAFgABAQEAAAAAAAAAAAAAAAAABAYF/8QAFxAAAwEAAAAAAAAAAAAAAAAAAAIDAf/aAAgBAQAAPwDMko2S"
        "jZKNkpPyUZJRslGyUnpYNlg2WDJYf//Z")
FRAMES, LANDMARKS, BEGIN = 200, 300, 1.0


def helix():
    """A flight with everything: FRAMES states 0.1 s apart at 1 m/s about a circle of 2 m, climbing."""
    times = [BEGIN + 0.1 * k for k in range(FRAMES)]
    turn = [0.4 * (t - BEGIN) for t in times]
    place = [[2 * math.cos(a), 2 * math.sin(a), 0.5 * a] for a in turn]
    # In x one in ten errors is beyond 3 sigma, in y none, in z all.
    true = [[p[0] - (0.05 if k % 10 == 0 else 0.02), p[1] - 0.01, p[2] + 0.2] for k, p in enumerate(place)]
    same = lambda *row: [list(row) for _ in times]
    return {
        "title": "A helix </script><script>throw 1</script> & more", "origin": "/data/helix", "app_version": "vio_run 9.8.7\nand more",
        "figures": {"frames": 210, "ate_m": 0.03125, "ate_yaw_deg": 0.51, "rpe_1s_m": 0.0123, "rpe_percent": 1.25,
                    "scale_error_percent": -0.75, "alignment": "yaw", "rpe_length_m": 10.0, "path_m": 21.5,
                    "median_ms": 5.5, "p99_ms": 17.25, "initialized_at_s": BEGIN, "duration_s": 20.9, "frames_dropped": 4,
                    "first_refusal": "", "events": {"keyframe": 39, "standing_still": 5}, "steps": [1, 2]},
        "camera_period_ms": 12.0,
        "states": {"t": times, "p": place, "q": [[0, 0, math.sin(a / 2), math.cos(a / 2)] for a in turn],
                   "v": [[-0.8 * math.sin(a), 0.8 * math.cos(a), 0.2] for a in turn],
                   "ba": same(0.1, 0.0, -0.1), "bg": same(0.01, 0.02, 0.03), "sigma_p": same(0.01, 0.01, 0.01),
                   "sigma_v": same(0.02, 0.02, 0.02), "sigma_ba": same(0.02, 0.02, 0.02), "sigma_bg": same(1e-3, 1e-3, 1e-3)},
        "truth": {"t": times, "p": true},
        "landmarks": [[4 * math.cos(k), 4 * math.sin(k), 0.01 * k, 3 + k % 20] for k in range(LANDMARKS)],
        "stages": {"t": times, "names": ["track", "solve"], "ms": [[4.0] * FRAMES, [1.5] * (FRAMES - 2) + [9.5, 9.5]]},
        "features": {"t": times, "count": [100 + k % 7 for k in range(FRAMES)], "age": [5.5] * FRAMES, "landmarks": [80] * FRAMES},
        "events": [{"t": BEGIN, "what": "initialized", "count": 1}, {"t": 7.0, "what": "imu_gap", "count": 2},
                   *({"t": t, "what": "keyframe", "count": 1} for t in times[::5])],
        "event_counts": {"initialized": 1, "imu_gap": 2, "keyframe": 40, "reset": 0},
        "thumbnails": [{"t": 1.0 + k, "width": 32, "height": 20, "scale": 0.05, "jpeg": JPEG,
                        "tracks": [[1, [10, 20]], [9, [100, 50, 110, 60, 120, 75.5]]]} for k in range(3)],
    }


def without_truth_and_images():
    data = helix()
    del data["truth"], data["thumbnails"]
    for key in ("ate_m", "ate_yaw_deg", "rpe_1s_m", "rpe_percent", "scale_error_percent", "path_m"):
        data["figures"][key] = None
    for k in range(50, 60):  # sigmas that are not known
        data["states"]["sigma_p"][k] = ["NaN", None, 0.01]
    return data


def without_imu():
    data = helix()
    for key in ("v", "ba", "bg", "sigma_v", "sigma_ba", "sigma_bg"):
        del data["states"][key]
    data["landmarks"] = [row[:3] for row in data["landmarks"]]
    data["stages"]["total"] = [6.5] * FRAMES
    data["sigma_meaning"] = "seen from the oldest frame"
    data["states"]["error_p"] = [[0.001, 0.05, 0.002]] * FRAMES
    return data


def never_initialized():
    data = helix()
    data["states"] = {key: [] for key in data["states"]}
    data["figures"] = {"frames": 210, "initialized_at_s": None, "first_refusal": "the body <i>rests</i>"}
    data["events"] = data["events"][1:2]
    data["landmarks"], data["truth"] = [], {"t": [], "p": []}
    return data


# What no app would write.
NONSENSE = {
    "title": 7, "figures": [], "camera_period_ms": "fast",
    "states": {"t": [0, None, "x", 1, 2], "p": [[1, 2], None, 3, [1, 2, 3]], "q": {}},
    "truth": {"t": [1], "p": None}, "landmarks": [None, [1], ["a", 2, 3], [1, 2, 3]],
    "stages": {"t": [1], "names": ["a", "b"], "ms": [[None]]},
    "features": [], "events": [None, {"t": "x"}, {"t": 1}], "event_counts": {"a": None},
    "thumbnails": [None, {}, {"jpeg": "AAAA", "width": -1, "tracks": [None, [1], [1, [1]], [None, [1, 2, 3, 4]], [2, [None, 2]]]}],
}

def traces(dom, plot):
    return json.loads(dom.attributes[f"plot-{plot}"]["data-traces"])


def read_png(data):
    """Rows of bytes, bytes a pixel; of what Chromium writes (8 bits, no interlace)."""
    chunks, at = {}, 8
    while at < len(data):
        (size,), kind = struct.unpack(">I", data[at:at + 4]), data[at + 4:at + 8]
        chunks[kind] = chunks.get(kind, b"") + data[at + 8:at + 8 + size]
        at += 12 + size
    width, height, depth, colour = struct.unpack(">IIBB", chunks[b"IHDR"][:10])
    assert depth == 8 and colour in (2, 6), (depth, colour)
    step = 3 if colour == 2 else 4
    raw, rows, above = zlib.decompress(chunks[b"IDAT"]), [], bytearray(width * step)
    for y in range(height):
        begin = y * (width * step + 1)
        kind, row = raw[begin], bytearray(raw[begin + 1:begin + 1 + width * step])
        for i in range(len(row)):
            a, c = (row[i - step], above[i - step]) if i >= step else (0, 0)
            b = above[i]
            if kind == 1:
                row[i] = (row[i] + a) & 255
            elif kind == 2:
                row[i] = (row[i] + b) & 255
            elif kind == 3:
                row[i] = (row[i] + (a + b) // 2) & 255
            elif kind == 4:
                pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
                row[i] = (row[i] + (a if pa <= pb and pa <= pc else b if pb <= pc else c)) & 255
        rows.append(row)
        above = row
    return rows, step


class ReportPageTest(AppTest):
    app = "write_report_page"
    browser = None

    def need_plotly(self):
        if not (self.folder_of_executables / "../share/glissade/plotly.min.js").exists():
            self.skipTest("no plotly.js where this was configured (scripts/test.sh fetches one)")

    def write_page(self, data, name="page.html"):
        self.run_ok(self.write("data.json", json.dumps(data)), self.folder / name)
        return (self.folder / name).read_text(encoding="utf-8")

    # ---- What is written ---------------------------------------------------------------------------

    def test_base64(self):
        for size in (*range(8), 1000):
            data = bytes((7 * k * k + 255 * size) % 256 for k in range(size))
            path = self.folder / "bytes"
            path.write_bytes(data)
            self.assertEqual(self.run_ok("--base64", path).strip(), base64.b64encode(data).decode())

    def test_where_plotly_is_missing(self):
        data = self.write("data.json", "{}")
        page = self.write("page.html", "an old page")
        no_plotly = self.write("other.js", "alert(1)")
        for file, says in ((self.folder / "none.js", "cannot be read"), (no_plotly, "no plotly.js")):
            result = subprocess.run([self.folder_of_executables / self.app, data, page], capture_output=True, text=True,
                                    env={**os.environ, "GLISSADE_PLOTLY_JS": str(file)}, check=False)
            self.assertEqual(result.returncode, 1)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertIn(f"{file}: {says}", result.stderr)
            self.assertIn("pip install plotly", result.stderr)
            self.assertEqual(page.read_text(encoding="utf-8"), "an old page")
        self.assertEqual(self.files(), ["data.json", "other.js", "page.html"])

    def test_files_that_cannot_be_written(self):
        self.need_plotly()
        result = self.run_app(self.write("data.json", "{}"), self.folder / "none" / "page.html")
        self.assertEqual(result.returncode, 1)
        self.assertIn("page.html: cannot be written", result.stderr)
        result = self.run_app(self.write("data.json", "[]"), self.folder / "page.html")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no object", result.stderr)
        self.assertEqual(self.files(), ["data.json"])

    def test_data_stay_data(self):
        self.need_plotly()
        data = {"title": "</script><!-- <script> \u2028 \u00fc \"'\\",
                "states": {"t": [1403638538.577829376], "p": [[1 / 3, 1e-9 / 3, "NaN"]]}}
        page = self.write_page(data)
        inside = re.search(r'<script type="application/json" id="data">\n(.*?)\n</script>', page, re.DOTALL).group(1)
        self.assertNotIn("<", inside)
        read = strict_json(inside)
        self.assertEqual(read["title"], data["title"])
        self.assertEqual(read["states"]["t"], data["states"]["t"])
        self.assertEqual(read["states"]["p"], [[0.3333333, 3.333333e-10, None]])

    def test_asks_nothing_of_the_network(self):
        self.need_plotly()
        page = self.write_page(helix())
        self.assertIn("default-src 'none'", page)
        own = re.sub(r"<script>.*?</script>", "", page, flags=re.DOTALL)
        self.assertEqual(re.findall(r"<(?:link|iframe|object|embed)\b|(?:src|href)=", own), [])
        self.assertIn("MIT License", own)
        self.assertIn("Plotly Technologies Inc.", own)
        self.assertNotRegex(page, r"@(STYLE|PLOTLY|SCRIPT|DATA)@")

    # ---- What the browser makes of it ---------------------------------------------------------------

    def page(self, data, webgl=True):
        """What the browser has made of the page."""
        self.need_plotly()
        if CHROMIUM is None:
            self.skipTest("no Chromium here (scripts/test.sh installs one)")
        if self.browser is None:
            type(self).browser = Browser(1000, 760)
            self.addClassCleanup(self.browser.close)
        self.write_page(data)
        self.browser.open(self.folder / "page.html", "document.documentElement?.dataset.state === 'done'", webgl)
        dom = self.browser.dom()
        self.assertEqual(dom.attributes["html"]["data-errors"], "0", dom.text("errors"))
        self.assertEqual(self.browser.complaints(), [])
        return dom

    def test_everything(self):
        dom = self.page(helix())
        self.assertEqual(dom.text("title"), helix()["title"])
        self.assertEqual(dom.text("origin"), "/data/helix")
        self.assertEqual(dom.text("app-version"), "Written by vio_run 9.8.7.")
        for words in ("ATE0.0313 mRMS, yaw aligned", "RPE1.25 %of the way, over 10.0 m", "RPE over 1 s0.0123 m", "Scale error-0.750 %",
                      "Yaw error0.510 °", "Initialized after1.00 s", "Time per frame5.50 msp99 5.58 ms", "Frames2104 dropped",
                      "Duration20.9 s", "Path length21.5 m"):
            self.assertIn(words, dom.text("figures"))
        self.assertIn("events.keyframe39", dom.text("more-figures"))
        self.assertNotIn("steps", dom.text("more-figures"))
        self.assertIn("hidden", dom.attributes["notice"])
        way = traces(dom, "way")
        self.assertEqual({key: way[key] for key in ("landmarks", "truth", "estimate", "start", "end")},
                         {"landmarks": LANDMARKS, "truth": FRAMES, "estimate": FRAMES, "start": 1, "end": 1})
        self.assertGreater(way["3 sigma"], 20 * 60)
        self.assertEqual(traces(dom, "position"), {"3 sigma": 3 * 2 * FRAMES, "estimate minus truth": 3 * FRAMES})
        self.assertEqual(dom.text("heading-position"), "Error of the position")
        self.assertIn("Inside the band: x 90.0 %, y 100 %, z 0.0 % of the frames", dom.text("caption-position"))
        self.assertEqual(traces(dom, "speed"), {"3 sigma": 2 * FRAMES, "estimate": FRAMES})
        self.assertEqual(traces(dom, "attitude"), {"roll": FRAMES, "pitch": FRAMES, "yaw": FRAMES})
        for bias in ("gyro-bias", "accel-bias"):
            self.assertEqual(traces(dom, bias), {"3 sigma": 3 * 2 * FRAMES, "estimate": 3 * FRAMES})
        self.assertEqual(traces(dom, "stages"), {"track": FRAMES, "solve": FRAMES, "camera's period, 12.0 ms": 2})
        self.assertIn("2 frames took longer than the camera's period of 12.0 ms", dom.text("caption-stages"))
        self.assertEqual(dom.text("table-stages"), "msmedianp99maxtrack4.004.004.00solve1.501.589.50whole frame5.505.5813.50")
        self.assertEqual(traces(dom, "features"), {"features in the image": FRAMES, "landmarks in the window": FRAMES,
                                                  "median age of the tracks": FRAMES})
        self.assertEqual(traces(dom, "events"), {"initialized": 1, "keyframe": 40, "imu gap": 1})
        self.assertEqual(dom.text("table-events"), "eventcountimu gap2keyframe40standing still5initialized1")
        # What is drawn, not only meant: bars, lines and marks of SVG.
        self.assertEqual(dom.count("plot-stages", "g.point"), 2 * FRAMES)
        self.assertEqual(dom.count("plot-position", "path.js-line"), 6 + 2)  # 2 in the legend
        self.assertEqual(dom.count("plot-events", "path.point"), 42)
        for plot in ("position", "speed", "attitude", "gyro-bias", "accel-bias", "stages", "features", "events"):
            self.assertIn("time [s]", dom.text(f"plot-{plot}"))
        self.assertIn("error in z [m]", dom.text("plot-position"))
        self.assertIn("y [rad/s]", dom.text("plot-gyro-bias"))
        self.assertIn("x [m/s²]", dom.text("plot-accel-bias"))
        # Tracks over images.
        self.assertEqual(dom.count("thumbnails", "img"), 3)
        self.assertEqual(dom.count("thumbnails", "polyline"), 6)
        self.assertEqual(dom.text("thumbnails"), "1.00 s, 2 tracks2.00 s, 2 tracks3.00 s, 2 tracks")
        self.assertIn("seen for 9 frames or more", dom.text("caption-images"))

        self.check_view(dom)

    def check_view(self, dom):
        """The view in 3-D is not only meant: pixels, and a picture for paper."""
        if dom.attributes["plot-way"]["data-view"] != "3d":
            self.skipTest("this Chromium has no WebGL: its view in 3-D has not been looked at")
        self.assertGreaterEqual(dom.count("plot-way", "canvas"), 1)
        # The estimate's colour, over far more rows and columns than the legend's piece of it takes.
        rows, step = read_png(self.browser.screenshot())
        self.assertEqual((len(rows), len(rows[0])), (760, 1000 * step))
        red = [(x // step, y) for y, row in enumerate(rows) for x in range(0, len(row), step)
               if row[x] > 190 and 60 < row[x + 1] < 130 and row[x + 2] < 60]
        self.assertGreater(len({x for x, _ in red}), 150)
        self.assertGreater(len({y for _, y in red}), 100)
        # On paper there is a picture of the view in its place.
        picture = "document.querySelector('#way .print-only')"
        self.browser.wait_for(f"{picture}.naturalWidth > 0")
        self.browser.call("Emulation.setEmulatedMedia", media="print")
        self.addCleanup(self.browser.call, "Emulation.setEmulatedMedia", media="")
        self.assertGreater(self.browser.evaluate(f"{picture}.clientHeight"), 100)
        self.assertEqual(self.browser.evaluate("document.getElementById('plot-way').clientHeight"), 0)

    def test_zoom_click_and_width(self):
        self.page(helix(), webgl=False)
        # A zoom is a zoom into all plots over time.
        self.browser.evaluate("Plotly.relayout('plot-speed', {'xaxis.range[0]': 5, 'xaxis.range[1]': 10}).then(() => 0)")
        for plot in ("position", "stages", "events"):
            self.browser.wait_for(f"document.getElementById('plot-{plot}').layout.xaxis.range.map(Number).join() === '5,10'", 20)

        # A click makes an image large.
        width = "document.querySelector('#thumbnails img').clientWidth"
        before = self.browser.evaluate(width)
        self.browser.evaluate("document.querySelector('#thumbnails figure').click()")
        self.assertGreater(self.browser.evaluate(width), 2 * before)

        # Plots follow the window.
        for width in (1280, 800):
            self.browser.resize(width, 760)
            self.addCleanup(self.browser.resize, 1000, 760)
            self.browser.wait_for("document.documentElement.scrollWidth <= window.innerWidth && "
                                  f"window.innerWidth === {width} && "
                                  "[...document.querySelectorAll('.main-svg')].every((svg) => svg.clientWidth <= window.innerWidth)", 20)

    def test_without_truth_and_images(self):
        dom = self.page(without_truth_and_images(), webgl=False)
        self.assertIn("ATEunknown", dom.text("figures"))
        self.assertRegex(dom.text("figures"), r"Path length1[5-9]\.\d m ?of the estimate")
        self.assertNotIn("truth", traces(dom, "way"))
        self.assertIn("No true trajectory is given", dom.text("caption-way"))
        self.assertEqual(dom.text("heading-position"), "Position")
        # A band has no points where its sigma is not known.
        self.assertEqual(traces(dom, "position"), {"3 sigma": 2 * (3 * FRAMES - 20), "estimate": 3 * FRAMES})
        self.assertEqual(dom.text("thumbnails"), "No images are given.")

    def test_without_imu_and_without_webgl(self):
        dom = self.page(without_imu(), webgl=False)
        for plot in ("gyro-bias", "accel-bias"):
            self.assertIn("without an IMU", dom.text(f"plot-{plot}"))
        self.assertEqual(traces(dom, "speed"), {"estimate": FRAMES - 1})
        self.assertIn("No velocity is estimated", dom.text("caption-speed"))
        self.assertEqual(dom.attributes["plot-way"]["data-view"], "plan")
        self.assertEqual(traces(dom, "way")["estimate"], 2 * FRAMES)
        self.assertIn("no WebGL", dom.text("caption-way"))
        self.assertEqual(traces(dom, "stages")["other"], FRAMES)
        self.assertIn("seen from the oldest frame", dom.text("caption-position"))
        self.assertEqual(traces(dom, "position")["error that the band is for"], 3 * FRAMES)
        self.assertIn("Inside the band: x 100 %, y 0.0 %, z 100 %", dom.text("caption-position"))

    def test_a_run_that_never_initialized(self):
        dom = self.page(never_initialized(), webgl=False)
        self.assertEqual(dom.text("notice"),
                         "This run never initialized: there is no estimate. The first refusal: the body <i>rests</i>")
        self.assertIn("Initialized afternever", dom.text("figures"))
        self.assertIn("Path lengthunknown", dom.text("figures"))
        for plot in ("way", "position", "speed", "attitude", "gyro-bias", "accel-bias"):
            self.assertEqual(dom.count(f"plot-{plot}", "p.missing"), 1, plot)
        self.assertEqual(traces(dom, "stages")["solve"], FRAMES)
        self.assertEqual(traces(dom, "events"), {"imu gap": 1})
        self.assertEqual(dom.count("thumbnails", "img"), 3)

    def test_nothing_and_nonsense(self):
        dom = self.page({}, webgl=False)
        self.assertEqual(dom.text("title"), "Report of a run")
        self.assertNotRegex(dom.text("figures"), r"[2-9]|NaN|undefined")
        for plot in ("way", "position", "speed", "attitude", "gyro-bias", "accel-bias", "stages", "features", "events"):
            self.assertEqual(dom.count(f"plot-{plot}", "p.missing"), 1, plot)
        # Mistakes of the page's own would be told, so that none above was hushed up.
        self.browser.evaluate("setTimeout(() => { throw new Error('deliberate'); }), Promise.reject('broken'), console.error('bad'), 0")
        self.browser.wait_for("document.documentElement.dataset.errors === '3'", 20)
        text = self.browser.dom().text("errors")
        for word in ("deliberate", "broken", "bad"):
            self.assertIn(word, text)
        self.assertGreaterEqual(len(self.browser.complaints()), 3)
        dom = self.page(NONSENSE, webgl=False)
        self.assertNotRegex(dom.text("figures"), r"NaN|undefined")
        self.assertEqual(traces(dom, "way")["landmarks"], 2)  # one, in two views
        self.assertIn("This image cannot be shown.", dom.text("thumbnails"))


if __name__ == "__main__":
    main(ReportPageTest)
