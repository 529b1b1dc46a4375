// How long a frame takes while the camera moves, with software GL. Compare two builds on one machine: the ratio counts.
// Usage: node test/frame_time.mjs PROGRAM RUN
import { open, serve, settings, withBrowser } from './browser.mjs';

const { program, run } = settings();
const kFrames = 40;
const { server, url } = await serve(program, run);
await withBrowser(async (browser) => {
  const { page, settle } = await open(browser, url, { width: 1180, height: 700 });
  await settle();
  const box = await page.locator('#canvas').boundingBox();
  const before = await page.evaluate(() => window.aligngs.viewer.frames), begin = Date.now();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  let x = 0;
  while (await page.evaluate(() => window.aligngs.viewer.frames) - before < kFrames) await page.mouse.move(box.x + box.width / 2 + 80 * Math.sin(++x / 10), box.y + box.height / 2);
  await page.mouse.up();
  const frames = await page.evaluate(() => window.aligngs.viewer.frames) - before;
  console.log(`${((Date.now() - begin) / frames).toFixed(1)} ms a frame while the camera moves (${frames} frames)`);
}, { cleanup: () => server.kill('SIGTERM') });
