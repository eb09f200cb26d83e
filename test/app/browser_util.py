# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Headless Chromium, driven over a pipe by its DevTools protocol: opens pages, asks what they hold, takes
pictures of them. https://chromedevtools.github.io/devtools-protocol"""

import base64
import fcntl
import html.parser
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

# Without scripts and styles: plotly.js is five megabytes.
OUTLINE = """(() => {
  const copy = document.documentElement.cloneNode(true);
  copy.querySelectorAll('script, style').forEach((part) => part.remove());
  return copy.outerHTML;
})()"""
WITHOUT_WEBGL = """(() => {
  const given = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function(kind, ...more) {
    return kind.startsWith('webgl') ? null : given.call(this, kind, ...more);
  };
})()"""


class Browser:
    """One window. Times are limits for a busy machine, not waits."""

    def __init__(self, width, height):
        self.folder = tempfile.mkdtemp(prefix="glissade_browser_")
        ends = [*os.pipe(), *os.pipe()]
        # Above the two numbers that Chromium reads and writes at, 3 and 4.
        to_read, self.write_end, self.read_end, to_write = (fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10) for end in ends)
        for end in ends:
            os.close(end)
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{to_read} 4>&{to_write}', "bash", CHROMIUM, "--headless", "--no-sandbox",
             "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
             "--no-first-run", f"--user-data-dir={self.folder}", "--remote-debugging-pipe", "about:blank"],
            pass_fds=(to_read, to_write), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.rest, self.last, self.session, self.events = b"", 0, None, []
        try:
            target = self.call("Target.createTarget", url="about:blank")["targetId"]
            self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
            for part in ("Page", "Runtime", "Log"):
                self.call(f"{part}.enable")
            self.resize(width, height)
        except RuntimeError:
            self.close()
            raise

    def close(self):
        self.process.kill()
        self.process.wait()
        os.close(self.write_end)
        os.close(self.read_end)
        shutil.rmtree(self.folder, ignore_errors=True)

    def resize(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def receive(self, end):
        while b"\0" not in self.rest:
            ready = select.select([self.read_end], [], [], max(0, end - time.monotonic()))[0]
            piece = os.read(self.read_end, 1 << 20) if ready else b""
            if not piece:
                raise RuntimeError("Chromium has ended" if ready else "Chromium does not answer")
            self.rest += piece
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, timeout=90, **parameters):
        """A method of the protocol; events that come meanwhile are kept."""
        self.last += 1
        message = {"id": self.last, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.write_end, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + timeout
        while True:
            answer = self.receive(end)
            if answer.get("id") == self.last:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def evaluate(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(json.dumps(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def wait_for(self, condition, timeout=90):
        end = time.monotonic() + timeout
        while not self.evaluate(condition):
            if time.monotonic() > end:
                raise RuntimeError(f"waited in vain for {condition}")
            time.sleep(0.05)

    def open(self, path, ready, webgl=True):
        """Opens a file and waits until `ready` is true there."""
        self.events = []
        script = None if webgl else self.call("Page.addScriptToEvaluateOnNewDocument", source=WITHOUT_WEBGL)["identifier"]
        self.call("Page.navigate", url=path.as_uri())
        self.wait_for(f"location.href === {json.dumps(path.as_uri())} && ({ready})")
        if script:
            self.call("Page.removeScriptToEvaluateOnNewDocument", identifier=script)

    def dom(self):
        return Dom(self.evaluate(OUTLINE))

    def screenshot(self):
        """The window as PNG."""
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])

    def complaints(self):
        """Exceptions, errors of the console, and what the browser has against the page, since it was opened."""
        self.evaluate("0")  # what has been sent before
        said = []
        for event in self.events:
            text = json.dumps(event.get("params", {}))
            kind = event.get("method")
            if kind == "Runtime.exceptionThrown" or \
               kind == "Runtime.consoleAPICalled" and event["params"]["type"] in ("error", "assert") or \
               kind == "Log.entryAdded" and event["params"]["entry"]["level"] == "error":
                said.append(text[:500])
        return said


class Dom(html.parser.HTMLParser):
    """Attributes and text of each element with an id, and counts of the elements in it, "tag" and "tag.class"."""

    EMPTY = {"meta", "br", "img", "input", "link", "hr", "area", "base", "col", "embed", "source", "track", "wbr"}

    def __init__(self, text):
        super().__init__()
        self.stack, self.attributes, self.texts, self.counts = [], {}, {}, {}
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        name = attrs.get("id") or ("html" if tag == "html" else None)
        for kind in (tag, *(f"{tag}.{c}" for c in (attrs.get("class") or "").split())):
            for _, owner in self.stack:
                if owner:
                    self.counts[owner][kind] = self.counts[owner].get(kind, 0) + 1
        if name:
            self.attributes[name], self.texts[name], self.counts[name] = attrs, "", {}
        if tag not in self.EMPTY:
            self.stack.append((tag, name))

    def handle_endtag(self, tag):
        if any(t == tag for t, _ in self.stack):
            while self.stack.pop()[0] != tag:
                pass

    def handle_data(self, data):
        for _, owner in self.stack:
            if owner:
                self.texts[owner] += data

    def text(self, name):
        return " ".join(self.texts[name].split())

    def count(self, name, kind):
        return self.counts[name].get(kind, 0)
