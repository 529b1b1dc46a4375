// Key frames and pictures: added, played, saved and opened; the program draws the same way from the file.
// Usage: node test/camera_test.mjs PROGRAM RUN [FOLDER_FOR_SCREENSHOTS]
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { aligngs, check, difference, open, ready, remove, serve, settings, skip, withBrowser } from './browser.mjs';

const { program, run, shots, folder } = settings();
if (!run || !existsSync(run)) skip('no run was given');
const { server, url } = await serve(program, run);
await withBrowser(async (browser) => {
  const { page, complaints, picture, settle, shot, message } = await open(browser, url, { shots, prefix: 'camera_', density: 0.5, width: 900, height: 520 });
  const saved = async (button, name) => {
    const [file] = await Promise.all([page.waitForEvent('download', { timeout: 60000 }), page.locator(button).click()]);
    await file.saveAs(join(folder, name));
    return { name: file.suggestedFilename(), bytes: readFileSync(join(folder, name)) };
  };
  const keys = () => page.evaluate(() => window.aligngs.page.path.keys);
  const eye = () => page.evaluate(() => { const p = window.aligngs.viewer.camera.getPosition(); return [p.x, p.y, p.z]; });
  const apart = (a, b) => Math.hypot(...a.map((v, k) => v - b[k]));

  check(await page.locator('#path-play').isDisabled(), 'there is nothing to play at first');
  await page.locator('#canvas').focus();
  await page.keyboard.press('k');
  const first = await eye();
  await page.evaluate(() => { const n = window.aligngs.page.navigation; n.turn(120, 20); n.dolly(0.8); });
  const second = await eye();
  await page.locator('#path-add').click();
  check((await keys()).length === 2 && await page.locator('#path-keys li').count() === 2, 'two views are added');
  await page.locator('#path-seconds').fill('1');
  await page.locator('#path-seconds').dispatchEvent('change');
  check((await keys())[1].time === 1, 'the path takes the seconds that are wanted');
  const seen = await picture();

  // Played.
  await page.evaluate(() => { window.aligngs.page.path.camera.end(window.aligngs.page.path.keys[0]); });
  check(apart(first, await eye()) < 1e-3, 'a view of the path is gone to');
  await page.locator('#path-play').click();
  await page.waitForFunction(() => !window.aligngs.page.path.playing, null, { timeout: 20000 });
  check(apart(second, await eye()) < 1e-3 && await page.evaluate(() => window.aligngs.page.navigation.enabled), 'playing ends at the last view, and the camera is free');
  check(difference(seen, await picture()) < 1, 'which looks as it did');
  await shot('path');

  // Saved, opened, and drawn by the program.
  const file = await saved('#path-save', 'keys.json');
  check(file.name === 'keys.json' && JSON.parse(file.bytes).keys.length === 2, 'the path is saved as keys.json');
  await page.locator('#path-keys .remove').first().click();
  check((await keys()).length === 1, 'a view is removed');
  await page.locator('#path-file').setInputFiles(join(folder, 'keys.json'));
  await page.waitForFunction(() => window.aligngs.page.path.keys.length === 2);
  check(true, 'and the file brings it back');
  writeFileSync(join(folder, 'torn.json'), file.bytes.subarray(0, 60));
  await page.locator('#path-file').setInputFiles(join(folder, 'torn.json'));
  await page.waitForFunction(() => !document.getElementById('message-box').hidden && document.getElementById('message-box').className === 'error');
  check(/JSON/.test(await message()) && (await keys()).length === 2, `a torn file is refused (${await message()})`);
  const drawn = join(folder, 'drawn.png');
  const canvas = await page.evaluate(() => { const c = document.getElementById('canvas'); return [c.clientWidth, c.clientHeight]; });
  aligngs(program, 'render', run, '--path', join(folder, 'keys.json'), '--at', '1', '--size', canvas.join('x'), '-o', drawn, '-q');
  const pixels = (png) => page.evaluate(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const small = document.createElement('canvas'), context = small.getContext('2d');
    small.width = 160; small.height = 90;
    context.drawImage(image, 0, 0, 160, 90);
    return { size: [image.naturalWidth, image.naturalHeight], data: Array.from(context.getImageData(0, 0, 160, 90).data) };
  }, png.toString('base64'));
  const off = difference(seen, (await pixels(readFileSync(drawn))).data);
  check(off < 8, `the program draws the same view (${off.toFixed(1)} levels off)`);

  // A picture at a size of its own.
  await page.locator('#picture-size').selectOption('1280x720');
  const big = await saved('#picture-save', 'big.png'), image = await pixels(big.bytes);
  check(big.name === 'view_1280x720.png' && image.size.join() === '1280,720', `a picture of a chosen size is saved (${image.size.join(' × ')})`);
  await settle();
  check(difference(seen, await picture()) < 1, 'and the picture on the screen stays');
  await page.reload();
  await ready(page);
  check((await keys()).length === 2, 'the path is there after a reload');
  check(complaints.length === 0, `no errors in the console ${complaints.slice(0, 3).join(' | ')}`);
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
