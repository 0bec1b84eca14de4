# SPDX-License-Identifier: BSD-2-Clause
"""browser: a headless Chromium, driven as a person would, by the DevTools protocol over a pipe: no package is needed.

    with browser.Browser("chromium") as b:
        page = b.page("file:///...", width=1100, height=900)
        page.value("document.title"), page.click("button"), page.key("ArrowRight"), page.shot("a.png")
        page.requests                       # every address that the page has asked for

All names are resolved to nothing, so that what is fetched from elsewhere fails, and is seen in page.requests."""
import base64
import json
import os
import select
import subprocess
import tempfile
import time

KEYS = {"ArrowRight": 39, "ArrowLeft": 37, "Tab": 9, "Enter": 13, "Home": 36, "End": 35, " ": 32}


class Browser:
    """Browser starts Chromium with file descriptors 3 and 4 as the protocol's pipe, and ends it."""

    def __init__(self, program):
        # A child of Chromium may still write while the folder is removed, because Chromium does not wait for its
        # children.
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_read, self.to = os.pipe()
        self.back, to_write = os.pipe()
        command = [program, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run",
                   "--disable-background-networking", "--host-resolver-rules=MAP * ~NOTFOUND",
                   "--remote-debugging-pipe",
                   f"--user-data-dir={self.profile.name}", "about:blank"]
        shell = 'exec 3<&"$1" 4>&"$2"; shift 2; exec "$@"'     # 3 and 4, whatever the pipes are here
        self.process = subprocess.Popen(["bash", "-c", shell, "-", str(to_read), str(to_write), *command],
                                        pass_fds=(to_read, to_write), stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.next, self.rest, self.answers, self.events = 0, b"", {}, []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        os.close(self.to)
        os.close(self.back)
        self.profile.cleanup()

    def receive(self, seconds):
        """receive waits for messages and sorts them into answers and events."""
        if not select.select([self.back], [], [], seconds)[0]:
            return
        self.rest += os.read(self.back, 1 << 20)
        *whole, self.rest = self.rest.split(b"\0")
        for text in whole:
            message = json.loads(text)
            if "id" in message:
                self.answers[message["id"]] = message
            else:
                self.events.append(message)

    def send(self, method, session=None, **parameters):
        """send returns the result of a command."""
        self.next += 1
        mine, end = self.next, time.monotonic() + 120
        message = {"id": mine, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while mine not in self.answers:
            if time.monotonic() > end or self.process.poll() is not None:
                raise RuntimeError(f"the browser does not answer {method}")
            self.receive(1)
        answer = self.answers.pop(mine)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        return answer["result"]

    def page(self, address, width=1100, height=900, dark=False):
        """page opens an address in a new tab."""
        target = self.send("Target.createTarget", url="about:blank", newWindow=True)["targetId"]
        return Page(self, self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"], address,
                    width, height,
                    dark)


class Page:
    """Page is one tab."""

    def __init__(self, browser, session, address, width, height, dark):
        self.browser, self.session = browser, session
        for what in ("Page", "Runtime", "Network"):
            self.send(what + ".enable")
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.send("Emulation.setEmulatedMedia",
                  features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self.send("Page.navigate", url=address)
        self.wait("document.readyState === 'complete'", 30)

    def send(self, method, **parameters):
        """send is the browser's, for this tab."""
        return self.browser.send(method, self.session, **parameters)

    def value(self, expression):
        """value returns what JavaScript computes (JSON)."""
        answer = self.send("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression[:200]}: "
                               f"{answer['exceptionDetails'].get('exception', {}).get('description')}")
        return answer["result"].get("value")

    def wait(self, expression, seconds=60):
        """wait returns when the expression is true; False: it never was."""
        end = time.monotonic() + seconds
        while not self.value(expression):
            if time.monotonic() > end:
                return False
            self.browser.receive(0.05)
        return True

    def place(self, expression):
        """place scrolls an element into view and returns its middle."""
        return self.value(f"(() => {{ const e = {expression}; e.scrollIntoView({{block: 'center'}}); "
                          "const r = e.getBoundingClientRect();"
                          " return [r.left + r.width / 2, r.top + r.height / 2]; })()")

    def click_at(self, x, y):
        """click_at presses and releases the mouse."""
        for kind in ("mousePressed", "mouseReleased"):
            self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def click(self, expression):
        """click clicks the middle of an element."""
        self.click_at(*self.place(expression))

    def key(self, name):
        """key presses a key."""
        for kind in ("rawKeyDown", "keyUp"):
            self.send("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=KEYS[name])

    def shot(self, path, of="document.documentElement"):
        """shot writes a picture of the page, or of one element."""
        x, y, width, height = self.value(f"(() => {{ const r = ({of}).getBoundingClientRect();"
                                         " return [r.left + scrollX, r.top + scrollY, r.width, r.height]; })()")
        clip = {"x": x, "y": y, "width": width, "height": height, "scale": 1}
        data = self.send("Page.captureScreenshot", captureBeyondViewport=True, clip=clip)["data"]
        with open(path, "wb") as f:
            f.write(base64.b64decode(data))

    @property
    def requests(self):
        """requests lists the addresses that this tab has asked for."""
        self.browser.receive(0)
        return [e["params"]["request"]["url"] for e in self.browser.events
                if e["method"] == "Network.requestWillBeSent" and e.get("sessionId") == self.session]
