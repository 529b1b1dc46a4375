// Dragging the picked object: a preview, one edit at the end, Escape, and steps of the arrow keys.
// Usage: node test/drag_test.mjs PROGRAM RUN [FOLDER_FOR_SCREENSHOTS]
import { cpSync, existsSync } from 'node:fs';
import { join } from 'node:path';
import { check, difference, open, remove, serve, settings, skip, withBrowser } from './browser.mjs';

const { program, run: given, shots, folder } = settings(), run = join(folder, 'run');
if (!given || !existsSync(given)) skip('no run was given');
cpSync(given, run, { recursive: true, filter: (path) => !path.includes('/control') });
const { server, url } = await serve(program, run);
await withBrowser(async (browser) => {
  const { page, complaints, picture, settle, shot } = await open(browser, url, { shots, prefix: 'drag_', density: 0.5, width: 900, height: 520 });
  await page.waitForFunction(() => window.aligngs.page.edits.objects.length > 0, null, { timeout: 60000 });
  const edits = () => page.locator('#edits li').allTextContents();
  const done = (count) => page.waitForFunction((n) => document.querySelectorAll('#edits li').length === n && !document.body.classList.contains('busy'),
    count, { timeout: 60000 });
  // Shifts and gaps as numbers.
  const snap = await page.evaluate(() => {
    const { Vec3, snapped } = window.aligngs.page.drag.constructor.parts, wall = { normal: new Vec3(1, 0, 0), gap: 0.5 };
    return [0.3, 0.46, 0.7].map((x) => snapped(new Vec3(x, 0, 0.1), [wall], 0.05)).map((v) => [v.x, v.z]);
  });
  check(Math.abs(snap[0][0] - 0.3) < 1e-6 && Math.abs(snap[1][0] - 0.5) < 1e-6 && Math.abs(snap[2][0] - 0.5) < 1e-6 && snap.every((v) => Math.abs(v[1] - 0.1) < 1e-6),
    'an object within 5 cm of a wall touches it, and none goes through');

  // A place of the canvas where an object is, once the camera looks at it.
  const thing = await page.evaluate(() => {
    const { page, viewer } = window.aligngs, shell = /wall|floor|ceiling|window|door|curtain|painting|rug|light/;
    const big = page.objects.objects.filter((o) => !shell.test(o.name)).sort((a, b) => b.count - a.count);
    const box = viewer.canvas.getBoundingClientRect();
    for (const o of big) {
      page.places.flyTo(o);
      for (const [u, v] of [[0.5, 0.5], [0.5, 0.6], [0.4, 0.5], [0.6, 0.5], [0.5, 0.4]]) {
        const x = box.left + u * box.width, y = box.top + v * box.height, found = viewer.pick(x, y);
        if (found && found.hit.label === o.label && found.hit.instance === o.instance) return { name: o.name, x, y, label: o.label, instance: o.instance };
      }
    }
    return null;
  });
  check(thing !== null, `an object can be picked (${thing?.name})`);
  await page.mouse.click(thing.x, thing.y);
  await settle();
  const centre = () => page.evaluate(({ label, instance }) => { const o = window.aligngs.page.objects.find(label, instance); return o && [o.centre.x, o.centre.y, o.centre.z]; }, thing);
  const away = () => page.mouse.move(2, 2); // what is under the pointer glows
  await away();
  const start = await picture(), was = await centre();
  const pose = () => page.evaluate(() => window.aligngs.page.navigation.pose.eye.toString());
  const eye = await pose();

  await page.mouse.move(thing.x, thing.y);
  await page.mouse.down();
  await page.mouse.move(thing.x + 40, thing.y + 10, { steps: 4 });
  const shown = await picture();
  check(difference(start, shown) > 0.5, `the object moves while it is dragged (${difference(start, shown).toFixed(2)} levels)`);
  check((await pose()) === eye, 'and the camera does not');
  await shot('dragging');
  await page.keyboard.press('Escape');
  await page.mouse.up();
  await away();
  check((await edits()).length === 0 && difference(start, await picture()) < 0.5, 'Escape leaves it where it was');

  await page.mouse.move(thing.x, thing.y);
  await page.mouse.down();
  await page.mouse.move(thing.x + 40, thing.y + 10, { steps: 4 });
  const asked = await page.evaluate(() => { const s = window.aligngs.page.drag.shift; return [s.x, s.y, s.z]; });
  await page.mouse.up();
  await done(1);
  check((await edits())[0].startsWith(`move ${thing.name} by `), `one edit at the end (${(await edits())[0]})`);
  const now = await centre(), off = now && Math.hypot(...now.map((v, k) => v - was[k] - asked[k]));
  check(now !== null && off < 0.05 + 0.1 * Math.hypot(...asked), `the object is where it was left, by ${off?.toFixed(3)} of ${Math.hypot(...asked).toFixed(3)}`);
  await shot('dragged');

  await page.locator('#undo').click();
  await done(0);
  await page.evaluate(({ label, instance }) => window.aligngs.page.selection.choose({ label, instance }), thing);
  await page.locator('#canvas').focus();
  await page.keyboard.down('Shift');
  for (let i = 0; i < 3; ++i) await page.keyboard.press('ArrowRight');
  const steps = await page.evaluate(() => window.aligngs.page.drag.shift.length());
  check(steps > 0.02, `three arrows with shift are ${steps.toFixed(2)} units`);
  await page.keyboard.up('Shift');
  await done(1);
  check((await edits()).length === 1, 'and one edit');
  check(complaints.length === 0, `no errors in the console ${complaints.join(' | ')}`);
}, { cleanup: () => { server.kill(); remove(folder); } });
