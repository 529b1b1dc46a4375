// Shared parts of the page's tests: a headless Chromium, a server, pictures of the canvas. Exit status 77: skipped,
// with the reason.
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

export const skip = (why) => { console.log(`skipped: ${why}`); process.exit(77); };
const browserPath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
if (!browserPath) skip('chromium is not installed (scripts/setup.sh --browser)');
const { chromium } = await import('playwright-core').catch(() => skip('playwright-core is not installed (npm ci in web/)'));

let failed = 0;
const begun = Date.now();
const seconds = () => `${((Date.now() - begun) / 1000).toFixed(1)} s`.padStart(7);
export const check = (ok, what) => { console.log(`${ok ? 'ok    ' : 'FAILED'} ${seconds()}  ${what}`); if (!ok) ++failed; };
export const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/// Arguments: PROGRAM RUN FOLDER_FOR_SCREENSHOTS; the run is skipped over by tests that make their own.
export function settings() {
  const [program = '../build/aligngs', run = '', shots = join(tmpdir(), 'aligngs_page')] = process.argv.slice(2);
  if (!existsSync(program)) skip(`${program} is not built`);
  mkdirSync(shots, { recursive: true });
  return { program, run, shots, folder: mkdtempSync(join(tmpdir(), 'aligngs_page_run_')) };
}

/// Runs the program to its end; its standard output.
export function aligngs(program, ...args) {
  const done = spawnSync(program, args, { encoding: 'utf8' });
  if (done.status !== 0) throw new Error(`aligngs ${args.join(' ')} ended with ${done.status}: ${done.stderr}`);
  return done.stdout;
}

/// `aligngs view`; resolves when it tells its address.
export async function serve(program, path, port = 0) {
  const developed = process.env.ALIGNGS_WEB_ROOT ? ['--web-root', process.env.ALIGNGS_WEB_ROOT] : []; // without building the program
  const server = spawn(program, ['view', path, '--json', ...(port ? ['--port', String(port)] : []), ...developed], { stdio: ['ignore', 'pipe', 'inherit'] });
  const { url } = JSON.parse(await new Promise((resolve, reject) => {
    server.stdout.once('data', (d) => resolve(String(d)));
    server.once('exit', (status) => reject(new Error(`aligngs view ended with ${status}`)));
  }));
  return { server, url };
}

/// Runs `body` with a browser and tells the outcome; everything started is ended.
export async function withBrowser(body, { cleanup = () => {} } = {}) {
  let browser;
  try {
    browser = await chromium.launch({
      executablePath: browserPath,
      args: ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
        '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--force-color-profile=srgb'],
    });
    await body(browser);
  } catch (error) {
    console.log(error);
    ++failed;
  } finally {
    await browser?.close();
    await cleanup();
  }
  process.exit(failed ? 1 : 0);
}
export const remove = (folder) => rmSync(folder, { recursive: true, force: true });

/// Waits until a page that was opened or loaded again has shown its first picture. Its script starts after the page has loaded.
export async function ready(page) {
  await page.waitForFunction(() => window.aligngs?.ready, null, { timeout: 60000 });
  await page.evaluate(() => window.aligngs.ready);
}

/// A page on `url` that has shown its first picture, with ways to look at it. `density`: device pixels a CSS pixel; fewer are
/// drawn sooner. `before` runs in the page before its script.
export async function open(browser, url, { width = 800, height = 480, density = 1, shots = '', prefix = '', before = null } = {}) {
  const page = await browser.newPage({ viewport: { width, height }, deviceScaleFactor: density });
  if (before) await page.addInitScript(before);
  const complaints = [];
  page.on('console', (m) => { if (m.type() === 'error') complaints.push(`${m.text()} ${m.location().url}`.trim()); });
  page.on('pageerror', (e) => complaints.push(e.stack ?? String(e)));
  await page.emulateMedia({ colorScheme: 'dark' });
  const started = Date.now();
  await page.goto(url);
  await ready(page);
  // Waits until sorting and drawing have ended, then reads the canvas.
  const settle = async () => {
    await page.evaluate(() => window.aligngs.page.loading);
    await page.waitForFunction(() => window.aligngs.viewer.resting && !document.getElementById('message').textContent.startsWith('loading'),
      null, { polling: 30, timeout: 60000 });
  };
  const picture = async (w = 160, h = 90) => {
    await settle();
    return page.evaluate(([w, h]) => {
      const source = document.getElementById('canvas'), small = document.createElement('canvas');
      small.width = w; small.height = h;
      const context = small.getContext('2d');
      context.drawImage(source, 0, 0, w, h);
      return Array.from(context.getImageData(0, 0, w, h).data);
    }, [w, h]);
  };
  const shot = (name) => page.screenshot({ path: join(shots, `${prefix}${name}.png`) });
  const slide = (id, value) => page.locator(id).evaluate((e, v) => { e.value = v; e.dispatchEvent(new Event('input')); }, String(value));
  const message = () => page.locator('#message').textContent();
  return { page, complaints, started, settle, picture, shot, slide, message };
}
/// Controls over the room whose middle lies under something else, and those of the page smaller than 24 pixels.
export const badControls = (page) => page.evaluate(() => {
  const found = [];
  for (const e of document.querySelectorAll('header button, main button, main input, aside button')) {
    const r = e.getBoundingClientRect();
    if (!e.offsetParent || getComputedStyle(e).visibility === 'hidden' || r.width === 0) continue;
    if (e.tagName === 'BUTTON' && (r.width < 24 || r.height < 24)) found.push(`${e.id || e.className} is small`);
    const over = e.closest('main') && document.elementFromPoint(r.left + r.width / 2, r.top + r.height / 2);
    if (over && !e.contains(over) && !over.contains(e)) found.push(`${e.id || e.textContent} lies under ${over.id || over.tagName}`);
  }
  return found;
});
/// Mean absolute difference of two pictures, in levels of 255.
export const difference = (a, b) => a.reduce((sum, v, i) => sum + Math.abs(v - b[i]), 0) / a.length;
/// How much is to be seen in a picture: the standard deviation of its values.
export function spread(a) {
  const mean = a.reduce((x, y) => x + y, 0) / a.length;
  return Math.sqrt(a.reduce((x, v) => x + (v - mean) ** 2, 0) / a.length);
}
