// How long a frame takes while the camera moves, with software GL. Compare two builds on one machine: the ratio counts.
// Usage: node test/frame_time.mjs PROGRAM RUN
import { open, serve, settings, withBrowser } from './browser.mjs';

const { program, run } = settings();
const kFrames = 30;
const { server, url } = await serve(program, run);
await withBrowser(async (browser) => {
  const { page, settle } = await open(browser, url, { width: 1180, height: 700 });
  await settle();
  const told = await page.evaluate(async (frames) => {
    const { viewer, page } = window.aligngs, turned = page.navigation ?? page.orbit, from = viewer.frames, begin = performance.now();
    while (viewer.frames - from < frames) { turned.turn(4, 0); await new Promise(requestAnimationFrame); }
    return `${((performance.now() - begin) / frames).toFixed(1)} ms a frame while the camera moves, ${viewer.canvas.width}x${viewer.canvas.height} pixels at the end`;
  }, kFrames);
  console.log(told);
}, { cleanup: () => server.kill('SIGTERM') });
