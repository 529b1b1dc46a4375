// The exported page opens from a file, without a server and without a network, and shows the same room.
// Usage: node test/html_test.mjs PROGRAM RUN [FOLDER_FOR_SCREENSHOTS]
import { cpSync, existsSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { aligngs, check, difference, open, remove, serve, settings, skip, spread, withBrowser } from './browser.mjs';

const { program, run: given, shots, folder } = settings(), file = join(folder, 'room.html');
if (!given || !existsSync(given)) skip('no run was given');
cpSync(given, join(folder, 'run'), { recursive: true, filter: (path) => !path.includes('/control') });
aligngs(program, 'export', join(folder, 'run'), '-f', 'html', '-o', file, '-q');
aligngs(program, 'export', join(folder, 'run'), '-f', 'labels.ply', '-o', join(folder, 'room.ply'), '-q');
const { server, url } = await serve(program, join(folder, 'run'));
await withBrowser(async (browser) => {
  const served = await open(browser, url, {});
  const there = await served.picture();
  await served.page.close();
  const context = await browser.newContext({ viewport: { width: 800, height: 480 }, offline: true });
  const asked = [];
  context.on('request', (r) => { if (!/^(file|blob|data):/.test(r.url())) asked.push(r.url()); });
  const { page, complaints, picture, shot, slide } = await open(context, pathToFileURL(file).href, { shots, prefix: 'html_' });
  const here = await picture();
  await shot('start');
  console.log(`${(statSync(file).size / 1e6).toFixed(2)} MB; the labelled PLY has ${(statSync(join(folder, 'room.ply')).size / 1e6).toFixed(2)} MB`);
  check(spread(here) > 25, 'the file shows a scene');
  check(difference(here, there) < 1, `the same as the server shows (${difference(here, there).toFixed(2)} levels)`);
  check(await page.locator('#classes li').count() > 2, 'its classes are listed');
  await slide('#overlay', 80);
  check(difference(here, await picture()) > 5, 'labels can be laid over it');
  await slide('#overlay', 0);
  const box = await page.locator('#canvas').boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  check(/object \d+/.test(await page.locator('#picked-text').textContent()), `a click names the object (${await page.locator('#picked-text').textContent()})`);
  check(!(await page.locator('#editing').isVisible()) && !(await page.locator('#compare-box').isVisible()), 'what needs a server is not offered');
  check(asked.length === 0, `nothing is fetched ${asked.slice(0, 3).join(' ')}`);
  check(complaints.length === 0, `no errors in the console ${complaints.slice(0, 3).join(' | ')}`);
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
