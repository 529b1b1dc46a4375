// How long the page takes to its first picture and to all splats, at several bandwidths.
// Usage: node test/load_time.mjs PROGRAM RUN
import { open, serve, settings, withBrowser } from './browser.mjs';

const { program, run } = settings();
const kBandwidths = [['loopback', 0], ['20 Mbit/s', 20], ['4 Mbit/s', 4]]; // megabits a second; 0: not throttled
const { server, url } = await serve(program, run);
await withBrowser(async (browser) => {
  for (const [name, megabits] of kBandwidths) {
    const page = await (await browser.newContext({ viewport: { width: 1180, height: 700 } })).newPage();
    const client = await page.context().newCDPSession(page);
    await client.send('Network.enable');
    let bytes = 0;
    client.on('Network.loadingFinished', (e) => { bytes += e.encodedDataLength; });
    if (megabits) await client.send('Network.emulateNetworkConditions', { offline: false, latency: 20, downloadThroughput: (megabits * 1e6) / 8, uploadThroughput: 1e6 / 8 });
    const begin = Date.now();
    await page.goto(url);
    const seen = async (what) => { await page.waitForFunction(what, null, { timeout: 300000, polling: 20 }); return (Date.now() - begin) / 1000; };
    const first = await seen(() => (window.aligngs?.viewer.splats?.count ?? 0) > 0 && window.aligngs.viewer.frames > 1);
    await seen(() => window.aligngs?.ready);
    await page.evaluate(() => window.aligngs.ready);
    const all = (Date.now() - begin) / 1000;
    console.log(`${name}: first picture ${first.toFixed(2)} s, all splats ${all.toFixed(2)} s, ${(bytes / 1e6).toFixed(2)} MB`);
    await page.close();
  }
}, { cleanup: () => server.kill('SIGTERM') });
