// A small room made of numbers, drawn as it was drawn before: guards upgrades of the renderer and of the page.
// Usage: node test/golden_test.mjs PROGRAM - [FOLDER_FOR_SCREENSHOTS] [--update]
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, open, remove, serve, settings, withBrowser } from './browser.mjs';

const golden = join(dirname(fileURLToPath(import.meta.url)), 'golden.png'), update = process.argv.includes('--update');
const { program, shots, folder } = settings(), file = join(folder, 'room.ply');

/// Floor, two walls and three boxes of flat Gaussians with classes; y points down, as in a run.
function room() {
  const rows = [];
  const plane = (origin, u, v, n, color, label, [nu, nv]) => {
    // Rotation that takes z to the normal, for axis-aligned normals.
    const q = n === 'x' ? [Math.SQRT1_2, 0, Math.SQRT1_2, 0] : n === 'y' ? [Math.SQRT1_2, Math.SQRT1_2, 0, 0] : [1, 0, 0, 0];
    const step = Math.hypot(...u) / nu;
    for (let i = 0; i < nu; ++i) for (let j = 0; j < nv; ++j) {
      const p = [0, 1, 2].map((k) => origin[k] + u[k] * (i + 0.5) / nu + v[k] * (j + 0.5) / nv);
      const shade = 0.9 + 0.1 * Math.sin(i * 1.3) * Math.cos(j * 0.9);
      rows.push({ p, color: color.map((c) => c * shade), scale: [step * 0.6, step * 0.6, 0.004], q, label });
    }
  };
  plane([-2, 0, -2], [4, 0, 0], [0, 0, 4], 'y', [0.55, 0.4, 0.25], 3, [40, 40]);
  plane([-2, -2, -2], [4, 0, 0], [0, 2, 0], 'z', [0.8, 0.8, 0.7], 0, [40, 20]);
  plane([-2, -2, -2], [0, 0, 4], [0, 2, 0], 'x', [0.6, 0.7, 0.8], 0, [40, 20]);
  for (const [x, z, s, color, label] of [[-1, -0.8, 0.5, [0.8, 0.2, 0.2], 7], [0.4, -1, 0.35, [0.2, 0.6, 0.3], 19], [0.9, 0.2, 0.25, [0.2, 0.3, 0.8], 39]]) {
    plane([x, -s, z], [s, 0, 0], [0, 0, s], 'y', color, label, [12, 12]);
    plane([x, -s, z + s], [s, 0, 0], [0, s, 0], 'z', color.map((c) => c * 0.8), label, [12, 12]);
    plane([x + s, -s, z], [0, 0, s], [0, s, 0], 'x', color.map((c) => c * 0.6), label, [12, 12]);
    plane([x, -s, z], [0, 0, s], [0, s, 0], 'x', color.map((c) => c * 0.6), label, [12, 12]);
  }
  const names = ['x', 'y', 'z', 'f_dc_0', 'f_dc_1', 'f_dc_2', 'opacity', 'scale_0', 'scale_1', 'scale_2', 'rot_0', 'rot_1', 'rot_2', 'rot_3'];
  const head = ['ply', 'format binary_little_endian 1.0', `element vertex ${rows.length}`, ...names.map((n) => `property float ${n}`),
    'property ushort label', 'property ushort instance', 'property uchar confidence', 'end_header', ''].join('\n');
  const body = Buffer.alloc(rows.length * 61);
  rows.forEach((r, i) => {
    const values = [...r.p, ...r.color.map((c) => (c - 0.5) / 0.28209479), 4, ...r.scale.map(Math.log), ...r.q];
    values.forEach((v, k) => body.writeFloatLE(v, i * 61 + 4 * k));
    body.writeUInt16LE(r.label, i * 61 + 56);
    body.writeUInt16LE(1, i * 61 + 58);
    body.writeUInt8(230, i * 61 + 60);
  });
  return Buffer.concat([Buffer.from(head), body]);
}

writeFileSync(file, room());
const { server, url } = await serve(program, file);
await withBrowser(async (browser) => {
  const { page, complaints, settle, shot, slide } = await open(browser, url, { shots, prefix: 'golden_', width: 760, height: 420 });
  await slide('#overlay', 25);
  await settle();
  await shot('page');
  const drawn = Buffer.from((await page.evaluate(() => document.getElementById('canvas').toDataURL('image/png'))).split(',')[1], 'base64');
  if (update) writeFileSync(golden, drawn);
  check(existsSync(golden), 'there is a golden picture (--update makes it)');
  // Compared in the browser, which can read PNG. Exact on one version of Chromium; others round differently here and there.
  const result = await page.evaluate(async ([a, b]) => {
    const pixels = async (base64) => {
      const image = new Image();
      image.src = `data:image/png;base64,${base64}`;
      await image.decode();
      const canvas = document.createElement('canvas');
      canvas.width = image.naturalWidth; canvas.height = image.naturalHeight;
      canvas.getContext('2d').drawImage(image, 0, 0);
      return canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    };
    const [x, y] = [await pixels(a), await pixels(b)];
    if (x.width !== y.width || x.height !== y.height) return { mean: 255, far: 1, size: `${x.width}x${x.height}, not ${y.width}x${y.height}` };
    let sum = 0, far = 0;
    for (let i = 0; i < x.data.length; ++i) { const d = Math.abs(x.data[i] - y.data[i]); sum += d; far += d > 24; }
    return { mean: sum / x.data.length, far: far / x.data.length, size: `${x.width}x${x.height}` };
  }, [drawn.toString('base64'), readFileSync(golden).toString('base64')]);
  check(result.mean < 1 && result.far < 0.005, `the golden picture is met (${result.size}, ${result.mean.toFixed(3)} levels, ${(100 * result.far).toFixed(2)} % of the values far off)`);
  check(await page.locator('#classes li').count() === 5, 'a single file shows its classes');
  check(!(await page.locator('#editing').isVisible()), 'and cannot be edited');
  check(complaints.length === 0, `no errors in the console ${complaints.slice(0, 3).join(' | ')}`);
}, { cleanup: () => { server.kill('SIGTERM'); remove(folder); } });
