"""A headless Chromium that reaches no network, and what it saw. Also takes pictures:

    /usr/bin/python3 tests/report/browser.py FILE.html PICTURE.png [--width 1280] [--height 900] [--dark] [--full]
        [--script JAVASCRIPT]
"""

import argparse
import base64
import json
import os
import pathlib
import shutil
import sys
import tempfile
import time

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

# `--use-gl=swiftshader` draws nothing in today's Chromium.
ARGUMENTS = [
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--no-first-run",
    "--hide-scrollbars",
    "--host-resolver-rules=MAP * ~NOTFOUND",
]


class Browser:
    """`with Browser() as browser: browser.open(path, width=390)`; pages one after the other."""

    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix="hardbody-report-")
        options = Options()
        options.binary_location = shutil.which("chromium") or "chromium"
        for argument in ARGUMENTS + [f"--user-data-dir={self.profile}"]:
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
        self.driver.set_page_load_timeout(120)
        self.driver.set_script_timeout(120)
        self.address = ""
        self.computed = 0  # by the last open(), of page_seconds()
        self.command("Network.enable")
        self.command(
            "Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=-1, uploadThroughput=-1
        )

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.driver.quit()
        shutil.rmtree(self.profile, ignore_errors=True)

    def command(self, name, **arguments):
        return self.driver.execute_cdp_cmd(name, arguments)

    def open(self, path, width=1280, height=900, dark=False, scale=1):
        """Seconds until the page has drawn itself."""
        # Of the page, also below the least width of a window.
        self.command(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=width < 600
        )
        self.command(
            "Emulation.setEmulatedMedia",
            features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}],
        )
        self.driver.get("about:blank")
        self.requests()
        self.complaints()
        self.address = pathlib.Path(os.path.abspath(path)).as_uri()
        begin = time.monotonic(), self.page_seconds()
        self.driver.get(self.address)
        self.run("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        self.computed = self.page_seconds() - begin[1]
        return time.monotonic() - begin[0]

    def page_seconds(self):
        """What the busiest thread of a page has computed until now: how long it takes where nothing else is running."""
        ticks = [0]
        parents = {}
        for entry in pathlib.Path("/proc").iterdir():
            try:
                fields = (entry / "stat").read_text().rsplit(") ", 1)[1].split() if entry.name.isdigit() else []
                if fields:
                    parents[int(entry.name)] = int(fields[1])
            except (OSError, IndexError):
                continue  # it has ended
        ours = {self.driver.service.process.pid}
        while new := {pid for pid, parent in parents.items() if parent in ours and pid not in ours}:
            ours |= new
        for pid in ours:
            try:
                command = pathlib.Path(f"/proc/{pid}/cmdline").read_text()
                fields = pathlib.Path(f"/proc/{pid}/task/{pid}/stat").read_text().rsplit(") ", 1)[1].split()
            except OSError:
                continue
            if "--type=renderer" in command:
                ticks.append(int(fields[11]) + int(fields[12]))
        return max(ticks) / os.sysconf("SC_CLK_TCK")

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def requests(self):
        """Addresses that the page asked for since it was opened, but itself and what is in it."""
        found = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            # The browser's own pages are none of ours.
            if message["method"] != "Network.requestWillBeSent" or message["params"]["documentURL"] != self.address:
                continue
            found.append(message["params"]["request"]["url"])
        return [address for address in found if not address.startswith(("data:", "blob:")) and address != self.address]

    def complaints(self):
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]

    def picture(self, path, full=False):
        arguments = {"format": "png", "captureBeyondViewport": full}
        if full:
            size = self.command("Page.getLayoutMetrics")["cssContentSize"]
            arguments["clip"] = {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}
        data = self.command("Page.captureScreenshot", **arguments)["data"]
        pathlib.Path(path).write_bytes(base64.b64decode(data))


def main():
    parser = argparse.ArgumentParser(description="Takes a picture of a report")
    parser.add_argument("file")
    parser.add_argument("picture")
    parser.add_argument("--width", type=int, default=1280)
    parser.add_argument("--height", type=int, default=900)
    parser.add_argument("--scale", type=float, default=1)
    parser.add_argument("--dark", action="store_true")
    parser.add_argument("--full", action="store_true", help="the whole page")
    parser.add_argument("--script", default="", help="run before")
    arguments = parser.parse_args()
    with Browser() as browser:
        browser.open(arguments.file, arguments.width, arguments.height, arguments.dark, arguments.scale)
        if arguments.script:
            print(browser.run(arguments.script))
        time.sleep(1)
        browser.picture(arguments.picture, arguments.full)
        for line in browser.complaints():
            print(line, file=sys.stderr)


if __name__ == "__main__":
    main()
