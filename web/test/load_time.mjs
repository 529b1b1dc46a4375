// How long the page takes to its first picture, to its first splats, and to all of them. Builds are compared in turn on one machine: the ratio
// counts. Usage: node test/load_time.mjs PROGRAM RUN [FOLDER_OF_ANOTHER_PAGE_OR_PROGRAM ...] [--rounds 5] [--bandwidths]
// Another page is a folder as web/dist, which PROGRAM serves; another program serves its own.
import { statSync } from 'node:fs';
import { serve, withBrowser } from './browser.mjs';
import { median, processorSeconds } from './processor_time.mjs';

const given = process.argv.slice(2), option = (name) => { const at = given.indexOf(name); return at < 0 ? null : given.splice(at, 2)[1]; };
const kRounds = Number(option('--rounds') ?? 5), bandwidths = given.includes('--bandwidths');
const [program, run, ...others] = given.filter((a) => !a.startsWith('--'));
const kBandwidths = bandwidths ? [['loopback', 0], ['20 Mbit/s', 20], ['4 Mbit/s', 4]] : [['loopback', 0]]; // megabits a second; 0: not throttled
const servers = [], own = process.env.ALIGNGS_WEB_ROOT; // of this page, while it is developed
for (const other of ['', ...others]) {
  const folder = other && statSync(other).isDirectory();
  if (folder) process.env.ALIGNGS_WEB_ROOT = other; else if (other || !own) delete process.env.ALIGNGS_WEB_ROOT; else process.env.ALIGNGS_WEB_ROOT = own;
  servers.push({ name: other || 'this', ...await serve(other && !folder ? other : program, run), shown: [], first: [], all: [], processor: [], bytes: 0 });
}
/// Notes milliseconds from the beginning of the navigation to the first sorted picture of splats, as the page sees it. The
/// same to the first sorted picture of all splats, in a room without edits. The same to the server's picture of the start pose, where there is one.
const watch = () => {
  let page;
  new PerformanceObserver((list) => {
    for (const e of list.getEntries()) if (e.naturalWidth > 1) window.startPicture ??= e.renderTime || e.loadTime;
  }).observe({ type: 'element', buffered: true });
  Object.defineProperty(window, 'aligngs', { get: () => page, set: (value) => {
    page = value;
    value.viewer.app.systems.gsplat.on('frame:ready', (_camera, _layer, ready, loading) => {
      const { splats } = value.viewer;
      if (!ready || loading > 0 || !splats) return;
      requestAnimationFrame(() => {
        window.firstPicture ??= performance.now();
        if (splats.count === (splats.total ?? splats.count)) window.wholePicture ??= performance.now();
      });
    });
  } });
};
await withBrowser(async (browser) => {
  for (const [name, megabits] of kBandwidths) {
    for (const s of servers) { s.shown = []; s.first = []; s.all = []; s.processor = []; }
    for (let round = 0; round < kRounds; ++round) {
      for (const s of servers) {
        const context = await browser.newContext({ viewport: { width: 1180, height: 700 } }), page = await context.newPage();
        await page.addInitScript(watch);
        const client = await context.newCDPSession(page);
        await client.send('Network.enable');
        s.bytes = 0;
        client.on('Network.loadingFinished', (e) => { s.bytes += e.encodedDataLength; });
        if (megabits) await client.send('Network.emulateNetworkConditions', { offline: false, latency: 20, downloadThroughput: (megabits * 1e6) / 8, uploadThroughput: 1e6 / 8 });
        const before = processorSeconds(servers.map((s) => s.server.pid));
        await page.goto(s.url);
        await page.waitForFunction(() => window.firstPicture, null, { timeout: 300000 });
        s.processor.push(processorSeconds(servers.map((s) => s.server.pid)) - before);
        const [splats, picture] = await page.evaluate(() => [window.firstPicture, window.startPicture]);
        s.shown.push(Math.min(splats, picture ?? splats) / 1000);
        s.first.push(splats / 1000);
        await page.waitForFunction(() => window.wholePicture, null, { timeout: 300000 });
        s.all.push(await page.evaluate(() => window.wholePicture) / 1000);
        await context.close();
        if (process.env.VERBOSE) console.log(`${round} ${s.name} ${s.shown.at(-1).toFixed(2)} ${s.first.at(-1).toFixed(2)} ${s.all.at(-1).toFixed(2)} ${s.processor.at(-1).toFixed(2)}`);
      }
    }
    for (const s of servers) {
      const ratio = s === servers[0] ? '' : `, ${(median(s.first) / median(servers[0].first)).toFixed(2)} times that of this page`, spent = median(s.processor).toFixed(2);
      console.log(`${name}, ${s.name}: first picture ${median(s.shown).toFixed(2)} s (${Math.min(...s.shown).toFixed(2)} to ${Math.max(...s.shown).toFixed(2)}), first splats ${median(s.first).toFixed(2)} s (${Math.min(...s.first).toFixed(2)} to ${Math.max(...s.first).toFixed(2)})${ratio}, ${spent} s of the processor until then, all splats ${median(s.all).toFixed(2)} s, ${(s.bytes / 1e6).toFixed(2)} MB`);
    }
  }
}, { cleanup: () => servers.forEach((s) => s.server.kill('SIGTERM')) });
