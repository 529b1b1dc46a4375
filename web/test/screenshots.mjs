// The pictures of the page in docs/page.md: every state at three sizes side by side, and docs/images/page.jpg.
// PNGS names a folder that keeps each picture as it was taken.
// Usage: [STATES=start,labels] [PNGS=FOLDER] node test/screenshots.mjs PROGRAM RUN [FOLDER: ../docs/images]
import { spawn } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, open, remove, serve, settings, skip, withBrowser } from './browser.mjs';

const { program, run: given, folder } = settings(), run = join(folder, 'demo_run');
const out = process.argv[4] ?? join(dirname(fileURLToPath(import.meta.url)), '../../docs/images'), only = process.env.STATES?.split(',');
const kSizes = [['desktop', 1180, 700], ['tablet', 820, 700], ['phone', 390, 844]]; // CSS pixels
const kHeight = 440, kGap = 8, kQuality = 0.7; // pixels of a row of pictures, between them, and of WebP
const kEdit = 'delete pillow, cushion', kStay = 60000;
if (!given || !existsSync(given)) skip('no run was given');
cpSync(given, run, { recursive: true, filter: (path) => !/\/(control|edits|edits\.json|page\.json)$/.test(path) });
mkdirSync(join(out, 'page'), { recursive: true });

const kEnough = Symbol('all states that were asked for are taken');
const taken = new Map(); // name of a state -> pictures as PNG, by size
const panel = async (page, is) => {
  await page.evaluate((on) => { if (document.getElementById('panel-button').offsetParent) window.aligngs.page.openPanel(on); }, is);
  if (is) await page.waitForFunction(() => document.querySelector('aside').getBoundingClientRect().bottom <= innerHeight + 1, null, { timeout: kStay }); // it slides
};

/// Goes through the states of a finished run.
async function finished({ page, settle, slide }, take) {
  await page.waitForFunction(() => window.aligngs.page.edits.objects.length > 0, null, { timeout: kStay });
  await page.evaluate(async () => { while (document.querySelectorAll('#edits li').length > 0) await window.aligngs.page.edits.undo(); }); // of the size before
  // Into the room, towards the bed, from the place of a photo.
  await page.evaluate(() => {
    const { page: { state, edits, places }, viewer } = window.aligngs, bed = edits.objects.find((o) => o.object.startsWith('bed#')) ?? edits.objects[0];
    const away = (c) => Math.hypot(...c.position.map((v, k) => v - bed.centre[k]));
    places.look(viewer.toWorld(state.cameras.reduce((far, c) => (away(c) > away(far) ? c : far)).position), viewer.toWorld(bed.centre));
  });
  await settle();
  await take('start');
  await slide('#overlay', 70);
  await take('labels');
  await slide('#overlay', 0);
  const box = await page.locator('#canvas').boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.move(2, 2);
  await take('picked');
  await page.locator('#picked-close').click();

  await panel(page, true);
  const noteTime = await page.evaluate((time) => { const { messages } = window.aligngs.page, before = messages.noteTime; messages.noteTime = time; return before; }, 10 * kStay); // the picture of an edit takes its time
  await page.locator('#edit-text').fill(kEdit);
  await page.locator('#edit-apply').click();
  await page.waitForFunction(() => document.querySelectorAll('#edits li').length === 1 && !document.body.classList.contains('busy'), null, { timeout: 4 * kStay });
  await take('edit');
  await page.evaluate((time) => { window.aligngs.page.messages.noteTime = time; }, noteTime);
  await page.locator('#undo').click();
  await page.waitForFunction(() => document.querySelectorAll('#edits li').length === 0 && !document.body.classList.contains('busy'), null, { timeout: 4 * kStay });
  await page.locator('#edit-text').fill('delete unicorn');
  await page.locator('#edit-apply').click();
  await page.waitForFunction(() => document.getElementById('message-box').className === 'error' && !document.body.classList.contains('busy'), null, { timeout: kStay });
  await panel(page, false);
  await take('message');
  await page.locator('#message-close').click();

  await page.evaluate(() => window.aligngs.page.comparison.next(1));
  await page.locator('#left-picture').evaluate((i) => i.decode());
  await take('comparison');
  await page.evaluate(() => window.aligngs.page.places.start());
  await page.locator('#walk').click();
  await take('walking');
  await page.locator('#walk').click();
  await page.locator('#plan-button').click();
  await take('plan');
  await page.locator('#plan-close').click();
  await page.locator('#show-mesh').click();
  await page.waitForFunction(() => window.aligngs.viewer.showsMesh, null, { timeout: kStay });
  await take('mesh');
  await page.locator('#show-splats').click();
  await page.locator('#select').click();
  await page.locator('[data-tool="rectangle"]').click();
  await page.mouse.move(box.x + box.width * 0.3, box.y + box.height * 0.35);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.7, box.y + box.height * 0.6, { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction(() => !document.getElementById('select-clear').disabled, null, { timeout: kStay });
  await page.mouse.move(2, 2);
  await take('select');
  await page.locator('#select-close').click();
  await panel(page, true);
  await page.locator('#cut-box summary').click();
  await slide('#cut-top', 45);
  await page.locator('#cut-box').scrollIntoViewIfNeeded();
  await panel(page, false);
  await take('cut');
  await panel(page, true);
  await page.locator('#cut-reset').click();
  await page.locator('#export-format').selectOption('html');
  await page.locator('#export').click();
  await page.waitForFunction(() => document.getElementById('export-dialog').open && /MB/.test(document.getElementById('export-size').textContent), null, { timeout: 4 * kStay });
  await take('export');
  await page.locator('#export-close').click();
  await panel(page, false);
  await page.locator('#help-button').click();
  await take('help');
  await page.locator('#help-close').click();
  if (await page.locator('#theme').isVisible()) {
    await page.locator('#theme').click();
    await take('light');
    await page.locator('#theme').click();
  }
}

/// The server has ended.
async function offline({ page }, take) {
  await page.waitForFunction(() => document.body.classList.contains('offline'), null, { timeout: kStay });
  await take('offline');
}

async function training({ page }, take) {
  await page.waitForFunction(() => window.aligngs.page.training.charts.points > 20, null, { timeout: 10 * kStay });
  await panel(page, true);
  await take('training', false);
}

/// Pictures side by side, as the text of a WebP or JPEG file.
async function joined(page, pictures, type, height) {
  const text = await page.evaluate(async ([pngs, height, gap, type, quality]) => {
    const images = await Promise.all(pngs.map(async (png) => { const i = new Image(); i.src = `data:image/png;base64,${png}`; await i.decode(); return i; }));
    const widths = images.map((i) => Math.round((i.naturalWidth * height) / i.naturalHeight)), canvas = document.createElement('canvas');
    canvas.width = widths.reduce((sum, w) => sum + w + gap, -gap);
    canvas.height = height;
    const context = canvas.getContext('2d');
    context.imageSmoothingQuality = 'high';
    context.fillStyle = '#fff';
    context.fillRect(0, 0, canvas.width, height);
    let x = 0;
    images.forEach((image, k) => { context.drawImage(image, x, 0, widths[k], height); x += widths[k] + gap; });
    return canvas.toDataURL(type, quality);
  }, [pictures.map((p) => p.toString('base64')), height, kGap, type, type.endsWith('jpeg') ? 0.82 : kQuality]);
  return Buffer.from(text.split(',')[1], 'base64');
}

const { server, url } = await serve(program, run);
let trainer;
await withBrowser(async (browser) => {
  const visit = async (address, states) => {
    for (const [size, width, height] of kSizes) {
      const shown = await open(browser, typeof address === 'string' ? address : await address(), { width, height });
      shown.page.setDefaultTimeout(4 * kStay); // a busy machine draws slowly
      const visited = states(shown, async (state, rest = true) => {
        if (only && !only.includes(state)) return;
        if (rest) await shown.settle();
        const picture = await shown.page.screenshot({ timeout: 4 * kStay });
        taken.set(state, [...(taken.get(state) ?? []), picture]);
        if (process.env.PNGS) writeFileSync(join(process.env.PNGS, `${state}_${size}.png`), picture);
        console.log(`${state}, ${size}`);
        if (only && only.every((s) => (taken.get(s) ?? []).length > kSizes.findIndex(([name]) => name === size))) throw kEnough;
      });
      await visited.catch((e) => { if (e !== kEnough) throw e; });
      const told = shown.complaints.filter((c) => !/ 400 |ERR_CONNECTION_REFUSED|ERR_INCOMPLETE|ERR_EMPTY/.test(c)); // the unicorn, and the server that has ended
      check(told.length === 0, `${size}: no errors in the console ${told.slice(0, 3).join(' | ')}`);
      await shown.page.context().close();
    }
  };
  let bytes = 0;
  const write = async () => {
    const page = await browser.newPage();
    for (const [state, pictures] of taken) {
      const file = await joined(page, pictures, 'image/webp', kHeight);
      bytes += file.length;
      writeFileSync(join(out, 'page', `${state}.webp`), file);
    }
    if (taken.has('picked')) writeFileSync(join(out, 'page.jpg'), await joined(page, taken.get('picked').slice(0, 1), 'image/jpeg', kSizes[0][2]));
    console.log(`${taken.size} states, ${(bytes / 1e6).toFixed(2)} MB so far`);
    taken.clear();
    await page.close();
  };
  await visit(url, finished);
  await write();
  if (!only || only.includes('offline')) {
    let ending;
    await visit(async () => { ending = await serve(program, run); return ending.url; }, async (shown, take) => {
      await shown.page.waitForFunction(() => window.aligngs.page.edits.objects.length > 0, null, { timeout: kStay });
      ending.server.kill('SIGTERM');
      await offline(shown, take);
    });
    await write();
  }
  if (!only || only.includes('training')) {
    trainer = spawn(program, ['train', join(run, 'scene'), '-o', join(folder, 'live_run'), '-n', '200000', '--view'], { stdio: ['ignore', 'ignore', 'pipe'] });
    const address = await new Promise((resolve) => {
      let told = '';
      trainer.stderr.on('data', (d) => { told += d; const found = /http:\/\/127\.0\.0\.1:\d+\//.exec(told); if (found) resolve(found[0]); });
    });
    await visit(address, training);
    await write();
  }
}, { cleanup: () => { server.kill('SIGTERM'); trainer?.kill('SIGKILL'); remove(folder); } });
