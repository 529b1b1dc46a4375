// The page in headless Chromium against `aligngs view`: every control does what it says, with screenshots to look at.
// Usage: node test/page_test.mjs RUN [PROGRAM] [FOLDER_FOR_SCREENSHOTS]. Exit status 77: skipped, with the reason.
import { spawn } from 'node:child_process';
import { appendFileSync, cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const skip = (why) => { console.log(`skipped: ${why}`); process.exit(77); };
const browserPath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
if (!browserPath) skip('chromium is not installed');
const { chromium } = await import('playwright-core').catch(() => skip('playwright-core is not installed (npm ci in web/)'));
const [given, program = '../build/aligngs', shots = join(tmpdir(), 'aligngs_page')] = process.argv.slice(2);
if (!given || !existsSync(given)) skip('no run was given');
if (!existsSync(program)) skip(`${program} is not built`);

mkdirSync(shots, { recursive: true });
const folder = mkdtempSync(join(tmpdir(), 'aligngs_page_run_')), run = join(folder, 'run');
cpSync(given, run, { recursive: true, filter: (path) => !path.endsWith('/checkpoints') }); // the test appends to its events
const server = spawn(program, ['view', run, '--json'], { stdio: ['ignore', 'pipe', 'inherit'] });
let failed = 0, browser;
const check = (ok, what) => { console.log(`${ok ? 'ok    ' : 'FAILED'} ${what}`); if (!ok) ++failed; };
try {
  const { url } = JSON.parse(await new Promise((resolve) => server.stdout.once('data', (d) => resolve(String(d)))));
  browser = await chromium.launch({
    executablePath: browserPath,
    args: ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
      '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
  });
  const page = await browser.newPage({ viewport: { width: 1000, height: 560 } });
  const complaints = [];
  page.on('console', (m) => { if (m.type() === 'error') complaints.push(m.text()); });
  page.on('pageerror', (e) => complaints.push(String(e)));
  const started = Date.now();
  await page.goto(url);
  await page.waitForFunction(() => window.aligngs?.ready, null, { timeout: 60000 });
  await page.evaluate(() => window.aligngs.ready);

  // Waits until sorting and drawing have ended, then reads the canvas.
  const settle = async () => {
    let before = -1;
    for (let i = 0; i < 40; ++i) {
      await page.waitForTimeout(700);
      const now = await page.evaluate(() => window.aligngs.viewer.frames);
      if (now === before) return;
      before = now;
    }
  };
  const picture = async () => {
    await settle();
    return page.evaluate(() => {
      const source = document.getElementById('canvas'), small = document.createElement('canvas');
      small.width = 160; small.height = 90;
      const context = small.getContext('2d');
      context.drawImage(source, 0, 0, 160, 90);
      return Array.from(context.getImageData(0, 0, 160, 90).data);
    });
  };
  const difference = (a, b) => a.reduce((sum, v, i) => sum + Math.abs(v - b[i]), 0) / a.length;
  const shot = (name) => page.screenshot({ path: join(shots, `${name}.png`) });

  const start = await picture();
  console.log(`first picture after ${Date.now() - started} ms`);
  await shot('start');
  const mean = start.reduce((a, b) => a + b, 0) / start.length, spread = Math.sqrt(start.reduce((a, v) => a + (v - mean) ** 2, 0) / start.length);
  check(spread > 25, `the start pose shows a scene (spread of the pixels ${spread.toFixed(1)})`);
  const idle = await page.evaluate(() => window.aligngs.viewer.frames);
  await page.waitForTimeout(2000);
  check(await page.evaluate(() => window.aligngs.viewer.frames) === idle, 'nothing is drawn while nothing changes');

  const classes = JSON.parse(readFileSync(join(run, 'classes.json'))).classes.filter((c) => c.gaussians > 0);
  check(await page.locator('#classes li').count() === classes.length, `${classes.length} classes are listed`);
  const slide = (id, value) => page.locator(id).evaluate((e, v) => { e.value = v; e.dispatchEvent(new Event('input')); }, value);
  await slide('#overlay', '80');
  const labels = await picture();
  await shot('labels');
  check(difference(start, labels) > 5, 'the label overlay changes the picture');
  await slide('#overlay', '0');
  check(difference(start, await picture()) < 1, 'and goes away again');

  const wall = page.locator('#classes li', { hasText: 'wall' }).first();
  await wall.locator('.eye').click();
  const hidden = await picture();
  check(difference(start, hidden) > 5, 'the eye hides a class');
  await shot('no_wall');
  await page.locator('#all').click();
  const bed = page.locator('#classes li').nth(2);
  await bed.locator('.solo').click();
  check(difference(start, await picture()) > 5, 'solo leaves one class');
  await shot('solo');
  await page.locator('#all').click();
  check(difference(start, await picture()) < 1, 'show all brings everything back');

  const box = await page.locator('#canvas').boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  const picked = await page.locator('#picked').textContent();
  check(classes.some((c) => picked.startsWith(`${c.name}:`)), `a click names the object (${picked})`);
  await page.keyboard.press('m');
  await page.mouse.click(box.x + box.width * 0.35, box.y + box.height * 0.6);
  await page.mouse.click(box.x + box.width * 0.65, box.y + box.height * 0.6);
  check(/^\d+\.\d+ (m|scene units)$/.test(await page.locator('#message').textContent()), `two clicks measure (${await page.locator('#message').textContent()})`);
  await settle();
  await shot('measure');
  await page.keyboard.press('m');

  await page.keyboard.press('c');
  check(difference(start, await picture()) > 0.05, 'camera frusta are drawn');
  await shot('cameras');
  await page.keyboard.press('c');
  await page.mouse.move(box.x + 300, box.y + 200);
  await page.mouse.down();
  await page.mouse.move(box.x + 420, box.y + 230, { steps: 4 });
  await page.mouse.up();
  check(difference(start, await picture()) > 5, 'dragging turns the view');
  await page.keyboard.press('h');
  check(difference(start, await picture()) < 1, 'home goes back to the start pose');

  // At a training photo's place the splats look like the photo.
  const cameras = JSON.parse(readFileSync(join(run, 'cameras.json')));
  const training = cameras.find((c) => c.split === 'train') ?? cameras[0];
  await page.locator('#view').selectOption(training.img_name);
  await settle();
  await shot('compare_photo');
  const agreement = await page.evaluate(async () => {
    const photo = document.getElementById('left-picture'), canvas = document.getElementById('canvas');
    await photo.decode();
    const w = 120, h = Math.round((120 * photo.clientHeight) / photo.clientWidth), ratio = canvas.width / canvas.clientWidth;
    const draw = (image, ...part) => {
      const c = document.createElement('canvas');
      c.width = w; c.height = h;
      c.getContext('2d').drawImage(image, ...part, 0, 0, w, h);
      return c.getContext('2d').getImageData(0, 0, w, h).data;
    };
    const a = draw(photo, 0, 0, photo.naturalWidth, photo.naturalHeight);
    const left = (canvas.clientWidth - photo.clientWidth) / 2, top = (canvas.clientHeight - photo.clientHeight) / 2;
    const b = draw(canvas, left * ratio, top * ratio, photo.clientWidth * ratio, photo.clientHeight * ratio);
    let sum = 0;
    for (let i = 0; i < a.length; ++i) if (i % 4 < 3) sum += (a[i] - b[i]) ** 2;
    return 10 * Math.log10(255 ** 2 / (sum / (0.75 * a.length)));
  });
  check(agreement > 17, `the splats lie over the training photo (${agreement.toFixed(1)} dB)`);
  const tested = await page.evaluate(() => fetch('/api/state').then((r) => r.json()).then((s) => Object.keys(s.views).find((v) => s.views[v].kinds.includes('depth'))));
  if (tested) {
    await page.locator('#view').selectOption(tested);
    for (const kind of ['depth', 'normal', 'label', 'rgb']) {
      await page.locator('#right').selectOption(kind);
      await page.waitForFunction(() => { const i = document.getElementById('right-picture'); return i.complete && i.naturalWidth > 0; });
      check(await page.locator('#right-picture').isVisible(), `a test view compares with its ${kind}`);
      if (kind === 'depth') await shot('compare_depth');
    }
  }
  await page.keyboard.press('Escape');
  check(difference(start, await picture()) < 1, 'Escape leaves the comparison');

  await page.waitForFunction(() => window.aligngs.page.charts.points > 0, null, { timeout: 10000 });
  const points = await page.evaluate(() => window.aligngs.page.charts.points);
  appendFileSync(join(run, 'events.ndjson'), '{"step":99999,"losses":{"total":0.1},"psnr":30.5,"gaussians":1234}\n');
  await page.waitForFunction((n) => window.aligngs.page.charts.points === n + 1, points, { timeout: 10000 });
  check((await page.locator('#progress').textContent()).includes('99999'), 'a new event reaches the charts');
  await shot('charts');

  if (existsSync(join(run, 'mesh', 'mesh.ply'))) {
    await page.keyboard.press('2');
    await page.waitForFunction(() => document.getElementById('show-mesh').getAttribute('aria-pressed') === 'true', null, { timeout: 60000 });
    const mesh = await picture();
    await shot('mesh');
    check(difference(start, mesh) < 25 && difference(start, mesh) > 0.5, 'the mesh shows the same room');
    await page.keyboard.press('1');
  }
  await page.setViewportSize({ width: 390, height: 780 });
  await page.locator('#panel-button').click();
  await settle();
  await shot('phone');
  check(await page.locator('#classes li').first().isVisible(), 'on a phone the panel opens');
  check(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), 'and nothing sticks out');
  check(complaints.length === 0, `no errors in the console ${complaints.slice(0, 3).join(' | ')}`);
} finally {
  await browser?.close();
  server.kill('SIGTERM');
  rmSync(folder, { recursive: true, force: true });
}
console.log(`screenshots: ${shots}`);
process.exit(failed ? 1 : 0);
