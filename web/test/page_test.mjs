// The page in headless Chromium against `aligngs view`: every control does what it says, with screenshots to look at.
// Usage: node test/page_test.mjs PROGRAM RUN [FOLDER_FOR_SCREENSHOTS]
import { appendFileSync, cpSync, existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { check, difference, open, remove, serve, settings, skip, spread, withBrowser } from './browser.mjs';

const { program, run: given, shots, folder } = settings(), run = join(folder, 'run');
if (!given || !existsSync(given)) skip('no run was given');
cpSync(given, run, { recursive: true, filter: (path) => !path.includes('/control') }); // the test appends to its events
const { server, url } = await serve(program, run);
/// Answers of workers come later by window.slowSorting milliseconds, as on a busy machine.
const slowSorts = () => {
  const listen = Worker.prototype.addEventListener;
  Worker.prototype.addEventListener = function (name, heard, ...more) {
    return listen.call(this, name, name === 'message' ? (e) => setTimeout(() => heard(e), window.slowSorting ?? 0) : heard, ...more);
  };
};
await withBrowser(async (browser) => {
  const { page, complaints, started, settle, picture, shot, slide } = await open(browser, url, { shots, width: 900, height: 520, before: slowSorts });
  /// The glow of the object under the pointer has gone: the next picture comes without it.
  const nothingGlows = () => page.waitForFunction(() => document.getElementById('hovered').hidden && !window.aligngs.page.selection.glows, null, { polling: 30, timeout: 10000 });
  const start = await picture();
  const asBefore = async (what) => {
    const off = difference(start, await picture());
    check(off < 1, `${what} (difference ${off.toFixed(3)} of 255)`);
  };
  const firstPicture = Date.now() - started;
  console.log(`first picture after ${firstPicture} ms`);
  await shot('start');
  check(spread(start) > 25, `the start pose shows a scene (spread of the pixels ${spread(start).toFixed(1)})`);
  check(firstPicture < 30000, 'the first picture stands within half a minute, on a machine without a graphics card');
  // The server's picture, which is shown before, is of the same place.
  const ahead = await page.evaluate(async () => {
    const picture = document.getElementById('first-picture'), gone = picture.hidden, canvas = document.getElementById('canvas').getBoundingClientRect();
    picture.hidden = false;
    for (let k = 0; k < 50 && picture.naturalWidth < 2; ++k) { // it is drawn in the background
      picture.src = `/api/start.jpg?${k}`;
      await picture.decode();
      await new Promise((later) => setTimeout(later, 200));
    }
    const small = document.createElement('canvas'), at = picture.getBoundingClientRect(), [w, h] = [160, 90];
    small.width = w; small.height = h;
    const context = small.getContext('2d'), x = w / canvas.width, y = h / canvas.height;
    context.drawImage(picture, (at.left - canvas.left) * x, (at.top - canvas.top) * y, at.width * x, at.height * y);
    picture.hidden = true;
    return { gone, width: picture.naturalWidth, pixels: Array.from(context.getImageData(0, 0, w, h).data) };
  });
  check(ahead.gone, 'the picture of the server has gone');
  check(ahead.width > 1000 && difference(start, ahead.pixels) < 8, `and shows what the splats show (difference ${difference(start, ahead.pixels).toFixed(1)} of 255)`);
  const idle = await page.evaluate(() => window.aligngs.viewer.frames);
  await page.waitForTimeout(2000);
  check(await page.evaluate(() => window.aligngs.viewer.frames) === idle, 'nothing is drawn while nothing changes');

  const classes = JSON.parse(readFileSync(join(run, 'classes.json'))).classes.filter((c) => c.gaussians > 0);
  check(await page.locator('#classes li').count() === classes.length, `${classes.length} classes are listed`);
  await slide('#overlay', '80');
  const labels = await picture();
  await shot('labels');
  check(difference(start, labels) > 5, 'the label overlay changes the picture');
  await slide('#overlay', '0');
  await asBefore('and goes away again');

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
  await asBefore('show all brings everything back');

  const box = await page.locator('#canvas').boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  const picked = await page.locator('#picked-text').textContent();
  check(classes.some((c) => picked.startsWith(`${c.name}:`)), `a click names the object (${picked})`);
  await page.keyboard.press('m');
  await page.mouse.click(box.x + box.width * 0.35, box.y + box.height * 0.6);
  await page.mouse.click(box.x + box.width * 0.65, box.y + box.height * 0.6);
  check(/^\d+\.\d+ (m|scene units)$/.test(await page.locator('#message').textContent()), `two clicks measure (${await page.locator('#message').textContent()})`);
  await settle();
  await shot('measure');
  await bed.locator('.solo').click();
  await page.mouse.click(box.x + box.width * 0.1, box.y + box.height * 0.3); // a wall that is not shown
  check((await page.locator('#message').textContent()).startsWith('nothing there'), `a click beside everything that is shown says so (${await page.locator('#message').textContent()})`);
  await page.locator('#all').click();
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
  await page.locator('#picked-close').click(); // it glows
  await page.mouse.move(2, 2); // so does the object under the pointer, once the panel has gone
  await nothingGlows();
  await page.keyboard.press('h');
  await asBefore('home goes back to the start pose');
  // Splats that the view cannot show are not drawn, and not missed.
  const [drawn, all] = await page.evaluate(() => { const { viewer } = window.aligngs; window.culled = viewer.culled; viewer.culled = null; viewer.draw(); return [viewer.order.shown, viewer.splats.count]; });
  await asBefore(`${drawn} of ${all} splats make the picture of all`);
  check(drawn < 0.95 * all && await page.evaluate(() => window.aligngs.viewer.order.shown) === all, 'and all were drawn for that');
  await page.evaluate(() => { const { viewer } = window.aligngs; viewer.culled = window.culled; viewer.draw(); });
  // A sort that is asked for while another one runs is not lost: its picture would stay in a wrong order.
  for (const round of [1, 2]) {
    await page.evaluate(async () => {
      window.slowSorting = 300; // milliseconds
      const { viewer, page } = window.aligngs, next = () => new Promise((done) => viewer.app.once('frameend', done));
      for (const turn of [500, 100]) { page.navigation.turn(turn, 0); await next(); } // the first sort runs, the second waits
    });
    await page.keyboard.press('h');
    await asBefore(`and does so while a sort runs, round ${round}`);
  }
  await page.evaluate(() => { window.slowSorting = 0; });

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
  // A view that nobody rendered is drawn by the server when the page asks for it.
  for (const kind of ['depth', 'normal', 'label', 'rgb']) {
    await page.locator('#right').selectOption(kind);
    await page.waitForFunction((k) => { const i = document.getElementById('right-picture'); return i.src.includes(k) && i.complete && i.naturalWidth > 0; }, kind);
    check((await page.locator('#right-picture').getAttribute('src')).startsWith('/api/render/'), `a training view compares with its ${kind}`);
    if (kind === 'normal') await shot('compare_training_normal');
  }
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
  await asBefore('Escape leaves the comparison');

  await page.waitForFunction(() => window.aligngs.page.training.charts.points > 0, null, { timeout: 10000 });
  const points = await page.evaluate(() => window.aligngs.page.training.charts.points);
  appendFileSync(join(run, 'events.ndjson'), '{"step":99999,"losses":{"total":0.1},"psnr":30.5,"gaussians":1234}\n');
  await page.waitForFunction((n) => window.aligngs.page.training.charts.points === n + 1, points, { timeout: 10000 });
  check((await page.locator('#progress').textContent()).includes('99999'), 'a new event reaches the charts');
  check(!(await page.locator('#progress').isVisible()), 'charts of a finished training are closed');
  await page.locator('#training summary').click();
  check(await page.evaluate(() => document.getElementById('lists').compareDocumentPosition(document.getElementById('training')) & 4) === 4, 'and lie below the lists');
  await page.locator('#charts').scrollIntoViewIfNeeded();
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
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
