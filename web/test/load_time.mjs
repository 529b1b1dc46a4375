// How long the page takes to its first picture and to all splats. Builds are compared in turn on one machine: the ratio
// counts. Usage: node test/load_time.mjs PROGRAM RUN [FOLDER_OF_ANOTHER_PAGE_OR_PROGRAM ...] [--rounds 5] [--bandwidths]
// Another page is a folder as web/dist, which PROGRAM serves; another program serves its own.
import { readdirSync, readFileSync, statSync } from 'node:fs';
import { serve, withBrowser } from './browser.mjs';

const given = process.argv.slice(2), option = (name) => { const at = given.indexOf(name); return at < 0 ? null : given.splice(at, 2)[1]; };
const kRounds = Number(option('--rounds') ?? 5), bandwidths = given.includes('--bandwidths');
const [program, run, ...others] = given.filter((a) => !a.startsWith('--'));
const kBandwidths = bandwidths ? [['loopback', 0], ['20 Mbit/s', 20], ['4 Mbit/s', 4]] : [['loopback', 0]]; // megabits a second; 0: not throttled
const servers = [];
for (const other of ['', ...others]) {
  const folder = other && statSync(other).isDirectory();
  if (folder) process.env.ALIGNGS_WEB_ROOT = other; else delete process.env.ALIGNGS_WEB_ROOT;
  servers.push({ name: other || 'this', ...await serve(other && !folder ? other : program, run), first: [], all: [], processor: [], bytes: 0 });
}
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

/// Seconds of processor time of the browser so far: they count where other work makes the clock's meaningless.
function processorSeconds() {
  const parents = new Map(), used = new Map(), kTicks = 100; // a second
  for (const pid of readdirSync('/proc').filter((name) => /^\d+$/.test(name))) {
    try {
      const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').replace(/^.*\) /, '').split(' '); // from the state on
      parents.set(pid, fields[1]);
      used.set(pid, (Number(fields[11]) + Number(fields[12])) / kTicks);
    } catch { /* it has ended */ }
  }
  const own = new Set(servers.map((s) => String(s.server.pid)));
  const ours = (pid) => !own.has(pid) && pid !== undefined && (parents.get(pid) === String(process.pid) || ours(parents.get(pid)));
  return [...used].reduce((sum, [pid, seconds]) => sum + (ours(pid) ? seconds : 0), 0);
}

/// Milliseconds from the beginning of the navigation to the first sorted picture of splats, as the page sees it.
const watch = () => {
  let page;
  Object.defineProperty(window, 'aligngs', { get: () => page, set: (value) => {
    page = value;
    value.viewer.app.systems.gsplat.on('frame:ready', (_camera, _layer, ready, loading) => {
      if (!ready || loading > 0 || !value.viewer.splats || window.firstPicture) return;
      requestAnimationFrame(() => { window.firstPicture ??= performance.now(); });
    });
  } });
};
await withBrowser(async (browser) => {
  for (const [name, megabits] of kBandwidths) {
    for (const s of servers) { s.first = []; s.all = []; s.processor = []; }
    for (let round = 0; round < kRounds; ++round) {
      for (const s of servers) {
        const context = await browser.newContext({ viewport: { width: 1180, height: 700 } }), page = await context.newPage();
        await page.addInitScript(watch);
        const client = await context.newCDPSession(page);
        await client.send('Network.enable');
        s.bytes = 0;
        client.on('Network.loadingFinished', (e) => { s.bytes += e.encodedDataLength; });
        if (megabits) await client.send('Network.emulateNetworkConditions', { offline: false, latency: 20, downloadThroughput: (megabits * 1e6) / 8, uploadThroughput: 1e6 / 8 });
        const before = processorSeconds();
        await page.goto(s.url);
        await page.waitForFunction(() => window.firstPicture, null, { timeout: 300000 });
        s.processor.push(processorSeconds() - before);
        s.first.push(await page.evaluate(() => window.firstPicture) / 1000);
        await page.evaluate(() => window.aligngs.ready);
        s.all.push(await page.evaluate(() => performance.now()) / 1000);
        await context.close();
        if (process.env.VERBOSE) console.log(`${round} ${s.name} ${s.first.at(-1).toFixed(2)} ${s.all.at(-1).toFixed(2)} ${s.processor.at(-1).toFixed(2)}`);
      }
    }
    for (const s of servers) {
      const ratio = s === servers[0] ? '' : `, ${(median(s.first) / median(servers[0].first)).toFixed(2)} times that of this page`, spent = median(s.processor).toFixed(2);
      console.log(`${name}, ${s.name}: first picture ${median(s.first).toFixed(2)} s (${Math.min(...s.first).toFixed(2)} to ${Math.max(...s.first).toFixed(2)})${ratio}, ${spent} s of the processor until then, all splats ${median(s.all).toFixed(2)} s, ${(s.bytes / 1e6).toFixed(2)} MB`);
    }
  }
}, { cleanup: () => servers.forEach((s) => s.server.kill('SIGTERM')) });
