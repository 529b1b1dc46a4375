// The exported page opens from a file, without a server and without a network. It has the same room, its mesh, the room
// before its edits, measurements and saved views. Every key and button that it offers works.
// Usage: node test/html_test.mjs PROGRAM RUN [FOLDER_FOR_SCREENSHOTS]
import { spawnSync } from 'node:child_process';
import { cpSync, existsSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { aligngs, check, difference, open, ready, remove, serve, settings, skip, spread, withBrowser } from './browser.mjs';

const kSizeOff = 0.15; // share that the size may differ from what was told before

const { program, run: given, shots, folder } = settings(), file = join(folder, 'room.html'), run = join(folder, 'run');
if (!given || !existsSync(given)) skip('no run was given');
cpSync(given, run, { recursive: true, filter: (path) => !/\/(control|edits|edits\.json|page\.json)$/.test(path) });
aligngs(program, 'edit', run, '--say', 'delete bed', '-q');
writeFileSync(join(run, 'page.json'), JSON.stringify({ format: 'aligngs page', version: 1,
  views: [{ name: 'the corner', eye: [0.5, 0.25, 1.25], target: [1.5, 1, 0.5] }], measurements: [{ from: [0, 0, 0], to: [0.3, 0, 0.4] }] }));
const made = spawnSync(program, ['export', run, '-f', 'html', '-o', file], { encoding: 'utf8' });
if (made.status !== 0) throw new Error(`the export ended with ${made.status}: ${made.stderr}`);
const told = Number(/about ([\d.]+) MB/.exec(made.stderr)?.[1]), size = statSync(file).size / 1e6;
const { server, url } = await serve(program, run);
await withBrowser(async (browser) => {
  check(Math.abs(told / size - 1) < kSizeOff, `the size is told before the file is written (about ${told} MB, then ${size.toFixed(2)} MB)`);
  const served = await open(browser, url, {});
  const there = await served.picture();
  await served.page.locator('#original').click();
  const thereBefore = await served.picture();
  await served.page.locator('#original').click();

  // The dialog of the page that is served tells the size, too.
  const reply = served.page.waitForResponse((r) => r.url().endsWith('/api/export'), { timeout: 120000 });
  await served.page.locator('#export-format').selectOption('html');
  await served.page.locator('#export').click();
  await served.page.locator('#export-dialog').waitFor({ state: 'visible', timeout: 60000 });
  const sizes = async () => Number(/about ([\d.]+) MB/.exec(await served.page.locator('#export-size').textContent())[1]);
  const whole = await sizes();
  check(Math.abs(whole / size - 1) < kSizeOff, `the dialog tells the same size (${whole} MB)`);
  await served.page.locator('#export-mesh').uncheck();
  const less = await sizes();
  check(less < whole, `and less without the mesh (${less} MB)`);
  await served.page.screenshot({ path: join(shots, 'html_dialog.png') });
  await served.page.locator('#export-save').click();
  const { bytes } = await (await reply).json();
  check(Math.abs(less / (bytes / 1e6) - 1) < kSizeOff, `the file without it has that size (${(bytes / 1e6).toFixed(2)} MB)`);
  await served.page.close();

  const context = await browser.newContext({ viewport: { width: 800, height: 480 }, offline: true });
  const asked = [];
  context.on('request', (r) => { if (!/^(file|blob|data):/.test(r.url())) asked.push(r.url()); });
  const { page, complaints, picture, shot, slide, settle, message } = await open(context, pathToFileURL(file).href, { shots, prefix: 'html_' });
  const here = await picture();
  await shot('start');
  check(spread(here) > 25, 'the file shows a scene');
  check(difference(here, there) < 1, `the same as the server shows (${difference(here, there).toFixed(2)} levels)`);
  await page.locator('#original').click();
  const before = await picture();
  check(difference(before, thereBefore) < 1 && difference(here, before) > 1, `and the room before its edits (${difference(before, thereBefore).toFixed(2)} levels)`);
  check(await page.locator('#classes li').count() > 2, 'its classes are listed');
  await page.keyboard.press('o');
  check(difference(here, await picture()) < 1, 'a key goes back to the edited room');
  await slide('#overlay', 80);
  check(difference(here, await picture()) > 5, 'labels can be laid over it');
  await slide('#overlay', 0);
  const box = await page.locator('#canvas').boundingBox(), middle = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.click(...middle);
  check(/ away/.test(await page.locator('#picked-text').textContent()), `a click names what is there (${await page.locator('#picked-text').textContent()})`);
  await page.locator('#picked-close').click();
  check(!(await page.locator('#editing').isVisible()) && !(await page.locator('#compare-box').isVisible()), 'what needs a server is not offered');

  // Mesh.
  const mode = async (name) => {
    await page.locator(`#show-${name}`).click();
    await page.waitForFunction((n) => document.getElementById(`show-${n}`).getAttribute('aria-pressed') === 'true', name, { timeout: 30000 });
    return picture();
  };
  const mesh = await mode('mesh'), triangles = () => page.evaluate(() => window.aligngs.viewer.mesh.indices.length / 3);
  await shot('mesh');
  check(spread(mesh) > 20 && difference(mesh, here) < 40, `the mesh is of the same room (${difference(mesh, here).toFixed(1)} levels off, ${await triangles()} triangles)`);
  await page.locator('#original').click();
  await settle();
  await page.waitForFunction(() => window.aligngs.viewer.showsMesh, null, { timeout: 30000 });
  check(difference(await picture(), mesh) > 1, 'and there is one of the room before its edits');
  await page.locator('#original').click();
  await mode('splats');

  // Measurements and views of the run.
  check((await page.locator('#measures li').allTextContents()).join().includes('0.500'), 'measurements are listed');
  await page.locator('#views button.class-name').click();
  const eye = await page.evaluate(() => { const { viewer } = window.aligngs; return viewer.fromWorld(viewer.camera.getPosition(), true); });
  check(Math.hypot(eye[0] - 0.5, eye[1] - 0.25, eye[2] - 1.25) < 1e-3, `a saved view is gone to (${eye.map((v) => v.toFixed(2))})`);
  await page.locator('#home').click();
  await page.locator('#measure').click();
  for (const dx of [-60, 60]) await page.mouse.click(middle[0] + dx, middle[1]);
  check(await page.locator('#measures li').count() === 2, 'a distance can be measured');
  await page.keyboard.press('Escape');
  await page.reload();
  await ready(page);
  check(await page.locator('#measures li').count() === 2, 'and is there when the file is opened again');

  // Every key of the help, and every button.
  const wrong = [];
  const look = async (what) => {
    await page.waitForTimeout(30);
    if (await page.evaluate(() => !document.getElementById('message-box').hidden && document.getElementById('message-box').className === 'error')) wrong.push(`${what}: ${await message()}`);
    if (complaints.length > 0) wrong.push(`${what}: ${complaints.splice(0).join(' ')}`);
    await page.evaluate(() => document.querySelectorAll('dialog[open]').forEach((d) => d.close()));
  };
  const keys = await page.evaluate(() => window.aligngs.page.keys.filter((k) => k.here?.() ?? true).flatMap((k) => k.keys));
  for (const key of keys) {
    await page.locator('#canvas').focus();
    await page.keyboard.press(key);
    await look(`key ${key}`);
  }
  check(wrong.length === 0, `all ${keys.length} keys of the help work ${wrong.join(' | ')}`);
  wrong.length = 0;
  const names = await page.evaluate(() => [...document.querySelectorAll('button, a[href]')].filter((b) => b.offsetParent && !b.disabled && !b.closest('li')).map((b) => b.id));
  for (const id of names) {
    await page.evaluate((name) => { const b = document.getElementById(name); if (b && b.offsetParent && !b.disabled) b.click(); }, id);
    await look(id);
  }
  await settle();
  check(names.length > 10 && wrong.length === 0, `all ${names.length} buttons work ${wrong.join(' | ')}`);
  check(asked.length === 0, `nothing is fetched ${asked.slice(0, 3).join(' ')}`);
  check(complaints.length === 0, `no errors in the console ${complaints.slice(0, 3).join(' | ')}`);
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
