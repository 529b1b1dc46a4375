// The mesh under the pointer: its triangles name the object, also while measuring; the box that cuts the room, for splats and mesh.
// Usage: node test/mesh_test.mjs PROGRAM RUN [FOLDER_FOR_SCREENSHOTS]
import { cpSync, existsSync } from 'node:fs';
import { join } from 'node:path';
import { check, difference, open, ready, remove, serve, settings, skip, withBrowser } from './browser.mjs';

const { program, run: given, shots, folder } = settings(), run = join(folder, 'run');
if (!given || !existsSync(given)) skip('no run was given');
cpSync(given, run, { recursive: true, filter: (path) => !path.includes('/control') });
const { server, url } = await serve(program, run);
await withBrowser(async (browser) => {
  const { page, complaints, picture, shot, message } = await open(browser, url, { shots, prefix: 'mesh_', density: 0.5, width: 1000, height: 620 });
  await page.keyboard.press('2');
  await page.waitForFunction(() => window.aligngs.viewer.showsMesh);
  const start = await picture(), box = await page.locator('#canvas').boundingBox();
  const at = (u, v) => [box.x + u * box.width, box.y + v * box.height];
  // Every triangle, one after the other, says the same as the page.
  const compared = await page.evaluate(() => {
    const { viewer } = window.aligngs, { mesh } = viewer, area = viewer.canvas.getBoundingClientRect(), V = viewer.middle().constructor;
    const back = viewer.world.getWorldTransform().clone().invert(), p = mesh.positions;
    const corner = (i) => new V(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
    const brute = (o, d) => {
      let best = Infinity;
      for (let f = 0; f < mesh.indices.length; f += 3) {
        const a = corner(mesh.indices[f]), u = corner(mesh.indices[f + 1]).sub(a), v = corner(mesh.indices[f + 2]).sub(a);
        const n = new V().cross(u, v), t = n.dot(a.clone().sub(o)) / n.dot(d);
        if (!(t > 0 && t < best)) continue;
        const q = o.clone().add(d.clone().mulScalar(t)).sub(a), uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), qu = q.dot(u), qv = q.dot(v), det = uu * vv - uv * uv;
        const s = (vv * qu - uv * qv) / det, r = (uu * qv - uv * qu) / det;
        if (s >= 0 && r >= 0 && s + r <= 1) best = t;
      }
      return best;
    };
    let worst = 0, hits = 0;
    for (let k = 0; k < 24; ++k) {
      const x = area.left + area.width * (0.1 + 0.8 * ((k * 0.618) % 1)), y = area.top + area.height * (0.1 + 0.8 * (k / 24));
      const eye = viewer.camera.getPosition(), far = viewer.camera.camera.screenToWorld(x - area.left, y - area.top, 10).sub(eye).normalize();
      const expected = brute(back.transformPoint(eye.clone()), back.transformVector(far)), found = viewer.pick(x, y);
      if (found) ++hits;
      if (!!found !== Number.isFinite(expected)) worst = Infinity;
      if (found) worst = Math.max(worst, Math.abs(found.hit.distance - expected));
    }
    return { worst, hits };
  });
  check(compared.hits > 12 && compared.worst < 1e-3, `the nearest of all triangles is found at ${compared.hits} places, within ${compared.worst.toExponential(1)}`);
  await page.mouse.move(...at(0.5, 0.5));
  await page.waitForFunction(() => !document.getElementById('hovered').hidden);
  const told = await page.locator('#hovered').textContent();
  check(/^[a-z ]+: .*away$/.test(told), `the pointer tells what is under it (${told})`);
  await page.mouse.click(...at(0.5, 0.5));
  const picked = await page.locator('#picked-text').textContent();
  check(picked.startsWith(told.split(':')[0]) && !picked.includes('of the ray'), `a click names it (${picked})`);
  await page.mouse.move(2, 2);
  const glowing = difference(start, await picture());
  check(glowing > 0.5, `and it glows (${glowing.toFixed(1)} levels)`);
  await shot('picked');
  await page.keyboard.press('Escape');
  const dark = difference(start, await picture());
  check(dark < 0.1, `until it is let go (${dark.toFixed(2)} levels)`);
  await page.keyboard.press('m');
  await page.mouse.click(...at(0.3, 0.5));
  await page.mouse.click(...at(0.6, 0.55));
  const measured = parseFloat(await message()), true_length = await page.evaluate(([a, b]) => { const v = window.aligngs.viewer; return v.pick(...a).point.distance(v.pick(...b).point); }, [at(0.3, 0.5), at(0.6, 0.55)]);
  check(Math.abs(measured - true_length) < 1e-3 && measured > 0.05, `two clicks measure on the mesh (${await message()})`);
  await shot('measured');
  await page.keyboard.press('m');
  await page.mouse.move(2, 2);

  // The box.
  const slide = (id, value) => page.locator(id).evaluate((e, v) => { e.value = v; e.dispatchEvent(new Event('input', { bubbles: true })); }, String(value));
  await page.locator('#cut-box summary').click();
  await slide('#cut-top', 50);
  const low = await picture();
  check(difference(start, low) > 5, `the box cuts the mesh (${difference(start, low).toFixed(1)} levels)`);
  await shot('cut_mesh');
  const height = await page.evaluate(([x, y]) => { const { room } = window.aligngs.viewer, found = window.aligngs.viewer.pick(x, y); return found && (found.point.y - room.floor) / (room.ceiling - room.floor); }, at(0.5, 0.2));
  check(height === null || height <= 0.51, 'nothing above it is under the pointer');
  await page.keyboard.press('1');
  const splats = await picture();
  await shot('cut_splats');
  await page.locator('#copy-link').click();
  await page.waitForFunction(() => location.hash.includes('cut='));
  await page.reload();
  await ready(page);
  check(difference(splats, await picture()) < 1.5, `and the splats, also in a link (${page.url().replace(/.*&/, '')})`);
  await page.locator('#save-view').click();
  await page.locator('#cut-reset').evaluate((e) => e.click());
  const whole = await picture();
  await shot('whole');
  check(difference(splats, whole) > 3, 'reset shows the whole room');
  await page.locator('#views li .class-name').first().click();
  check(difference(splats, await picture()) < 1.5, 'a kept view has its box');
  check(complaints.length === 0, `no errors in the console ${complaints.slice(0, 3).join(' | ')}`);
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
