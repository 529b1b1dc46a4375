// Messages of the page when things go wrong: a server that ends and comes back, a torn file, a run without checkpoints.
// Usage: node test/states_test.mjs PROGRAM RUN [FOLDER_FOR_SCREENSHOTS]
import { appendFileSync, cpSync, existsSync, renameSync } from 'node:fs';
import { join } from 'node:path';
import { check, open, ready, remove, serve, settings, skip, sleep, withBrowser } from './browser.mjs';

const { program, run: given, shots, folder } = settings(), run = join(folder, 'run');
if (!given || !existsSync(given)) skip('no run was given');
cpSync(given, run, { recursive: true, filter: (path) => !path.includes('/control') });
let { server, url } = await serve(program, run);
const end = () => new Promise((resolve) => { server.once('exit', resolve); server.kill('SIGTERM'); });
await withBrowser(async (browser) => {
  const { page, message, shot } = await open(browser, url, { shots, prefix: 'states_', density: 0.5 });
  await page.waitForFunction(() => window.aligngs.page.edits.objects.length > 0, null, { timeout: 60000 });

  // The server ends and another one takes its place.
  await end();
  await page.waitForFunction(() => !document.getElementById('offline').hidden, null, { timeout: 10000 });
  check(await page.locator('#reload').isVisible(), 'without its server the page offers to reload');
  await page.evaluate(() => window.aligngs.page.edits.apply('delete bed'));
  check(/^The server does not answer/.test(await message()), `what needs the server says so (${await message()})`);
  await shot('offline');
  ({ server, url } = await serve(program, run, Number(new URL(url).port)));
  await page.waitForFunction(() => document.getElementById('offline').hidden, null, { timeout: 15000 });
  check(/started again/.test(await message()), `the page finds the new server (${await message()})`);
  await page.evaluate(() => window.aligngs.page.edits.preview('delete bed'));
  check(await page.locator('#preview').isVisible(), 'and is logged in there: an edit is previewed');
  await page.locator('#preview-close').click();

  // A torn line among the events.
  const points = () => page.evaluate(() => window.aligngs.page.training.charts.points);
  await page.waitForFunction(() => window.aligngs.page.training.charts.points > 0, null, { timeout: 10000 });
  const before = await points();
  appendFileSync(join(run, 'events.ndjson'), '{"step":5,"los\n{"step":99999,"losses":{"total":0.1},"psnr":30.5,"gaussians":1234}\n');
  for (let i = 0; i < 50 && await points() === before; ++i) await sleep(100);
  check(await points() === before + 1, 'a torn line among the events loses that line alone');

  // Metres of a network are called an estimate beside the lengths.
  const estimate = page.locator('#object-box .estimate');
  check(await estimate.isHidden(), 'known metres have no remark');
  await page.evaluate(() => {
    const shown = window.aligngs.page;
    if (shown.plan.room) shown.plan.room.scale.source = 'network estimate';
    shown.state.units_estimated = true;
    shown.showScale();
  });
  check(await estimate.isVisible(), "a network's metres are called an estimate");

  // Messages go.
  await page.evaluate(() => window.aligngs.page.messages.show('a mistake', 'error'));
  await page.locator('#message-close').click();
  check(!(await page.locator('#message-box').isVisible()), 'a message can be closed');
  await page.evaluate(() => { const { messages } = window.aligngs.page; messages.noteTime = 300; messages.show('a note'); });
  check(await page.locator('#message-box').isVisible(), 'a note is shown');
  await page.locator('#message-box').waitFor({ state: 'hidden', timeout: 5000 });
  check(true, 'and goes by itself');

  // A phone: a message hides no control.
  await page.setViewportSize({ width: 390, height: 844 });
  await page.evaluate(() => window.aligngs.page.messages.show('A long message that tells in many words what went wrong, and what to do now. '.repeat(3), 'error'));
  const hidden = await page.evaluate(() => {
    const box = document.getElementById('message-box').getBoundingClientRect();
    return [...document.querySelectorAll('button, input, select, a, summary')].filter((e) => {
      const r = e.getBoundingClientRect();
      return e.checkVisibility() && e.id !== 'message-close' && r.width > 0 && r.left < box.right && r.right > box.left && r.top < box.bottom && r.bottom > box.top;
    }).map((e) => e.id || e.textContent);
  });
  check(hidden.length === 0, `on a phone a message hides no control ${hidden.join(' ')}`);
  await shot('phone_message');
  await page.locator('#message-close').click();

  // Without checkpoints.
  await page.setViewportSize({ width: 800, height: 480 });
  renameSync(join(run, 'checkpoints'), join(run, 'elsewhere'));
  await page.reload();
  await ready(page);
  check(await page.locator('#editing').isVisible() && !(await page.locator('#not-editable').isVisible()), 'a run without checkpoints can be edited');
  check(await page.locator('#classes li').count() > 2, 'and is looked at as before');
  const tested = await page.evaluate(() => Object.keys(window.aligngs.page.state.views).find((v) => window.aligngs.page.state.views[v].kinds.includes('depth')));
  const trained = await page.evaluate(() => window.aligngs.page.state.cameras.find((c) => !window.aligngs.page.state.views[c.img_name])?.img_name);
  const kinds = async (view) => { await page.locator('#view').selectOption(view); return page.locator('#right option').allTextContents(); };
  check((await kinds(trained)).length === 1, 'pictures that nobody can draw are not offered');
  if (tested) check((await kinds(tested)).includes('depth'), 'those that are there are');
  await shot('without_checkpoints');
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
