// How long a frame takes while the camera moves, with software GL. Pages are compared in turn on one machine: the ratio
// counts. Usage: node test/frame_time.mjs PROGRAM RUN [FOLDER_OF_ANOTHER_PAGE ...] [--rounds 5]
// Another page is a folder as web/dist, which PROGRAM serves.
import { serve, withBrowser } from './browser.mjs';
import { median, processorSeconds } from './processor_time.mjs';

const given = process.argv.slice(2), at = given.indexOf('--rounds'), kRounds = at < 0 ? 5 : Number(given.splice(at, 2)[1]);
const [program, run, ...others] = given;
const kWarm = 8, kFrames = 10, kTurn = 13; // frames until the quality of a moving picture is found, and while time is taken; pixels that the pointer is dragged a frame
const kSize = { width: 1180, height: 700 }, kWait = 300000;
const own = process.env.ALIGNGS_WEB_ROOT, pages = [];
for (const name of ['', ...others]) {
  if (name || own) process.env.ALIGNGS_WEB_ROOT = name || own;
  pages.push({ name: name || 'this page', ...await serve(program, run), clock: [], processor: [] });
}
const servers = pages.map((p) => p.server.pid);

/// Turns the camera and draws until so many frames were drawn; milliseconds a frame.
const turning = ([frames, step]) => {
  const { viewer, page } = window.aligngs, turned = page.navigation ?? page.orbit;
  // A frame has ended when the graphics unit has drawn it: one pixel is read.
  const pixel = new Uint8Array(4), gl = viewer.app.graphicsDevice.gl, drawn = () => new Promise((done) => viewer.app.once('frameend', done));
  return (async () => {
    const begin = performance.now();
    for (let i = 0; i < frames; ++i) {
      turned.turn(step, 0);
      viewer.app.renderNextFrame = true;
      await drawn();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    }
    return (performance.now() - begin) / frames;
  })();
};

await withBrowser(async (browser) => {
  for (let round = 0; round < kRounds; ++round) {
    for (const p of pages) {
      const page = await browser.newPage({ viewport: kSize });
      await page.goto(p.url);
      await page.waitForFunction(() => window.aligngs?.ready, null, { timeout: kWait });
      await page.evaluate(() => window.aligngs.ready);
      await page.waitForFunction(() => window.aligngs.viewer.settled, null, { timeout: kWait });
      await page.evaluate(turning, [kWarm, kTurn]);
      const before = processorSeconds(servers);
      p.clock.push(await page.evaluate(turning, [kFrames, kTurn]));
      p.processor.push((1000 * (processorSeconds(servers) - before)) / kFrames);
      if (process.env.VERBOSE) console.log(`${round} ${p.name} ${p.clock.at(-1).toFixed(0)} ms, ${p.processor.at(-1).toFixed(0)} ms of the processor`);
      await page.close();
    }
  }
  const [now] = pages;
  for (const p of pages) {
    const ratio = (kind) => (p === now ? '' : `, ${(median(p[kind]) / median(now[kind])).toFixed(2)} times that of this page`);
    console.log(`${p.name}: ${median(p.clock).toFixed(0)} ms a frame (${Math.min(...p.clock).toFixed(0)} to ${Math.max(...p.clock).toFixed(0)})${ratio('clock')}; processor ${median(p.processor).toFixed(0)} ms${ratio('processor')}`);
  }
}, { cleanup: () => pages.forEach((p) => p.server.kill('SIGTERM')) });
