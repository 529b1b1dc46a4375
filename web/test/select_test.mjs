// Selecting by hand: rectangle, lasso and brush, by mouse and touch; names that edits know, on the page and on the command line.
// Usage: node test/select_test.mjs PROGRAM RUN [FOLDER_FOR_SCREENSHOTS]
import { cpSync, existsSync } from 'node:fs';
import { join } from 'node:path';
import { aligngs, badControls, check, difference, open, remove, serve, settings, skip, withBrowser } from './browser.mjs';

const { program, run: given, shots, folder } = settings(), run = join(folder, 'run');
if (!given || !existsSync(given)) skip('no run was given');
cpSync(given, run, { recursive: true, filter: (path) => !path.includes('/control') });
const { server, url } = await serve(program, run);
await withBrowser(async (browser) => {
  const { page, complaints, picture, shot, message } = await open(browser, url, { shots, prefix: 'select_', density: 0.5, width: 1000, height: 620 });
  await page.waitForFunction(() => window.aligngs.page.edits.objects.length > 0, null, { timeout: 60000 });
  const start = await picture(), box = await page.locator('#canvas').boundingBox();
  const at = (u, v) => [box.x + u * box.width, box.y + v * box.height];
  const count = async () => Number((await page.locator('#select-count').textContent()).replace(/[^0-9]/g, ''));
  const drag = async (...points) => {
    await page.mouse.move(...at(...points[0]));
    await page.mouse.down();
    for (const p of points.slice(1)) await page.mouse.move(...at(...p), { steps: 4 });
    await page.mouse.up();
  };

  // Shapes.
  await page.keyboard.press('b');
  check(await page.locator('#select-bar').isVisible(), 'a key opens the tools');
  await page.locator('[data-tool=rectangle]').click();
  await drag([0.35, 0.35], [0.65, 0.65]);
  const front = await count();
  check(front > 20, `a rectangle selects ${front} splats`);
  check(difference(start, await picture()) > 1, 'which glow');
  await shot('rectangle');
  const hidden = await page.evaluate(() => { // splats that something else hides
    const { viewer, page: p } = window.aligngs, s = viewer.splats, area = viewer.canvas.getBoundingClientRect();
    const chosen = Array.from({ length: s.count }, (_, i) => i).filter((i) => p.hand.flags[i] && s.opacities[i] > 0.3), step = Math.ceil(chosen.length / 60);
    const sample = chosen.filter((_, k) => k % step === 0), far = sample.filter((i) => {
      const world = viewer.toWorld([0, 1, 2].map((k) => s.centres[3 * i + k])), at = viewer.camera.camera.worldToScreen(world);
      const found = viewer.pick(at.x + area.left, at.y + area.top);
      return found && world.distance(viewer.camera.getPosition()) > found.hit.distance + 0.03 * viewer.room.diagonal;
    });
    return far.length / sample.length;
  });
  check(hidden < 0.1, `what is behind them is not taken (${(100 * hidden).toFixed(0)} % of a sample lie deeper)`);
  await drag([0.05, 0.2], [0.95, 0.78]);
  const seen = await count();
  await page.locator('#select-through').check();
  await drag([0.05, 0.2], [0.95, 0.78]);
  check((await count()) > 1.05 * seen, `"through everything" takes ${await count()} instead of ${seen}`);
  await page.locator('#select-through').uncheck();
  await page.locator('[data-tool=lasso]').click();
  await drag([0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]);
  const lasso = await count();
  check(lasso > 5 && lasso < front, `a lasso takes ${lasso}`);
  await page.locator('[data-tool=brush]').click();
  await page.keyboard.down('Shift');
  await drag([0.2, 0.7], [0.35, 0.7]);
  await page.keyboard.up('Shift');
  const more = await count();
  check(more > lasso, `a brush with Shift adds (${more})`);
  await shot('brush');
  await page.locator('[data-how=subtract]').click();
  await drag([0.2, 0.7], [0.35, 0.7]);
  check((await count()) < more, `and takes away with the button (${await count()})`);
  await page.locator('[data-how=new]').click();
  await page.locator('#select-clear').click();
  await page.mouse.move(2, 2);
  check((await count()) === 0 && difference(start, await picture()) < 1, 'clear lets everything go');

  // The keyboard alone.
  const press = async (key, times = 1) => { for (let i = 0; i < times; ++i) await page.keyboard.press(key); };
  await page.locator('[data-tool=rectangle]').focus();
  await press('Enter');
  check(await page.evaluate(() => document.activeElement.id) === 'canvas', 'Enter on a tool goes to the picture');
  const looked = await page.evaluate(() => window.aligngs.page.navigation.pose.eye.toString());
  await press('ArrowLeft', 6);
  await press('ArrowUp', 5);
  await press('Enter');
  await press('ArrowRight', 12);
  await press('ArrowDown', 10);
  await shot('keyboard');
  await press('Enter');
  const keyed = await count();
  check(keyed > 20, `arrows and Enter draw a rectangle (${keyed} splats)`);
  check(looked === await page.evaluate(() => window.aligngs.page.navigation.pose.eye.toString()), 'and leave the camera');
  await press('?');
  check((await page.locator('#key-list').textContent()).includes('draw the selection'), 'the list of keys says so');
  await press('Escape');
  await page.locator('[data-tool=lasso]').focus();
  await press('Enter');
  for (const key of ['ArrowRight', 'ArrowDown', 'ArrowLeft']) { await press('Enter'); await press(key, 6); }
  await press('Enter', 2);
  check((await count()) > 0 && (await count()) < keyed, `and a lasso (${await count()})`);
  await press('Enter');
  await press('ArrowRight');
  await press('Escape');
  check(await page.locator('#select-bar').isVisible() && (await page.locator('#draw-line').getAttribute('d')) === '', 'Escape leaves the shape, not the tools');
  await page.locator('#select-clear').click();

  // The camera, and a finger.
  const pose = () => page.evaluate(() => window.aligngs.page.navigation.pose.eye.toString());
  const stood = await pose();
  await drag([0.5, 0.5], [0.55, 0.5]);
  check(stood === await pose(), 'a drag that draws leaves the camera');
  await page.locator('[data-tool=look]').click();
  await drag([0.5, 0.5], [0.55, 0.5]);
  check(stood !== await pose(), '"look" moves it');
  await page.locator('#home').click();
  await page.locator('[data-tool=rectangle]').click();
  const cdp = await page.context().newCDPSession(page);
  const touch = (type, ...point) => cdp.send('Input.dispatchTouchEvent', { type, touchPoints: point.length ? [{ x: at(...point)[0], y: at(...point)[1] }] : [] });
  await touch('touchStart', 0.4, 0.45);
  for (const p of [0.45, 0.5, 0.6]) await touch('touchMove', p, 0.6);
  await touch('touchEnd');
  const kept = await count();
  check(kept > 5, `a finger draws (${kept})`);

  // Names.
  const save = async (name) => { await page.locator('#select-name').fill(name); await page.locator('#select-name').press('Enter'); };
  await save('wall');
  await page.waitForFunction(() => document.getElementById('message').textContent.includes('means objects'), null, { timeout: 60000 });
  check(true, `the name of a class is refused (${await message()})`);
  await save('my corner');
  const row = page.locator('#selections li');
  await row.first().waitFor({ timeout: 60000 });
  check((await row.first().locator('.class-name').textContent()) === 'my corner', 'a selection gets a name');
  check(aligngs(program, 'edit', run, '--list', '-q').includes(`my corner: ${kept} Gaussians`), 'which the command line knows');
  await shot('named');
  await page.locator('#select').click();
  check(await page.locator('#select-bar').isHidden(), 'the tools go');
  await page.mouse.move(2, 2);
  check(difference(start, await picture()) < 1, 'and the glow with them');

  await page.setViewportSize({ width: 390, height: 844 });
  await page.locator('#select').click();
  await picture();
  await shot('phone');
  const sticks = await page.evaluate(() => { const r = document.getElementById('select-bar').getBoundingClientRect(); return r.left < 0 || r.right > innerWidth || document.documentElement.scrollWidth > innerWidth; });
  check(!sticks, 'the tools fit on a phone');
  const bad = async (where) => { const found = await badControls(page); check(found.length === 0, `plan and stick leave the tools free ${where} ${found.join(', ')}`); };
  const hasPlan = await page.locator('#plan-button').isVisible(), beside = hasPlan ? ['#walk', '#plan-button'] : ['#walk'];
  for (const button of beside) await page.locator(button).click();
  await page.evaluate(() => window.aligngs.page.messages.show('A message of two lines, which stays until it is closed: it and the plan leave each other free.', 'result'));
  await bad('on a phone');
  await page.setViewportSize({ width: 1000, height: 620 });
  await bad('beside the panel');
  await shot('message_beside_plan');
  await page.locator('#message-close').click();
  await page.setViewportSize({ width: 390, height: 844 });
  if (hasPlan) await page.locator('#plan-close').click();
  await page.locator('#select-close').click();
  await page.locator('#walk').click();
  await page.setViewportSize({ width: 1000, height: 620 });
  await page.locator('#home').click();

  // Edits.
  const edits = (n) => page.waitForFunction((k) => document.querySelectorAll('#edits li').length === k && !document.body.classList.contains('busy'), n, { timeout: 60000 });
  await row.first().locator('button.class-name').click();
  await page.waitForFunction(() => document.getElementById('picked-text').textContent.includes('by hand'));
  check(difference(start, await picture()) > 0.5, 'a click in the list shows it');
  await page.locator('#picked-edits button[data-edit=delete]').click();
  await edits(1);
  check((await page.locator('#edits li').first().textContent()) === 'delete my corner, hole filled', 'and its button deletes it');
  const gone = await picture();
  check(difference(start, gone) > 0.3, `from the picture (${difference(start, gone).toFixed(2)} levels)`);
  await shot('deleted');
  await page.keyboard.press('z');
  await edits(0);
  check(difference(start, await picture()) < 1, 'undo brings it back');
  await page.locator('#edit-text').fill('recolor my corner to #ff2020');
  await page.locator('#edit-text').press('Enter');
  await edits(1);
  await shot('recoloured');
  await page.locator('#undo').click();
  await edits(0);
  await row.first().locator('.rename').click();
  await row.first().locator('input').fill('reading nook');
  await row.first().locator('input').press('Enter');
  await page.waitForFunction(() => document.querySelector('#selections .class-name')?.textContent === 'reading nook');
  aligngs(program, 'edit', run, '-q', '--rename-selection', 'reading nook', 'nook');
  await page.waitForFunction(() => document.querySelector('#selections .class-name')?.textContent === 'nook', null, { timeout: 10000 });
  check(true, 'a name is changed here and on the command line');
  await row.first().locator('.remove').click();
  await page.waitForFunction(() => document.getElementById('selection-box').hidden);
  check(true, 'a selection is forgotten');
  const expected = (c) => c.includes('400'); // the name of a class
  check(complaints.filter((c) => !expected(c)).length === 0, `no errors in the console ${complaints.slice(0, 3).join(' | ')}`);
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
