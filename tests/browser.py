"""Drives a headless Chromium for tests of pages, by its DevTools protocol over a pair of pipes. It needs only
Python's own library."""
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time

NAMES = ('chromium', 'chromium-browser', 'google-chrome')


def find():
    """Returns the path of the browser. Exits with 77 (skipped) if there is none."""
    for name in NAMES:
        path = shutil.which(name)
        if path:
            return path
    print('no chromium', file=sys.stderr)
    sys.exit(1 if os.environ.get('LAMPYRIS_NO_SKIP') else 77)


class Browser:
    """A browser with one page: `with Browser() as browser: browser.open(path)`."""

    def __init__(self, width=1200, height=900, dark=False):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.downloads = os.path.join(self.folder.name, 'downloads')
        os.mkdir(self.downloads)
        self.number, self.events, self.buffer = 0, [], b''
        to_read, self.to = os.pipe()
        self.back, to_write = os.pipe()
        # The browser reads descriptor 3 and writes descriptor 4; the pipes may have the same numbers.
        shell = f'exec {find()} "$@" 3<&{to_read} 4>&{to_write}'
        with open(os.path.join(self.folder.name, 'log'), 'wb') as log:
            self.process = subprocess.Popen(
                ['bash', '-c', shell, 'chromium', '--headless=new', '--remote-debugging-pipe',
                 '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--no-first-run',
                 '--disable-extensions', '--disable-background-networking', '--hide-scrollbars',
                 f'--user-data-dir={self.folder.name}/profile', f'--window-size={width},{height}',
                 'about:blank'],
                pass_fds=(to_read, to_write), stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        os.close(to_read)
        os.close(to_write)
        target = next(t for t in self.call('Target.getTargets', session=False)['targetInfos']
                      if t['type'] == 'page')
        self.session = None
        self.session = self.call('Target.attachToTarget', session=False, flatten=True,
                                 targetId=target['targetId'])['sessionId']
        self.call('Browser.setDownloadBehavior', session=False, behavior='allow',
                  downloadPath=self.downloads)
        for domain in ('Page', 'Runtime', 'Network', 'Log'):
            self.call(domain + '.enable')
        self.resize(width, height, dark)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self.to)  # the browser ends when this pipe is closed
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.back)
        self.folder.cleanup()

    def call(self, method, session=True, **parameters):
        self.number += 1
        message = {'id': self.number, 'method': method, 'params': parameters}
        if session:
            message['sessionId'] = self.session
        os.write(self.to, json.dumps(message).encode() + b'\0')
        while True:
            answer = self.receive(60)
            if answer.get('id') != self.number:
                self.events.append(answer)
                continue
            if 'error' in answer:
                raise AssertionError(f'{method}: {answer["error"]["message"]}')
            return answer['result']

    def receive(self, seconds):
        end = time.monotonic() + seconds
        while b'\0' not in self.buffer:
            if not select.select([self.back], [], [], max(end - time.monotonic(), 0))[0]:
                raise AssertionError('the browser does not answer')
            part = os.read(self.back, 1 << 20)
            if not part:
                raise AssertionError('the browser ended')
            self.buffer += part
        text, _, self.buffer = self.buffer.partition(b'\0')
        return json.loads(text)

    def resize(self, width, height, dark=False):
        self.call('Emulation.setDeviceMetricsOverride', width=width, height=height,
                  deviceScaleFactor=1, mobile=False)
        self.call('Emulation.setEmulatedMedia', features=[
            {'name': 'prefers-color-scheme', 'value': 'dark' if dark else 'light'}])

    def open(self, path):
        self.call('Page.navigate', url='file://' + os.path.abspath(path))
        self.wait('document.readyState === "complete"')

    def run(self, script):
        """Returns the value of a JavaScript expression, evaluated in the page."""
        answer = self.call('Runtime.evaluate', expression=script, returnByValue=True,
                           awaitPromise=True)
        if 'exceptionDetails' in answer:
            raise AssertionError(answer['exceptionDetails'].get('exception', {}).get('description'))
        return answer['result'].get('value')

    def wait(self, condition, seconds=30):
        end = time.monotonic() + seconds
        while not self.run(condition):
            if time.monotonic() > end:
                raise AssertionError('never so: ' + condition)
            time.sleep(0.02)

    def place(self, selector):
        """Scrolls an element into view and returns the position of its centre."""
        return self.run(f'''(() => {{
            const e = document.querySelector({json.dumps(selector)});
            e.scrollIntoView({{block: "center", behavior: "instant"}});
            const b = e.getBoundingClientRect();
            return [b.left + b.width / 2, b.top + b.height / 2];
        }})()''')

    def mouse(self, kind, x, y, modifiers=0, **more):
        self.call('Input.dispatchMouseEvent', type=kind, x=x, y=y, modifiers=modifiers, **more)

    def click(self, selector):
        self.click_at(*self.place(selector))

    def click_at(self, x, y):
        for kind in ('mousePressed', 'mouseReleased'):
            self.mouse(kind, x, y, button='left', buttons=1, clickCount=1)

    def drag(self, start, end, modifiers=0):
        self.mouse('mousePressed', *start, modifiers, button='left', buttons=1, clickCount=1)
        for part in (0.5, 1):
            self.mouse('mouseMoved', *(a + part * (b - a) for a, b in zip(start, end)), modifiers,
                       button='left', buttons=1)
        self.mouse('mouseReleased', *end, modifiers, button='left', clickCount=1)

    def key(self, key, modifiers=0):
        text = {'text': key} if len(key) == 1 else {}
        if key == 'Enter':
            text = {'text': '\r'}
        self.call('Input.dispatchKeyEvent', type='keyDown', key=key, modifiers=modifiers, **text)
        self.call('Input.dispatchKeyEvent', type='keyUp', key=key, modifiers=modifiers)

    def download(self, name, seconds=30):
        path = os.path.join(self.downloads, name)
        end = time.monotonic() + seconds
        while not os.path.exists(path):
            if time.monotonic() > end:
                raise AssertionError(f'{name} was not saved')
            time.sleep(0.02)
        with open(path, 'rb') as file:
            return file.read()

    def screenshot(self, path, whole=False):
        import base64
        more = {}
        if whole:
            size = self.call('Page.getLayoutMetrics')['cssContentSize']
            more = {'captureBeyondViewport': True, 'clip': {
                'x': 0, 'y': 0, 'width': size['width'], 'height': size['height'], 'scale': 1}}
        with open(path, 'wb') as file:
            file.write(base64.b64decode(self.call('Page.captureScreenshot', format='png', **more)['data']))

    def complaints(self):
        """Returns the errors in the page's console and the addresses that it has requested from the
        network."""
        self.run('0')
        found = []
        for event in self.events:
            method, parameters = event.get('method'), event.get('params', {})
            if method == 'Runtime.exceptionThrown':
                details = parameters['exceptionDetails']
                found.append(details.get('exception', {}).get('description', details['text']))
            elif method == 'Log.entryAdded' and parameters['entry']['level'] == 'error':
                found.append(parameters['entry']['text'])
            elif method == 'Network.requestWillBeSent':
                url = parameters['request']['url']
                if not url.startswith(('file:', 'data:', 'blob:', 'about:')):
                    found.append('asked for ' + url)
        return found
