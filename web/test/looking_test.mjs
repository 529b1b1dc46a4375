// Finding one's way: glow and names, the object list, walking, walls that go, the plan, keys, links, and a phone.
// Usage: node test/looking_test.mjs PROGRAM RUN [FOLDER_FOR_SCREENSHOTS]
import { cpSync, existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { badControls, check, difference, open, ready, remove, serve, settings, skip, spread, withBrowser } from './browser.mjs';

const { program, run: given, shots, folder } = settings(), run = join(folder, 'run');
if (!given || !existsSync(given)) skip('no run was given');
cpSync(given, run, { recursive: true, filter: (path) => !path.includes('/control') });
const { server, url } = await serve(program, run);
const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
await withBrowser(async (browser) => {
  const { page, complaints, picture, settle, shot, message } = await open(browser, url, { shots, prefix: 'looking_', density: 0.5, width: 1000, height: 620 });
  await page.waitForFunction(() => window.aligngs.page.edits.objects.length > 0, null, { timeout: 60000 });
  const start = await picture();
  const pose = () => page.evaluate(() => { const { eye, target } = window.aligngs.page.navigation.pose; return { eye: [eye.x, eye.y, eye.z], target: [target.x, target.y, target.z] }; });
  const moved = (a, b) => Math.hypot(...a.map((v, k) => v - b[k]));
  const away = async (p) => page.evaluate((v) => { const { room } = window.aligngs.viewer, V = window.aligngs.page.navigation.pose.eye.constructor; return room.cuts(new V(...v)).length; }, p);
  check(await away((await pose()).eye) === 0, 'the start pose is inside the room');

  // Objects glow under the pointer and when they are picked.
  const box = await page.locator('#canvas').boundingBox(), middle = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(...middle);
  await page.waitForFunction(() => !document.getElementById('hovered').hidden);
  const told = await page.locator('#hovered').textContent();
  check(/^[a-z ]+: .*\d m away$|units away$/.test(told), `the pointer tells what is under it (${told})`);
  await page.mouse.click(...middle);
  const glowing = await picture();
  check(difference(start, glowing) > 0.3, `a picked object glows (${difference(start, glowing).toFixed(2)} levels)`);
  await shot('picked');
  await page.mouse.move(box.x + 2, box.y - 5);
  await page.keyboard.press('Escape');
  check(difference(start, await picture()) < 1, 'and stops when it is let go');

  // The list.
  const rows = page.locator('#objects li'), all = await rows.count();
  check(all > 2, `${all} objects are listed`);
  check(/\d+ × \d+ × \d+ cm|units/.test(await rows.first().textContent()), `with their sizes (${await rows.first().textContent()})`);
  const wanted = await page.evaluate(() => window.aligngs.page.objects.objects.find((o) => !/wall|floor|ceiling/.test(o.name)).name);
  await page.locator('#object-search').fill(wanted.replace(/#.*/, ''));
  check(await rows.count() < all && (await rows.first().textContent()).includes(wanted.replace(/#.*/, '')), 'search leaves those with a name');
  const before = await pose();
  await rows.first().locator('.fly').click();
  await settle();
  check(moved(before.eye, (await pose()).eye) > 0.05, 'fly to moves the camera');
  const near = await picture();
  await shot('flown_to');
  await rows.first().locator('.eye').click();
  check(difference(near, await picture()) > 1, 'the eye hides one object');
  await page.locator('#objects-all').click();
  check(difference(near, await picture()) < 3, 'and it comes back');
  await page.locator('#object-search').fill('');

  // Walking.
  await page.locator('#home').click();
  await page.keyboard.press('g');
  await page.locator('#canvas').focus();
  const stood = await pose();
  for (const [key, what] of [['w', 'w'], ['ArrowUp', 'the arrow up']]) {
    const from = (await pose()).eye;
    await page.keyboard.down(key);
    await page.waitForTimeout(300);
    await page.keyboard.up(key);
    check(moved(from, (await pose()).eye) > 0.02, `${what} walks ahead`);
  }
  check(Math.abs((await pose()).eye[1] - stood.eye[1]) < 0.26, 'at the height of the eyes');
  await page.evaluate(() => { for (let i = 0; i < 200; ++i) window.aligngs.page.navigation.walk(0, 0, 0.2); });
  check(await away((await pose()).eye) === 0, 'a walk ends at the wall');
  await page.locator('#home').click();
  const stick = await page.locator('#stick').boundingBox(), from = (await pose()).eye;
  await page.mouse.move(stick.x + stick.width / 2, stick.y + stick.height / 2);
  await page.mouse.down();
  await page.mouse.move(stick.x + stick.width / 2, stick.y + 5);
  await page.waitForTimeout(500);
  await page.mouse.up();
  check(moved(from, (await pose()).eye) > 0.02, 'the stick walks too');
  await shot('walking');
  await page.keyboard.press('g');

  // From outside the walls are cut away, and the distance has a limit.
  await page.locator('#home').click();
  await page.evaluate(() => { for (let i = 0; i < 60; ++i) window.aligngs.page.navigation.dolly(1.2); });
  const outside = await pose();
  check(await away(outside.eye) > 0, 'the camera can go outside');
  const far = moved(outside.eye, outside.target);
  check(far < 2 * await page.evaluate(() => window.aligngs.viewer.room.diagonal), `but not out of sight (${far.toFixed(1)} scene units)`);
  const cut = await picture();
  await shot('outside');
  const whole = await page.evaluate(() => { const v = window.aligngs.viewer; v.layer.cut([], 1); v.draw(); }).then(picture);
  check(difference(cut, whole) > 1, `walls in the way are not drawn (${difference(cut, whole).toFixed(1)} levels)`);
  await page.locator('#home').click();
  check(difference(start, await picture()) < 1, 'home goes back inside');

  // The plan, where the run has one.
  if (await page.locator('#plan-button').isVisible()) {
    await page.keyboard.press('f');
    await page.waitForFunction(() => document.querySelectorAll('#plan-picture .plan-wall').length >= 3);
    await shot('plan');
    const inside = await page.locator('#plan-picture').boundingBox(), at = (await pose()).eye;
    await page.mouse.click(inside.x + inside.width * 0.55, inside.y + inside.height * 0.45);
    check(moved(at, (await pose()).eye) > 0.02 && await away((await pose()).eye) === 0, 'a click on the plan goes there');
    await page.locator('#plan-close').click();
    await page.keyboard.press('g');
  }

  // A known length sets the scale, and is taken back.
  if (existsSync(join(run, 'room.json'))) {
    const scale = () => JSON.parse(readFileSync(join(run, 'room.json'), 'utf8')).scale, first = scale(), item = page.locator('#measures li').first();
    const size = () => page.evaluate(() => window.aligngs.page.objects.size(window.aligngs.page.objects.objects[0])), before_size = await size();
    await page.keyboard.press('m');
    for (const x of [0.35, 0.65]) await page.mouse.click(box.x + box.width * x, box.y + box.height * 0.6);
    await page.keyboard.press('m');
    const measured = parseFloat(await item.textContent());
    await item.locator('.known').click();
    await page.locator('#known-length').fill('-1');
    await page.locator('#known-length').press('Enter');
    check(scale().units_per_scene_unit === first.units_per_scene_unit, 'a length below zero is not sent');
    await page.locator('#known-length').fill(String(2 * measured));
    await shot('known_length');
    await page.locator('#known-length').press('Enter');
    await page.waitForFunction((m) => Math.abs(parseFloat(document.querySelector('#measures li')?.textContent) - 2 * m) < 2e-3, measured);
    check(Math.abs(scale().units_per_scene_unit / first.units_per_scene_unit - 2) < 0.01 && scale().source === 'given', `the length that is known sets the scale (${await message()})`);
    check(await size() !== before_size, `and objects have other sizes (${before_size}, now ${await size()})`);
    await page.locator('#scale-reset').click();
    await page.waitForFunction((m) => Math.abs(parseFloat(document.querySelector('#measures li')?.textContent) - m) < 2e-3, measured);
    check(scale().source === first.source && await page.locator('#scale-reset').isHidden(), 'the scale is taken back');
    await page.locator('#measures-clear').click();
  }

  // Links and kept views.
  await page.evaluate(() => { window.aligngs.page.navigation.turn(150, 40); });
  const here = await pose();
  await page.locator('#save-view').click();
  await page.locator('#copy-link').click();
  await page.waitForFunction(() => location.hash.includes('eye=') && document.getElementById('message').textContent.includes('link'));
  check(/link/.test(await message()), `a link is made (${page.url().replace(/.*#/, '#')})`);
  await page.reload();
  await ready(page);
  check(moved(here.eye, (await pose()).eye) < 0.01 && moved(here.target, (await pose()).target) < 0.01, 'the link opens the same view');
  await page.locator('#home').click();
  await page.locator('#views li .class-name').first().click();
  check(moved(here.eye, (await pose()).eye) < 0.01, 'a kept view comes back after a reload');

  // Keys and dialogs.
  await page.locator('#canvas').focus();
  await page.keyboard.press('?');
  check(await page.locator('#help').evaluate((d) => d.matches(':modal')), 'the list of keys is a dialog');
  check(!(await page.locator('#key-list').textContent()).includes('pause the training'), 'with what works here alone');
  await shot('keys');
  await page.keyboard.press('Escape');
  check(!(await page.locator('#help').isVisible()), 'which Escape closes');
  await page.locator('#show-splats').focus(); // the first control of the page
  const reached = new Set();
  for (let i = 0; i < 60; ++i) { await page.keyboard.press('Tab'); reached.add(await page.evaluate(() => document.activeElement.id)); }
  for (const id of ['walk', 'home', 'help-button', 'canvas', 'overlay', 'edit-text', 'object-search']) check(reached.has(id), `Tab reaches ${id}`);

  // Accessibility, dark and light, and on a phone.
  await page.evaluate(`${axe};0`); // not by the page's own policy, which lets no script in
  const violations = async () => page.evaluate(async () => {
    const { violations: found } = await window.axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa'] });
    return found.map((v) => `${v.id}: ${v.nodes.slice(0, 3).map((n) => n.target.join(' ')).join(', ')}`);
  });
  for (const scheme of ['dark', 'light']) {
    await page.emulateMedia({ colorScheme: scheme });
    await settle();
    const found = await violations();
    check(found.length === 0, `axe finds nothing in ${scheme} colours ${found.join('; ')}`);
    await shot(scheme);
  }
  await page.setViewportSize({ width: 390, height: 844 });
  await settle();
  await shot('phone');
  check(spread(await picture(80, 120)) > 20, 'the room is to be seen on a phone');
  await page.locator('#panel-button').click();
  await page.waitForTimeout(300);
  const small = await badControls(page);
  check(small.length === 0, `a thumb finds every control ${small.join(', ')}`);
  const found = await violations();
  check(found.length === 0, `axe finds nothing on a phone ${found.join('; ')}`);
  check(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), 'nothing sticks out');
  await shot('phone_panel');
  check(complaints.length === 0, `no errors in the console ${complaints.slice(0, 3).join(' | ')}`);
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
