// The picture of an edit in README.md, made from a run of `aligngs demo`. screenshots.mjs makes those of the page.
// Usage: node test/readme_images.mjs PROGRAM RUN [FOLDER: ../docs/images]
import { cpSync, existsSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, open, remove, serve, settings, skip, withBrowser } from './browser.mjs';

const { program, run: given, folder } = settings(), run = join(folder, 'demo_run');
const out = process.argv[4] ?? join(dirname(fileURLToPath(import.meta.url)), '../../docs/images');
if (!given || !existsSync(given)) skip('no run was given');
cpSync(given, run, { recursive: true, filter: (path) => !/\/(control|edits|edits\.json)$/.test(path) });
const { server, url } = await serve(program, run);
await withBrowser(async (browser) => {
  const { page, settle, slide } = await open(browser, url, { width: 1180, height: 700 });
  await page.waitForFunction(() => window.aligngs.page.edits.objects.length > 0, null, { timeout: 60000 });
  const edit = 'delete pillow, cushion';
  await page.locator('#edit-text').fill(edit);
  // The photo that has most of them well inside, from not too near.
  const view = await page.evaluate(() => {
    const { edits, state } = window.aligngs.page, wanted = edits.objects.filter((o) => /^(pillow|cushion)#/.test(o.object));
    const score = (c) => wanted.reduce((sum, o) => {
      const d = o.centre.map((v, k) => v - c.position[k]), p = [0, 1, 2].map((k) => d[0] * c.rotation[0][k] + d[1] * c.rotation[1][k] + d[2] * c.rotation[2][k]);
      const u = (c.fx * p[0]) / p[2] / c.width, v = (c.fy * p[1]) / p[2] / c.height;
      return sum + (p[2] > 1.2 && Math.abs(u) < 0.32 && Math.abs(v) < 0.32 ? 1 + 1 / p[2] : 0);
    }, 0);
    return state.cameras.reduce((best, c) => (score(c) > score(best) ? c : best)).img_name;
  });
  await page.evaluate((name) => { // from that photo's place, as a person looking around
    const { viewer, page: { navigation, state, edits } } = window.aligngs;
    const bed = edits.objects.find((o) => o.object.startsWith('bed#')) ?? edits.objects[0];
    navigation.lookFrom(viewer.toWorld(state.cameras.find((c) => c.img_name === name).position), viewer.toWorld(bed.centre));
  }, view);
  await slide('#overlay', 0);
  await page.locator('#view').selectOption(view);
  await slide('#wipe', 0); // no photo, the splats alone
  const drawn = async () => {
    await settle();
    return page.evaluate(() => document.getElementById('canvas').toDataURL('image/png'));
  };
  const before = await drawn();
  await page.locator('#edit-text').fill(`${edit} --fill`);
  await page.locator('#edit-apply').click();
  await page.waitForFunction(() => document.querySelectorAll('#edits li').length === 1 && !document.body.classList.contains('busy'), null, { timeout: 60000 });
  const after = await drawn();
  const jpeg = await page.evaluate(async ([a, b]) => {
    const pictures = await Promise.all([a, b].map(async (src) => { const i = new Image(); i.src = src; await i.decode(); return i; }));
    const photo = document.getElementById('left-picture'), canvas = document.getElementById('canvas'), ratio = canvas.width / canvas.clientWidth;
    const w = photo.clientWidth, h = photo.clientHeight, width = 560, height = Math.round((width * h) / w), joined = document.createElement('canvas');
    joined.width = 2 * width + 8; joined.height = height;
    const context = joined.getContext('2d');
    context.fillStyle = '#fff';
    context.fillRect(0, 0, joined.width, height);
    pictures.forEach((p, i) => context.drawImage(p, ((canvas.clientWidth - w) / 2) * ratio, ((canvas.clientHeight - h) / 2) * ratio, w * ratio, h * ratio, i * (width + 8), 0, width, height));
    return joined.toDataURL('image/jpeg', 0.85);
  }, [before, after]);
  writeFileSync(join(out, 'edit.jpg'), Buffer.from(jpeg.split(',')[1], 'base64'));
  check(before !== after, 'the edit shows');
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
