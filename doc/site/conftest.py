"""What the tests of the site and of the page of a run share: a headless Chromium."""

import functools
import http.server
import os
import shutil
import threading
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[2]
BOOK = ROOT / "target/book"
PICTURES = ROOT / "target/book-pictures"
PHONE = {"width": 390, "height": 844}
DESK = {"width": 1280, "height": 900}
class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@pytest.fixture(scope="session")
def address():
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=BOOK))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    program = os.environ.get("CHROMIUM") or shutil.which("chromium") or "/usr/bin/chromium"
    switches = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"]
    switches += ["--disable-component-update", "--disable-sync"]
    PICTURES.mkdir(parents=True, exist_ok=True)
    # Playwright gives the browser a new --user-data-dir.
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, headless=True, args=switches)
        yield browser
        browser.close()


@pytest.fixture
def tab(browser):
    """A tab that notes errors of the console, of scripts and of requests, and requests to another host."""
    context = browser.new_context(viewport=DESK, color_scheme="light")
    tab = context.new_page()
    tab.faults = []
    tab.on("console", lambda message: message.type in ("error", "warning") and tab.faults.append(message.text))
    tab.on("pageerror", lambda error: tab.faults.append(str(error)))
    tab.on("requestfailed", lambda request: tab.faults.append(f"failed: {request.url}"))
    tab.on("response", lambda answer: answer.status >= 400 and tab.faults.append(f"{answer.status}: {answer.url}"))
    own = ("http://127.0.0.1:", "file://", "data:", "blob:")
    tab.on("request", lambda request: request.url.startswith(own) or tab.faults.append(f"outside: {request.url}"))
    yield tab
    context.close()
