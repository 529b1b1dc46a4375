// A training with `--view`: the splats grow while the page looks on; pause, checkpoint and stop reach the trainer.
// Usage: node test/live_test.mjs PROGRAM SCENE [FOLDER_FOR_SCREENSHOTS]
import { spawn } from 'node:child_process';
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { check, difference, open, remove, settings, skip, sleep, withBrowser } from './browser.mjs';

const { program, run: scene, shots, folder } = settings(), run = join(folder, 'run');
if (!scene || !existsSync(scene)) skip('no scene was given');
const trainer = spawn(program, ['train', scene, '-o', run, '-n', '200000', '--view', '--set', 'checkpoint.keep=9'], { stdio: ['ignore', 'ignore', 'pipe'] });
let told = '';
const ended = new Promise((resolve) => trainer.once('exit', resolve));
const url = await new Promise((resolve, reject) => {
  trainer.stderr.on('data', (d) => { told += d; const found = /http:\/\/127\.0\.0\.1:\d+\//.exec(told); if (found) resolve(found[0]); });
  trainer.once('exit', (status) => reject(new Error(`train --view ended with ${status}: ${told}`)));
});
await withBrowser(async (browser) => {
  const { page, complaints, shot } = await open(browser, url, { shots, prefix: 'live_' });
  const splats = () => page.evaluate(() => window.aligngs.viewer.splats?.count ?? 0);
  const small = () => page.evaluate(() => {
    const source = document.getElementById('canvas'), c = document.createElement('canvas');
    c.width = 80; c.height = 45;
    c.getContext('2d').drawImage(source, 0, 0, 80, 45);
    return Array.from(c.getContext('2d').getImageData(0, 0, 80, 45).data);
  });
  await page.waitForFunction(() => (window.aligngs.viewer.splats?.count ?? 0) > 0, null, { timeout: 60000 });
  check(true, `splats are there while it trains (${await splats()})`);
  check(await page.locator('#stages .stage-now').textContent() === 'train', 'the stage list says that it trains');
  check(await page.locator('#controls').isVisible() && !(await page.locator('#editing').isVisible()), 'it can be paused and stopped, not edited');
  await page.waitForFunction(() => window.aligngs.page.training.charts.points > 3, null, { timeout: 60000 });
  // The server's picture is shown before splats are drawn, which takes long on a busy machine.
  const isDrawn = (pixels) => pixels.some((value, i) => i % 4 < 3 && value !== pixels[i % 4]);
  for (let i = 0; i < 600 && !isDrawn(await small()); ++i) await sleep(100);
  const first = await small(), loaded = await page.evaluate(() => window.aligngs.page.loadedSplats);
  await shot('first');
  await page.waitForFunction((before) => window.aligngs.page.loadedSplats !== before, loaded, { timeout: 60000 });
  await sleep(1500);
  const second = await small();
  check(difference(first, second) > 0.05, `the splats move while it trains (${difference(first, second).toFixed(2)} levels)`);
  check(await page.evaluate(() => window.aligngs.page.training.charts.points) > 3, 'loss and PSNR are drawn');
  check(/step \d+, .* Gaussians, .* dB/.test(await page.locator('#progress').textContent()), await page.locator('#progress').textContent());
  await shot('second');

  await page.locator('#pause').click();
  await page.waitForFunction(() => document.getElementById('status').textContent.includes('paused'), null, { timeout: 30000 });
  await sleep(700);
  const step = await page.locator('#progress').textContent();
  await sleep(1500);
  check(await page.locator('#progress').textContent() === step, `pause holds it (${step.split(',')[0]})`);
  await shot('paused');
  await page.locator('#checkpoint').click();
  const checkpoints = () => (existsSync(join(run, 'checkpoints')) ? readdirSync(join(run, 'checkpoints')).filter((f) => f.endsWith('.safetensors')) : []);
  for (let i = 0; i < 50 && checkpoints().length === 0; ++i) await sleep(100);
  check(checkpoints().length > 0, `a checkpoint is written on demand (${checkpoints().join(' ')})`);
  await page.locator('#canvas').click({ position: { x: 5, y: 5 } });
  await page.keyboard.press(' ');
  await page.waitForFunction((before) => document.getElementById('progress').textContent !== before, step, { timeout: 30000 });
  check(true, 'the space bar lets it go on');
  await page.locator('#stop').click();
  await page.waitForFunction(() => document.getElementById('status').textContent === 'stopped', null, { timeout: 30000 });
  check(JSON.parse(readFileSync(join(run, 'run.json'))).status === 'stopped', 'stop ends the training with a checkpoint');
  for (let i = 0; i < 50 && existsSync(join(run, 'live')); ++i) await sleep(100);
  check(!existsSync(join(run, 'live')), 'and leaves no snapshot behind');
  check(await splats() > 0 && difference(await small(), second) < 60, 'the page goes on and shows the last splats');
  check(!(await page.locator('#controls').isVisible()) && /--resume/.test(await page.locator('#why-not-editable').textContent()),
    'it has no buttons for what has ended, and tells how to go on');
  check(!(await page.locator('#training').evaluate((e) => e.open)), 'and the charts of the finished training are closed');
  await shot('stopped');
  trainer.kill('SIGINT');
  const status = await Promise.race([ended, sleep(30000).then(() => 'nothing')]);
  check(status === 75 && told.includes('--resume'), `Ctrl-C then ends it as a stopped training (status ${status}), with the words to go on`);
  await page.waitForFunction(() => document.getElementById('status').textContent === 'no connection', null, { timeout: 10000 });
  check(await page.locator('#offline').isVisible(), 'the page says that its server is gone');
  check(complaints.filter((c) => !/ERR_CONNECTION|ERR_INCOMPLETE|404/.test(c)).length === 0, `no errors in the console ${complaints.slice(0, 3).join(' | ')}`);
}, { cleanup: () => { trainer.kill('SIGKILL'); remove(folder); } });
